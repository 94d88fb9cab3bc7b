"""Boards of known size: what `--board` says, and their points in a picture."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_bt.tags import UNIT_CORNERS
from momantu_skills.calibration.camera import tag_edges
from momantu_skills.calibration.errors import CalibrationError

with lazily():
    import cv2

    from momantu_skills.perception.tags import detector

KINDS = ("chessboard", "charuco", "aprilgrid")
_WORDS = re.compile(r"([a-z]+)[ :]+([0-9]+)x([0-9]+)")
_SHARE, _MOST_WINDOW = 0.4, 15
"""Half of a chessboard's window: this share of the smallest square's edge, at most so many px."""
_ENDS = (3, 50, 0.001)
"""cornerSubPix stops after 50 steps, or one below 0.001 px: OpenCV calls both criteria 3."""
_LEAST_POINTS = 8
"""Of a board that may be partly hidden; fewer hardly tell where it is."""


@dataclass(frozen=True, slots=True)
class Board:
    """A board. columns, rows: inner corners of a chessboard, squares of a ChArUco board, tags.

    square: edge of a square, or of an AprilGrid's black tags, m. marker: edge of a ChArUco board's
    marker, m. dictionary: of its markers, as OpenCV names it. gap: between an AprilGrid's tags, m.
    """

    kind: str
    columns: int
    rows: int
    square: float
    marker: float = 0.0
    dictionary: str = "4X4_50"
    gap: float = 0.0

    def __str__(self) -> str:
        """As `--board` has it: `chessboard 9x6`."""
        return f"{self.kind} {self.columns}x{self.rows}"

    def points(self) -> Array:
        """All points (N, 3) of the board in its own frame, m."""
        if self.kind == "aprilgrid":
            return self._corners_of_tags()
        columns, rows = self.columns, self.rows
        if self.kind == "charuco":
            columns, rows = columns - 1, rows - 1
        grid = np.mgrid[0:columns, 0:rows].T.reshape(-1, 2).astype(float)
        return np.column_stack([grid * self.square, np.zeros(len(grid))])

    def _corners_of_tags(self) -> Array:
        """Four corners of each tag. As Kalibr prints it, tag 0 is at the bottom left; y is up.

        Of the black square: Kalibr's border is two cells wide, that of other prints one.
        """
        cells = np.mgrid[0 : self.columns, 0 : self.rows].T.reshape(-1, 1, 2)
        flat = cells * (self.square + self.gap) + (UNIT_CORNERS + 0.5) * self.square
        return np.column_stack([flat.reshape(-1, 2), np.zeros(4 * len(cells))])


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """The points of a board that a picture shows.

    indices: (N,) of `Board.points`. pixels: (N, 2).
    """

    indices: NDArray[np.intp]
    pixels: Array


def read_board(
    text: str, square: float, marker: float = 0.0, dictionary: str = "4X4_50", gap: float = 0.0
) -> Board:
    """The board that `--board`, `--square`, `--marker`, `--dictionary` and `--gap` describe.

    Raises:
        CalibrationError: one of them is not valid.
    """
    found = _WORDS.fullmatch(text.strip().lower())
    if found is None or found[1] not in KINDS:
        raise CalibrationError(
            f"--board {text!r} is no board; expected 'chessboard 9x6' (inner corners), "
            f"'charuco 7x5' (squares) or 'aprilgrid 6x6' (tags)"
        )
    board = Board(found[1], int(found[2]), int(found[3]), square, marker, dictionary, gap)
    if min(board.columns, board.rows) < 3 or max(board.columns, board.rows) > 50:
        raise CalibrationError(f"--board {text!r}: expected 3 to 50 columns and rows")
    if not 0.0 < square < 10.0:
        raise CalibrationError(f"--square {square:g} m; expected a length such as 25mm")
    if board.kind == "charuco":
        if not 0.0 < marker < square:
            raise CalibrationError(
                "a ChArUco board needs --marker, a length below --square, such as 18mm"
            )
        if not hasattr(cv2.aruco, f"DICT_{dictionary}"):
            names = [name[5:] for name in dir(cv2.aruco) if name.startswith("DICT_")]
            raise CalibrationError(f"--dictionary {dictionary!r}; expected {', '.join(names)}")
    if board.kind == "aprilgrid" and gap <= 0.0:
        raise CalibrationError(
            "an AprilGrid needs --gap, the length between two tags, such as 9mm (Kalibr's "
            "tagSpacing times tagSize)"
        )
    return board


def find(board: Board, gray: NDArray[np.uint8]) -> Seen | None:
    """The board's points in a gray picture (H, W); None if it is not there."""
    kinds = {"chessboard": _find_corners, "charuco": _find_charuco, "aprilgrid": _find_tags}
    return kinds[board.kind](board, gray)


