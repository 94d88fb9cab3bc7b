"""What a robot is told of tags: their layout, and where those are that do not move."""

from __future__ import annotations

from dataclasses import replace

from momantu_bt.descriptions.apriltag_ros import read_tags
from momantu_bt.geometry import Transform
from momantu_bt.tags import TagBundle
from momantu_worlds.scenes.arrange.episode import map_from_hung
from momantu_worlds.scenes.file.objects import TagNote
from momantu_worlds.scenes.file.values import transform
from momantu_worlds.scenes.file.world import WorldFile


def told_tags(world: WorldFile) -> dict[str, TagBundle]:
    """The tags of `site.tags` and `site.tags_file` by name.

    A tag that is hung is told with its place; the place that the site itself has counts more.

    Raises:
        TagsFileError: the file of tags is missing or wrong.
    """
    notes = world.site
    found = {} if notes.tags_file is None else read_tags(world.beside(notes.tags_file))
    for name, told in notes.tags.items():
        if name in world.all_tags:
            found[name] = _bundle(world.all_tags[name])
        if told.place is not None:
            found[name] = replace(found[name], map_from_bundle=transform(told.place))
    return found


def _bundle(note: TagNote) -> TagBundle:
    place: Transform | None = None if note.hung is None else map_from_hung(note.hung)
    return TagBundle(note.family, note.plates, place)
