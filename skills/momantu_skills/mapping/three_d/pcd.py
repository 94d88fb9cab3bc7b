"""Point clouds as PCL reads them: PCD 0.7, binary, x y z as 32 bit floats."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array

HEADER = """\
# .PCD v0.7 - Point Cloud Data file format
VERSION 0.7
FIELDS x y z
SIZE 4 4 4
TYPE F F F
COUNT 1 1 1
WIDTH {count}
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS {count}
DATA binary
"""


def pcd(points: Array) -> bytes:
    """The whole file of points (n, 3), m."""
    header = HEADER.format(count=len(points)).encode("ascii")
    return header + np.ascontiguousarray(points, dtype="<f4").tobytes()
