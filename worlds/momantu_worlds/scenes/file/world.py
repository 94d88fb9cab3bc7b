"""A whole world file, as checked values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, PrivateAttr

from momantu_bt.descriptions.goal import GoalDemand, GoalDemands, demands
from momantu_bt.formats.maps import picture_file
from momantu_bt.formats.places import KeyPath
from momantu_bt.geometry import Pose2D
from momantu_worlds.scenes.file.actors import ActorNote
from momantu_worlds.scenes.file.bodies import BodyNote
from momantu_worlds.scenes.file.building import (
    MOST_DOORS,
    MOST_ROOMS,
    Door,
    Doorway,
    Floor,
    Room,
    Walls,
)
from momantu_worlds.scenes.file.furniture import MeshUse, Piece, Table
from momantu_worlds.scenes.file.objects import Distractors, Item, ObjectNote, Tag, TagNote
from momantu_worlds.scenes.file.site import SiteNotes
from momantu_worlds.scenes.file.values import Name, Part
from momantu_worlds.scenes.file.variation import Light, Start, Unknown
from momantu_worlds.scenes.file.walls import RoomWalls, WallRun, given_runs

MOST_ACTORS = 20
MOST_PIECES, MOST_TABLES, MOST_OBJECTS, MOST_TAGS, MOST_BODIES = 1000, 100, 200, 100, 2000


class WorldFile(Part):
    """A whole world file. All sections but its version, its name and the start are optional."""

    momantu_world: Literal[1]
    name: Name
    robot: Annotated[str, Field(min_length=1, max_length=500)] = "fetch"
    floor: Floor = Floor()
    walls: Walls = Walls()
    rooms: Annotated[dict[Name, Room], Field(max_length=MOST_ROOMS)] = {}
    doors: Annotated[dict[Name, Door], Field(max_length=MOST_DOORS)] = {}
    doorways: Annotated[dict[Name, Doorway], Field(max_length=MOST_DOORS)] = {}
    tables: Annotated[dict[Name, Table], Field(max_length=MOST_TABLES)] = {}
    item: Item | None = None
    tag: Tag | None = None
    objects: Annotated[dict[Name, ObjectNote], Field(max_length=MOST_OBJECTS)] = {}
    tags: Annotated[dict[Name, TagNote], Field(max_length=MOST_TAGS)] = {}
    distractors: Distractors | None = None
    furniture: Annotated[dict[Name, Piece], Field(max_length=MOST_PIECES)] = {}
    bodies: Annotated[dict[Name, BodyNote], Field(max_length=MOST_BODIES)] = {}
    actors: Annotated[dict[Name, ActorNote], Field(max_length=MOST_ACTORS)] = {}
    start: Start
    unknown: Unknown | None = None
    light: Light = Light()
    goal: GoalDemands | None = None
    site: SiteNotes = SiteNotes()

    _file: Path = PrivateAttr(default=Path())
    _goal_line: int = PrivateAttr(default=1)

    def located(self, file: Path, goal_line: int = 1) -> WorldFile:
        """The same world, with the file that it was read from, and the line of its goal there."""
        self._file, self._goal_line = file, goal_line
        return self

    @property
    def file(self) -> Path:
        """The file that it was read from."""
        return self._file

    def beside(self, name: str) -> Path:
        """Path of a file that the world file names: relative to the world file."""
        return self._file.parent / name

    def mesh_files(self) -> tuple[Path, ...]:
        """Every mesh file that it names, once."""
        return tuple(dict.fromkeys(self.beside(use.file) for _, use in self.mesh_uses()))

    def mesh_uses(self) -> Iterator[tuple[KeyPath, MeshUse]]:
        """Every mesh, with the keys under which it is written."""
        if self.item is not None and self.item.mesh is not None:
            yield ("item", "mesh"), self.item.mesh
        sections: dict[str, Mapping[str, Table | Piece | ObjectNote]] = {
            "tables": self.tables,
            "furniture": self.furniture,
            "objects": self.objects,
        }
        for section, notes in sections.items():
            for name, note in notes.items():
                if note.mesh is not None:
                    yield (section, name, "mesh"), note.mesh
        for name, body in self.bodies.items():
            for number, part in enumerate(body.parts):
                if part.mesh is not None:
                    yield ("bodies", name, "parts", number, "mesh"), part.mesh

    def files(self) -> tuple[Path, ...]:
        """The world file itself and all files that it names: meshes, its own tags, its own map.

        Raises:
            MapError: the map is missing or broken.
        """
        found = [self._file, *self.mesh_files()]
        if self.site.tags_file is not None:
            found.append(self.beside(self.site.tags_file))
        if self.site.map is not None:
            map_file = self.beside(self.site.map)
            found += [map_file, picture_file(map_file)]
        return tuple(found)

    @property
    def demands(self) -> tuple[GoalDemand, ...]:
        """What the goal demands; nothing without a goal."""
        return demands(self.goal)

    @property
    def goal_place(self) -> str:
        """Where the goal is written: `four_rooms.yaml:164`."""
        return f"{self._file.name}:{self._goal_line}"

    @property
    def sought(self) -> str | None:
        """The object to bring: the goal's first, or the item."""
        if self.demands:
            return self.demands[0].item
        return None if self.item is None else self.item.name

    @cached_property
    def room_walls(self) -> RoomWalls:
        """The walls that follow from the rooms."""
        return RoomWalls(self.walls, self.rooms, self.doors)

    @cached_property
    def wall_runs(self) -> tuple[WallRun, ...]:
        """Every wall: those given piece by piece, then those of the rooms."""
        return (*given_runs(self.walls), *self.room_walls.runs())

    @cached_property
    def door_leaves(self) -> tuple[tuple[str, Door, Pose2D], ...]:
        """Closed doors, and where the middle of each leaf is."""
        return tuple(self.room_walls.leaves())

    @cached_property
    def all_doorways(self) -> dict[str, Doorway]:
        """Gaps to drive through: those that are given, then the open doors."""
        return {**self.doorways, **self.room_walls.doorways()}

    @cached_property
    def all_tags(self) -> dict[str, TagNote]:
        """Every tag by its name; the one that `tag` describes comes first."""
        return {**({} if self.tag is None else {self.tag.name: self.tag}), **self.tags}
