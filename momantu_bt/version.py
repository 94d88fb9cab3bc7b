"""The version of momantu-bt."""

__version__ = "0.1.0"
