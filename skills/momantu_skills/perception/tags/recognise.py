"""All tags and bundles in pictures, each with its pose: those of the site, and the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from momantu_bt.messages import CameraImage
from momantu_bt.tags import TagBundle, TagFamily, TagPlate, single_tag
from momantu_skills.perception.tags.bundles import BundlePose, Seen, TagsDisagreeError, pose_of
from momantu_skills.perception.tags.depth import mean_depth, plane_of
from momantu_skills.perception.tags.detector import Detection, find_all


@dataclass(frozen=True, slots=True, eq=False)
class Recognised:
    """A tag or bundle in a picture. name: of what the robot is told of, or empty."""

    name: str
    bundle: TagBundle
    pose: BundlePose


@dataclass(frozen=True, slots=True, eq=False)
class Recognition:
    """What pictures show. detections: all tags; found: those with a pose.

    refused: names, or ids of tags without a name, that show without a usable pose, and why.
    """

    detections: tuple[Detection, ...]
    found: tuple[Recognised, ...]
    refused: Mapping[str, str]

    def named(self, name: str) -> Recognised | None:
        """The one of a name, if it has a pose."""
        return next((each for each in self.found if each.name == name), None)


def recognise(
    images: Sequence[CameraImage],
    known: Mapping[str, TagBundle],
    edge: float | None = None,
    families: Sequence[TagFamily] = (),
) -> Recognition:
    """Find tags of the known families and of `families` in pictures from one place.

    A tag that the robot is not told of has a pose if `edge` is its edge, m; one that shows twice
    has two. A bundle that shares an id with another one is told only by the ids of its own.
    """
    wanted = sorted({bundle.family for bundle in known.values()} | set(families))
    if not wanted:
        return Recognition((), (), {})
    detections = find_all(images, wanted)
    image = images[-1]
    if len(images) > 1:
        image = replace(image, depth=mean_depth([each.depth for each in images]))
    found: list[Recognised] = []
    refused: dict[str, str] = {}
    for name, bundle in known.items():
        _recognise_one(name, bundle, known, detections, image, found, refused)
    told = {(bundle.family, tag) for bundle in known.values() for tag in bundle.ids}
    for each in detections if edge is not None else ():
        if each.key not in told and edge is not None and each.family in families:
            alone = {"": single_tag(each.tag_id, edge, each.family)}
            _recognise_one("", alone[""], alone, [each], image, found, refused)
    return Recognition(tuple(detections), tuple(found), refused)


def _recognise_one(
    name: str,
    bundle: TagBundle,
    known: Mapping[str, TagBundle],
    detections: Sequence[Detection],
    image: CameraImage,
    found: list[Recognised],
    refused: dict[str, str],
) -> None:
    """Add a bundle to what was found, or to what was refused; neither if it does not show."""
    plates = {plate.tag_id: plate for plate in bundle.plates}
    seen = [
        _seen(plates[each.tag_id], each, image)
        for each in detections
        if each.family == bundle.family and each.tag_id in plates
    ]
    if not seen:
        return
    key = name or ", ".join(str(each.plate.tag_id) for each in seen)
    if len(bundle.plates) == 1 and len(seen) > 1:
        refused[key] = f"the tag {seen[0].plate.tag_id} shows {len(seen)} times"
        return
    try:
        pose = pose_of(seen, image.intrinsics)
    except TagsDisagreeError as error:
        refused[key] = str(error)
        return
    if pose is None:
        refused[key] = f"depth says that the edge is not {seen[0].plate.edge:g} m"
    elif not _told_apart(name, bundle, known, pose):
        refused[key] = "all its tags that show belong to another bundle too"
    else:
        found.append(Recognised(name, bundle, pose))


def _seen(plate: TagPlate, detection: Detection, image: CameraImage) -> Seen:
    return Seen(plate, detection.corners, plane_of(image, detection.corners))


def _told_apart(
    name: str, bundle: TagBundle, known: Mapping[str, TagBundle], pose: BundlePose
) -> bool:
    """Whether a tag counts that is in no other bundle."""
    others = {
        tag
        for other, its in known.items()
        if other != name and its.family == bundle.family and len(its.plates) > 1
        for tag in its.ids
    }
    return len(bundle.plates) == 1 or any(each.plate.tag_id not in others for each in pose.used)
