"""Sites, worlds and verdicts: what the robot is told, where it acts, and who judges."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from momantu_bt.errors import ExitCode, MomantuError
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.marker import Marker
from momantu_bt.messages import ObjectClass
from momantu_bt.tags import TagBundle
from momantu_bt.zone import Zone

if TYPE_CHECKING:
    from momantu_bt.robot import Robot, RobotDescription

TICK = 0.05
"""Seconds of the world's clock between two ticks of the tree."""


@dataclass(frozen=True, slots=True)
class Overhang:
    """A solid above a surface, such as the next board of a shelf.

    map_from_overhang: its centre on the floor plan. size: (x, y) extent, m. bottom, top: heights
    of its lower and upper side above the floor, m.
    """

    map_from_overhang: Pose2D
    size: tuple[float, float]
    bottom: float
    top: float


@dataclass(frozen=True, slots=True)
class Surface:
    """A named table or shelf, as a person would describe it.

    map_from_surface: centre of its top on the floor plan. size: (x, y) extent of the top, m.
    height: of the top above the floor, m. sides: the directions from which the robot can approach
    it, as angles in the surface's frame, rad; the first is preferred. over: solids above it that
    are not surfaces themselves. round: the top is a disc of that diameter, else a rectangle.
    """

    map_from_surface: Pose2D
    size: tuple[float, float]
    height: float
    sides: tuple[float, ...]
    over: tuple[Overhang, ...] = ()
    round: bool = False


class Surfaces(Mapping[str, Surface]):
    """A site's surfaces as one run believes them: as told, until a skill finds one elsewhere.

    corrections: how often that happened.
    """

    def __init__(self, told: Mapping[str, Surface]) -> None:
        """Believe what is told. A `Surfaces` is copied with what it was told."""
        self._told = dict(told.told if isinstance(told, Surfaces) else told)
        self._now = dict(self._told)
        self.corrections = 0

    @property
    def told(self) -> Mapping[str, Surface]:
        """The surfaces as the site says."""
        return MappingProxyType(self._told)

    @property
    def corrected(self) -> tuple[str, ...]:
        """Names of the surfaces that were found elsewhere."""
        return tuple(name for name in self._told if self._now[name] != self._told[name])

    def correct(self, name: str, surface: Surface) -> None:
        """From now on believe this of the surface; KeyError if none has that name."""
        if name not in self._told:
            raise KeyError(name)
        self._now[name] = surface
        self.corrections += 1

    def teach(self, name: str, surface: Surface) -> None:
        """Add a surface that was not told, or replace one that was."""
        self._told[name] = self._now[name] = surface
        self.corrections += 1

    def __getitem__(self, name: str) -> Surface:
        """The surface as believed now."""
        return self._now[name]

    def __iter__(self) -> Iterator[str]:
        """The names, in the site's order."""
        return iter(self._told)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._told)


class Places(Mapping[str, Pose2D]):
    """A site's places in one run: those that were told, and those that the robot was taught."""

    def __init__(self, told: Mapping[str, Pose2D]) -> None:
        self._poses = dict(told)

    def teach(self, name: str, map_from_base: Pose2D) -> None:
        """Add a place, or move one."""
        self._poses[name] = map_from_base

    def __getitem__(self, name: str) -> Pose2D:
        """Where the base stands there."""
        return self._poses[name]

    def __iter__(self) -> Iterator[str]:
        """The names: first those that were told."""
        return iter(self._poses)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._poses)


