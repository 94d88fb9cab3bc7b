"""What the network sees in one picture: things with poses and sizes in a crop's frame."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from momantu_bt.categories import Symmetry
from momantu_bt.geometry import Array
from momantu_skills.perception.learned import weights
from momantu_skills.perception.learned.claims import Cells, claimed
from momantu_skills.perception.learned.crops import LOW, NORMAL, Crop, channels, mirror
from momantu_skills.perception.learned.instances import LEAST, instances
from momantu_skills.perception.learned.network import NOTHING
from momantu_skills.perception.learned.refining import Seen, refined
from momantu_skills.perception.learned.solids import Solid
from momantu_skills.perception.learned.targets import OFFSET_UNIT

SHOWN = 0.5
"""Least probability that a cell shows a thing."""
MIRRORED = 60_000
"""Pixels of a crop up to which its mirror image is looked at too: of a larger one, which takes
longest and shows things near by, it tells little more."""


class Seeing:
    """The network with its weights."""

    def __init__(self, path: Path) -> None:
        """path: of the weights; raises WeightsError if they are none."""
        self._network = weights.load(path)
        self._handled = [
            number
            for number, symmetry in enumerate(self._network.categories.values())
            if symmetry is Symmetry.HANDLE
        ]

    def solids(self, crop: Crop) -> list[Solid]:
        """The things in a crop, in its frame `level`."""
        layers = channels(crop)
        normals = layers[NORMAL, ::2, ::2].reshape(3, -1).T.astype(np.float64)
        chances, coordinates, offsets = self._said(layers)
        points = crop.cells()
        shown = (chances[:, NOTHING] < 1.0 - SHOWN) & np.isfinite(points[:, 2])
        if int(shown.sum()) < LEAST:
            return []
        every = points
        points, coordinates, offsets = points[shown], coordinates[:, shown], offsets[shown]
        chances, normals = chances[shown], normals[shown]
        owner = instances(points + OFFSET_UNIT * offsets)
        of_category, of_handle = self._of_category(chances)
        cells = Cells(points, coordinates, of_category, of_handle)
        things = claimed(cells, owner, self._network.categories)
        free = np.isfinite(every[:, 2]) & ~shown & (every[:, 2] > LOW)
        around = np.concatenate([every[free], points[owner < 0]])
        found = []
        for number, thing in things.items():
            mine = owner == number
            seen = Seen(points[mine], normals[mine], of_handle[mine], around, crop.eye)
            found.append(replace(refined(thing, seen), points=points[mine]))
        return found

    def _of_category(self, chances: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Chances (n, categories), and which of the cells (n,) show a handle."""
        of_category, handle = chances[:, NOTHING + 1 : -1].copy(), chances[:, -1]
        of_handle = np.zeros(len(chances), dtype=np.bool_)
        for number in self._handled:
            of_handle |= handle > of_category[:, number]
            of_category[:, number] += handle
        return of_category, of_handle

    def _said(self, layers: NDArray[np.float32]) -> tuple[Array, Array, Array]:
        """Chances (n, classes), coordinates (k, n, 3), offsets (n, 3) of all cells.

        The network sees the crop and, up to MIRRORED pixels, its mirror image: k answers count.

        layers: (CHANNELS, h, w) of a crop.
        """
        before = torch.get_num_threads()
        torch.set_num_threads(1)
        try:
            said = [self._answers(layers)]
            if layers.shape[1] * layers.shape[2] <= MIRRORED:
                said.append(_turned(self._answers(mirror(layers))))
        finally:
            torch.set_num_threads(before)
        chances, places, votes = (
            np.stack(all_)
            .reshape(len(said), len(all_[0]), -1)
            .transpose(0, 2, 1)
            .astype(np.float64)
            for all_ in zip(*said, strict=True)
        )
        return chances.mean(axis=0), places, votes.mean(axis=0)

    def _answers(self, layers: NDArray[np.float32]) -> list[NDArray[np.float32]]:
        """Chances, coordinates and offsets, each (k, h/2, w/2)."""
        with torch.inference_mode():
            seen = torch.from_numpy(np.ascontiguousarray(layers))[None]
            seen = seen.contiguous(memory_format=torch.channels_last)
            scores, coordinates, offsets = self._network(seen)
            return [
                part[0].contiguous().numpy()
                for part in (scores.softmax(dim=1), coordinates, offsets)
            ]


def _turned(answers: list[NDArray[np.float32]]) -> list[NDArray[np.float32]]:
    """What was said of a mirror image, as said of the crop itself."""
    chances, coordinates, offsets = (part[:, :, ::-1].copy() for part in answers)
    coordinates[1] *= -1.0
    offsets[0] *= -1.0
    return [chances, coordinates, offsets]
