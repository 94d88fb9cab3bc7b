"""Labelled pictures: what is true of each thing in them, for training and measuring detectors.

A folder holds four files for each picture, named by its seed: `000012.json` (below), `.jpg` (the
colours), `.depth.png` (16 bits, millimetres, 0 where nothing was measured) and `.things.png` (8
bits, the number of the thing that is seen, or 0).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from momantu_bt.categories import USUAL, Symmetry, categories_from
from momantu_bt.errors import MomantuError
from momantu_bt.formats.files import write_whole
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage, frozen
from momantu_bt.plugins import Group

VERSION = 1
"""Version of the files."""
MILLIMETRES = 1000.0
"""Depth values of a file per metre."""
_DAMAGED = (OSError, ValueError, KeyError, TypeError, AttributeError, IndexError, SyntaxError)
"""What reading a damaged file raises; Pillow calls a broken chunk of a PNG a wrong syntax."""
QUALITY = 92
"""JPEG quality of the colours."""


class LabelledError(MomantuError):
    """A labelled picture cannot be read; the message says which and why."""


@dataclass(frozen=True, slots=True)
class Label:
    """What is true of one thing in a picture.

    number: its value in the picture of numbers. camera_from_object: in the optical frame; the
    origin is the centre of its box, z its axis, a mug's handle lies towards +x. size: (3,) extent
    along its axes without a handle, m. seen: number of pixels that show it.
    """

    number: int
    category: str
    family: str
    camera_from_object: Transform
    size: tuple[float, float, float]
    seen: int


@dataclass(frozen=True, slots=True, eq=False)
class Labelled:
    """A picture and what is true of it.

    odom_from_camera: where the camera is told to be, with errors of its mounting; odom is level.
    height: of the surface, m in odom. outline: (4, 2) its corners, odom. numbers: (h, w) uint8.
    categories: all that such pictures may show.
    """

    seed: int
    image: CameraImage
    odom_from_camera: Transform
    height: float
    outline: Array
    numbers: NDArray[np.uint8]
    things: tuple[Label, ...]
    categories: Mapping[str, Symmetry] = field(default_factory=lambda: USUAL)


class Renderer(Protocol):
    """Makes labelled pictures.

    An entry point of `momantu_bt.labelled` is called with the names of worlds (none: its usual
    ones) and `testing`, whether to show what is kept for testing, and returns one.
    """

    def picture(self, seed: int) -> Labelled:
        """The picture of a seed, the same whenever it is made."""
        ...


def _objection(name: str, plugin: Any) -> str | None:
    return None if callable(plugin) else f"{plugin!r} cannot be called"


RENDERERS: Group[Callable[..., Renderer]] = Group("momantu_bt.labelled", "renderer", _objection)
"""What renders labelled pictures, by name."""


def write(folder: Path, made: Labelled) -> None:
    """Write a picture's four files, the one with the labels last."""
    stem = folder / f"{made.seed:06d}"
    write_whole(stem.with_suffix(".jpg"), _jpeg(made.image.color))
    depth = np.rint(made.image.depth * MILLIMETRES).astype(np.uint16)
    write_whole(stem.with_suffix(".depth.png"), _png(depth))
    write_whole(stem.with_suffix(".things.png"), _png(made.numbers))
    write_whole(stem.with_suffix(".json"), json.dumps(_labels(made)))


def seeds_in(folder: Path) -> tuple[int, ...]:
    """Seeds of the whole pictures in a folder, in order."""
    return tuple(sorted(int(path.stem) for path in folder.glob("*.json") if path.stem.isdigit()))


