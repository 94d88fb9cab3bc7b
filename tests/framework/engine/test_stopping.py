"""However a run or a skill ends: nothing is owned, nothing moves, every generator is closed."""

from __future__ import annotations

import itertools
import os
import signal
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.engine.skills.session import Session
from momantu_bt.engine.skills.start import Setup, SkillContext
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS
from momantu_bt.failure import Failure
from momantu_bt.frames import FrameBuffer
from momantu_bt.messages import BaseVelocity, GripperCommand, JointPositions
from momantu_bt.skill import In, Out, Run, Skill, compute
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, run_skill
from momantu_bt.world import TICK, Verdict

GOALS = {
    "base": BaseVelocity(0.3, 0.0),
    "head": JointPositions(("pan",), (0.5,)),
    "arm": JointPositions(("lift",), (0.1,)),
    "gripper": GripperCommand(0.02, 20.0),
}
CLOSED: list[str] = []


@pytest.fixture(autouse=True)
def _forget():
    CLOSED.clear()


class Move(Skill):
    """Moves base and head until it is told to end."""

    ticks: int = In(10_000, doc="how long")
    uses = {"base", "head"}

    def run(self, robot) -> Run:
        try:
            for _ in range(self.ticks):
                robot.command("base", GOALS["base"])
                robot.command("head", GOALS["head"])
                yield "moving"
        finally:
            CLOSED.append("move")


class Reach(Skill):
    """Moves the arm and the base, for which it may have to wait."""

    patient: bool = In(False, doc="waits while the base is another's")
    uses = {"arm", "base"}

    def run(self, robot) -> Run:
        try:
            robot.command("arm", GOALS["arm"])
            while self.patient:
                try:
                    robot.command("base", GOALS["base"])
                    break
                except Failure as busy:
                    yield f"waiting for {busy.value.data['owner']}"
            robot.command("base", GOALS["base"])
            yield "reaching"
        finally:
            CLOSED.append("reach")


class Bang(Skill):
    """Raises after a while."""

    def run(self, robot) -> Run:
        yield "lit"
        yield "burning"
        raise RuntimeError("bang")


def still(world):
    """Whether the last thing each actuator was told is to stop, and it has stopped."""
    last = {actuator: goal for _, actuator, goal in world.robot.commands}
    return set(last.values()) == {None} and world.robot.linear == 0.0


def interrupting(robot):
    if abs(robot.now() - 0.5) < TICK / 2:
        os.kill(os.getpid(), signal.SIGINT)


def exploding(robot):
    if robot.now() > 0.5:
        raise OSError("gone")


class BadObserver:
    """Breaks in the middle of the run."""

    def ticked(self, run):
        if run.context.now > 0.5:
            raise OSError("disk full")

    def close(self):
        pass


ENDINGS = {
    "success": ("{move: {ticks: 5}}", {}, {}, "SUCCESS"),
    "failure": ("{parallel: [move, bang]}", {}, {}, "FAILURE"),
    "timeout": ("{move: {}, timeout: 0.5 s}", {}, {}, "FAILURE"),
    "too long": ("move", {}, {"max_time": 0.5}, "FAILURE"),
    "interrupt": ("move", {"on_step": interrupting}, {}, "INTERRUPTED"),
    "world": ("move", {"on_step": exploding}, {}, "ERROR"),
    "observer": ("move", {}, {"watch": lambda run: [BadObserver()]}, "ERROR"),
}


@pytest.mark.parametrize("name", ENDINGS)
def test_every_way_of_ending_stops_what_was_moving(run_yaml, name):
    tree, scripted, options, status = ENDINGS[name]
    world = ScriptedWorld(**scripted)
    report = run_yaml(f"trees: {{Main: [{tree}]}}", Move, Bang, world=world, **options)
    assert report.status == status
    assert CLOSED == ["move"]
    last = {actuator: goal for _, actuator, goal in world.robot.commands}
    assert last == dict.fromkeys(world.robot.description.actuators)
    if name != "world":
        assert still(world)


def test_a_guard_that_fails_stops_the_work_in_the_same_tick(run_yaml):
    text = """
values: {n: 0}
trees:
  Main:
    fallback:
      - reactive_sequence:
        - script: $n += 1
        - condition: $n < 4
        - move
      - wait: 1 s
"""
    world = ScriptedWorld()
    run_yaml(text, Move, world=world)
    told = [
        (round(time / TICK), goal) for time, name, goal in world.robot.commands if name == "base"
    ]
    assert told[:4] == [(1, GOALS["base"]), (2, GOALS["base"]), (3, GOALS["base"]), (4, None)]


def session(kind, world, book, name, **inputs):
    context = SkillContext(
        clock=world,
        frames=FrameBuffer(world.robot.description.kinematics()),
        site=world.site,
        services={},
    )
    setup = Setup(kind, book.lease(name, kind.uses), context)
    return Session(setup, inputs, (0, name))


