"""A URDF alone: its links and joints, its shapes, rays and kinematics on them."""
