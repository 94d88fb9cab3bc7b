"""The planning scene: what stands around the robot, what the site knows, what is held."""
