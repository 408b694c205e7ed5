#version 330 core
// A body's surface: each vertex follows its joints (matrix palette), four to a group. Matrices are three rows a joint.
layout(location = 0) in vec3 vertex;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 tint;
layout(location = 3) in vec4 joints_0;  // the strongest first
layout(location = 4) in vec4 weights_0;
#if GROUPS > 1
layout(location = 5) in vec4 joints_1;
layout(location = 6) in vec4 weights_1;
#endif
#if GROUPS > 2
layout(location = 7) in vec4 joints_2;
layout(location = 8) in vec4 weights_2;
#endif
layout(std140) uniform Palette {
    vec4 rows[ROWS];
};
layout(std140) uniform Marks {
    vec4 marks[MARKS];  // a joint's colour, and its heat from 0 to 1, below 0 none
};
uniform mat4 clip_from_world;
uniform mat4 window_from_clip;  // what part of the picture is drawn: for picking, a few pixels
uniform vec3 eye;
uniform vec3 sight;
uniform float nudge;    // metres by which the skin counts as farther from the eye than it is
uniform int selected;
uniform int hovered;
uniform int heated;
uniform int segments;
out vec3 world;
out vec3 facing;
out vec3 base;
out vec2 mark;   // how much of the vertex is selected, hovered
out vec2 warmth; // heat, and how much of the vertex has one
flat out int carrier;
invariant gl_Position;  // depths that one program lays are met by another to the bit

vec4 x = vec4(0.0), y = vec4(0.0), z = vec4(0.0);
vec4 painted = vec4(0.0);

void follow(vec4 joints, vec4 weights) {
    for (int k = 0; k < 4; k++) {
        float w = weights[k];
        if (w == 0.0)
            continue;
        int j = int(joints[k]);
        x += w * rows[3 * j];
        y += w * rows[3 * j + 1];
        z += w * rows[3 * j + 2];
        mark += w * vec2(j == selected, j == hovered);
        if (segments != 0)
            painted += w * w * w * w * vec4(marks[j].rgb, 1.0);  // the power draws the border between segments finer
        if (heated != 0) {
            float heat = marks[j].a;
            warmth += heat < 0.0 ? vec2(0.0) : w * vec2(heat, 1.0);
        }
    }
}

void main() {
    mark = vec2(0.0);
    warmth = vec2(0.0);
    follow(joints_0, weights_0);
#if GROUPS > 1
    follow(joints_1, weights_1);
#endif
#if GROUPS > 2
    follow(joints_2, weights_2);
#endif
    if (warmth.y > 0.0)
        warmth.x /= warmth.y;
    vec4 at = vec4(vertex, 1.0);
    world = vec3(dot(x, at), dot(y, at), dot(z, at));
    vec3 across = cross(y.xyz, z.xyz);  // the cofactors stand for the inverse transpose: lengths do not matter here
    facing = vec3(dot(across, normal), dot(cross(z.xyz, x.xyz), normal), dot(cross(x.xyz, y.xyz), normal));
    facing *= dot(x.xyz, across) < 0.0 ? -1.0 : 1.0;
    base = segments != 0 && painted.a > 0.0 ? painted.rgb / painted.a : tint;
    carrier = int(joints_0.x);
    gl_Position = clip_from_world * vec4(world, 1.0);
    vec3 away = dot(sight, sight) > 0.0 ? sight : normalize(world - eye);
    vec4 farther = clip_from_world * vec4(world + nudge * away, 1.0);
    gl_Position.z = farther.z / farther.w * gl_Position.w;
    gl_Position = window_from_clip * gl_Position;
}
