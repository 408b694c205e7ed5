"""What moves: skeletons, the motion matrix, kinematics and error metrics. Arrays in, arrays out."""
