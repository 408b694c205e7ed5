#version 330 core
// Which actor and joint is seen at a pixel, each plus one; 0 where nothing is.
in vec2 warmth;
flat in int carrier;
uniform int actor;
uniform int n_joints;
uniform int only_hot;
out ivec2 id;

void main() {
    if (only_hot != 0 && warmth.x * warmth.y < 0.02)
        discard;  // not seen, so not met
    id = ivec2(actor + 1, carrier < n_joints ? carrier + 1 : 1);
}
