"""Two maps on one picture: what both have, and what one of them alone has."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_skills.mapping.comparing.agreement import Overlaid
from momantu_skills.mapping.pictures import sheet
from momantu_skills.mapping.pictures.raster import known_window, resampled

BOTH, ONLY_A, ONLY_B = (0, 0, 0), (213, 94, 0), (0, 114, 178)
"""Black, and the vermilion and the blue of Okabe and Ito, which the colour-blind tell apart."""
FLOOR, FLOOR_A, FLOOR_B, NOBODY = (255, 255, 255), (250, 226, 205), (209, 231, 245), (205, 205, 205)


def comparison_png(laid: Overlaid, note: str) -> bytes:
    """A PNG of both maps on the first one's raster. note: a line beneath the key."""
    in_a, in_b = laid.a != UNKNOWN, laid.b != UNKNOWN
    window = known_window(in_a | in_b, laid.resolution)
    rows, columns = (part.stop - part.start for part in window)
    size = sheet.pixels_of((rows, columns))
    colors = np.empty((*size, 3), dtype=np.uint8)
    colors[:] = NOBODY
    occupied_a, occupied_b = laid.a == OCCUPIED, laid.b == OCCUPIED
    agreed = laid.agrees_a | laid.agrees_b
    layers = (
        (in_a & ~in_b, FREE, FLOOR_A),
        (in_b & ~in_a, FREE, FLOOR_B),
        (in_a & in_b, FREE, FLOOR),
        (agreed, OCCUPIED, BOTH),
        (occupied_b & ~laid.agrees_b, OCCUPIED, ONLY_B),
        (occupied_a & ~laid.agrees_a, OCCUPIED, ONLY_A),
    )
    for mask, value, color in layers:
        colors[_shown(mask[window], value, size)] = color
    key = [
        (BOTH, "wall in both"),
        (ONLY_A, "wall in A only"),
        (ONLY_B, "wall in B only"),
        (FLOOR, "known to both"),
        (FLOOR_A, "known to A only"),
        (FLOOR_B, "known to B only"),
        (NOBODY, "unknown"),
    ]
    corner = [
        low + part.start * laid.resolution
        for low, part in zip(laid.origin, window[::-1], strict=True)
    ]
    extent = columns * laid.resolution, rows * laid.resolution
    return sheet.Sheet(colors, extent, (corner[0], corner[1]), key, [note]).png()


def _shown(mask: NDArray[np.bool_], value: int, size: tuple[int, int]) -> NDArray[np.bool_]:
    """Which pixels show a mask; walls and floor are shrunk as those of a map."""
    cells = np.where(mask, np.uint8(value), np.uint8(UNKNOWN))
    return np.asarray(resampled(cells, *size) == value)
