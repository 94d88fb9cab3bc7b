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

import inspect
import sys
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, TypeAlias, TypeVar

import numpy as np

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim
from momantu_bt.failure import CODE, Failure, FailureValue
from momantu_bt.frames import FrameBuffer
from momantu_bt.marker import Marker
from momantu_bt.robot import Robot
from momantu_bt.symptom import Symptom
from momantu_bt.world import Site

__all__ = ["Clock", "Compute", "Failure", "In", "Needs", "Out", "Port", "Run", "Skill", "compute"]


class _Missing:
    def __repr__(self) -> str:
        return "MISSING"


MISSING: Any = _Missing()
"""The default of an input that a tree must give."""

NAMES = ("place", "surface", "named_pose", "category", "goal", "spot")
"""What a text input may name, so that the checker knows the valid values.

`goal` is a place, or a pose of the map written as text (see `Pose2D.from_text`), where the robot is
to stand; `spot` is the same, but the robot need not stand there.
It may also be an entry point group, such as `momantu_bt.detectors`; the input then names a plug-in
of that group.
"""


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


@dataclass(frozen=True, slots=True)
class Port:
    """One port as declared. type: the resolved annotation. names: see `NAMES`, or None.

    least, most: bounds of a number, in the port's unit. endless: -1 is valid too and means
    "without end". frame: "map" for a pose that must lie on the site's map, or None.
    may_be_empty, ignored: see `In`.
    """

    name: str
    direction: str
    type: Any
    doc: str
    default: Any = MISSING
    unit: str | None = None
    live: bool = False
    names: str | None = None
    least: float | None = None
    most: float | None = None
    endless: bool = False
    frame: str | None = None
    may_be_empty: bool = False
    ignored: bool = False

    @property
    def bounded(self) -> bool:
        """Whether a number may be too small or too large."""
        return self.least is not None or self.most is not None

    def allows(self, number: float) -> bool:
        """Whether a number is within the bounds."""
        if self.endless and number == -1:
            return True
        above = self.least is None or number >= self.least
        return above and (self.most is None or number <= self.most)

    @property
    def bounds(self) -> str:
        """The bounds in words: "at least 1, or -1 for no end"; empty without bounds."""
        words = [] if self.least is None else [f"at least {self.least:g}"]
        words += [] if self.most is None else [f"at most {self.most:g}"]
        return " and ".join(words) + (", or -1 for no end" if self.endless else "")

    @property
    def required(self) -> bool:
        """Whether a tree must give it."""
        return self.direction == "in" and self.default is MISSING


class _PortDescriptor:
    direction = ""

    def __init__(
        self,
        default: Any = MISSING,
        *,
        doc: str,
        unit: str | None = None,
        live: bool = False,
        names: str | None = None,
        least: float | None = None,
        most: float | None = None,
        frame: str | None = None,
        may_be_empty: bool = False,
        ignored: bool = False,
    ) -> None:
        if may_be_empty and default is MISSING:
            raise TypeError("may_be_empty=True needs a default, for a key without a value")
        if names is not None and names not in NAMES and "." not in names:
            valid = f"{', '.join(NAMES)}, or the name of an entry point group"
            raise TypeError(f"names={names!r}; valid: {valid}")
        if least is not None and most is not None and least > most:
            raise TypeError(f"least={least:g} is more than most={most:g}")
        self.default, self.doc, self.unit, self.live = default, doc, unit, live
        self.names, self.least, self.most, self.frame = names, least, most, frame
        self.may_be_empty, self.ignored = may_be_empty, ignored
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, instance: Any, owner: type) -> Any:
        if instance is None:
            return self
        value = instance.port_values.get(self.name, self.default)
        if value is MISSING:
            raise AttributeError(f"port {self.name!r} of {owner.__name__} has no value yet")
        return value

    def __set__(self, instance: Any, value: Any) -> None:
        instance.port_values[self.name] = value


class _InDescriptor(_PortDescriptor):
    direction = "in"


class _OutDescriptor(_PortDescriptor):
    direction = "out"


class _NeedsDescriptor:
    def __init__(self, service: str | None) -> None:
        self.service = service or ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.service = self.service or name

    def __get__(self, instance: Any, owner: type) -> Any:
        if instance is None:
            return self
        return instance.services[self.service]


