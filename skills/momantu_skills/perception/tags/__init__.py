"""AprilTags: found in pictures, and where they are, one by one or as bundles."""
