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
out vec4 colour;

float grid(vec2 at, vec2 pixel) {
    vec2 away = abs(fract(at - 0.5) - 0.5) / max(pixel, vec2(1e-6));
    vec2 line = 1.0 - clamp(away - 0.25, 0.0, 1.0);
    line *= clamp(1.0 - pixel * 4.0, 0.0, 1.0);  // too dense to tell apart: gone before it flickers
    return max(line.x, line.y);
}

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
    float alpha = 1.0 - (1.0 - strength) * (1.0 - dark);
    colour = vec4(tone * strength * (1.0 - dark), alpha);  // premultiplied: the shadow is black
}
