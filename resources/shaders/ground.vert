#version 330 core
// A square of the ground about the figure, as large as the fade of the grid.
uniform mat4 clip_from_world;
uniform vec3 centre;
uniform float reach;
out vec3 world;

void main() {
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
    world = centre + vec3(corner.x, 0.0, corner.y) * reach;
    gl_Position = clip_from_world * vec4(world, 1.0);
}
