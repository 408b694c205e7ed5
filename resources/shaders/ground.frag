#version 330 core
// The ground: lines each unit and each ten, as wide as a pixel and fading out, with the two axes and the soft shadow.
in vec3 world;
uniform vec3 centre;
uniform float reach;
uniform float spacing;
uniform vec3 line_colour;
uniform float line_strength;
uniform vec3 axis_x;
uniform vec3 axis_z;
uniform float show_axes;
uniform sampler2D shadow;
uniform vec4 shadow_window;  // corner x, z, and one over its width and depth; 0 where there is none
uniform float shadow_strength;
#ifdef SUN
uniform mat4 sun_from_world;
uniform sampler2DShadow sun_map;
uniform float sun_strength;
#endif
out vec4 colour;

float grid(vec2 at, vec2 pixel) {
    vec2 away = abs(fract(at - 0.5) - 0.5) / max(pixel, vec2(1e-6));
    vec2 line = 1.0 - clamp(away - 0.25, 0.0, 1.0);
    line *= clamp(1.0 - pixel * 4.0, 0.0, 1.0);  // too dense to tell apart: gone before it flickers
    return max(line.x, line.y);
}

#ifdef SUN
float sunless(vec3 at) {  // the share of the sun that something takes away
    vec3 place = (sun_from_world * vec4(at, 1.0)).xyz * 0.5 + 0.5;
    if (any(lessThan(place.xy, vec2(0.0))) || any(greaterThan(place.xy, vec2(1.0))))
        return 0.0;
    vec2 pixel = 1.0 / vec2(textureSize(sun_map, 0));
    float sum = 0.0;
    for (int i = -3; i <= 3; i++)
        for (int j = -3; j <= 3; j++)
            sum += texture(sun_map, vec3(place.xy + vec2(i, j) * pixel * 2.2, clamp(place.z, 0.0, 1.0)));
    return 1.0 - sum / 49.0;
}
#endif

void main() {
    vec2 at = world.xz / spacing;
    vec2 pixel = fwidth(at);
    float fine = grid(at, pixel);
    float coarse = grid(at / 10.0, pixel / 10.0);
    float away = length(world.xz - centre.xz) / reach;
    float fade = clamp(1.0 - away, 0.0, 1.0);
    fade = fade * fade;
    float strength = max(fine * 0.42, coarse) * line_strength * fade;
    vec3 tone = line_colour;
    vec2 axis = 1.0 - clamp(abs(at) / max(pixel, vec2(1e-6)) - 0.6, 0.0, 1.0);
    axis *= show_axes * fade;
    tone = mix(tone, axis_x, axis.y);
    strength = max(strength, axis.y * 0.75);
    tone = mix(tone, axis_z, axis.x);
    strength = max(strength, axis.x * 0.75);
    vec2 inside = (world.xz - shadow_window.xy) * shadow_window.zw;
    float dark = 0.0;
    if (shadow_window.z > 0.0 && all(greaterThan(inside, vec2(0.0))) && all(lessThan(inside, vec2(1.0))))
        dark = texture(shadow, inside).r * shadow_strength;
#ifdef SUN
    dark = 1.0 - (1.0 - 0.62 * dark) * (1.0 - sun_strength * sunless(world));
#endif
    float alpha = 1.0 - (1.0 - strength) * (1.0 - dark);
    colour = vec4(tone * strength * (1.0 - dark), alpha);  // premultiplied: the shadow is black
}
