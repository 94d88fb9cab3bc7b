"""A recorded run again: its instants, its tree without a world, and what two runs differ in."""
