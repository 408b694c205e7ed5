#version 330 core
// Only how far away a surface is.
void main() {
}