def size_of_chessboard(gray: NDArray[np.uint8]) -> tuple[int, int] | None:
    """Columns and rows of inner corners of whatever chessboard a picture shows; None without.

    It has to have more than 3 x 3: so many are seen in parts of any board.
    """
    flags = cv2.CALIB_CB_LARGER | cv2.CALIB_CB_NORMALIZE_IMAGE
    found, _, meta = cv2.findChessboardCornersSBWithMeta(gray, (3, 3), flags)
    if not found or meta is None or meta.ndim != 2:
        return None
    size = int(meta.shape[1]), int(meta.shape[0])
    return None if size == (3, 3) else size


def _find_corners(board: Board, gray: NDArray[np.uint8]) -> Seen | None:
    """By one detector after the other: each finds boards that the others miss."""
    size = (board.columns, board.rows)
    normal = cv2.CALIB_CB_NORMALIZE_IMAGE
    for detect, flags in (
        (cv2.findChessboardCornersSB, normal),
        # by quadrilaterals: narrow rims, dim or small boards, bent ones of a fisheye
        (cv2.findChessboardCorners, normal | cv2.CALIB_CB_ADAPTIVE_THRESH),
        # in the picture enlarged: slow
        (cv2.findChessboardCornersSB, normal | cv2.CALIB_CB_ACCURACY),
    ):
        found, corners = detect(gray, size, None, flags)
        if found:
            grid = np.asarray(corners, dtype=float).reshape(board.rows, board.columns, 2)
            pixels = _refined(gray, grid)
            return Seen(np.arange(len(pixels)), pixels)
    return None


def _refined(gray: NDArray[np.uint8], corners: Array) -> Array:
    """Corners (N, 2) where the edges in a window meet, from corners (rows, columns, 2).

    The window is as large as the squares allow: what is found without one is off by 0.1 pixels and
    more. A corner that it moves far is taken as it was.
    """
    sides = [np.linalg.norm(np.diff(corners, axis=axis), axis=2).min() for axis in (0, 1)]
    half = int(np.clip(_SHARE * min(sides), 2, _MOST_WINDOW))
    before = corners.reshape(-1, 1, 2)
    after = cv2.cornerSubPix(gray, before.astype(np.float32), (half, half), (-1, -1), _ENDS)
    near = np.linalg.norm(after - before, axis=2, keepdims=True) < max(1.0, half / 4)
    return np.asarray(np.where(near, after, before), dtype=float).reshape(-1, 2)


def _find_charuco(board: Board, gray: NDArray[np.uint8]) -> Seen | None:
    family = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{board.dictionary}"))
    size = (board.columns, board.rows)
    charuco = cv2.aruco.CharucoBoard(size, board.square, board.marker, family)
    for old in (False, True):  # OpenCV before 4.6 printed an even number of rows otherwise
        charuco.setLegacyPattern(old)
        corners, ids, _, _ = cv2.aruco.CharucoDetector(charuco).detectBoard(gray)
        if ids is not None and len(ids) >= _LEAST_POINTS:
            pixels = np.asarray(corners, dtype=float).reshape(-1, 2)
            return Seen(np.asarray(ids).ravel().astype(np.intp), pixels)
    return None


def _find_tags(board: Board, gray: NDArray[np.uint8]) -> Seen | None:
    plain, wide = detector.tags_in(gray), detector.wide_tags_in(gray)
    found = plain if len(plain) >= len(wide) else wide
    own = sorted(each for each in found if each < board.columns * board.rows)
    if 4 * len(own) < _LEAST_POINTS:
        return None
    indices = 4 * np.repeat(own, 4) + np.tile(np.arange(4), len(own))
    pixels = tag_edges.refined(gray, np.array([found[each] for each in own], dtype=float))
    return Seen(indices.astype(np.intp), pixels.reshape(-1, 2))
