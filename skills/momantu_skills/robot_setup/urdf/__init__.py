"""A URDF as it is: its links and joints, its shapes, rays and kinematics on them."""
