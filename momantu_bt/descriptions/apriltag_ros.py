"""The tags.yaml of apriltag_ros: tags that stand alone, and bundles with their layout.

Lengths are in metres, quaternions x y z w. What is left out is as apriltag_ros has it: no shift, no
turn, and names `tag_ID` and `bundle_NUMBER`. The settings of apriltag_ros may be in the same file;
of them only `tag_family` counts.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field

from momantu_bt.descriptions.reading import DescriptionError, KeyMessage, Reading, read_text
from momantu_bt.descriptions.validation import checked
from momantu_bt.geometry import Transform
from momantu_bt.tags import USUAL_FAMILY, TagBundle, TagFamily, TagPlate, single_tag

UNIT = 0.05
"""How far the length of a quaternion may be off 1."""
_Id = Annotated[int, Field(ge=0)]
_Size = Annotated[float, Field(gt=0, le=10, allow_inf_nan=False)]
_Number = Annotated[float, Field(allow_inf_nan=False)]


class TagsFileError(DescriptionError):
    """A file of tags is wrong; the message lists every problem with its line and a caret."""

    what: ClassVar[str] = "tags"


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class _Standalone(_Part):
    id: _Id
    size: _Size
    name: str | None = None


class _Member(_Part):
    id: _Id
    size: _Size
    x: _Number = 0.0
    y: _Number = 0.0
    z: _Number = 0.0
    qw: _Number = 1.0
    qx: _Number = 0.0
    qy: _Number = 0.0
    qz: _Number = 0.0

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        return self.qw, self.qx, self.qy, self.qz

    def plate(self) -> TagPlate:
        return TagPlate(self.id, self.size, Transform((self.x, self.y, self.z), self.quaternion))


class _Bundle(_Part):
    name: str | None = None
    layout: Annotated[tuple[_Member, ...], Field(min_length=1)]


class _File(_Part):
    standalone_tags: tuple[_Standalone, ...] = ()
    tag_bundles: tuple[_Bundle, ...] = ()
    tag_family: TagFamily | None = None
    tag_threads: Any = None
    tag_decimate: Any = None
    tag_blur: Any = None
    tag_refine_edges: Any = None
    tag_debug: Any = None
    max_hamming_dist: Any = None
    publish_tf: Any = None
    transport_hint: Any = None
    remove_duplicates: Any = None
    camera_frame: Any = None


def read_tags(path: Path, family: TagFamily = USUAL_FAMILY) -> dict[str, TagBundle]:
    """The tags and bundles of a file by their names. family: unless the file says `tag_family`.

    Raises:
        TagsFileError: the file cannot be read, or it is wrong.
    """
    reading = Reading(path, read_text(path, TagsFileError), TagsFileError)
    file = checked(reading, _File, TagsFileError)
    reading.refuse(_wrong(file))
    family = file.tag_family or family
    found = {name: single_tag(tag.id, tag.size, family) for _, name, tag in _alone(file)}
    for _, name, bundle in _bundles(file):
        found[name] = TagBundle(family, tuple(each.plate() for each in bundle.layout))
    return found


def _alone(file: _File) -> Iterator[tuple[int, str, _Standalone]]:
    for number, tag in enumerate(file.standalone_tags):
        yield number, tag.name or f"tag_{tag.id}", tag


def _bundles(file: _File) -> Iterator[tuple[int, str, _Bundle]]:
    for number, bundle in enumerate(file.tag_bundles):
        yield number, bundle.name or f"bundle_{number}", bundle


def _wrong(file: _File) -> Iterator[KeyMessage]:
    names: set[str] = set()
    ids: set[int] = set()
    for number, name, tag in _alone(file):
        if tag.id in ids:
            yield ("standalone_tags", number, "id"), f"the tag {tag.id} is here twice"
        ids.add(tag.id)
        if name in names:
            yield ("standalone_tags", number), f"the name {name!r} is here twice"
        names.add(name)
    for number, name, bundle in _bundles(file):
        if name in names:
            yield ("tag_bundles", number), f"the name {name!r} is here twice"
        names.add(name)
        members: set[int] = set()
        for index, each in enumerate(bundle.layout):
            place = ("tag_bundles", number, "layout", index)
            if each.id in members:
                yield (*place, "id"), f"the tag {each.id} is twice in the bundle {name!r}"
            members.add(each.id)
            length = sum(part**2 for part in each.quaternion) ** 0.5
            if abs(length - 1.0) > UNIT:
                yield place, f"the quaternion has the length {length:.3g}; expected 1"
