"""Sites, worlds and verdicts: what the robot is told, where it acts, and who judges."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from momantu_bt.errors import ExitCode, MomantuError
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import ObjectClass

if TYPE_CHECKING:
    from momantu_bt.robot import Robot, RobotDescription

TICK = 0.05
"""Seconds of the world's clock between two ticks of the tree."""


@dataclass(frozen=True, slots=True)
class Overhang:
    """A solid that hangs over a surface, such as the next board of a shelf.

    map_from_overhang: its middle on the floor plan. size: (x, y) extent, m. bottom, top: heights
    above the floor between which it lies, m.
    """

    map_from_overhang: Pose2D
    size: tuple[float, float]
    bottom: float
    top: float


@dataclass(frozen=True, slots=True)
class Surface:
    """A named table or shelf, as a person would describe it.

    map_from_surface: centre of its top on the floor plan. size: (x, y) extent of the top, m.
    height: of the top above the floor, m. sides: the directions, as angles in the surface's own
    frame (rad), from which it can be approached; the first is preferred. over: what hangs over it
    and is not a surface itself.
    """

    map_from_surface: Pose2D
    size: tuple[float, float]
    height: float
    sides: tuple[float, ...]
    over: tuple[Overhang, ...] = ()


@dataclass(frozen=True, slots=True)
class Site:
    """Everything that the robot is told about its surroundings.

    map_file: map_server's YAML of the floor plan; overhang_file: the same format, for known
    furniture that the laser's plane does not meet. start: the rough pose in the map where the
    robot stands at first, within start_sigma (m, rad).
    services: tunables of services and skills, by name.
    """

    name: str
    map_file: Path | None = None
    overhang_file: Path | None = None
    start: Pose2D = field(default_factory=lambda: Pose2D(0.0, 0.0, 0.0))
    start_sigma: tuple[float, float] = (0.15, 0.13)
    places: Mapping[str, Pose2D] = field(default_factory=lambda: MappingProxyType({}))
    surfaces: Mapping[str, Surface] = field(default_factory=lambda: MappingProxyType({}))
    objects: Mapping[str, ObjectClass] = field(default_factory=lambda: MappingProxyType({}))
    services: Mapping[str, Mapping[str, Any]] = field(default_factory=lambda: MappingProxyType({}))

    def known_places(self) -> tuple[str, ...]:
        """Names of places and surfaces."""
        return (*self.places, *self.surfaces)


@dataclass(frozen=True, slots=True)
class Incident:
    """Something dangerous that the robot did, by ground truth.

    time: s. kind: "force" (it pushed too hard), "dropped" (it let go above a surface) or "moving"
    (it still moves although the run is over). value: N, m, or m/s and rad/s.
    """

    time: float
    kind: str
    sentence: str
    value: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """The referee's word, from ground truth.

    success: every demand is met. unmet: one sentence per demand that is not.
    measures: numbers behind it (tilt in rad, distances in m, forces in N).
    incidents: what was dangerous, in the order of time, whether or not it was demanded.
    """

    success: bool
    unmet: tuple[str, ...] = ()
    measures: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    incidents: tuple[Incident, ...] = ()


@dataclass(frozen=True, slots=True)
class TreeLine:
    """One line of the tree as a display shows it: indentation depth, text, status name."""

    depth: int
    text: str
    status: str


class Video(Protocol):
    """A film of the run: third-person view, head camera and the tree's state in one picture."""

    def add(self, lines: Sequence[TreeLine], headline: str) -> None:
        """Take one frame of now."""
        ...

    def close(self) -> None:
        """Finish the file; safe to call twice."""
        ...


class View(Protocol):
    """A live 3D view in a browser."""

    @property
    def url(self) -> str:
        """The address to open in a browser."""
        ...

    def update(self) -> None:
        """Show the current world."""
        ...

    def close(self) -> None:
        """Stop serving; safe to call twice."""
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
        """Advance by one TICK; drivers act at the physics rate in between."""
        ...

    def verdict(self) -> Verdict | None:
        """The referee's verdict on this moment; None without a referee."""
        ...

    def open_video(self, path: Path, title: str) -> Video:
        """Start a film; the file is written next to its final name and renamed at the end."""
        ...

    def open_view(self, port: int) -> View:
        """Serve the scene to a browser on this machine."""
        ...

    def close(self) -> None:
        """Free everything; safe to call twice."""
        ...


@runtime_checkable
class WorldTexts(Protocol):
    """A world that is described by files, which a record of a run keeps."""

    def texts(self) -> Mapping[str, str]:
        """The files' texts by their names."""
        ...


@runtime_checkable
class AboutWorld(Protocol):
    """An entry of a world that can say more of itself than its site does."""

    def about(self) -> Mapping[str, Mapping[str, str]]:
        """Sections (tags, goal, variation …), each with a line of text per subject."""
        ...


class WorldEntry(Protocol):
    """The object that an entry point of `momantu_bt.worlds` names; light to import.

    site: the nominal site, read without a simulator, for the checker and `show`.
    open: build the episode of a seed. Raises WorldError when it cannot.
    """

    @property
    def name(self) -> str:
        """The world's name, as trees and the command line write it."""
        ...

    @property
    def default_robot(self) -> str:
        """The robot to use when no other is named."""
        ...

    def site(self) -> Site:
        """The nominal site."""
        ...

    def open(self, description: RobotDescription, seed: int, *, referee: bool = True) -> World:
        """Build the world for one episode."""
        ...


class WorldError(MomantuError):
    """A world could not start; the message says why and what to do."""

    exit_code = ExitCode.NO_WORLD


def seeded(*parts: str | float) -> np.random.Generator:
    """A random generator that depends on its parts alone, the same in every process.

    Parts are the run's seed and whatever names the use: `seeded(seed, "laser", stamp)`.
    """
    digest = hashlib.blake2b("\x1f".join(repr(p) for p in parts).encode(), digest_size=16).digest()
    words: NDArray[np.uint32] = np.frombuffer(digest, dtype=np.uint32)
    return np.random.Generator(np.random.PCG64(words.tolist()))
