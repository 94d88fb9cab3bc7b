"""The world file: its schema, its reader, and the checks across its sections."""
