"""What the robot is told: places, surfaces and what hangs over them, and maps."""
