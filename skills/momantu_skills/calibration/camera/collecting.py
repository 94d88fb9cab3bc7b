"""What the pictures of a board that are being collected cover already, and what is missing."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_skills.calibration.camera.board import Board, Seen
from momantu_skills.calibration.camera.coverage import CELLS
from momantu_skills.calibration.errors import CalibrationError

with lazily():
    import cv2

INDEX = "seen.jsonl"
"""File beside the pictures: a line for each, with the cells that its board covers."""
ENOUGH = 0.7
"""Share of the cells that the pictures should cover."""
TILT = 20.0
"""Degrees by which boards should be tilted to each of four sides."""


@dataclass(frozen=True, slots=True)
class Picture:
    """One picture. cells: row and column of those covered. tilt: of the board's normal, deg.

    tilt: to the right and down, (2,).
    """

    name: str
    board: str
    cells: frozenset[tuple[int, int]]
    tilt: tuple[float, float]


def picture_of(
    name: str, board: Board, seen: Seen, size: tuple[int, int], matrix: Array
) -> Picture:
    """What a picture of this size (width, height) covers; matrix (3, 3): the lens as believed."""
    at = (seen.pixels / size * CELLS).clip(0, CELLS - 1).astype(int)
    points = board.points()[seen.indices]
    _, turn, _ = cv2.solvePnP(points, seen.pixels, matrix, None)
    normal = cv2.Rodrigues(turn)[0][:, 2]
    normal = normal * np.sign(normal[2])
    tilt = np.degrees(np.arctan2(normal[:2], normal[2]))
    cells = frozenset((int(row), int(column)) for column, row in at)
    return Picture(name, str(board), cells, (float(tilt[0]), float(tilt[1])))


def read_index(folder: Path) -> list[Picture]:
    """The pictures that a folder has so far.

    Raises:
        CalibrationError: the index cannot be read.
    """
    file = folder / INDEX
    if not file.exists():
        return []
    try:
        lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
        return [
            Picture(
                str(line["picture"]),
                str(line["board"]),
                frozenset((int(row), int(column)) for row, column in line["cells"]),
                (float(line["tilt"][0]), float(line["tilt"][1])),
            )
            for line in lines
        ]
    except (OSError, ValueError, TypeError, KeyError, IndexError):
        raise CalibrationError(
            f"{file} cannot be read; remove it, or name another folder"
        ) from None


def line_of(picture: Picture) -> str:
    """A picture's line in the index."""
    cells = sorted(picture.cells)
    data = {"picture": picture.name, "board": picture.board, "cells": cells, "tilt": picture.tilt}
    return json.dumps(data) + "\n"


def share(pictures: Sequence[Picture]) -> float:
    """Share of the cells that are covered, 0 to 1."""
    return len(_covered(pictures)) / CELLS**2


def wanted(pictures: Sequence[Picture]) -> list[str]:
    """What further pictures should show, in words; nothing if they are enough."""
    said = []
    covered = _covered(pictures)
    if len(covered) < ENOUGH * CELLS**2:
        edges = {
            "the left": [(i, 0) for i in range(CELLS)],
            "the right": [(i, CELLS - 1) for i in range(CELLS)],
            "the top": [(0, i) for i in range(CELLS)],
            "the bottom": [(CELLS - 1, i) for i in range(CELLS)],
        }
        empty = [name for name, edge in edges.items() if len(covered & set(edge)) <= CELLS // 2]
        said.append(f"the board at {' and '.join(empty) or 'the empty places'}")
    tilts = np.array([each.tilt for each in pictures]).reshape(-1, 2)
    sides = {
        "right": tilts[:, 0].max(initial=0.0),
        "left": -tilts[:, 0].min(initial=0.0),
        "down": tilts[:, 1].max(initial=0.0),
        "up": -tilts[:, 1].min(initial=0.0),
    }
    flat = [name for name, most in sides.items() if most < TILT]
    if flat:
        said.append(f"the board turned {', '.join(flat)} by {TILT:.0f} degrees and more")
    return said


def drawn(pictures: Sequence[Picture]) -> list[str]:
    """The cells as lines of text: # covered, . not."""
    covered = _covered(pictures)
    rows = range(CELLS)
    return ["".join("#" if (row, column) in covered else "." for column in rows) for row in rows]


def _covered(pictures: Sequence[Picture]) -> set[tuple[int, int]]:
    return {cell for each in pictures for cell in each.cells}
