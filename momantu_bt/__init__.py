"""momantu-bt: program a mobile manipulator by editing one tree file."""

__version__ = "0.1.0"
