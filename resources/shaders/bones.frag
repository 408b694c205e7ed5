#version 330 core
// A line with round ends and an outline, smoothed over a pixel; or who it is, for picking.
noperspective in vec2 at;
flat in vec4 ends;
flat in vec2 widths;
flat in vec4 paint;
flat in ivec2 owner;
#ifdef PICK
uniform float slack;  // pixels by which it may be missed
out ivec2 id;
#else
uniform vec4 outline;
uniform float outline_width;
out vec4 colour;
#endif

void main() {
    vec2 along = ends.zw - ends.xy, from = at - ends.xy;
    float t = clamp(dot(from, along) / max(dot(along, along), 1e-6), 0.0, 1.0);
    float away = length(from - t * along) - mix(widths.x, widths.y, t);
#ifdef PICK
    if (away > slack)
        discard;
    id = owner + 1;
#else
    float inside = clamp(0.5 - away, 0.0, 1.0);
    float around = clamp(0.5 - away + outline_width, 0.0, 1.0);
    float ring = (around - inside) * outline.a;
    colour = vec4(paint.rgb * inside + outline.rgb * ring, inside + ring) * paint.a;
#endif
}
