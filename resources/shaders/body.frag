#version 330 core
// Light on a body: sky and ground from a hemisphere, a warm key, a cool fill, a rim; a filmic shoulder at the end.
in vec3 world;
in vec3 facing;
in vec3 base;
in vec2 mark;
in vec2 warmth;
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
uniform float only_hot;
uniform float ground_y;
uniform sampler2D heat_map;
out vec4 colour;

vec3 film(vec3 light) {  // a rational shoulder: linear in the dark, soft in the bright, and then sRGB
    light = light * (1.0 + light * 0.12) / (1.0 + light * 0.42);
    return pow(clamp(light, 0.0, 1.0), vec3(1.0 / 2.2));
}

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
    light += key_light * key + fill_light * clamp(dot(n, fill_from), 0.0, 1.0);
    float edge = 1.0 - facing_eye;
    edge *= edge * edge;
    vec3 lit = skin * light + rim_light * edge * (0.35 + 0.65 * clamp(n.y * 0.5 + 0.5, 0.0, 1.0));
#ifdef GLOSS
    vec3 halfway = normalize(key_from + v);
    float gloss = pow(clamp(dot(n, halfway), 0.0, 1.0), 38.0);
    lit += key_light * gloss * 0.10;
#endif
    lit = mix(lit, accent * (0.45 + 0.75 * key + edge), 0.72 * mark.x);
    lit += accent * mark.y * (1.0 - mark.x) * 0.20;
    float opacity = alpha * mix(1.0, 0.75 + 0.6 * edge, ghost);
    opacity *= mix(1.0, smoothstep(0.01, 0.12, warmth.x * warmth.y), only_hot);
    if (opacity < 0.004)
        discard;  // what is not seen must not hide what is behind it
    colour = vec4(film(lit), clamp(opacity, 0.0, 1.0));
}