@dataclass(frozen=True, slots=True)
class Site:
    """Everything that the robot is told about its surroundings.

    map_file: the floor plan, in map_server's YAML format. overhang_file: a map in the same format
    of known furniture that the laser's plane misses. start: the robot's approximate start pose in
    the map; start_sigma: its standard deviations (m, rad). places, surfaces: in a run a `Places`
    and a `Surfaces`, which skills correct, and to which they add what they are taught. tags:
    AprilTags and bundles of them, by name. services: parameters of services and skills, by name.
    area: the least x and y and the largest x and y of the floor plan, m; None if they are not
    known. zones: parts of the floor to keep out of, to drive slowly in, or to prefer, by name.
    """

    name: str
    map_file: Path | None = None
    overhang_file: Path | None = None
    start: Pose2D = field(default_factory=lambda: Pose2D(0.0, 0.0, 0.0))
    start_sigma: tuple[float, float] = (0.15, 0.13)
    places: Mapping[str, Pose2D] = field(default_factory=lambda: MappingProxyType({}))
    surfaces: Mapping[str, Surface] = field(default_factory=lambda: MappingProxyType({}))
    objects: Mapping[str, ObjectClass] = field(default_factory=lambda: MappingProxyType({}))
    tags: Mapping[str, TagBundle] = field(default_factory=lambda: MappingProxyType({}))
    services: Mapping[str, Mapping[str, Any]] = field(default_factory=lambda: MappingProxyType({}))
    area: tuple[float, float, float, float] | None = None
    zones: Mapping[str, Zone] = field(default_factory=lambda: MappingProxyType({}))

    def known_places(self) -> tuple[str, ...]:
        """Names of places and surfaces."""
        return (*self.places, *self.surfaces)

    def nowhere(self) -> Site:
        """The same without what lies somewhere; what tags and objects look like is kept."""
        tags = {name: replace(tag, map_from_bundle=None) for name, tag in self.tags.items()}
        return replace(
            self,
            places=Places({}),
            surfaces=Surfaces({}),
            tags=MappingProxyType(tags),
            zones=MappingProxyType({}),
        )

    def uncharted(self) -> Site:
        """The same for a robot that has no map, or makes it itself: it is told where it starts."""
        return replace(self.nowhere(), map_file=None, overhang_file=None, area=None)

    def of_a_run(self) -> Site:
        """The same for one run, whose skills may correct where a surface stands."""
        return replace(self, places=Places(self.places), surfaces=Surfaces(self.surfaces))


@dataclass(frozen=True, slots=True)
class Incident:
    """Something dangerous that the robot did, by ground truth.

    time: s. kind: "force" (the robot pushed too hard), "person" (it pushed somebody), "dropped" (it
    released an object above a surface) or "moving" (it still moves after the end of the run).
    value: the force in N, the height in m, or the speed in m/s or rad/s.
    """

    time: float
    kind: str
    sentence: str
    value: float


@dataclass(frozen=True, slots=True)
class Demanded:
    """One demand of the goal, and whether it is met.

    demand: in words, such as `can on table_b beside tag`. place: where it is written, such as
    `my_flat.yaml:64`; "" if that is not known. unmet: a sentence for each criterion that is not
    met, of this object alone.
    """

    demand: str
    place: str
    met: bool
    unmet: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Verdict:
    """The referee's judgement of the episode, from ground truth.

    success: every demand is met; None: nothing is demanded. unmet: one sentence for each criterion
    that is not met.
    measures: the measured numbers (tilt in rad, distances in m, forces in N).
    causes: of measures of the whole run, by the same names, which bodies they belong to.
    incidents: everything dangerous that happened, ordered by time, demanded or not.
    demands: each of them, if the world tells.
    """

    success: bool | None
    unmet: tuple[str, ...] = ()
    measures: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    incidents: tuple[Incident, ...] = ()
    demands: tuple[Demanded, ...] = ()
    causes: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, slots=True)
class TreeLine:
    """One line of the tree on a display: indentation depth, text and status name."""

    depth: int
    text: str
    status: str


class Video(Protocol):
    """A film of the run: third-person view, head camera and the tree's state in one picture."""

    def add(self, lines: Sequence[TreeLine], headline: str) -> None:
        """Add a frame that shows the current moment."""
        ...

    def close(self) -> None:
        """Finish the file. Calling it twice is safe."""
        ...


class View(Protocol):
    """A live 3D view in a browser."""

    @property
    def url(self) -> str:
        """The address to open in a browser."""
        ...

    def update(self) -> None:
        """Show the world's current state."""
        ...

    def close(self) -> None:
        """Stop serving. Calling it twice is safe."""
        ...


class Layer(Enum):
    """What a marker in a view shows; a person can hide each layer."""

    SCAN = "laser scan"
    PATH = "path"
    COSTMAP = "costmap"
    OBJECTS = "detections"
    MARKERS = "other markers"


