"""World files, the episodes drawn from them, what the robot is told, the referee; no simulator."""
