"""The planning scene: obstacles around the robot, the site's furniture, the held object."""
