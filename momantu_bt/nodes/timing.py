"""Timeout, Delay, Sleep. They measure time by the world's clock, never by the wall clock."""

from __future__ import annotations

from momantu_bt.engine.causes import running_as_cause
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.label import ShowsValues
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.role import Role
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.engine.status import RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import TIMEOUT
from momantu_bt.tree.catalogue.codes import joined
from momantu_bt.tree.catalogue.flow import again, around
from momantu_bt.tree.catalogue.spec import TIME, decorator, leaf, time_ports
from momantu_bt.tree.catalogue.wording import duration_text


def seconds(inputs: Inputs) -> float:
    """The time, s, of a node with the inputs `duration` and `msec`, of which one is given."""
    duration: float | None = inputs["duration"]
    if duration is not None:
        return duration
    milliseconds: int = inputs["msec"]
    return milliseconds / 1000.0


class Timeout(Decorator):
    """Halts a child that runs too long, and fails with TIMEOUT.

    The failure's cause says what was running. Time counts from this node's start; a limit of 0 or
    less means no limit. Within the limit, the node returns the child's status.
    """

    spec = decorator(
        "Timeout",
        "timeout",
        "Halts the child and fails with TIMEOUT when it takes longer.",
        *time_ports("the limit", least=0.001),
        xml={"duration": ""},
        one_of=TIME,
        flow=again(around),
        codes=lambda node, failing: joined(failing.children, frozenset({TIMEOUT})),
        around=lambda node: f"at most {duration_text(node)}",
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.begun: float | None = None

    def step(self) -> Status:
        """Tick the child; halt it when its time is up."""
        limit = seconds(self.inputs)
        if self.begun is None:
            self.begun = self.context.now
        self.state = RUNNING
        passed = self.context.now - self.begun
        if self.child.state is RUNNING and 0.0 < limit <= passed + CLOCK_SLACK:
            cause = running_as_cause(self.child, passed)
            self.child.reset()
            self.begun = None
            return self.fail(TIMEOUT, f"{self.child.name} took longer than {limit:g} s", cause)
        status = self.child.execute()
        if status is not RUNNING:
            self.begun = None
        if status.completed:
            self.child.reset()
        return self.pass_on(status)

    def clear(self) -> None:
        """The time starts again."""
        self.begun = None


class Delay(Decorator):
    """Returns RUNNING for a while, then ticks the child; each start waits again."""

    spec = decorator(
        "Delay",
        "delay",
        "Waits before the child.",
        *time_ports("how long"),
        xml={"duration": "", "msec": "delay_msec"},
        one_of=TIME,
        flow=around,
        around=lambda node: f"after {duration_text(node)}",
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.begun: float | None = None

    def step(self) -> Status:
        """Wait, then tick the child."""
        if self.begun is None:
            self.begun = self.context.now
        self.state = RUNNING
        duration = seconds(self.inputs)
        if self.context.now - self.begun < duration - CLOCK_SLACK:
            return RUNNING
        status = self.child.execute()
        if status is not RUNNING:
            self.begun = None
        if status is not RUNNING and status is not SKIPPED:
            self.child.reset()
        return self.pass_on(status)

    def clear(self) -> None:
        """Forget the wait; the next start waits again."""
        self.begun = None


class Sleep(ShowsValues, TreeNode):
    """Returns RUNNING for a while, then SUCCESS."""

    spec = leaf(
        "Sleep", "wait", "Waits.", *time_ports("how long"), xml={"duration": ""}, one_of=TIME
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.until = 0.0

    @property
    def role(self) -> Role:
        """Its role in displays: waiting counts as an action."""
        return Role.ACT

    def step(self) -> Status:
        """Wait; the duration is read at the start."""
        if self.state is not RUNNING:
            duration = seconds(self.inputs)
            self.until = self.context.now + duration
            self.show_values({"duration": f"{duration:g} s", "msec": duration * 1000.0})
        return SUCCESS if self.context.now >= self.until - CLOCK_SLACK else RUNNING
