"""A recorded run again: its moments, its tree without a world, and what two runs differ in."""
