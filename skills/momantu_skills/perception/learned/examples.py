"""Crops for training, made once of labelled pictures and kept beside them."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from momantu_bt.categories import Symmetry
from momantu_bt.geometry import Array, Transform
from momantu_bt.labelled import Labelled, read
from momantu_skills.perception.camera.cloud import points_from_depth
from momantu_skills.perception.geometry.regions import depth_inside
from momantu_skills.perception.learned.crops import Crop, channels, cut, mirror
from momantu_skills.perception.learned.standing import standing
from momantu_skills.perception.learned.targets import Targets, Truth, targets

FOLDER = "crops-2"
"""Where the crops are kept; its number changes with their kind."""
SPAN = 0.03
"""How far from its true height a surface is looked for, m."""
AROUND = 0.1
"""How far around a surface points are looked at, m."""


class Example:
    """A crop and what is true of it."""

    def __init__(self, crop: Crop, numbers: NDArray[np.uint8], truths: list[Truth]) -> None:
        self.crop, self.numbers, self.truths = crop, numbers, truths

    def arrays(self, classes: Sequence[str]) -> tuple[NDArray[np.float32], Targets]:
        """What the network sees and what it shall say. classes: their names."""
        crop, numbers = self.crop, self.numbers[::2, ::2]
        made = targets(crop.points[::2, ::2], numbers, crop.eye, self.truths, classes)
        return channels(crop), made


def example(made: Labelled) -> Example | None:
    """The example of a picture; None where no surface or nothing on it is seen."""
    image = made.image
    points = made.odom_from_camera.apply(points_from_depth(image.depth, image.intrinsics, 2))
    near = np.abs(points[:, 2] - made.height) < SPAN + AROUND
    points = points[near]
    points = points[depth_inside(points[:, :2], made.outline) > -AROUND]
    surface = standing(points, made.odom_from_camera, made.height - SPAN, made.height + SPAN)
    if surface is None:
        return None
    crop = cut(image, surface.odom_from_camera, surface.height, surface.outline)
    if crop is None:
        return None
    level_from_camera = crop.odom_from_level.inverse() @ surface.odom_from_camera
    truths = [
        Truth(
            thing.number,
            thing.category,
            made.categories[thing.category],
            level_from_camera @ thing.camera_from_object,
            np.array(thing.size),
        )
        for thing in made.things
        if thing.category in made.categories
    ]
    numbers = np.ascontiguousarray(made.numbers[crop.rows][:, crop.columns])
    return Example(crop, numbers, truths)


def kept(folder: Path, seed: int) -> Example | None:
    """The example of a picture, from where it is kept or made now; None if there is none in it."""
    path = folder / FOLDER / f"{seed:06d}.npz"
    if not path.exists():
        found = example(read(folder, seed))
        path.parent.mkdir(exist_ok=True)
        _store(path, found)
        return found
    try:
        return _load(path)
    except (OSError, ValueError, KeyError, zipfile.BadZipFile):
        path.unlink()  # an interrupted write: make it again
        return kept(folder, seed)


def _store(path: Path, found: Example | None) -> None:
    if found is None:
        np.savez(path, nothing=np.zeros(0))
        return
    poses = [
        [
            t.number,
            *t.level_from_object.position,
            *t.level_from_object.quaternion,
            *t.size,
        ]
        for t in found.truths
    ]
    crop = found.crop
    np.savez(
        path,
        points=crop.points,
        color=crop.color,
        eye=np.array(crop.eye),
        numbers=found.numbers,
        truths=np.array(poses, dtype=np.float64).reshape(-1, 11),
        categories=np.array([t.category for t in found.truths], dtype=np.str_),
        symmetries=np.array([str(t.symmetry) for t in found.truths], dtype=np.str_),
    )


def _load(path: Path) -> Example | None:
    with np.load(path, allow_pickle=False) as data:
        if "nothing" in data:
            return None
        points, color = data["points"], data["color"]
        rows, columns = np.arange(points.shape[0]), np.arange(points.shape[1])
        crop = Crop(points, color, Transform(), float(data["eye"]), rows, columns)
        names, kinds = data["categories"].tolist(), data["symmetries"].tolist()
        told = zip(data["truths"], names, kinds, strict=True)
        return Example(crop, data["numbers"], [_truth(*each) for each in told])


def _truth(row: Array, category: str, symmetry: str) -> Truth:
    pose = Transform(row[1:4], row[4:8])
    return Truth(int(row[0]), category, Symmetry(symmetry), pose, row[8:11])


def mirrored(seen: NDArray[np.float32], made: Targets) -> tuple[NDArray[np.float32], Targets]:
    """The example as in a mirror; things of all categories have mirror images of their kind."""
    seen = mirror(seen)
    coordinates, offsets = made.coordinates[..., ::-1].copy(), made.offsets[..., ::-1].copy()
    coordinates[:, 1] *= -1.0
    offsets[0] *= -1.0
    classes, things, weights = made.classes[:, ::-1], made.things[:, ::-1], made.weights[:, ::-1]
    return seen, Targets(classes, things, weights, coordinates, offsets)


def recolored(seen: NDArray[np.float32], draw: np.random.Generator) -> NDArray[np.float32]:
    """The example with its colours exchanged, and brighter or darker."""
    color = seen[5:8][draw.permutation(3)]
    seen[5:8] = np.clip(color * draw.uniform(0.7, 1.3) + draw.uniform(-0.2, 0.2), -1.2, 1.2)
    return seen


def alone(seen: NDArray[np.float32], made: Targets) -> list[NDArray[np.generic]]:
    """An example as arrays of a batch of one.

    Returns: what is seen (1, c, h, w), classes and things (1, h/2, w/2), weights (1, h/2, w/2),
    coordinates (1, VALID, 3, h/2, w/2), offsets (1, 3, h/2, w/2).
    """
    parts = (seen, made.classes, made.things, made.weights, made.coordinates, made.offsets)
    return [np.ascontiguousarray(part)[None] for part in parts]
