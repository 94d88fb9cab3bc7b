"""What makes a world unusable, found from its description alone, without a simulator."""
