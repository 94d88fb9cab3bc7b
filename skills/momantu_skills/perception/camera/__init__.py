"""The camera: from depth to points, which joints aim it, one picture with its pose."""
