"""Checks of a world file's references: unknown and duplicate names, missing files."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from momantu_bt.descriptions.apriltag_ros import TagsFileError, read_tags
from momantu_bt.descriptions.reading import KeyMessage
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import KeyPath
from momantu_bt.lazy import lazily
from momantu_worlds.scenes.file.world import WorldFile

with lazily():
    from momantu_bt.formats import maps

FLOOR = "floor"
"""The name of the floor's body."""
WITHOUT_WORLD = "none"
"""The name for running without a world, in trees and on the command line."""


def dangling(world: WorldFile, also: Collection[str] = ()) -> Iterator[KeyMessage]:
    """Find all references in a file to something that does not exist.

    also: names of parts that were left out because of other errors.
    """
    if world.name == WITHOUT_WORLD:
        yield ("name",), f"{WITHOUT_WORLD!r} means no world at all; choose another name"
    yield from _twice(world)
    yield from _Names(world, also).findings()
    yield from _files(world)
    for name, problem in world.room_walls.problems.items():
        yield ("doors", name), f"the door {name!r}: {problem}"


def _twice(world: WorldFile) -> Iterator[KeyMessage]:
    """Find bodies with the same name: those named in the file, and the walls built from it."""
    seen: dict[str, str] = {FLOOR: "the floor"} | {run.name: "a wall" for run in world.wall_runs}
    named = {("item", "name"): world.item, ("tag", "name"): world.tag}
    found: list[tuple[KeyPath, str, str]] = [
        (place, each.name, place[0]) for place, each in named.items() if each is not None
    ]
    sections: dict[str, tuple[str, Iterable[str]]] = {
        "doors": ("door", world.doors),
        "tables": ("table", world.tables),
        "furniture": ("piece of furniture", world.furniture),
        "bodies": ("body", world.bodies),
        "objects": ("object", world.objects),
        "tags": ("tag", world.tags),
        "actors": ("actor", world.actors),
    }
    for section, (what, names) in sections.items():
        found += [((section, name), name, what) for name in names]
    for place, name, what in found:
        if name in seen:
            yield place, f"{name!r} is {_a(seen[name])} already; choose another name"
        seen.setdefault(name, what)
    for name in sorted(set(world.doorways) & set(world.doors)):
        yield ("doorways", name), f"{name!r} is a door already; choose another name"


def _a(what: str) -> str:
    if what.startswith(("a ", "the ")):
        return what
    return f"{'an' if what[0] in 'aeiou' else 'a'} {what}"


