"""MCAP files: their records as bytes, safe writing, and the schemas of messages."""
