"""Trees whose leaves start anew in each tick: skills, and built-in leaves with the same ports."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from py_trees.behaviour import Behaviour
from py_trees.common import ParallelPolicy, Status
from py_trees.composites import Composite, Parallel, Selector, Sequence

from momantu_bt.engine.build import Built, build
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.engine.skills.body import Body
from momantu_bt.failure import Failure
from momantu_bt.frames import FrameBuffer
from momantu_bt.robot import Robot
from momantu_bt.skill import In, Out, Run, Skill
from momantu_bt.testing import ManualClock, ScriptedWorld
from momantu_bt.tree.model import Document, Literal, Node, PortValue, Reference, Tree
from ticking.measuring import Tick
from ticking.shapes import GROUP, HERE, Bare, groups_of, node, plain_tick, recorded_tick

NODES = 100
SECOND = 1.0
"""What a leaf of two ticks waits, s."""


class End(Skill):
    """Ends at once."""

    def run(self, robot: Robot) -> Run:
        """Return."""
        return
        yield ""


class Scale(Skill):
    """Gives its input, scaled."""

    value: float = In(unit="m", least=0.0, most=10.0, doc="what to scale")
    factor: float = In(1.0, least=0.0, doc="by how much")
    result: float = Out(unit="m", doc="the scaled value")

    def run(self, robot: Robot) -> Run:
        """Multiply."""
        self.result = self.value * self.factor
        return
        yield ""


class Refuse(Skill):
    """Fails at once."""

    message: str = In(doc="why")
    failures = {"NO_WAY": "the way is closed"}

    def run(self, robot: Robot) -> Run:
        """Raise."""
        raise Failure("NO_WAY", self.message)
        yield ""


class Pause(Skill):
    """Ends in its second tick."""

    duration: float = In(unit="s", least=0.0, doc="how long it takes")

    def run(self, robot: Robot) -> Run:
        """Yield once."""
        yield "waits"


class BarePause(Behaviour):
    """A plain leaf that ends in its second tick."""

    def initialise(self) -> None:
        """Begin to count."""
        self.left = 2

    def update(self) -> Status:
        """RUNNING, then SUCCESS."""
        self.left -= 1
        return Status.RUNNING if self.left else Status.SUCCESS


@dataclass(frozen=True, slots=True)
class Case:
    """One row. bare, leaf, skill: the leaf on each side. ticks: from its start to its end."""

    title: str
    group: str
    bare: Callable[[str], Behaviour]
    leaf: tuple[str, Mapping[str, PortValue]]
    skill: tuple[str, Mapping[str, PortValue]]
    ticks: int = 1


A, B = Reference("a"), Reference("b")
FAILS = {"message": Literal("closed")}
WAITS = {"duration": Literal("1 s")}
CASES = (
    Case("ends", "Sequence", lambda n: Bare(n, Status.SUCCESS), ("AlwaysSuccess", {}), ("End", {})),
    Case(
        "ports",
        "Sequence",
        lambda n: Bare(n, Status.SUCCESS),
        ("SetBlackboard", {"key": B, "value": A}),
        ("Scale", {"value": A, "factor": Literal("2"), "result": B}),
    ),
    Case(
        "fails",
        "Fallback",
        lambda n: Bare(n, Status.FAILURE),
        ("Fail", {"code": Literal("NO_WAY"), **FAILS}),
        ("Refuse", FAILS),
    ),
    Case("two ticks", "ParallelAll", BarePause, ("Sleep", WAITS), ("Pause", WAITS), ticks=2),
)
SKILLS = {kind.__name__: kind for kind in (End, Scale, Refuse, Pause)}


LEAVES = groups_of(NODES) * GROUP
"""How many leaves of the kind that is measured a tree has."""


def sides(case: Case, folder: Path) -> dict[str, Tick]:
    """What ticks each tree from the starts of all its leaves to their ends."""
    leaf, skill = document_of(case, *case.leaf), document_of(case, *case.skill)
    plain = {"leaf": ours(leaf), "skill": ours(skill)}
    recorded = ours(skill)
    return {
        "bare": through(case, bare(case).tick_once, ManualClock()),
        **{
            side: through(case, plain_tick(built), clock_of(built)) for side, built in plain.items()
        },
        "recorded": through(case, recorded_tick(skill, recorded, folder), clock_of(recorded)),
    }


def through(case: Case, tick: Tick, clock: ManualClock) -> Tick:
    """All the ticks that its leaves take."""
    if case.ticks == 1:
        return tick

    def ticks() -> None:
        for _ in range(case.ticks):
            tick()
            clock.advance(SECOND)

    return ticks


def clock_of(built: Built) -> ManualClock:
    clock = built.root.context.clock
    assert isinstance(clock, ManualClock)
    return clock


def bare(case: Case) -> Composite:
    """The tree of py_trees."""
    groups = []
    for number in range(groups_of(NODES)):
        made = composite(case.group, f"g{number}")
        made.add_children([case.bare(f"l{number}_{i}") for i in range(GROUP)])
        if case.group == "Fallback":
            made.add_child(Bare(f"l{number}_last", Status.SUCCESS))
        groups.append(made)
    root = composite("Sequence" if case.group == "Fallback" else case.group, "root")
    root.add_children(groups)
    return root


def composite(group: str, name: str) -> Composite:
    if group == "ParallelAll":
        return Parallel(name, ParallelPolicy.SuccessOnAll(synchronise=False))
    return (Selector if group == "Fallback" else Sequence)(name, memory=True)


def document_of(case: Case, type_: str, ports: Mapping[str, PortValue]) -> Document:
    """Our tree with leaves of one type."""
    ending = (node("AlwaysSuccess"),) if case.group == "Fallback" else ()
    groups: list[Node] = []
    for _ in range(groups_of(NODES)):
        leaves = tuple(node(type_, dict(ports)) for _ in range(GROUP))
        groups.append(node(case.group, children=leaves + ending))
    root = node("Sequence" if case.group == "Fallback" else case.group, children=tuple(groups))
    return Document("starts.yaml", "Main", {"Main": Tree("Main", root, HERE)})


def ours(document: Document) -> Built:
    """It in our engine, with a robot."""
    world = ScriptedWorld()
    context = RunContext(ManualClock())
    frames = FrameBuffer(world.robot.description.kinematics())
    context.body = Body(Actuators(world.robot, context.events), frames, world.site, {})
    built = build(document, context, SKILLS.__getitem__)
    built.board.set("a", 1.5)
    return built