class _Names:
    """Checks of the names that sections use for each other."""

    def __init__(self, world: WorldFile, also: Collection[str]) -> None:
        self._world, self._also = world, also
        self._surfaces = surface_names(world)

    def findings(self) -> Iterator[KeyMessage]:
        yield from self._boards()
        for place, top in self._tops():
            yield from self._missing(place, top, self._surfaces, "table")
        yield from self._goal()

    def _missing(
        self, place: KeyPath, name: str, known: Iterable[str], what: str
    ) -> Iterator[KeyMessage]:
        names = list(known)
        if name not in names and name not in self._also:
            yield place, f"there is no {what} {name!r}; {valid_names(name, names, f'{what}s')}"

    def _boards(self) -> Iterator[KeyMessage]:
        """Check boards that are surfaces: their shelf, their number, and duplicates."""
        world = self._world
        taken: dict[tuple[str, int], str] = {}
        shelves = [name for name, piece in world.furniture.items() if piece.boards]
        for name, table in world.tables.items():
            if table.board_of is None or table.board is None:
                continue
            place = ("tables", name)
            yield from self._missing(
                (*place, "board_of"), table.board_of, shelves, "shelf with boards"
            )
            if table.board_of in shelves:
                piece = world.furniture[table.board_of]
                if table.board > len(piece.boards):
                    message = f"{table.board_of!r} has {len(piece.boards)} boards, counted from 1"
                    yield (*place, "board"), message
                elif piece.moves:
                    message = (
                        f"{table.board_of!r} carries a surface: shift and turn it, instead of moves"
                    )
                    yield ("furniture", table.board_of, "moves"), message
            other = taken.setdefault((table.board_of, table.board), name)
            if other != name:
                yield (*place, "board"), f"this board is {other!r} already"

    def _tops(self) -> Iterator[tuple[KeyPath, str]]:
        """What stands on which surface."""
        world = self._world
        if world.item is not None:
            yield from ((("item", "on"), top) for top in world.item.tops)
        if world.tag is not None and world.tag.on is not None:
            yield ("tag", "on"), world.tag.on
        for name, note in world.objects.items():
            yield from ((("objects", name, "on"), top) for top in note.tops)
        for name, tag in world.tags.items():
            if tag.on is not None:
                yield ("tags", name, "on"), tag.on
        if world.distractors is not None:
            for number, top in enumerate(world.distractors.on or ()):
                yield ("distractors", "on", number), top

    def _goal(self) -> Iterator[KeyMessage]:
        world = self._world
        names = goal_names(world)
        for number, demand in enumerate(world.demands):
            place: KeyPath = ("goal", number) if isinstance(world.goal, tuple) else ("goal",)
            yield from self._missing((*place, "item"), demand.item, names["item"], "object")
            yield from self._missing((*place, "on"), demand.on, names["on"], "table")
            if demand.beside is None:
                continue
            yield from self._missing(
                (*place, "beside"), demand.beside, names["beside"], "tag or body"
            )
            if demand.beside == demand.item:
                yield (*place, "beside"), f"{demand.item!r} cannot stand beside itself"


def goal_names(world: WorldFile) -> dict[str, tuple[str, ...]]:
    """The names that a goal's keys can have."""
    surfaces = surface_names(world)
    return {
        "item": (
            *([world.item.name] if world.item is not None else ()),
            *world.objects,
            *(name for name, body in world.bodies.items() if not body.static),
        ),
        "on": surfaces,
        "beside": (*world.all_tags, *world.objects, *surfaces, *world.bodies),
    }


def surface_names(world: WorldFile) -> tuple[str, ...]:
    """Names of all surfaces: tables, boards, and bodies with a top."""
    bodies = (name for name, body in world.bodies.items() if body.surface is not None)
    return (*world.tables, *bodies)


def _files(world: WorldFile) -> Iterator[KeyMessage]:
    for place, use in world.mesh_uses():
        if not world.beside(use.file).is_file():
            yield (*place, "file"), f"there is no file {use.file!r} beside the world file"
    if world.site.map is not None and (wrong := _map_problem(world, world.site.map)):
        yield ("site", "map"), wrong
    yield from _told_tags(world)


def _told_tags(world: WorldFile) -> Iterator[KeyMessage]:
    """Tags of the site that neither this file nor the file of tags has."""
    known = list(world.all_tags)
    if world.site.tags_file is not None:
        file = world.beside(world.site.tags_file)
        try:
            known += read_tags(file)
        except TagsFileError as error:
            yield ("site", "tags_file"), f"{world.site.tags_file!r} cannot be used:\n{error}"
            return
    for name in world.site.tags:
        if name not in known:
            yield ("site", "tags", name), f"no tag {name!r}; {valid_names(name, known, 'tags')}"


def _map_problem(world: WorldFile, name: str) -> str | None:
    """Why the robot cannot use the world's own map; None if it can."""
    file = world.beside(name)
    if not file.is_file():
        return f"there is no file {name!r} beside the world file"
    try:
        free = maps.read_map(file).cells() == maps.FREE
    except maps.MapError as error:
        return str(error)
    if free.any():
        return None
    return (
        f"the map {name!r} has no free cell, so a robot cannot be anywhere on it; look at its "
        "picture, `negate`, `free_thresh` and `occupied_thresh`"
    )
