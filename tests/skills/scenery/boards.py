"""Invented pictures of calibration boards."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from momantu_skills.calibration.camera.board import Board, Seen
from momantu_skills.calibration.models import Model
from momantu_worlds.scenes.catalogue.tags import tag_cells

from momantu_bt.geometry import Array

SIZE = (640, 480)
MATRIX = np.array([[520.0, 0, 330.0], [0, 515.0, 235.0], [0, 0, 1.0]])
DISTORTION = {
    Model.PINHOLE: np.array([-0.25, 0.08, 0.001, -0.0005, 0.0]),
    Model.PINHOLE8: np.array([-0.25, 0.08, 0.001, -0.0005, 0.0, 0.02, 0.0, 0.0]),
    Model.FISHEYE: np.array([-0.02, 0.005, 0.0, 0.0]),
}
CHESSBOARD = Board("chessboard", 9, 6, 0.025)


def places(seed: int, count: int) -> list[tuple[Array, Array]]:
    """Rotation vectors and positions of a board in the camera's frame, tilted to all sides."""
    rng = np.random.default_rng(seed)
    turns = [0.45 * np.array([np.cos(a), np.sin(a), 0.3]) for a in 2.4 * np.arange(count)]
    shifts = rng.uniform((-0.16, -0.12, 0.28), (-0.04, -0.02, 0.4), (count, 3))
    return list(zip(turns, shifts, strict=True))


def seen(model: Model, noise: float, count: int = 14, seed: int = 0) -> list[Seen]:
    """What pictures show of the chessboard, with noise of pixels."""
    rng = np.random.default_rng(seed)
    points = CHESSBOARD.points().reshape(-1, 1, 3)
    found = []
    for turn, shift in places(seed, count):
        project = cv2.fisheye.projectPoints if model is Model.FISHEYE else cv2.projectPoints
        pixels, _ = project(points, turn, shift, MATRIX, DISTORTION[model])
        exact = np.asarray(pixels, dtype=float).reshape(-1, 2)
        found.append(Seen(np.arange(len(exact)), exact + rng.normal(size=exact.shape) * noise))
    return found


def sheet(board: Board, square: int = 40, kalibr: bool = False) -> Array:
    """The printed board with a white rim of one square, `square` pixels for each.

    kalibr: an AprilGrid as Kalibr prints it.
    """
    if board.kind == "charuco":
        family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
        size = (board.columns, board.rows)
        charuco = cv2.aruco.CharucoBoard(size, board.square, board.marker, family)
        image = charuco.generateImage((board.columns * square, board.rows * square))
    elif board.kind == "aprilgrid":
        image = tags(board, square, kalibr)
    else:
        dark = np.indices((board.rows + 1, board.columns + 1)).sum(axis=0) % 2 == 0
        image = np.kron(np.where(dark, 0, 255), np.ones((square, square))).astype(np.uint8)
    return np.pad(np.asarray(image), square, constant_values=255)


def tags(board: Board, edge: int, kalibr: bool = False) -> Array:
    """The tags of an AprilGrid, `edge` pixels for each; its gap is a quarter of a tag.

    kalibr: their border is two cells wide, and black squares touch their corners.
    """
    gap = edge // 4
    step = edge + gap
    image = np.full((board.rows * step, board.columns * step), 255, dtype=np.uint8)
    for index in range(board.columns * board.rows):
        row, column = divmod(index, board.columns)
        top, left = (board.rows - 1 - row) * step, column * step
        cells = np.pad(tag_cells(index)[1:-1, 1:-1], 1 if kalibr else 0)
        drawn = np.kron(cells, np.ones((edge // len(cells),) * 2))
        image[top : top + edge, left : left + edge] = np.where(drawn > 0, 255, 0)
        if kalibr:
            image[top + edge : top + step, left + edge : left + step] = 0
    return image


def picture(
    board: Board, turn: Array, shift: Array, square: int = 40, kalibr: bool = False
) -> Array:
    """A picture (480, 640) of the board by a pinhole camera without distortion."""
    rotation, _ = cv2.Rodrigues(turn)
    # middles of the sheet's pixels to metres of the board, from its first inner corner
    scale = board.square / square
    onto = np.diag([scale, scale, 1.0])
    onto[:2, 2] = 0.5 * scale - (2 if board.kind == "chessboard" else 1) * board.square
    away = MATRIX @ np.column_stack([rotation[:, 0], rotation[:, 1], shift]) @ onto
    flat = cv2.warpPerspective(sheet(board, square, kalibr), away, SIZE, borderValue=(128,))
    return np.asarray(cv2.GaussianBlur(flat, (3, 3), 0.7))


def folder(path: Path, board: Board, count: int, kalibr: bool = False) -> Path:
    """A folder of pictures of a board."""
    path.mkdir(exist_ok=True)
    for index, (turn, shift) in enumerate(places(1, count)):
        cv2.imwrite(str(path / f"{index:02}.png"), picture(board, turn, shift, kalibr=kalibr))
    return path
