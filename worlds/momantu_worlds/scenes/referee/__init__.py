"""The referee: whether the goal is met, incidents, and whether claims of skills are true."""
