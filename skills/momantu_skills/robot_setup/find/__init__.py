"""Finding a robot's properties in its URDF."""
