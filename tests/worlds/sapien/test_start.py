"""Opening a world runs no library that a run does not use."""

from __future__ import annotations

import subprocess
import sys

NEVER = ("numpy.f2py", "numpy.testing", "requests", "scipy.optimize", "trimesh")
PROGRAM = f"""
import sys
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.worlds import four_rooms
Simulator(fetch(), four_rooms.draw(0), 0, render=False)
ran = {{name for name, module in sys.modules.items() if type(module) is type(sys)}}
print(sorted(ran.intersection({NEVER!r})))
"""


def test_a_world_loads_neither_trimesh_nor_what_only_sapien_imports() -> None:
    for _ in range(2):  # the first time, cells of the robot may have to be cut
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True
        )
    assert done.stdout.splitlines()[-1] == "[]", done.stderr
