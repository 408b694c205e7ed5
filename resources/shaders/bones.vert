#version 330 core
// Joints and bones over the picture: each a quad, in pixels, about a line whose width may change from end to end.
layout(location = 0) in vec2 corner;
layout(location = 1) in vec4 line;   // from, to
layout(location = 2) in vec2 radii;  // at either end
layout(location = 3) in vec4 tint;
layout(location = 4) in vec2 who;    // actor and joint
uniform vec2 size;
uniform mat4 window_from_clip;
noperspective out vec2 at;
flat out vec4 ends;
flat out vec2 widths;
flat out vec4 paint;
flat out ivec2 owner;

void main() {
    at = corner;
    ends = line;
    widths = radii;
    paint = tint;
    owner = ivec2(who);
    gl_Position = window_from_clip * vec4(corner / size * 2.0 - 1.0, 0.0, 1.0);
}