def test_a_busy_actuator_fails_the_second_skill_and_names_the_first():
    world = ScriptedWorld()
    book = Actuators(world.robot)
    driver, reach = (session(Move, world, book, "driver"), session(Reach, world, book, "reach"))
    assert driver.step() is RUNNING
    assert reach.step() is FAILURE
    assert reach.failure.code == "ACTUATOR_BUSY"
    assert dict(reach.failure.data) == {"actuator": "base", "owner": "driver"}
    assert CLOSED == ["reach"]
    assert book.owner("arm") is None
    assert book.owner("base") == "driver"


def test_who_waits_for_an_actuator_gets_it_as_soon_as_the_owner_ends():
    world = ScriptedWorld()
    book = Actuators(world.robot)
    driver = session(Move, world, book, "driver", ticks=2)
    reach = session(Reach, world, book, "reach", patient=True)
    phases = []
    for _ in range(4):
        if driver.status is not SUCCESS:
            driver.step()
        reach.step()
        phases.append(reach.phase)
        world.step()
    assert phases == ["waiting for driver", "waiting for driver", "reaching", "reaching"]
    base = [goal for _, name, goal in world.robot.commands if name == "base"]
    assert base == [GOALS["base"], GOALS["base"], None, GOALS["base"], GOALS["base"], None]


class Stubborn(ScriptedRobot):
    """Some actuators of it cannot be stopped."""

    broken: tuple[str, ...] = ()

    def stop(self, actuator):
        if actuator in self.broken:
            raise OSError(f"{actuator} does not answer")
        super().stop(actuator)


@pytest.mark.parametrize("broken", [("base",), ("head",), ("base", "head"), ("arm", "gripper")])
def test_a_driver_that_cannot_stop_one_actuator_still_stops_the_others(run_yaml, broken):
    robot = Stubborn()
    robot.broken = broken
    world = ScriptedWorld(robot)
    report = run_yaml("trees: {Main: {move: {ticks: 3}}}", Move, world=world)
    assert report.status == "ERROR"
    assert "does not answer" in report.error
    assert CLOSED == ["move"]
    stopped = {actuator for _, actuator, goal in robot.commands if goal is None}
    assert stopped == set(robot.description.actuators) - set(broken)


def test_a_driver_that_breaks_while_the_tree_is_halted_leaves_no_skill_open(run_yaml):
    robot = Stubborn()
    robot.broken = ("base", "head", "arm")
    text = "trees: {Main: {parallel: [move, {hold: {}}]}}"

    class Hold(Skill):
        """Holds the arm."""

        uses = {"arm"}

        def run(self, robot) -> Run:
            try:
                while True:
                    robot.command("arm", GOALS["arm"])
                    yield "holding"
            finally:
                CLOSED.append("hold")

    report = run_yaml(text, Move, Hold, world=ScriptedWorld(robot), max_time=0.5)
    assert report.status == "ERROR"
    assert sorted(CLOSED) == ["hold", "move"]
    assert all(node.seconds > 0.0 for node in report.nodes)
    assert ("gripper", None) in [(name, goal) for _, name, goal in robot.commands]


class BadEnd:
    """An observer that cannot be closed, such as a film on a full disk."""

    def ticked(self, run):
        pass

    def close(self):
        raise OSError("no space left")


def test_an_observer_that_cannot_be_closed_does_not_cost_the_report(run_yaml):
    closed = []

    class Good:
        def ticked(self, run):
            pass

        def close(self):
            closed.append(True)

    world = ScriptedWorld(verdict_of=lambda robot: Verdict(True))
    report = run_yaml(
        "trees: {Main: [{move: {ticks: 3}}]}",
        Move,
        world=world,
        watch=lambda run: [BadEnd(), Good()],
    )
    assert (report.status, report.exit_code) == ("ERROR", 4)
    assert "no space left" in report.error
    assert report.ticks == 4
    assert closed == [True]


def test_a_referee_that_breaks_is_an_error_of_the_run(run_yaml):
    def judge(robot):
        raise ZeroDivisionError("no ground truth")

    report = run_yaml("trees: {Main: [succeed]}", world=ScriptedWorld(verdict_of=judge))
    assert (report.status, report.success) == ("ERROR", None)
    assert "no ground truth" in report.error


class Untidy(Skill):
    """Ends badly in `finally`, whatever ended it."""

    ending: str = In("phase", doc="phase, crash, fail, odd or live")
    live: int = In(0, doc="a live input", live=True)
    failures = {"NO": "no"}
    uses = {"base"}

    def run(self, robot) -> Run:
        try:
            robot.command("base", GOALS["base"])
            yield "moving"
            if self.ending == "crash":
                raise KeyError("crash")
            if self.ending == "fail":
                raise Failure("NO", "no")
            if self.ending == "odd":
                yield 3
            yield "still moving"
        finally:
            CLOSED.append("untidy")
            raise RuntimeError("cleanup broke")


@pytest.mark.parametrize("ending", ["phase", "crash", "fail", "odd"])
def test_a_cleanup_that_raises_fails_its_own_leaf_and_nothing_else(run_yaml, ending):
    text = f"trees: {{Main: {{fallback: [{{untidy: {{ending: {ending}}}}}, {{wait: 0.2 s}}]}}}}"
    world = ScriptedWorld()
    report = run_yaml(text, Untidy, world=world)
    assert report.status == "SUCCESS"
    untidy = next(node for node in report.nodes if node.type == "untidy")
    assert untidy.failures == 1
    assert CLOSED == ["untidy"]
    assert still(world)


