"""`python -m momantu_bt`: the command line."""

import sys

from momantu_bt.cli import main

if __name__ == "__main__":
    sys.exit(main())
