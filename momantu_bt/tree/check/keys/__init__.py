"""Keys of the blackboard, followed from where they are written to where they are read."""