def test_what_broke_the_skill_is_the_cause_of_what_broke_its_cleanup():
    failure = run_skill(Untidy, inputs={"ending": "odd"}).failure
    assert [link.code for link in failure.chain()] == ["SKILL_ERROR", "SKILL_ERROR"]
    assert "cleanup broke" in failure.message
    assert "yielded 3" in failure.cause.message


def test_a_live_input_that_loses_its_type_ends_the_skill(run_yaml):
    text = """
values: {count: 1}
trees:
  Main:
    parallel:
      children:
        - untidy: {ending: live, live: $count}
        - sequence: [wait: 0.05 s, script: '$count := "two"', wait: 1 s]
"""
    world = ScriptedWorld()
    report = run_yaml(text, Untidy, world=world)
    assert report.status == "FAILURE"
    assert "WRONG_TYPE" in [link.code for link in report.failure.chain()]
    assert CLOSED == ["untidy"]
    assert still(world)


class Exhausted(Skill):
    """Raises StopIteration before it has begun, as a bare next() does."""

    where: str = In("run", doc="init or run")

    def __init__(self):
        super().__init__()
        CLOSED.append("made")

    def run(self, robot):
        next(iter(()))


class Empty(Skill):
    """Does so while it is made."""

    def __init__(self):
        super().__init__()
        next(iter(()))

    def run(self, robot) -> Run:
        yield "never"


@pytest.mark.parametrize("skill", [Exhausted, Empty])
def test_a_skill_that_never_began_has_not_succeeded(skill):
    result = run_skill(skill)
    assert (result.status, result.code) == ("FAILURE", "SKILL_ERROR")
    assert "StopIteration" in result.failure.message


class Ponder(Skill):
    """Thinks while it owns the base."""

    thought: int = Out(doc="what came of it")
    uses = {"base"}

    def run(self, robot) -> Run:
        robot.command("base", GOALS["base"])
        self.thought = yield from compute(lambda: 3, 1.0)
        robot.stop("base")
        yield "done"


@given(at=st.integers(1, 25))
def test_thinking_can_be_halted_in_any_tick(at):
    count = itertools.count(1)

    def halt(session, world):
        if next(count) == at:
            session.halt()

    result = run_skill(Ponder, on_tick=halt)
    assert result.ticks == min(at, 22)
    assert (result.status == "SUCCESS") == (at >= 22)
    assert [goal for _, _, goal in result.robot.commands][-1] is None


ACTIONS = st.lists(
    st.tuples(
        st.integers(0, 2),
        st.sampled_from(["command", "stop", "end"]),
        st.sampled_from(["base", "arm", "gripper"]),
    ),
    max_size=25,
)


def tell(lease, action, actuator):
    if action == "command":
        lease.command(actuator, GOALS[actuator])
    else:
        lease.stop(actuator)


@given(actions=ACTIONS)
def test_the_book_of_owners_agrees_with_a_plain_model_of_it(actions):
    book = Actuators(ScriptedRobot())
    leases = [book.lease(f"skill {i}", {"base", "arm", "gripper"}) for i in range(3)]
    owners: dict[str, int] = {}
    for who, action, actuator in actions:
        told = len(book.robot.commands)
        if action == "end":
            owned = [name for name, owner in owners.items() if owner == who]
            leases[who].end()
            stopped = [(name, goal) for _, name, goal in book.robot.commands[told:]]
            assert stopped == [(name, None) for name in owned]
            owners = {name: owner for name, owner in owners.items() if owner != who}
        elif owners.get(actuator, who) != who:
            with pytest.raises(Failure) as refused:
                tell(leases[who], action, actuator)
            assert refused.value.value.data["owner"] == f"skill {owners[actuator]}"
            assert len(book.robot.commands) == told
        else:
            tell(leases[who], action, actuator)
            owners[actuator] = who
        for name in GOALS:
            owner = owners.get(name)
            assert book.owner(name) == (None if owner is None else f"skill {owner}")
    issued = [(one.actuator, one.goal) for one in book.issued]
    assert issued == [(name, goal) for _, name, goal in book.robot.commands]


def test_only_undeclared_work_counts_as_slow(run_yaml, monkeypatch):
    wall = [0.0]
    monkeypatch.setattr(time, "perf_counter", lambda: wall[0])

    class Slow(Skill):
        """Takes its time, declared and not."""

        def run(self, robot) -> Run:
            wall[0] += 0.03
            yield "slow"
            wall[0] += 0.01
            yield "quick"
            wall[0] += 0.04
            yield from compute(lambda: wall.append(wall.pop() + 9.0), 0.2)
            wall[0] += 0.05

    report = run_yaml("trees: {Main: [slow]}", Slow)
    slow = next(node for node in report.nodes if node.type == "slow")
    assert (slow.slow_ticks, slow.slowest_s) == (3, 0.05)
