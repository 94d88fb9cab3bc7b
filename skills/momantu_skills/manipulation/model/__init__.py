"""The robot's body for planning: URDF, convex hulls, kinematics, collision checks."""
