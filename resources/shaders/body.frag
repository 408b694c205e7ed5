#version 330 core
// Light on a body: sky and ground from a hemisphere, a warm key, a cool fill, a rim; a filmic shoulder at the end.
#ifdef WIRE
in vec3 world_;
in vec3 facing_;
in vec3 base_;
in vec2 mark_;
in vec2 warmth_;
noperspective in vec3 sides;
flat in float height;
#define world world_
#define facing facing_
#define base base_
#define mark mark_
#define warmth warmth_
uniform vec3 wire;         // the colour of the edges, sRGB
uniform float wire_width;  // half of it, in pixels
#else
in vec3 world;
in vec3 facing;
in vec3 base;
in vec2 mark;
in vec2 warmth;
#endif
uniform vec3 eye;
uniform vec3 sight;        // the direction of an orthographic camera; 0 for a perspective one
uniform vec3 key_from;
uniform vec3 fill_from;
uniform vec3 sky_light;
uniform vec3 ground_light;
uniform vec3 key_light;
uniform vec3 fill_light;
uniform vec3 rim_light;
uniform vec4 tint;         // colour and how much of it
uniform vec3 accent;
uniform float alpha;
uniform float ghost;
uniform float xray;
uniform float only_hot;
uniform float ground_y;
uniform sampler2D heat_map;
#ifdef SUN
uniform vec3 sun_from;
uniform mat4 sun_from_world;
uniform sampler2DShadow sun_map;
uniform float sun_reach;   // metres that a pixel of the map covers
#endif
out vec4 colour;

vec3 film(vec3 light) {  // a rational shoulder: linear in the dark, soft in the bright, and then sRGB
    light = light * (1.0 + light * 0.12) / (1.0 + light * 0.42);
    return pow(clamp(light, 0.0, 1.0), vec3(1.0 / 2.2));
}

#ifdef SUN
float sunlit(vec3 at) {  // the share of the sun that reaches a place, softened over a square of 5 by 5 places
    vec3 place = (sun_from_world * vec4(at, 1.0)).xyz * 0.5 + 0.5;
    vec2 pixel = 1.0 / vec2(textureSize(sun_map, 0));
    float sum = 0.0;
    for (int i = -2; i <= 2; i++)
        for (int j = -2; j <= 2; j++)
            sum += texture(sun_map, vec3(place.xy + vec2(i, j) * pixel * 1.8, min(place.z, 1.0)));
    return sum / 25.0;
}
#endif

void main() {
    vec3 n = normalize(facing);
    vec3 v = dot(sight, sight) > 0.0 ? -sight : normalize(eye - world);
    if (dot(n, v) < -0.3)
        n = -n;  // a foreign mesh that is inside out is lit all the same
    float facing_eye = clamp(dot(n, v), 0.0, 1.0);
    vec3 skin = mix(base, tint.rgb, tint.a);
    skin = mix(skin, texture(heat_map, vec2(warmth.x, 0.5)).rgb, warmth.y);
    vec3 light = mix(ground_light, sky_light, n.y * 0.5 + 0.5);
    float near_ground = clamp((world.y - ground_y) * 2.2, 0.0, 1.0);
    light *= 0.72 + 0.28 * near_ground;  // the ground takes light away from what is close to it
    float key = clamp((dot(n, key_from) + 0.18) / 1.18, 0.0, 1.0);
#ifdef SUN
    float sun = clamp((dot(n, sun_from) + 0.10) / 1.10, 0.0, 1.0);
    float reached = sun > 0.0 ? sunlit(world + n * sun_reach * 3.0) : 0.0;
    key = 0.42 * key + 0.72 * sun * reached;  // the key goes with the camera, the sun stands still
    light *= 0.88 + 0.12 * reached;
#endif
    light += key_light * key + fill_light * clamp(dot(n, fill_from), 0.0, 1.0);
    float edge = 1.0 - facing_eye;
    float rim = edge * edge * edge;
    vec3 lit = skin * light + rim_light * rim * (0.35 + 0.65 * clamp(n.y * 0.5 + 0.5, 0.0, 1.0));
#ifdef GLOSS
    vec3 halfway = normalize(key_from + v);
    float gloss = pow(clamp(dot(n, halfway), 0.0, 1.0), 38.0);
    lit += key_light * gloss * 0.10;
#endif
    lit = mix(lit, accent * (0.45 + 0.75 * key + rim), 0.72 * mark.x);
    lit += accent * mark.y * (1.0 - mark.x) * 0.20;
    float opacity = alpha * mix(1.0, 0.75 + 0.6 * rim, ghost);
    opacity *= mix(1.0, 0.16 + 0.74 * edge * edge + 0.25 * mark.x, xray);
    opacity *= mix(1.0, smoothstep(0.01, 0.12, warmth.x * warmth.y), only_hot);
    if (opacity < 0.004)
        discard;  // what is not seen must not hide what is behind it
    vec3 shown = film(lit);
#ifdef WIRE
    float line = 1.0 - smoothstep(wire_width - 0.5, wire_width + 0.5, min(sides.x, min(sides.y, sides.z)));
    line *= mix(0.30, 0.85, smoothstep(2.0, 9.0, height));  // triangles too small to tell apart stay a surface
    shown = mix(shown, mix(wire, film(accent), 0.7 * mark.x), line);
#endif
    colour = vec4(shown, clamp(opacity, 0.0, 1.0));
}
