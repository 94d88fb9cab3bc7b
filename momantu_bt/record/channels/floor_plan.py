"""The site's floor plan as a grid: `/map`, once."""

from __future__ import annotations

import base64

import numpy as np

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN, MapPicture
from momantu_bt.frames import MAP
from momantu_bt.geometry import Transform
from momantu_bt.record.channels.channel import time_text
from momantu_bt.record.channels.poses import pose_text

FREE_BYTE, OCCUPIED_BYTE, UNKNOWN_BYTE = 0, 100, 255
"""The meanings of a byte in a viewer's grid."""
_BYTES = np.zeros(3, np.uint8)
_BYTES[[FREE, OCCUPIED, UNKNOWN]] = FREE_BYTE, OCCUPIED_BYTE, UNKNOWN_BYTE
_UINT8 = 1
"""foxglove.NumericType."""


def grid_text(plan: MapPicture) -> str:
    """The plan as a message for viewers."""
    corner = pose_text(Transform((*plan.origin, 0.0)))
    cells = _BYTES[plan.cells()]
    columns, size = cells.shape[1], plan.resolution
    data = base64.b64encode(cells.tobytes()).decode("ascii")
    return (
        f'{{"timestamp":{time_text(0.0)},"frame_id":"{MAP}","pose":{corner},'
        f'"column_count":{columns},"cell_size":{{"x":{size!r},"y":{size!r}}},'
        f'"row_stride":{columns},"cell_stride":1,'
        f'"fields":[{{"name":"occupancy","offset":0,"type":{_UINT8}}}],"data":"{data}"}}'
    )