@runtime_checkable
class MarkerView(Protocol):
    """A view that also shows what the robot believes, and what skills draw."""

    def draw(
        self, name: str, marker: Marker, map_from_frame: Transform, layer: Layer = Layer.MARKERS
    ) -> None:
        """Show a marker; it replaces an earlier one of that name."""
        ...

    def erase(self, name: str) -> None:
        """Show a marker no longer."""
        ...


@runtime_checkable
class TreeView(Protocol):
    """A view that also shows the tree, and that can stay open when the run is over."""

    def tell(self, headline: str, lines: Sequence[TreeLine]) -> None:
        """Show what runs, and the tree's lines."""
        ...

    def end(self, text: str) -> None:
        """The run is over, as the text says; from now on a person can close the view."""
        ...

    @property
    def dismissed(self) -> bool:
        """Whether a person has closed the view in the browser."""
        ...


class World(Protocol):
    """A place with a robot in it and a clock of its own."""

    @property
    def name(self) -> str:
        """The world's name."""
        ...

    @property
    def site(self) -> Site:
        """The site of this episode."""
        ...

    @property
    def robot(self) -> Robot:
        """The robot's driver."""
        ...

    def now(self) -> float:
        """Seconds since the episode began."""
        ...

    def step(self) -> None:
        """Advance by one TICK; in between, drivers run at the rate of the physics."""
        ...

    def verdict(self) -> Verdict | None:
        """The referee's verdict on the current state; None without a referee."""
        ...

    def open_video(self, path: Path, title: str) -> Video:
        """Start a film. It is written to a temporary file beside `path` and renamed at the end."""
        ...

    def open_view(self, port: int) -> View:
        """Serve the scene to a browser on this machine."""
        ...

    def close(self) -> None:
        """Free all resources. Calling it twice is safe."""
        ...


@runtime_checkable
class WorldTexts(Protocol):
    """A world that is described by files; the record of a run keeps their texts."""

    def texts(self) -> Mapping[str, str]:
        """The text of each file, by file name."""
        ...


@runtime_checkable
class MeasuredWorld(Protocol):
    """A world in which somebody can measure where the robot stands at first."""

    @property
    def start(self) -> Pose2D:
        """Where its base truly stands as the episode begins, in the frame of the site."""
        ...


@runtime_checkable
class AboutWorld(Protocol):
    """A world's entry that can describe more of the world than its site."""

    def about(self) -> Mapping[str, Mapping[str, str]]:
        """Sections (tags, goal, variation …), each with one line of text per subject."""
        ...


class WorldEntry(Protocol):
    """The object that an entry point of `momantu_bt.worlds` names. Importing it must be cheap.

    site: the nominal site, for the checker and `show`; reading it starts no simulator.
    open: builds the episode of a seed. It raises WorldError when it cannot.
    """

    @property
    def name(self) -> str:
        """The world's name, as trees and the command line write it."""
        ...

    @property
    def default_robot(self) -> str:
        """The robot to use when the user names none."""
        ...

    def site(self) -> Site:
        """The nominal site."""
        ...

    def open(self, description: RobotDescription, seed: int, *, referee: bool = True) -> World:
        """Build the world for one episode."""
        ...


@runtime_checkable
class MappedWorld(Protocol):
    """A world that knows its maps without being opened; `check` then looks where poses lie."""

    def site_for(self, description: RobotDescription) -> Site:
        """The nominal site with the maps of a robot; raises WorldError."""
        ...


class WorldError(MomantuError):
    """A world could not start; the message says why and what to do."""

    exit_code = ExitCode.NO_WORLD


def seeded(*parts: str | float) -> np.random.Generator:
    """A random generator that depends on `parts` alone; it is the same in every process.

    parts: the run's seed and what names its use, for example `seeded(seed, "laser", stamp)`.
    """
    digest = hashlib.blake2b("\x1f".join(repr(p) for p in parts).encode(), digest_size=16).digest()
    words: NDArray[np.uint32] = np.frombuffer(digest, dtype=np.uint32)
    return np.random.Generator(np.random.PCG64(words))
