"""Names in a world file that point at nothing, or at two things, and files that are not there."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from typing import TypeAlias

from momantu_worlds.scenes.world_file import WorldFile
from momantu_worlds.scenes.world_furniture import MeshUse

Place: TypeAlias = tuple[str | int, ...]
Finding: TypeAlias = tuple[Place, str]
FLOOR = "floor"
"""The name of the body that everything stands on."""
NO_WORLD = "none"
"""What trees and the command line call running without a world."""


def dangling(world: WorldFile) -> Iterator[Finding]:
    """Everything that one part of a file says of another and that is not so."""
    if world.name == NO_WORLD:
        yield ("name",), f"{NO_WORLD!r} means no world at all; choose another name"
    yield from _twice(world)
    yield from _boards(world)
    yield from _standing(world)
    yield from _goal(world)
    yield from _files(world)
    for name, problem in world.room_walls.problems.items():
        yield ("doors", name), f"the door {name!r}: {problem}"


def _twice(world: WorldFile) -> Iterator[Finding]:
    """Bodies of one name: all that a file names, and the walls that follow from it."""
    seen: dict[str, str] = {FLOOR: "the floor"} | {run.name: "a wall" for run in world.wall_runs}
    named = {("item", "name"): world.item, ("tag", "name"): world.tag}
    found: list[tuple[Place, str, str]] = [
        (place, each.name, place[0]) for place, each in named.items() if each is not None
    ]
    sections: dict[str, tuple[str, Iterable[str]]] = {
        "doors": ("door", world.doors),
        "tables": ("table", world.tables),
        "furniture": ("piece of furniture", world.furniture),
        "bodies": ("body", world.bodies),
        "objects": ("object", world.objects),
        "tags": ("tag", world.tags),
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


def _boards(world: WorldFile) -> Iterator[Finding]:
    """Boards that are surfaces: their shelf, their number, and whether somebody took it."""
    taken: dict[tuple[str, int], str] = {}
    for name, table in world.tables.items():
        if table.board_of is None or table.board is None:
            continue
        piece = world.furniture.get(table.board_of)
        shelves = [other for other, each in world.furniture.items() if each.boards]
        if piece is None or not piece.boards:
            message = no_such(table.board_of, shelves, "shelf with boards", "shelves with boards")
            yield ("tables", name, "board_of"), message
        elif table.board > len(piece.boards):
            message = f"{table.board_of!r} has {len(piece.boards)} boards, counted from 1"
            yield ("tables", name, "board"), message
        elif piece.moves:
            message = f"{table.board_of!r} carries a surface; write shift and turn, not moves"
            yield ("furniture", table.board_of, "moves"), message
        other = taken.setdefault((table.board_of, table.board), name)
        if other != name:
            yield ("tables", name, "board"), f"this board is {other!r} already"


def _standing(world: WorldFile) -> Iterator[Finding]:
    """What stands on a surface that is none."""
    surfaces = surface_names(world)
    asked: list[tuple[Place, str]] = []
    if world.item is not None:
        asked.append((("item", "on"), world.item.on))
    if world.tag is not None and world.tag.on is not None:
        asked.append((("tag", "on"), world.tag.on))
    for name, note in world.objects.items():
        asked += [(("objects", name, "on"), top) for top in note.tops]
    asked += [(("tags", name, "on"), tag.on) for name, tag in world.tags.items() if tag.on]
    if world.distractors is not None:
        asked += [(("distractors", "on", i), on) for i, on in enumerate(world.distractors.on or ())]
    for place, top in asked:
        if top not in surfaces:
            yield place, no_such(top, surfaces, "table", "tables")


def _goal(world: WorldFile) -> Iterator[Finding]:
    goal = world.goal
    if goal is None:
        return
    things = [*([world.item.name] if world.item is not None else ()), *world.objects]
    if goal.item not in things:
        yield ("goal", "item"), no_such(goal.item, things, "object", "objects")
    surfaces = surface_names(world)
    if goal.on not in surfaces:
        yield ("goal", "on"), no_such(goal.on, surfaces, "table", "tables")
    markers = [*world.all_tags, *world.objects, *surfaces, *world.bodies]
    if goal.beside is not None and goal.beside not in markers:
        yield ("goal", "beside"), no_such(goal.beside, markers, "tag or body", "there are")
    elif goal.beside == goal.item:
        yield ("goal", "beside"), f"{goal.item!r} cannot stand beside itself"


def surface_names(world: WorldFile) -> tuple[str, ...]:
    """Names of all surfaces: tables, boards, and bodies with a top."""
    bodies = (name for name, body in world.bodies.items() if body.surface is not None)
    return (*world.tables, *bodies)


def _files(world: WorldFile) -> Iterator[Finding]:
    for place, use in _meshes(world):
        if not world.beside(use.file).is_file():
            yield (*place, "file"), f"there is no file {use.file!r} beside the world file"
    if world.site.map is not None and not world.beside(world.site.map).is_file():
        yield ("site", "map"), f"there is no file {world.site.map!r} beside the world file"


def _meshes(world: WorldFile) -> Iterator[tuple[Place, MeshUse]]:
    for section, pieces in (("tables", world.tables), ("furniture", world.furniture)):
        for name, piece in pieces.items():
            if piece.mesh is not None:
                yield (section, name, "mesh"), piece.mesh
    for name, body in world.bodies.items():
        for number, part in enumerate(body.parts):
            if part.mesh is not None:
                yield ("bodies", name, "parts", number, "mesh"), part.mesh


def no_such(name: str, having: Iterable[str], what: str, several: str) -> str:
    """A name that is none, the nearest one, and all that there are."""
    names = list(dict.fromkeys(having))
    near = difflib.get_close_matches(name, names, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"there is no {what} {name!r}; {hint}{several}: {', '.join(names) or 'none'}"
