"""Writing a robot file from a proposal."""
