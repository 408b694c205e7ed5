#version 330 core
// Coloured lines and points over the picture: the axes in the corner, the ring about a joint.
layout(location = 0) in vec3 vertex;
layout(location = 1) in vec4 tint;
uniform mat4 clip_from_mark;
out vec4 paint;

void main() {
    paint = tint;
    gl_Position = clip_from_mark * vec4(vertex, 1.0);
}
