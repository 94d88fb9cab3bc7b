"""The pictures of a folder, and where each shows the board."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from momantu_bt.lazy import lazily
from momantu_skills.calibration.camera.board import Board, Seen, find, size_of_chessboard
from momantu_skills.calibration.camera.lens import LEAST_PICTURES
from momantu_skills.calibration.errors import CalibrationError

with lazily():
    import cv2

SUFFIXES = frozenset({".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".webp"})
_ASKED = 5
"""Pictures that are searched for a board of another size."""
_MOST_ODD = 0.2
"""Largest share of pictures of another size than the others: with more, they are two cameras'."""


@dataclass(frozen=True, slots=True, eq=False)
class Pictures:
    """size: width and height, px. names: of the pictures with the board; without: of the others.

    odd: names of those with another size, which do not count, and that size.
    """

    size: tuple[int, int]
    names: tuple[str, ...]
    seen: tuple[Seen, ...]
    without: tuple[str, ...]
    odd: tuple[tuple[str, tuple[int, int]], ...] = ()


def read_pictures(folder: Path, board: Board) -> Pictures:
    """Look for the board in every picture of a folder, by name.

    Raises:
        CalibrationError: there are no pictures, many are of another size than the others, or too
            few show the board.
    """
    if not folder.is_dir():
        raise CalibrationError(f"{folder} is no folder; expected a folder of pictures")
    files = sorted(each for each in folder.iterdir() if each.suffix.lower() in SUFFIXES)
    if not files:
        raise CalibrationError(f"{folder} has no pictures; expected PNG, JPEG, TIFF, …")
    sizes = [_size(_gray(file)) for file in files]
    size = _usual_size(files, sizes)
    names, seen, without, odd = [], [], [], []
    for file, own in zip(files, sizes, strict=True):
        if own != size:
            odd.append((file.name, own))
            continue
        points = find(board, _gray(file))
        if points is None:
            without.append(file.name)
        else:
            names.append(file.name)
            seen.append(points)
    if len(seen) < LEAST_PICTURES:
        raise CalibrationError(_too_few(folder, board, len(seen), files))
    return Pictures(size, tuple(names), tuple(seen), tuple(without), tuple(odd))


def _usual_size(files: Sequence[Path], sizes: Sequence[tuple[int, int]]) -> tuple[int, int]:
    """The size of most pictures; refuses those of two cameras."""
    usual, count = Counter(sizes).most_common(1)[0]
    if len(files) - count <= _MOST_ODD * len(files):
        return usual
    first = files[sizes.index(usual)].name
    file, own = next(each for each in zip(files, sizes, strict=True) if each[1] != usual)
    raise CalibrationError(
        f"{file} has {own[0]} x {own[1]} pixels, {first} {usual[0]} x {usual[1]}: one camera's "
        "pictures are of one size"
    )


def _size(gray: NDArray[np.uint8]) -> tuple[int, int]:
    return gray.shape[1], gray.shape[0]


def _gray(file: Path) -> NDArray[np.uint8]:
    gray = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
    if gray is None:
        raise CalibrationError(f"{file} is no picture that can be read; delete it from the folder")
    return np.asarray(gray)


def gray_of(color: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A picture (h, w, 3), RGB, as shades of gray (h, w)."""
    return np.asarray(cv2.cvtColor(color, cv2.COLOR_RGB2GRAY), dtype=np.uint8)


def png_of(color: NDArray[np.uint8]) -> bytes:
    """A picture (h, w, 3), RGB, as a PNG file."""
    return bytes(cv2.imencode(".png", cv2.cvtColor(color, cv2.COLOR_RGB2BGR))[1].tobytes())


def _shows_mirrored(file: Path, board: Board) -> bool:
    return find(board, np.ascontiguousarray(_gray(file)[:, ::-1])) is not None


def _too_few(folder: Path, board: Board, count: int, files: list[Path]) -> str:
    how = f"{count} of {len(files)} pictures show" if count else "no picture shows"
    article = "an" if board.kind == "aprilgrid" else "a"
    said = f"in {folder}, {how} {article} {board}; at least {LEAST_PICTURES} are needed"
    mirrored = (file.name for file in files[:_ASKED] if _shows_mirrored(file, board))
    if board.kind != "chessboard" and (name := next(mirrored, "")):
        return f"{said}. {name} shows it mirrored: is the picture flipped, or the print?"
    sizes = []
    for file in files[:_ASKED] if board.kind == "chessboard" else []:
        found = size_of_chessboard(_gray(file))
        if found is not None and sorted(found) != sorted((board.columns, board.rows)):
            sizes.append(((max(found), min(found)), file.name))
    if sizes:
        often = Counter(size for size, _ in sizes)
        columns, rows = size = max(often, key=lambda each: (often[each], each))
        name = dict(reversed(sizes))[size]
        return f"{said}. {name} shows another one: --board 'chessboard {columns}x{rows}'"
    return f"{said}. Is the whole board in the picture, sharp and evenly lit, with a white rim?"
