"""What the GPU is told: meshes, skinning, overlays, picking. OpenGL, no Qt."""
