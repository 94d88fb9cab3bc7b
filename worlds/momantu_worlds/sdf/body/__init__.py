"""Links and shapes of SDF as bodies of a world file, in its frame."""
