"""The points of a PointCloud2: its fields by their names, whatever their types and order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""Types of fields by the number that sensor_msgs/PointField has for each."""
TIMES = ("t", "time", "timestamp", "time_stamp", "timeStamp", "offset_time", "stamp")
"""Names by which drivers tell when a point was measured: Ouster, Velodyne, Hesai, and others."""
RINGS = ("ring", "line", "channel")
NOWHERE = 1e-3
"""Distance from the lidar, m, up to which a point is none: drivers write 0 0 0 for no echo."""


class CloudError(ValueError):
    """A cloud has no points that can be read; the message says why."""


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Points (n, 3) of one turn, m, in the order in which the message has them; echoes only.

    times: (n,) as the message tells them, in a unit of the driver's; rings: (n,). None: untold.
    """

    xyz: Array
    times: Array | None
    rings: NDArray[np.int64] | None


def points_of(message: Any) -> Points:
    """The points of a message; those without an echo are left out.

    Raises:
        CloudError: it has no x, y and z of floating point, or holds less data than it says.
    """
    table = _table(message)
    names = table.dtype.names or ()
    missing = [name for name in ("x", "y", "z") if name not in names]
    if missing:
        has = ", ".join(names) or "no fields"
        raise CloudError(f"its points have no {' and no '.join(missing)}, but {has}")
    kinds = {table.dtype[name].kind for name in ("x", "y", "z")}
    if kinds != {"f"}:
        raise CloudError("its x, y and z are whole numbers; expected float32 or float64, in m")
    xyz = np.column_stack([table[name].astype(np.float64) for name in ("x", "y", "z")])
    with np.errstate(over="ignore", invalid="ignore"):
        kept = np.isfinite(xyz).all(axis=1) & (np.abs(xyz).max(axis=1, initial=0.0) > NOWHERE)
    times = next((table[name].astype(np.float64) for name in TIMES if name in names), None)
    if times is not None and not np.isfinite(times[kept]).all():
        times = None
    return Points(xyz[kept], None if times is None else times[kept], _rings(message, table, kept))


def _table(message: Any) -> NDArray[np.void]:
    """All points as records; a gap at the end of a row is skipped."""
    order = ">" if message.is_bigendian else "<"
    fields = {field.name: field for field in message.fields if field.datatype in NUMBERS}
    width, height, step = int(message.width), int(message.height), int(message.point_step)
    kind = np.dtype(
        {
            "names": list(fields),
            "formats": [order + NUMBERS[each.datatype] for each in fields.values()],
            "offsets": [int(each.offset) for each in fields.values()],
            "itemsize": max(step, 1),
        }
    )
    row = max(int(message.row_step), width * step)
    data = np.ascontiguousarray(message.data, dtype=np.uint8)
    if len(data) < row * (height - 1) + width * step:
        raise CloudError(
            f"it says that it has {height} x {width} points of {step} bytes, and holds "
            f"{len(data)} bytes"
        )
    rows = [data[row * k : row * k + width * step].view(kind) for k in range(height)]
    return np.concatenate(rows) if rows else np.zeros(0, kind)


def _rings(message: Any, table: NDArray[np.void], kept: Any) -> NDArray[np.int64] | None:
    """The ring of each point: as told, or the row of a cloud that has rows."""
    names = table.dtype.names or ()
    name = next((name for name in RINGS if name in names), None)
    if name is not None and table.dtype[name].kind in "iu":
        return np.asarray(table[name][kept].astype(np.int64))
    if message.height > 1:
        return np.asarray(np.repeat(np.arange(message.height), message.width)[kept])
    return None
