"""Skills: typed ports and one generator.

class Nod(Skill):
    \"\"\"Tilt the camera down and up again.\"\"\"

    angle: float = In(0.3, unit="rad", doc="how far")
    failures = {"NO_HEAD": "the camera does not tilt"}
    uses = {CAMERA_CARRIER}

    def run(self, robot: Robot) -> Run:
        ...
        yield "down"
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar, Protocol, TypeAlias, TypeVar

import numpy as np

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim
from momantu_bt.failure import CODE, Failure, FailureValue
from momantu_bt.frames import FrameBuffer
from momantu_bt.marker import Marker
from momantu_bt.port import MISSING, In, Needs, NeedsDescriptor, Out, Port, declared_ports
from momantu_bt.robot import Robot
from momantu_bt.symptom import Symptom
from momantu_bt.world import Site

__all__ = [
    "MISSING",
    "Clock",
    "Compute",
    "Failure",
    "In",
    "Needs",
    "Out",
    "Port",
    "Run",
    "Skill",
    "compute",
]


class Clock(Protocol):
    """The world's clock."""

    def now(self) -> float:
        """Seconds since the run began."""
        ...


@dataclass(frozen=True, slots=True)
class Compute:
    """A function call that takes `budget` seconds of the run's clock."""

    function: Callable[[], Any]
    budget: float


Run: TypeAlias = Generator[str | Compute, Any, None]
"""What `Skill.run` returns: `yield "phase"` ends the tick, RUNNING."""

T = TypeVar("T")


def compute(function: Callable[[], T], budget: float) -> Generator[Compute, Any, T]:
    """Do work that takes time.

    Write `plan = yield from compute(lambda: search(...), budget=0.2)`.
    In a lock-step run the function is called at once. The clock then advances by `budget` seconds,
    so that computation costs time in simulation too. An exception of the function is raised here.
    """
    result: T = yield Compute(function, budget)
    return result


class Host:
    """What the engine does for a running skill besides the robot. This one does nothing."""

    @property
    def watched(self) -> bool:
        """Whether somebody sees what the skill draws."""
        return False

    def random(self) -> np.random.Generator:
        """The random numbers of the skill; see `Skill.random`."""
        raise AttributeError("a skill that the engine does not run has no random numbers")

    def log(self, text: str) -> None:
        """Show a line to whoever watches the run."""

    def draw(self, markers: Sequence[Marker]) -> None:
        """Show markers to whoever watches the run."""

    def call(
        self, skill: str | type[Skill], inputs: Mapping[str, Any]
    ) -> Generator[str | Compute, Any, Mapping[str, Any]]:
        """Run another skill to its end; see `Skill.call`."""
        raise RuntimeError(f"{skill!r} is called by a skill that the engine does not run")
        yield ""


