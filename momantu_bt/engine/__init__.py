"""Model to nodes to ticks."""
