#version 330 core
// A body's surface: each vertex follows up to four joints (matrix palette). Matrices are three rows a joint.
layout(location = 0) in vec3 vertex;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 tint;
layout(location = 3) in vec4 joints;
layout(location = 4) in vec4 weights;
layout(std140) uniform Palette {
    vec4 rows[ROWS];
};
layout(std140) uniform Marks {
    vec4 marks[MARKS];  // four joints to a vec4: heat 0 to 1, below 0 none
};
uniform mat4 clip_from_world;
uniform vec3 eye;
uniform vec3 sight;
uniform float nudge;    // metres by which the skin counts as farther from the eye than it is
uniform int selected;
uniform int hovered;
uniform int heated;
out vec3 world;
out vec3 facing;
out vec3 base;
out vec2 mark;   // how much of the vertex is selected, hovered
out vec2 warmth; // heat, and how much of the vertex has one

void main() {
    vec4 x = vec4(0.0), y = vec4(0.0), z = vec4(0.0);
    mark = vec2(0.0);
    warmth = vec2(0.0);
    for (int k = 0; k < 4; k++) {
        float w = weights[k];
        if (w <= 0.0)
            continue;
        int j = int(joints[k]);
        x += w * rows[3 * j];
        y += w * rows[3 * j + 1];
        z += w * rows[3 * j + 2];
        mark += w * vec2(j == selected, j == hovered);
        if (heated != 0) {
            float heat = marks[j >> 2][j & 3];
            warmth += heat < 0.0 ? vec2(0.0) : w * vec2(heat, 1.0);
        }
    }
    if (warmth.y > 0.0)
        warmth.x /= warmth.y;
    vec4 at = vec4(vertex, 1.0);
    world = vec3(dot(x, at), dot(y, at), dot(z, at));
    facing = vec3(dot(x.xyz, normal), dot(y.xyz, normal), dot(z.xyz, normal));
    base = tint;
    gl_Position = clip_from_world * vec4(world, 1.0);
    vec3 away = dot(sight, sight) > 0.0 ? sight : normalize(world - eye);
    vec4 farther = clip_from_world * vec4(world + nudge * away, 1.0);
    gl_Position.z = farther.z / farther.w * gl_Position.w;
}
