#version 330 core
// The backdrop: a vertical gradient with a soft light behind the figure, dithered against banding.
in vec2 place;
uniform vec3 top;
uniform vec3 bottom;
uniform vec3 glow;
uniform float aspect;
out vec4 colour;

void main() {
    vec2 away = (place - vec2(0.5, 0.52)) * vec2(min(aspect, 2.0), 1.0);
    vec3 backdrop = mix(bottom, top, smoothstep(0.0, 1.0, place.y));
    backdrop += glow * exp(-5.0 * dot(away, away));
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    colour = vec4(backdrop + (noise - 0.5) / 255.0, 1.0);
}
