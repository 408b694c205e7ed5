#version 330 core
// One triangle that covers the picture; made from the vertex number, so that no buffer is needed.
out vec2 place;

void main() {
    vec2 corner = vec2(float((gl_VertexID & 1) << 2), float((gl_VertexID & 2) << 1)) - 1.0;
    place = corner * 0.5 + 0.5;
    gl_Position = vec4(corner, 1.0, 1.0);
}
