"""A recorded run as one HTML page that needs nothing else."""

from momantu_bt.page.page import write_page

__all__ = ["write_page"]
