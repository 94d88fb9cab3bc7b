"""Corners of tags where their edges meet: lines through where the brightness changes.

A corner that is looked for in a window around it, as chessboards allow, is off inwards by a quarter
of a pixel, for blur rounds it; the edges beside it are not moved by blur.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily

with lazily():
    import cv2

_ALONG = np.linspace(0.12, 0.88, 24)
"""Where along an edge it is looked for, as shares of its length."""
_BENT = float((4.0 * _ALONG * (1.0 - _ALONG)).mean())
"""Mean distance of a bent edge from its chord, as a share of that of its middle."""
_STEPS = 13
"""Brightnesses across the edge at each of these places."""
_WIDE = 0.4
"""How far from the edge, in cells of the tag: its border is one cell wide, and blurred."""
_CELLS = 8
_LEAST, _MOST = 1.5, 5.0
"""px from the edge."""
_ROUNDS = 6
_HASTE = 1.5
"""What is far from the edge counts less, so that a step falls short; steps are longer by this."""
_FAR = 2.0
"""px; a tag whose corners would move farther is taken as it was."""


def refined(gray: NDArray[np.uint8], corners: Array) -> Array:
    """Corners (T, 4, 2) of tags of the family 36h11, in px, from corners that are right to 1 px."""
    found = corners.astype(float)
    for _ in range(_ROUNDS):
        found = _crossings(*_lines(gray, found))
    near = np.linalg.norm(found - corners, axis=2).max(axis=1) < _FAR
    return np.where(near[:, None, None], found, corners)


def bent(corners: Array, middles: Array) -> Array:
    """How far `refined` finds corners from where they are, (T, 4, 2) px, if a lens bends the edges.

    The line through an edge that is bent lies beyond its ends, by most of the bend.
    corners, middles: (T, 4, 2) px, where the lens puts the corners and the middle of each edge from
    one corner to the next.
    """
    after = np.roll(corners, -1, axis=1)
    along = (after - corners) / np.linalg.norm(after - corners, axis=2, keepdims=True)
    across = np.stack([along[..., 1], -along[..., 0]], axis=-1)
    off = _BENT * ((middles - 0.5 * (corners + after)) * across).sum(axis=2)
    rows = np.stack([np.roll(across, 1, axis=1), across], axis=2)
    offs = np.stack([np.roll(off, 1, axis=1), off], axis=2)
    return np.asarray(np.linalg.solve(rows, offs[..., None])[..., 0])


def _lines(gray: NDArray[np.uint8], corners: Array) -> tuple[Array, Array]:
    """A point and a direction (T, 4, 2) of each edge, from one corner to the next."""
    way = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(way, axis=2, keepdims=True)
    along = way / length
    across = np.stack([along[..., 1], -along[..., 0]], axis=-1)
    on = corners[:, :, None] + _ALONG[:, None] * way[:, :, None]
    off = _edge(gray, on, across, np.clip(_WIDE * length / _CELLS, _LEAST, _MOST))
    slope, offset = _fitted((_ALONG - 0.5) * length, off)
    middle = corners + 0.5 * way + offset[..., None] * across
    return middle, along + slope[..., None] * across


def _edge(gray: NDArray[np.uint8], on: Array, across: Array, half: Array) -> Array:
    """How far the edge is from places (T, 4, S, 2), across (T, 4, 2): (T, 4, S) px.

    The mean place of the change of brightness: blur leaves it where it is, and so do even shades on
    both sides. What is far counts less, as there the other side of the tag's border begins, which
    would move the edge outwards. half: (T, 4, 1) px, how far it is looked for.
    """
    shares = np.linspace(-1.0, 1.0, _STEPS)
    places = on[:, :, :, None] + (shares * half)[:, :, None, :, None] * across[:, :, None, None]
    between = 0.5 * (shares[1:] + shares[:-1])
    change = np.diff(_brightness(gray, places), axis=-1) * np.cos(0.5 * np.pi * between)
    total = change.sum(axis=-1)
    total = np.where(abs(total) < 1.0, 1.0, total)
    return np.asarray(np.clip(_HASTE * (between * change).sum(-1) / total, -1.0, 1.0) * half)


def _brightness(gray: NDArray[np.uint8], places: Array) -> Array:
    """Between pixels, at places (..., 2)."""
    flat = places.reshape(-1, len(_ALONG) * _STEPS, 2).astype(np.float32)
    x, y = np.ascontiguousarray(flat[..., 0]), np.ascontiguousarray(flat[..., 1])
    light = cv2.remap(
        gray.astype(np.float32), x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    return np.asarray(light, dtype=float).reshape(places.shape[:-1])


def _fitted(x: Array, y: Array) -> tuple[Array, Array]:
    """Slopes and offsets (T, 4) of lines through points (T, 4, P); those far off count less."""
    weight = np.ones_like(x)
    for _ in range(3):
        total = weight.sum(axis=-1)
        mean_x, mean_y = (weight * x).sum(-1) / total, (weight * y).sum(-1) / total
        dx, dy = x - mean_x[..., None], y - mean_y[..., None]
        slope = (weight * dx * dy).sum(-1) / np.maximum((weight * dx * dx).sum(-1), 1e-9)
        left = dy - slope[..., None] * dx
        usual = np.maximum(np.median(abs(left), axis=-1, keepdims=True), 0.02)
        weight = 1.0 / (1.0 + (left / (3.0 * usual)) ** 2)
    return slope, mean_y - slope * mean_x


def _crossings(points: Array, ways: Array) -> Array:
    """Where each edge meets the one before it: the corners (T, 4, 2)."""
    before, way = np.roll(points, 1, axis=1), np.roll(ways, 1, axis=1)
    apart = points - before
    area = way[..., 0] * ways[..., 1] - way[..., 1] * ways[..., 0]
    share = (apart[..., 0] * ways[..., 1] - apart[..., 1] * ways[..., 0]) / area
    return np.asarray(before + share[..., None] * way)
