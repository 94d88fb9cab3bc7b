"""A camera's calibration as lines for a person, and notes on what is worth a doubt."""

from __future__ import annotations

from typing import Any

import numpy as np

from momantu_skills.calibration.camera.coverage import CELLS, covered, gain
from momantu_skills.calibration.camera.lens import Lens
from momantu_skills.calibration.camera.pictures import Pictures
from momantu_skills.calibration.models import Model
from momantu_skills.calibration.poses import turns_between

_FEW = 10
_TILT = np.radians(20.0)
_COVERED = 0.7
_BAD_ERROR = 0.7
"""px; sharp pictures of a flat board are better."""
_NAMES = {
    Model.PINHOLE: ("k1", "k2", "p1", "p2", "k3"),
    Model.PINHOLE8: ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    Model.FISHEYE: ("k1", "k2", "k3", "k4"),
}


def lines(pictures: Pictures, lens: Lens) -> list[str]:
    """The result for a terminal."""
    width, height = pictures.size
    matrix = lens.matrix
    values = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], *lens.distortion]
    names = ("fx", "fy", "cx", "cy", *_NAMES[lens.model])
    return [
        f"{lens.used.sum()} pictures of {width} x {height} pixels count, of "
        f"{len(_all(pictures))}; model {lens.model}",
        f"error: {lens.error:.3f} px (root mean square)",
        *(
            f"  {name} {value:12.5f} ± {deviation:.5f}"
            for name, value, deviation in zip(names, values, lens.deviations, strict=True)
        ),
        "",
        *_pictures(pictures, lens),
    ]


def _pictures(pictures: Pictures, lens: Lens) -> list[str]:
    width = max(map(len, _all(pictures)))
    said = [f"{'picture':<{width}}     error      covers alone"]
    for name, error, used, share in zip(
        pictures.names, lens.errors, lens.used, gain(pictures, lens), strict=True
    ):
        alone = f"{100 * share:7.0f} %" if used else "  outlier, does not count"
        said.append(f"{name:<{width}}  {error:8.3f} px {alone}")
    said += [f"{name:<{width}}  no board" for name in pictures.without]
    for name, (wide, high) in pictures.odd:
        said.append(f"{name:<{width}}  {wide} x {high} pixels, does not count")
    return said


def _all(pictures: Pictures) -> tuple[str, ...]:
    return (*pictures.names, *pictures.without, *(name for name, _ in pictures.odd))


def plain(pictures: Pictures, lens: Lens, doubts: list[str]) -> dict[str, Any]:
    """The result for a program: pixels and coefficients."""
    matrix = lens.matrix
    values = [matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], *lens.distortion]
    names = ("fx", "fy", "cx", "cy", *_NAMES[lens.model])
    return {
        "model": str(lens.model),
        "width": int(pictures.size[0]),
        "height": int(pictures.size[1]),
        "error": float(lens.error),
        "parameters": {
            name: {"value": float(value), "deviation": float(deviation)}
            for name, value, deviation in zip(names, values, lens.deviations, strict=True)
        },
        "pictures": [
            {"name": name, "error": float(error), "used": bool(used)}
            for name, error, used in zip(pictures.names, lens.errors, lens.used, strict=True)
        ],
        "without_board": list(pictures.without),
        "of_another_size": [name for name, _ in pictures.odd],
        "notes": doubts,
    }


def notes(pictures: Pictures, lens: Lens) -> list[str]:
    """Sentences for a person, each with what to do."""
    said = []
    if lens.used.sum() < _FEW:
        said.append(f"{lens.used.sum()} pictures are few; 20 or more are good")
    cells = covered(pictures, lens)
    share = float((cells > 0).mean())
    if share < _COVERED:
        said.append(
            f"the boards cover {100 * share:.0f} % of the picture; add pictures with the board at "
            f"{_empty(cells > 0)}"
        )
    if lens.error > _BAD_ERROR:
        said.append(
            f"the error is large: {lens.error:.2f} px. Is the board flat, are the pictures sharp, "
            f"and does another --model fit better?"
        )
    turned, _ = turns_between(lens.camera_from_board[lens.used])
    if turned[1] < _TILT:
        degrees = ", ".join(f"{np.degrees(each):.0f}" for each in turned)
        said.append(f"the board is hardly tilted ({degrees} deg about three axes); tilt it more")
    return said


def _empty(cells: np.ndarray) -> str:
    """The sides of the picture where most is empty, in words."""
    edges = {
        "the left": cells[:, 0],
        "the right": cells[:, -1],
        "the top": cells[0],
        "the bottom": cells[-1],
    }
    empty = [name for name, edge in edges.items() if edge.sum() < (CELLS + 1) // 2]
    return " and ".join(empty) or "the empty places that --plot shows"
