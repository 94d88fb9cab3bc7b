"""Text to checked model: reading, checking, converting and showing tree files."""
