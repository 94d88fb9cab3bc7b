"""`python -m momantu_bt`: the command line."""

from momantu_bt.cli import main

if __name__ == "__main__":
    main()
