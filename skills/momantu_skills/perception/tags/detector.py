"""The AprilTag library: tags of several families in one picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any, cast

import numpy as np
import pyapriltags
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.messages import CameraImage
from momantu_bt.tags import USUAL_FAMILY, TagFamily
from momantu_skills.perception.light import levels, lift_of, light_of

PIXEL_CENTRE = 0.5
"""Pixel coordinate of the first pixel's centre, px: 0.5 in the tag library, 0 in the pinhole
matrices here."""
LEAST_MARGIN = 15.0
"""Decision margin of the decoded bits below which a tag is ignored."""
WRONG_BITS = 1
"""Most bits of a tag that may be wrong in a clear picture; in a lifted or averaged one, or where no
tag was found at first, none."""
EXACT = frozenset({"tag16h5", "tagCircle21h7"})
"""Families with so few bits that a wrong one makes tags out of anything: none may be wrong."""
LARGE = frozenset({"tagCircle49h12", "tagCustom48h12", "tagStandard52h13"})
"""Families with so many ids that the library's table of ids with wrong bits needs gigabytes."""
IDS = MappingProxyType(
    {
        "tag36h11": 587,
        "tag25h9": 35,
        "tag16h5": 30,
        "tagStandard41h12": 2115,
        "tagStandard52h13": 48714,
        "tagCircle21h7": 38,
        "tagCircle49h12": 65535,
        "tagCustom48h12": 42211,
    }
)
"""How many ids a family has."""


@dataclass(frozen=True, slots=True, eq=False)
class Detection:
    """One tag in a picture. corners: (4, 2), px, in the order of `UNIT_CORNERS`."""

    family: TagFamily
    tag_id: int
    corners: Array

    @property
    def key(self) -> tuple[TagFamily, int]:
        """Family and id."""
        return self.family, self.tag_id


def find_all(
    images: Sequence[CameraImage], families: Sequence[TagFamily] = (USUAL_FAMILY,)
) -> list[Detection]:
    """Every tag in pictures from one place; an id that shows twice is there twice, larger first.

    Several pictures are averaged. Dim ones are searched in lifted light too, as the library counts
    light in whole levels of 255. Where no tag is found, the picture is searched as it is, with its
    gamma: small tags before grey show there, see `tags_in`.
    """
    grays = [np.ascontiguousarray(image.color[..., 1]) for image in images]
    mean = light_of(grays)
    alone = len(grays) == 1
    found = _detect(levels(mean), families, WRONG_BITS if alone else 0)
    lift = lift_of(mean)
    if lift is not None:
        plain = {each.key for each in found}
        lifted = _detect(levels(mean, lift), families, 0)
        found = _ordered([*found, *(each for each in lifted if each.key not in plain)])
    return found or _detect(np.mean(grays, axis=0).astype(np.uint8), families, 0)


def find_tags(images: Sequence[CameraImage], family: TagFamily = USUAL_FAMILY) -> dict[int, Array]:
    """Corners (4, 2) in px of every tag of a family in pictures from one place, by id.

    The larger one if an id repeats; else as `find_all`.
    """
    return _by_id(find_all(images, (family,)))


def tags_in(gray: NDArray[np.uint8], family: TagFamily = USUAL_FAMILY) -> dict[int, Array]:
    """Corners (4, 2) in px of every tag in a gray picture (H, W), by id.

    Its gamma is reversed, because otherwise white bleeds into a tag's black border and the tag
    seems 1.6 % farther away. Small tags that are only found otherwise, as grey around them looks
    nearly black then, are as the picture has them.
    """
    light = _by_id(_detect(levels(light_of([gray])), (family,), WRONG_BITS))
    return {**_by_id(_detect(gray, (family,), WRONG_BITS)), **light}


def wide_tags_in(gray: NDArray[np.uint8]) -> dict[int, Array]:
    """As `tags_in`, of the usual family with a border of two cells: those of Kalibr's AprilGrids.

    Black squares touch the corners of these tags. The picture is made brighter, so that what blur
    leaves between two of them counts as white.
    """
    bright = np.sqrt(255.0 * gray).astype(np.uint8)
    return _by_id(_kept(_wide_detector(), bright, WRONG_BITS))


def _by_id(found: Sequence[Detection]) -> dict[int, Array]:
    """The larger of those with one id."""
    return {each.tag_id: each.corners for each in reversed(found)}


def _detect(
    light: NDArray[np.uint8], families: Sequence[TagFamily], wrong_bits: int
) -> list[Detection]:
    return _kept(_detector(tuple(sorted(set(families)))), light, wrong_bits)


def _kept(
    detector: pyapriltags.Detector, light: NDArray[np.uint8], wrong_bits: int
) -> list[Detection]:
    found = []
    for each in detector.detect(np.ascontiguousarray(light)):
        family = cast(TagFamily, each.tag_family.decode())
        most = 0 if family in EXACT else wrong_bits
        if each.hamming <= most and each.decision_margin >= LEAST_MARGIN:
            corners = np.asarray(each.corners, dtype=np.float64) - PIXEL_CENTRE
            found.append(Detection(family, int(each.tag_id), corners))
    return _ordered(found)


def _ordered(found: list[Detection]) -> list[Detection]:
    return sorted(found, key=lambda each: (each.family, each.tag_id, -area(each.corners)))


def area(corners: Array) -> float:
    """Area of a quadrilateral (4, 2)."""
    return abs(signed_area(corners))


def signed_area(corners: Array) -> float:
    """Area of a quadrilateral (4, 2), negative where its corners go the other way round."""
    x, y = corners[:, 0], corners[:, 1]
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


@lru_cache(maxsize=8)
def _detector(families: tuple[TagFamily, ...]) -> pyapriltags.Detector:
    """A detector of these families.

    pyapriltags itself always prepares for two wrong bits, which takes minutes and gigabytes for the
    large families; so the families are added here, as it does it.
    """
    detector = _empty()
    for name in families:
        family = getattr(detector.libc, f"{name}_create")()
        _enter(detector, name, family, 0 if name in LARGE or name in EXACT else WRONG_BITS)
    return detector


@lru_cache(maxsize=1)
def _wide_detector() -> pyapriltags.Detector:
    """A detector of the usual family with a border of two cells."""
    detector = _empty()
    family = getattr(detector.libc, f"{USUAL_FAMILY}_create")()
    layout = family.contents
    layout.width_at_border += 2
    layout.total_width += 2
    for bit in range(layout.nbits):
        layout.bit_x[bit] += 1
        layout.bit_y[bit] += 1
    _enter(detector, USUAL_FAMILY, family, WRONG_BITS)
    return detector


def _empty() -> pyapriltags.Detector:
    return pyapriltags.Detector(families="", nthreads=1, quad_decimate=1.0)


def _enter(detector: pyapriltags.Detector, name: TagFamily, family: Any, bits: int) -> None:
    """Make a detector look for a family, with so many bits that may be wrong."""
    library: Any = detector.libc
    library.apriltag_detector_add_family_bits(detector.tag_detector_ptr, family, bits)
    detector.tag_families[name] = family
