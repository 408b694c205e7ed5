#version 330 core
// Hands a triangle on with each corner's distance from the side across, in pixels, so that its edges can be drawn.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
uniform vec2 pixels;  // half the size of the picture
in vec3 world[];
in vec3 facing[];
in vec3 base[];
in vec2 mark[];
in vec2 warmth[];
flat in int carrier[];
out vec3 world_;
out vec3 facing_;
out vec3 base_;
out vec2 mark_;
out vec2 warmth_;
noperspective out vec3 sides;
flat out float height;  // the least of the three

void main() {
    vec2 at[3];
    for (int k = 0; k < 3; k++)
        at[k] = gl_in[k].gl_Position.xy / max(gl_in[k].gl_Position.w, 1e-6) * pixels;
    vec2 a = at[2] - at[1], b = at[0] - at[2], c = at[1] - at[0];
    float area = abs(a.x * b.y - a.y * b.x);
    vec3 heights = area / max(vec3(length(a), length(b), length(c)), vec3(1e-6));
    for (int k = 0; k < 3; k++) {
        gl_Position = gl_in[k].gl_Position;
        world_ = world[k];
        facing_ = facing[k];
        base_ = base[k];
        mark_ = mark[k];
        warmth_ = warmth[k];
        sides = vec3(k == 0 ? heights.x : 0.0, k == 1 ? heights.y : 0.0, k == 2 ? heights.z : 0.0);
        height = min(heights.x, min(heights.y, heights.z));
        EmitVertex();
    }
    EndPrimitive();
}