def In(
    default: Any = MISSING,
    *,
    doc: str,
    unit: str | None = None,
    live: bool = False,
    names: str | None = None,
    least: float | None = None,
    most: float | None = None,
    frame: str | None = None,
    may_be_empty: bool = False,
    ignored: bool = False,
) -> Any:
    """Declare an input. Without a default it is required. live: read again on each tick.

    unit: SI unit that numbers in trees are converted to. names: see `NAMES`.
    least, most: bounds of a number, in `unit`; the checker rejects a tree that exceeds them.
    frame: "map" for a pose2d in the map where the robot is to stand; the checker rejects one
    outside the map, and one that the map shows to be occupied.
    may_be_empty: the key that the tree gives may have no value yet; the input then is its default.
    ignored: the skill does not read it; trees made for other systems may give it.
    """
    return _InDescriptor(
        default,
        doc=doc,
        unit=unit,
        live=live,
        names=names,
        least=least,
        most=most,
        frame=frame,
        may_be_empty=may_be_empty,
        ignored=ignored,
    )


def Out(*, doc: str, unit: str | None = None, live: bool = False) -> Any:
    """Declare an output. It is written on SUCCESS, or with `live` on each assignment.

    With `live`, what the skill has assigned is written also when it fails.
    """
    return _OutDescriptor(doc=doc, unit=unit, live=live)


def Needs(service: str | None = None) -> Any:
    """Declare that the skill needs a service. service: its name; by default the attribute's."""
    return _NeedsDescriptor(service)


class Skill:
    """What a robot can do. Subclass it, declare ports and codes, write `run`.

    failures: each code this skill raises, with a sentence that explains it.
    uses: the actuators it commands; CAMERA_CARRIER for the one that carries the camera.
    calls: the skills that it calls, by name or class. Their actuators must be in `uses`; the
    services that they need start with the run.
    one_of: groups of inputs with defaults; a tree gives exactly one input of each group.
    activities: what the skill does, for faults that start during such an activity. The value is a
    suffix to the skill's name that says when: "" as soon as the skill runs, "+2 s" two seconds
    later, "/closing" when it yields the phase "closing". None: derived from `uses` and outputs.
    symptoms: for each code, what is wrong in the world when the skill fails with it. Leave out
    codes that no fault explains. None: each code may be caused by any fault of the actuators,
    sensors and inputs that the skill uses.

    The engine makes a new instance for each start. Before it calls `run` it sets the inputs,
    `services`, `clock`, `random`, `frames`, `site` and `host`.
    """

    failures: ClassVar[Mapping[str, str]] = {}
    uses: ClassVar[frozenset[str] | set[str]] = frozenset()
    calls: ClassVar[Iterable[str | type[Skill]]] = ()
    one_of: ClassVar[tuple[tuple[str, ...], ...]] = ()
    activities: ClassVar[Mapping[Activity, str] | None] = None
    symptoms: ClassVar[Mapping[str, frozenset[Symptom] | set[Symptom]] | None] = None

    ports: ClassVar[Mapping[str, Port]] = {}
    needs: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        cls.ports = {**cls.ports, **_declared_ports(cls)}
        mine = [v.service for v in vars(cls).values() if isinstance(v, _NeedsDescriptor)]
        cls.needs = tuple(dict.fromkeys((*cls.needs, *mine)))
        cls.calls = _checked_calls(cls)
        wrong = [code for code in cls.failures if not CODE.fullmatch(code)]
        if wrong:
            raise TypeError(f"{cls.__name__}.failures: {', '.join(wrong)}: not UPPER_CASE words")
        optional = [p.name for p in cls.ports.values() if p.direction == "in" and not p.required]
        wrong = [name for group in cls.one_of for name in group if name not in optional]
        if wrong:
            raise TypeError(f"{cls.__name__}.one_of: {', '.join(wrong)}: no input with a default")

    def __init__(self) -> None:
        self.port_values: dict[str, Any] = {}
        self.services: Mapping[str, Any] = {}
        self.clock: Clock
        self.random: np.random.Generator
        self.frames: FrameBuffer
        self.site: Site
        self.host = Host()

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


def _declared_ports(cls: type) -> dict[str, Port]:
    scope = vars(sys.modules[cls.__module__])
    annotations = inspect.get_annotations(cls)
    ports: dict[str, Port] = {}
    for name, value in vars(cls).items():
        if not isinstance(value, _PortDescriptor):
            continue
        if name not in annotations:
            raise TypeError(f"port {cls.__name__}.{name} has no type; write `{name}: text = …`")
        annotation = annotations[name]
        if isinstance(annotation, str):
            try:
                annotation = eval(annotation, dict(scope))
            except NameError as error:
                raise TypeError(
                    f"port {cls.__name__}.{name}: {error}; its type must be imported at run time"
                ) from None
        port = Port(
            name,
            value.direction,
            annotation,
            value.doc,
            value.default,
            value.unit,
            value.live,
            value.names,
            value.least,
            value.most,
            frame=value.frame,
            may_be_empty=value.may_be_empty,
            ignored=value.ignored,
        )
        if isinstance(port.default, int | float) and not port.allows(port.default):
            raise TypeError(f"port {cls.__name__}.{name}: the default is not {port.bounds}")
        ports[name] = port
    return ports
