"""The robot's body for planning: URDF, hulls, kinematics, collision checks."""
