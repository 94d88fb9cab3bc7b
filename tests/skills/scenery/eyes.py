"""Invented recordings for hand-eye calibration: random robots, mountings and boards."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from momantu_skills.calibration.hand_eye.views import Mounting, Views
from momantu_skills.calibration.poses import Poses, angles, quaternions, rotations_of
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform

TURN = np.radians(0.3)
SHIFT = 0.001


def vectors(rng: np.random.Generator, count: int, length: float) -> Array:
    """Random vectors (count, 3) whose root mean square length is given."""
    return rng.normal(size=(count, 3)) * length / np.sqrt(3.0)


def views(
    seed: int, count: int = 17, turn: float = 0.0, shift: float = 0.0, wrong: int = 0
) -> tuple[Views, Mounting, NDArray[np.intp]]:
    """Views of a board with noise of rad and m, the truth, and which views are wrong."""
    rng = np.random.default_rng(seed)
    eye = Transform(rng.uniform(-0.15, 0.15, 3), rng.normal(size=4))
    target = Transform(rng.uniform(-1.0, 1.0, 3), rng.normal(size=4))
    place = np.column_stack([rng.uniform(-0.15, 0.15, (count, 2)), rng.uniform(0.4, 0.9, count)])
    seen = Poses(rotations_of(vectors(rng, count, 0.9)), place)
    outer = Poses.of([target]) @ seen.inverse() @ Poses.of([eye.inverse()])
    noisy = Poses(
        seen.rotations @ rotations_of(vectors(rng, count, turn)),
        seen.positions + vectors(rng, count, shift),
    )
    chosen = np.sort(rng.permutation(count)[:wrong])
    noisy.rotations[chosen] = rotations_of(vectors(rng, wrong, 2.0))
    noisy.positions[chosen] = rng.uniform(-0.3, 0.9, (wrong, 3))
    return Views(outer, noisy), Mounting(eye, target), chosen


def noisy_hand(views: Views, seed: int, turn: float, shift: float) -> Views:
    """The same views with noise of the hand's pose, about the hand."""
    rng = np.random.default_rng(seed)
    turns = rotations_of(vectors(rng, len(views), turn))
    noise = Poses(turns, vectors(rng, len(views), shift))
    return Views(views.outer @ noise, views.camera_from_target)


def errors(found: Transform, true: Transform) -> tuple[float, float]:
    """The angle in deg and the distance in mm between two transforms."""
    apart = float(np.linalg.norm(found.position - true.position))
    return float(np.degrees(angles(found.rotation.T @ true.rotation))), 1e3 * apart


def motion(times: Array, seed: int) -> Poses:
    """A hand that turns and moves smoothly, at times (N,) in s."""
    rng = np.random.default_rng(seed)
    rates, phases = rng.uniform(0.8, 3.0, (3, 6)), rng.uniform(0.0, 6.0, (3, 6))
    waves = np.sin(times[:, None, None] * rates + phases).mean(axis=1)
    return Poses(rotations_of(0.9 * waves[:, :3]), 0.4 * waves[:, 3:])


def rows(times: Array, poses: Poses) -> Array:
    """Rows (N, 8) t, x, y, z, qx, qy, qz, qw."""
    return np.column_stack([times, poses.positions, quaternions(poses.rotations)[:, [1, 2, 3, 0]]])


def write(path: Path, table: Array, header: str = "") -> Path:
    """Write rows as CSV."""
    lines = [",".join(f"{value:.9f}" for value in row) for row in table]
    path.write_text("\n".join([header, *lines] if header else lines) + "\n", encoding="utf-8")
    return path