class Skill:
    """What a robot can do. Subclass it, declare ports and codes, write `run`.

    failures: each code this skill raises, with a sentence that explains it.
    uses: the actuators it commands; CAMERA_CARRIER for the one that carries the camera.
    senses: kinds of sensors that the robot must have, such as `camera`; without one of them the
    tree is refused.
    calls: the skills that it calls, by name or class. Their actuators must be in `uses`; the
    services that they need start with the run.
    one_of: groups of inputs with defaults; a tree gives exactly one input of each group.
    activities: what the skill does, for faults that start during such an activity. The value is a
    suffix to the skill's name that says when: "" as soon as the skill runs, "+2 s" two seconds
    later, "/closing" when it yields the phase "closing". None: derived from `uses` and outputs.
    symptoms: for each code, what is wrong in the world when the skill fails with it. Leave out
    codes that no fault explains. None: each code may be caused by any fault of the actuators,
    sensors and inputs that the skill uses.

    also_called: what people call it, such as `grab`; `check` then asks "did you mean pick?".

    The engine makes a new instance for each start. Before it calls `run` it sets the inputs,
    `services`, `clock`, `frames`, `site` and `host`.
    """

    failures: ClassVar[Mapping[str, str]] = {}
    uses: ClassVar[frozenset[str] | set[str]] = frozenset()
    senses: ClassVar[frozenset[str] | set[str]] = frozenset()
    calls: ClassVar[Iterable[str | type[Skill]]] = ()
    one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()
    activities: ClassVar[Mapping[Activity, str] | None] = None
    symptoms: ClassVar[Mapping[str, frozenset[Symptom] | set[Symptom]] | None] = None
    also_called: ClassVar[tuple[str, ...]] = ()

    ports: ClassVar[Mapping[str, Port]] = {}
    needs: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        cls.ports = {**cls.ports, **declared_ports(cls)}
        mine = [v.service for v in vars(cls).values() if isinstance(v, NeedsDescriptor)]
        cls.needs = tuple(dict.fromkeys((*cls.needs, *mine)))
        cls.calls = _checked_calls(cls)
        wrong = [code for code in cls.failures if not CODE.fullmatch(code)]
        if wrong:
            raise TypeError(f"{cls.__name__}.failures: {', '.join(wrong)}: not UPPER_CASE words")
        optional = [p.name for p in cls.ports.values() if p.direction == "in" and not p.required]
        wrong = [name for group in cls.one_of for name in group if name not in optional]
        if wrong:
            raise TypeError(f"{cls.__name__}.one_of: {', '.join(wrong)}: no input with a default")

    clock: Clock
    frames: FrameBuffer
    site: Site
    services: Mapping[str, Any] = MappingProxyType({})
    host: Host = Host()

    def __init__(self) -> None:
        self.port_values: dict[str, Any] = {}

    @cached_property
    def random(self) -> np.random.Generator:
        """Random numbers that depend on the run's seed, the node and the number of its start."""
        return self.host.random()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Arguments of `momantu_bt.testing.run_skill` with which `momantu-bt skills test` runs it.

        Each call returns new objects. Inputs that are left out get values made from their types.
        """
        return {}

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """What the skill's result says about the world, for the referee; None: nothing to check.

        Called once after the skill has ended, only in worlds with a referee. It must not read
        sensors or command actuators. failure: None after SUCCESS: return what should now be true.
        After a failure: return what would make it a false alarm, for example "an object is held"
        after the failure "nothing is held".
        """
        return None

    def call(
        self, skill: str | type[Skill], /, **inputs: Any
    ) -> Generator[str | Compute, Any, Mapping[str, Any]]:
        """Run another skill to its end, and return its outputs by port.

        Write `way = (yield from self.call("dock", at="desk"))["way"]`.
        skill: one of `calls`. inputs: by port, as a tree gives them. Each of its ticks is a tick of
        this skill, and its phase is shown as `dock/turning`. At its end its actuators
        stop; they stay this skill's own. A halt of this skill halts it too.

        Raises:
            Failure: the called skill's own failure. If it is not caught and its code is in
                `failures`, this skill fails with that code; otherwise with CALL_FAILED. In both
                cases the called skill's failure is the cause.
        """
        return (yield from self.host.call(skill, inputs))

    def log(self, text: str) -> None:
        """Show a line in the terminal, the record and the page; it never influences the run."""
        self.host.log(text)

    def draw(self, *markers: Marker) -> None:
        """Show markers in the record, the page's map and 3D viewers; see `momantu_bt.marker`.

        It costs next to nothing when nobody watches. Where the markers themselves are expensive,
        ask `self.host.watched` first.
        """
        self.host.draw(markers)

    def run(self, robot: Robot) -> Run:
        """The skill's work: `yield "phase"` is RUNNING, return SUCCESS, raise Failure FAILURE."""
        raise NotImplementedError(f"{type(self).__name__} has no run(self, robot)")
        yield ""


def _checked_calls(cls: type[Skill]) -> tuple[str | type[Skill], ...]:
    """Its `calls` in an order that is the same in every process."""
    calls = cls.calls
    given = [] if isinstance(calls, str) else list(calls)
    wrong = isinstance(calls, str) or not all(
        isinstance(each, str) or (isinstance(each, type) and issubclass(each, Skill))
        for each in given
    )
    if wrong:
        raise TypeError(
            f"{cls.__name__}.calls is {calls!r}; expected skills by name or class, such as "
            '("dock",)'
        )
    if isinstance(calls, set | frozenset):
        given.sort(key=lambda each: each if isinstance(each, str) else each.__name__)
    return tuple(given)