def read(folder: Path, seed: int) -> Labelled:
    """Read a picture.

    Raises:
        LabelledError: a file of it is missing, damaged, or of another version.
    """
    stem = folder / f"{seed:06d}"
    try:
        labels = json.loads(stem.with_suffix(".json").read_text())
        if labels.get("momantu_labels") != VERSION:
            raise ValueError(f"expected `momantu_labels: {VERSION}`")
        with Image.open(stem.with_suffix(".jpg")) as picture:
            color = np.asarray(picture.convert("RGB"))
        with Image.open(stem.with_suffix(".depth.png")) as picture:
            depth = np.asarray(picture).astype(np.float32) / np.float32(MILLIMETRES)
        with Image.open(stem.with_suffix(".things.png")) as picture:
            numbers = np.asarray(picture, dtype=np.uint8)
        if not color.shape[:2] == depth.shape == numbers.shape:
            raise ValueError("its pictures differ in size")
        intrinsics = frozen(np.array(labels["intrinsics"], dtype=np.float64).reshape(3, 3))
        image = CameraImage(float(seed), "camera", frozen(color), frozen(depth), intrinsics)
        things = tuple(map(_label, labels["things"]))
        return Labelled(
            seed,
            image,
            _pose(labels["odom_from_camera"]),
            float(labels["height"]),
            np.array(labels["outline"], dtype=np.float64).reshape(-1, 2),
            numbers,
            things,
            categories_from(labels.get("categories", USUAL)),
        )
    except _DAMAGED as error:
        raise LabelledError(
            f"{stem}.json and its pictures cannot be read: {error}; remove them and render seed "
            f"{seed} again"
        ) from None


def categories_in(folder: Path) -> dict[str, Symmetry]:
    """The categories that a folder's pictures may show, the usual ones first.

    Raises:
        LabelledError: a file is damaged, or two have different symmetries of one category.
    """
    found: dict[str, Symmetry] = {}
    for seed in seeds_in(folder):
        path = folder / f"{seed:06d}.json"
        try:
            told = categories_from(json.loads(path.read_text()).get("categories", USUAL))
        except _DAMAGED as error:
            raise LabelledError(
                f"{path} cannot be read: {error}; render seed {seed} again"
            ) from None
        for name, symmetry in told.items():
            if found.setdefault(name, symmetry) is not symmetry:
                raise LabelledError(
                    f"{path} has the category {name!r} with the symmetry {symmetry}, others in "
                    f"{folder} with {found[name]}; render them into folders of their own"
                )
    first = [name for name in USUAL if name in found]
    return {name: found[name] for name in (*first, *sorted(found.keys() - USUAL.keys()))}


def read_all(folder: Path) -> Iterator[Labelled]:
    """All pictures of a folder, by seed; raises as `read`."""
    for seed in seeds_in(folder):
        yield read(folder, seed)


def _labels(made: Labelled) -> dict[str, Any]:
    return {
        "momantu_labels": VERSION,
        "seed": made.seed,
        "categories": {name: str(kind) for name, kind in made.categories.items()},
        "intrinsics": np.asarray(made.image.intrinsics).ravel().tolist(),
        "odom_from_camera": _numbers(made.odom_from_camera),
        "height": made.height,
        "outline": np.asarray(made.outline).tolist(),
        "things": [
            {
                "number": thing.number,
                "category": thing.category,
                "family": thing.family,
                "camera_from_object": _numbers(thing.camera_from_object),
                "size": list(thing.size),
                "seen": thing.seen,
            }
            for thing in made.things
        ],
    }


def _label(told: dict[str, Any]) -> Label:
    x, y, z = map(float, told["size"])
    pose = _pose(told["camera_from_object"])
    return Label(
        int(told["number"]),
        str(told["category"]),
        str(told["family"]),
        pose,
        (x, y, z),
        int(told["seen"]),
    )


def _numbers(pose: Transform) -> list[float]:
    """Position and quaternion (w, x, y, z), one after the other."""
    return [*pose.position.tolist(), *pose.quaternion.tolist()]


def _pose(numbers: list[float]) -> Transform:
    return Transform(numbers[:3], numbers[3:])


def _jpeg(color: NDArray[np.uint8]) -> bytes:
    data = BytesIO()
    Image.fromarray(color).save(data, "JPEG", quality=QUALITY)
    return data.getvalue()


def _png(pixels: NDArray[Any]) -> bytes:
    data = BytesIO()
    Image.fromarray(pixels).save(data, "PNG", compress_level=1)
    return data.getvalue()
