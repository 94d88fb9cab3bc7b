"""What can be found out about a robot from its URDF."""
