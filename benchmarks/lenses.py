"""How exactly `calibrate camera` tells a lens, beside plain OpenCV with the same points.

    python benchmarks/lenses.py --cameras 100
    python benchmarks/lenses.py --cameras 20 --board charuco --model pinhole8

Draws pictures of a board through random lenses: for each quarter of a pixel its ray, through the
distortion, to the board's print; then blur and noise. Of 25 pictures, two are blurred by motion
over 9 pixels, and one is sheared by 3 %: so a camera sees a moving board that reads row by row.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from momantu_skills.calibration.camera.board import Board, Seen, find
from momantu_skills.calibration.camera.lens import COEFFICIENTS, fit
from momantu_skills.calibration.models import Model
from scipy.ndimage import map_coordinates

from momantu_bt.geometry import Array
from tests.skills.scenery.boards import sheet

SIZE = (640, 480)
BOARDS = {
    "chessboard": Board("chessboard", 9, 6, 0.025),
    "charuco": Board("charuco", 10, 7, 0.025, 0.018),
    "aprilgrid": Board("aprilgrid", 6, 4, 0.032, gap=0.008),
}
PRINTED = 64
"""Pixels of the print for each square or tag."""
FINER = 2
"""Rays along each side of a pixel."""
BLURRED, SHEARED = (7, 15), (20,)
GOAL = 0.3, 2.0
"""Per cent of the focal length, and pixels of the centre."""


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """The true lens. matrix: (3, 3), px. distortion: as OpenCV orders it."""

    model: Model
    matrix: Array
    distortion: Array

    def project(self, points: Array) -> Array:
        """Pixels (N, 2) of points (N, 3) ahead of the camera."""
        shaped, none = points.reshape(-1, 1, 3), np.zeros(3)
        call = cv2.fisheye.projectPoints if self.model is Model.FISHEYE else cv2.projectPoints
        return np.asarray(call(shaped, none, none, self.matrix, self.distortion)[0]).reshape(-1, 2)

    def rays(self, pixels: Array) -> Array:
        """Directions (N, 2), x and y at z = 1, that fall on pixels (N, 2)."""
        focal, centre = self.matrix[[0, 1], [0, 1]], self.matrix[:2, 2]
        flat = (pixels - centre) / focal
        if self.model is Model.FISHEYE:
            radius = np.linalg.norm(flat, axis=1)
            k, angle = self.distortion, radius
            for _ in range(100):  # r = a (1 + k1 a^2 + k2 a^4 + ...)
                powers = angle[:, None] ** (2.0, 4.0, 6.0, 8.0)
                angle = radius / (1.0 + powers @ k)
            return np.asarray(flat * (np.tan(angle) / np.maximum(radius, 1e-12))[:, None])
        found = flat
        for _ in range(100):
            points = np.column_stack([found, np.ones(len(found))])
            change = (pixels - self.project(points)) / focal
            found = found + change
            if abs(change).max() < 1e-8:
                break
        return np.asarray(found)


def random_camera(rng: np.random.Generator, model: Model) -> Camera:
    """A lens whose picture grows with the angle up to its corners, and beyond."""
    fx = rng.uniform(400.0, 900.0) if model is not Model.FISHEYE else rng.uniform(330.0, 500.0)
    matrix = np.diag([fx, fx * rng.uniform(0.99, 1.01), 1.0])
    matrix[:2, 2] = np.array(SIZE) / 2.0 - 0.5 + rng.uniform(-30.0, 30.0, 2)
    if model is Model.FISHEYE:
        most = np.array([0.05, 0.02, 0.01, 0.004])
        return Camera(model, matrix, rng.uniform(-most, most))
    while True:
        k1, k2, k3 = rng.uniform((-0.4, -0.2, -0.1), (0.15, 0.2, 0.1))
        p1, p2 = rng.uniform(-0.002, 0.002, 2)
        more = rng.uniform(-0.1, 0.1, 3) if model is Model.PINHOLE8 else ()
        camera = Camera(model, matrix, np.array([k1, k2, p1, p2, k3, *more]))
        reach = np.linalg.norm(np.array(SIZE) / 2.0 + 30.0) / fx * np.linspace(0, 1.5, 60)
        radii = camera.project(np.column_stack([reach, 0 * reach, 0 * reach + 1]))[:, 0]
        if (np.diff(radii) > 0.4 * fx * np.diff(reach)).all():
            return camera


class Studio:
    """A camera before a board: draws pictures of it."""

    def __init__(self, board: Board, camera: Camera, rng: np.random.Generator) -> None:
        self.board, self.camera, self.rng = board, camera, rng
        self.print = sheet(board, PRINTED).astype(np.float32)
        xs = (np.arange(SIZE[0] * FINER) + 0.5) / FINER - 0.5
        ys = (np.arange(SIZE[1] * FINER) + 0.5) / FINER - 0.5
        coarse = np.stack(np.meshgrid(xs[::4], ys[::4]), axis=-1).astype(float)
        rays = camera.rays(coarse.reshape(-1, 2)).reshape(coarse.shape)
        self.rays = _finer(rays, len(xs), len(ys))

    def place(self) -> tuple[Array, Array]:
        """Rotation (3, 3) and position (3,) of the print at which all of it is in the picture."""
        edges = (np.array(self.print.shape[::-1]) / PRINTED - 2.0) * self.board.square
        points = np.pad(np.mgrid[0:9, 0:7].T.reshape(-1, 2) / (8.0, 6.0) * edges, ((0, 0), (0, 1)))
        while True:
            axis = self.rng.normal(size=3) * (1.0, 1.0, 0.4)
            turn = axis / np.linalg.norm(axis) * self.rng.uniform(0.2, 0.8)
            rotation = np.asarray(cv2.Rodrigues(turn)[0])
            share = self.rng.uniform(0.35, 0.8)
            depth = edges[0] * self.camera.matrix[0, 0] / SIZE[0] / share
            ray = self.camera.rays(self.rng.uniform((60.0, 60.0), np.array(SIZE) - 60.0)[None])[0]
            shift = depth * np.array([*ray, 1.0]) - rotation @ points.mean(axis=0)
            there = points @ rotation.T + shift
            if there[:, 2].min() < 0.05:
                continue
            seen = self.camera.project(there)
            if ((seen > 3.0) & (seen < np.array(SIZE) - 4.0)).all():
                return rotation, shift

    def picture(self, rotation: Array, shift: Array, shear: float = 0.0, motion: int = 0) -> Any:
        """A gray picture (480, 640) of the board at a place."""
        edges = np.array(self.print.shape[::-1]) / PRINTED * self.board.square
        rim = np.mgrid[0:9, 0:7].T.reshape(-1, 2) / (8.0, 6.0) * edges - self.board.square
        there = self.camera.project(np.pad(rim, ((0, 0), (0, 1))) @ rotation.T + shift)
        low = np.clip(there.min(axis=0).astype(int) - 8, 0, None)
        high = np.clip(there.max(axis=0).astype(int) + 8, None, SIZE)
        part = self.rays[low[1] * FINER : high[1] * FINER, low[0] * FINER : high[0] * FINER]
        board_from_ray = np.linalg.inv(np.column_stack([rotation[:, :2], shift]))
        flat = part @ board_from_ray[:, :2].T + board_from_ray[:, 2]
        onto = flat[..., :2] / flat[..., 2:] * (PRINTED / self.board.square)
        onto = (onto + PRINTED - 0.5).astype(np.float32)
        fine = cv2.remap(self.print, onto, None, cv2.INTER_LINEAR, borderValue=128.0)  # type: ignore[call-overload]
        drawn = np.full(SIZE[::-1], 128.0, dtype=np.float32)
        inside = tuple(int(each) for each in high - low)
        drawn[low[1] : high[1], low[0] : high[0]] = cv2.resize(
            fine, inside, interpolation=cv2.INTER_AREA
        )
        drawn = cv2.GaussianBlur(drawn, (0, 0), self.rng.uniform(0.5, 1.0))
        if motion:
            drawn = cv2.blur(drawn, (motion, 1))
        if shear:
            way = np.array([[1.0, shear, 0.0], [0.0, 1.0, 0.0]])
            drawn = cv2.warpAffine(drawn, way, SIZE, borderValue=128.0)
        drawn = 25.0 + 0.78 * drawn + self.rng.normal(0.0, 2.0, drawn.shape)
        return np.clip(drawn.round(), 0, 255).astype(np.uint8)

    def pictures(self, count: int) -> list[Any]:
        """A set for one calibration, with the blurred and sheared ones."""
        made = []
        for index in range(count):
            rotation, shift = self.place()
            shear = 0.03 if index in SHEARED else 0.0
            made.append(self.picture(rotation, shift, shear, 9 if index in BLURRED else 0))
        return made


def _finer(rays: Array, columns: int, rows: int) -> Any:
    """Rays on a grid with four times as many points along each side, by cubic interpolation."""
    xs, ys = np.meshgrid(np.arange(columns) / 4.0, np.arange(rows) / 4.0)
    wider = np.pad(rays, ((3, 3), (3, 3), (0, 0)), "reflect", reflect_type="odd")
    sides = [map_coordinates(wider[..., side], [ys + 3.0, xs + 3.0], order=3) for side in (0, 1)]
    return np.stack(sides, axis=-1)


def plain(board: Board, seen: Sequence[Seen], model: Model) -> tuple[Array, Array]:
    """Plain OpenCV with all pictures: matrix and distortion."""
    points = board.points()
    shape = (1, -1, 3), (1, -1, 2)
    if model is Model.FISHEYE:
        flags = cv2.CALIB_RECOMPUTE_EXTRINSIC | cv2.CALIB_FIX_SKEW
        objects: list[Any] = [points[each.indices].reshape(shape[0]) for each in seen]
        pixels: list[Any] = [each.pixels.reshape(shape[1]) for each in seen]
        found: Any = cv2.fisheye.calibrate(
            objects, pixels, SIZE, np.eye(3), np.zeros(4), flags=flags
        )
    else:
        flags = cv2.CALIB_RATIONAL_MODEL if model is Model.PINHOLE8 else 0
        objects = [points[each.indices].astype(np.float32) for each in seen]
        pixels = [each.pixels.astype(np.float32) for each in seen]
        found = cv2.calibrateCamera(objects, pixels, SIZE, None, None, flags=flags)  # type: ignore[call-overload]
    return np.asarray(found[1]), np.asarray(found[2]).ravel()[: COEFFICIENTS[model]]


def off(matrix: Array, true: Array) -> tuple[float, float]:
    """Of the focal lengths the larger error in per cent, and that of the centre in pixels."""
    focal = max(abs(matrix[i, i] / true[i, i] - 1.0) for i in (0, 1))
    return 100.0 * focal, float(np.linalg.norm(matrix[:2, 2] - true[:2, 2]))


def measure(kind: str, model: Model, cameras: range, count: int, verbose: bool) -> None:
    """Calibrate each camera and print the table's rows."""
    board = BOARDS[kind]
    errors: dict[str, list[tuple[float, float]]] = {"calibrate camera": [], "plain OpenCV": []}
    ratios, found, left_out, wrongly = [], 0, 0, 0
    for seed in cameras:
        rng = np.random.default_rng(seed)
        camera = random_camera(rng, model)
        shown = [find(board, each) for each in Studio(board, camera, rng).pictures(count)]
        numbers = [index for index, each in enumerate(shown) if each is not None]
        seen = [each for each in shown if each is not None]
        lens = fit(board, seen, SIZE, model)
        errors["calibrate camera"].append(off(lens.matrix, camera.matrix))
        errors["plain OpenCV"].append(off(plain(board, seen, model)[0], camera.matrix))
        parameters = [(0, 0), (1, 1), (0, 2), (1, 2)]
        ratios += [
            (lens.matrix[at] - camera.matrix[at]) / deviation
            for at, deviation in zip(parameters, lens.deviations[:4], strict=True)
        ]
        found += len(seen)
        gone = {numbers[index] for index in np.flatnonzero(~lens.used)}
        left_out += len(gone & set(SHEARED))
        wrongly += len(gone - set(SHEARED) - set(BLURRED))
        if verbose:
            said = [f"{v:.3f}" for each in errors.values() for v in each[-1]]
            begin = f"# {seed}: f {camera.matrix[0, 0]:.0f}, {len(seen)} found, {gone} out,"
            print(begin, *said, flush=True)
    for name, each in errors.items():
        focal, centre = np.array(each).T
        good = float(np.mean((focal <= GOAL[0]) & (centre <= GOAL[1])))
        print(
            f"| {kind}, {model} | {name} | {np.median(focal):.3f} % | {focal.max():.2f} % | "
            f"{np.median(centre):.2f} px | {centre.max():.2f} px | {100 * good:.0f} % |"
        )
    print(
        f"{found} of {len(cameras) * count} pictures show the board; {left_out} of {len(cameras)} "
        f"sheared ones and {wrongly} right ones were left out; errors are "
        f"{np.sqrt(np.mean(np.square(ratios))):.2f} standard deviations (root mean square)",
        flush=True,
    )


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--cameras", type=int, default=100, help="random lenses")
    parser.add_argument("--first", type=int, default=0, help="the first camera's seed")
    parser.add_argument("--pictures", type=int, default=25, help="for each camera")
    parser.add_argument("--board", choices=BOARDS, default="chessboard")
    parser.add_argument("--model", choices=list(Model), type=Model, default=Model.PINHOLE)
    parser.add_argument("--verbose", action="store_true", help="a line for each camera")
    given = parser.parse_args(arguments)
    cameras = range(given.first, given.first + given.cameras)
    measure(given.board, given.model, cameras, given.pictures, given.verbose)


if __name__ == "__main__":
    main()
