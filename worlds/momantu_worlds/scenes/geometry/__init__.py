"""Bodies as plain values, and their geometry: extents, outlines, prisms, floor-plan shapes."""
