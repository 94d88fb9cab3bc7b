"""Everything a tree gets from outside: steps of skills, published values, odometry, answers.

The rest of a run follows from the tree file, the clock and the blackboard. So a replay that has
recorded these things can repeat the run without a world.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, TypeAlias, TypeVar

from momantu_bt.engine.changes import SeenNode
from momantu_bt.engine.events import Events
from momantu_bt.engine.skills.body import Body
from momantu_bt.engine.skills.session import Session
from momantu_bt.engine.skills.start import Setup, SkillContext
from momantu_bt.engine.status import Status
from momantu_bt.failure import FailureValue
from momantu_bt.marker import Marker
from momantu_bt.skill import Clock, Host, Skill

T = TypeVar("T")

PERSON, POSITION, SPEED = "a person", "odometry's position", "odometry's speed"
POSE, TURNING, TRANSFORM = "the robot's pose", "odometry's speed and turn", "a transform"
"""Names of questions. Published values use their blackboard keys, which have no spaces."""


class SkillSession(Protocol):
    """One start of one skill; see `Session`, which is the real one."""

    phase: str
    failure: FailureValue | None
    took: float

    @property
    def outputs(self) -> dict[str, Any]:
        """Values of the output ports that have one."""
        ...

    def step(self, live_inputs: Mapping[str, Any] | None = None) -> Status:
        """Run to the skill's next `yield`, or to its end."""
        ...

    def halt(self) -> None:
        """Stop the skill at any point."""
        ...


Starter: TypeAlias = Callable[[Mapping[str, Any]], SkillSession]


class Surroundings(Protocol):
    """The part of a run that the start of a skill needs; see `RunContext`."""

    @property
    def clock(self) -> Clock:
        """The world's time."""
        ...

    @property
    def seed(self) -> int:
        """The run's seed."""
        ...

    @property
    def earlier(self) -> int:
        """How many trees a session has run before this one."""
        ...

    @property
    def body(self) -> Body | None:
        """The robot and its surroundings; None in a run without a world."""
        ...

    @property
    def events(self) -> Events:
        """The run's events."""
        ...

    @property
    def logs(self) -> list[Logged]:
        """What skills have logged in this tick."""
        ...


class SkillNode(SeenNode, Protocol):
    """A node that runs a skill. path: its position in the tree. runs: its starts so far."""

    kind: type[Skill]
    path: str
    runs: int

    @property
    def skill_name(self) -> str:
        """The skill's name in the tree file."""
        ...

    @property
    def context(self) -> Surroundings:
        """The run to which it belongs."""
        ...


class Logged(NamedTuple):
    """A skill has logged a line."""

    leaf: SkillNode
    text: str


class Drawn(NamedTuple):
    """A skill has drawn markers."""

    leaf: SkillNode
    markers: tuple[Marker, ...]


class LeafReporter(Host):
    """Passes on what the skill of a leaf logs and draws."""

    def __init__(self, leaf: SkillNode) -> None:
        self._leaf, self._events = leaf, leaf.context.events

    @property
    def watched(self) -> bool:
        """Whether somebody sees what the skill draws."""
        return self._events.has_subscribers(Drawn)

    def log(self, text: str) -> None:
        """Add each line to the journal of this tick."""
        lines = text.splitlines()
        self._leaf.context.logs.extend(Logged(self._leaf, line) for line in lines)

    def draw(self, markers: Sequence[Marker]) -> None:
        """Publish markers."""
        self._events.publish(Drawn(self._leaf, tuple(markers)))


class Outside:
    """The outside of a normal run: skills run on the robot, and a person answers questions."""

    def runs_skills(self, body: Body | None) -> bool:
        """Whether the run can start skills."""
        return body is not None

    def starter(self, leaf: SkillNode) -> Starter:
        """What starts a leaf's skill, again and again. It gets the inputs, by port."""
        context = leaf.context
        body = context.body
        assert body is not None
        surroundings = SkillContext(
            clock=context.clock,
            frames=body.frames,
            site=body.site,
            services=body.services,
            skills=body.skills,
            reporter=LeafReporter(leaf),
        )
        lease = body.actuators.lease(leaf.name, leaf.kind.uses)
        setup, seed, path = Setup(leaf.kind, lease, surroundings), context.seed, leaf.path
        earlier = (context.earlier,) if context.earlier else ()
        return lambda inputs: Session(setup, inputs, (seed, path, leaf.runs, *earlier))

    def ask(self, key: str, ask: Callable[[], T]) -> T:
        """Call `ask` and return its answer. key: the name of the question, such as `battery`."""
        return ask()


class SkillStepped(NamedTuple):
    """A leaf's skill has made a step. Its outputs are not on the blackboard yet."""

    leaf: SkillNode
    session: SkillSession
    status: Status


class SkillEnded(NamedTuple):
    """A leaf's skill has ended without being halted. Its outputs are not on the blackboard yet."""

    leaf: SkillNode
    session: SkillSession


class Answered(NamedTuple):
    """A question was answered. key: as in `Outside.ask`. answer: `Refused` for a failure."""

    key: str
    answer: Any


@dataclass(frozen=True, slots=True)
class Refused:
    """A question was answered with a failure."""

    failure: FailureValue
