"""Draw the maps of worlds anew after their files were changed.

`python -m momantu_worlds.scenes four_rooms`
"""

import sys

from momantu_bt.world import WorldError
from momantu_worlds.scenes.loading import keep

if __name__ == "__main__":
    try:
        for name in sys.argv[1:] or ["four_rooms"]:
            keep(name)
    except WorldError as error:
        sys.exit(str(error))
