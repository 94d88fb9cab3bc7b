"""Repeat, RetryUntilSuccessful, KeepRunningUntilFailure, ForEach, RunOnce: decorators that loop.

| child returns | Repeat            | RetryUntilSuccessful | KeepRunningUntilFailure |
|---------------|-------------------|----------------------|-------------------------|
| SUCCESS       | again; in the end SUCCESS | SUCCESS      | again                   |
| FAILURE       | FAILURE           | again; in the end FAILURE | FAILURE            |
| RUNNING       | RUNNING           | RUNNING              | RUNNING                 |
| SKIPPED       | SKIPPED           | SKIPPED              | RUNNING                 |

After a round that began and ended within one tick, the node returns RUNNING, so that nodes above
it can interrupt. After a longer round the next one begins in the same tick. -1 means no limit of
rounds.
"""

from __future__ import annotations

from typing import Any, Literal

from momantu_bt.engine.causes import with_beside, with_tries
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.failure import FAILED, FailureValue
from momantu_bt.nodes.counting import count_text, written_count
from momantu_bt.tree import model
from momantu_bt.tree.catalogue.flow import After, Walk, again, around, as_child, perhaps
from momantu_bt.tree.catalogue.known import NEVER, Known, meet
from momantu_bt.tree.catalogue.spec import Dialect, decorator, input_port, output_port
from momantu_bt.tree.catalogue.wording import tries_text
from momantu_bt.tree.model import Node

_ENDLESS = model.Literal(-1)


def _until_failure(walk: Walk, node: Node, before: Known) -> After:
    end = as_child(walk, node, before)
    return After(NEVER, end.failure, end.skipped)


def _once(walk: Walk, node: Node, before: Known) -> After:
    """After the first end: skipped with the child's writes still there, or its result again."""
    end = as_child(walk, node, before)
    return After(end.success, meet(end.failure, before), before)


def _rounds(walk: Walk, node: Node, before: Known) -> After:
    """Without end, it never succeeds."""
    end = around(walk, node, before)
    return After(NEVER, end.failure, end.skipped) if node.ports.get("cycles") == _ENDLESS else end


def _tries(walk: Walk, node: Node, before: Known) -> After:
    """Without end, it never fails."""
    end = around(walk, node, before)
    return After(end.success, NEVER, end.skipped) if node.ports.get("attempts") == _ENDLESS else end


def _each(walk: Walk, node: Node, before: Known) -> After:
    if node.ports.get("until", model.Literal("failure")) == model.Literal("failure"):
        return perhaps(walk, node, before)
    end = as_child(walk, node, before)
    if node.ports["until"] == model.Literal("success"):
        return After(end.success, meet(before, end.failure), NEVER)
    return After(before, meet(before, end.failure), NEVER)


class Repeat(Decorator):
    """Runs the child again when it succeeds."""

    spec = decorator(
        "Repeat",
        "repeat",
        "Runs the child again when it succeeds.",
        input_port("cycles", int, "runs in all; -1 is without end", least=1, endless=True),
        xml={"cycles": "num_cycles"},
        flow=again(_rounds),
        around=lambda node: tries_text(node, "cycles", "round", "rounds"),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.count = 0

    def step(self) -> Status:
        """Run rounds until the child returns RUNNING, fails, or ended within one tick."""
        cycles: int = self.inputs["cycles"]
        self.state = RUNNING
        while self.count < cycles or cycles == -1:
            fresh = self.child.state is IDLE
            status = self.child.execute()
            if status is RUNNING:
                return RUNNING
            self.child.reset()
            if status is SKIPPED:
                return SKIPPED
            if status is FAILURE:
                self.count = 0
                return self.pass_on(FAILURE)
            self.count += 1
            if fresh and (self.count < cycles or cycles == -1):
                return RUNNING
        self.count = 0
        return SUCCESS

    @property
    def note(self) -> str:
        """The number of the current round."""
        return count_text("round", self.count + 1, written_count(self.model, "cycles"))

    def clear(self) -> None:
        """Forget the rounds."""
        self.count = 0


class RetryUntilSuccessful(Decorator):
    """Runs the child again when it fails; `attempts` counts all tries."""

    spec = decorator(
        "RetryUntilSuccessful",
        "retry",
        "Runs the child again when it fails.",
        input_port("attempts", int, "tries in all; -1 is without end", least=1, endless=True),
        xml={"attempts": "num_attempts"},
        retries=True,
        flow=again(_tries),
        around=lambda node: tries_text(node, "attempts"),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.count = 0

    def step(self) -> Status:
        """Try until the child returns RUNNING, succeeds, or failed within one tick."""
        attempts: int = self.inputs["attempts"]
        self.state = RUNNING
        while self.count < attempts or attempts == -1:
            fresh = self.child.state is IDLE
            status = self.child.execute()
            if status is RUNNING:
                return RUNNING
            self.child.reset()
            if status is not FAILURE:
                self.count = 0 if status is SUCCESS else self.count
                return status
            self.count += 1
            attempts = self.inputs["attempts"]
            if fresh and (self.count < attempts or attempts == -1):
                return RUNNING
        tries, self.count = self.count, 0
        return self.fail_with(with_tries(self, self.failure_of(self.child), tries, attempts))

    @property
    def note(self) -> str:
        """The number of the current try."""
        return count_text("try", self.count + 1, written_count(self.model, "attempts"))

    def clear(self) -> None:
        """Forget the tries."""
        self.count = 0


class KeepRunningUntilFailure(Decorator):
    """Runs the child again and again until it fails."""

    spec = decorator(
        "KeepRunningUntilFailure",
        "keep_running_until_failure",
        "Runs the child again and again until it fails.",
        flow=again(_until_failure),
        around=lambda node: "again and again until it fails",
    )

    def step(self) -> Status:
        """One round at most."""
        self.state = RUNNING
        status = self.child.execute()
        if status is FAILURE or status is SUCCESS:
            self.child.reset()
        if status is FAILURE:
            return self.pass_on(FAILURE)
        return RUNNING


class ForEach(Decorator):
    """Runs the child for each item of a list, or until it has succeeded for one.

    The list is read when the node starts; the key of `as` holds the current item. SUCCESS after
    the last item (at once for an empty list). FAILURE when the child fails. When the child is
    skipped, the next item follows. With `until: success` it is the other way round: SUCCESS as soon
    as the child succeeds; when it fails, the next item follows; FAILURE after the last item, with
    the failures of all. An empty list fails.
    """

    spec = decorator(
        "ForEach",
        "for_each",
        "Runs the child for each item of a list, until it fails or, if asked, succeeds.",
        input_port("in", tuple, "the items"),
        output_port("as", object, "the key that holds the item of the round"),
        input_port(
            "until",
            Literal["failure", "success"],
            "success: it ends well with the first item for which the child succeeds",
            "failure",
        ),
        first=None,
        modifier=False,
        dialect=Dialect.OURS,
        item=("as", "in"),
        flow=again(_each),
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.item = parts.key("as")
        self.items: tuple[Any, ...] | None = None
        self.at = 0
        self.failures_seen: list[FailureValue] = []

    def step(self) -> Status:
        """One round at most."""
        if self.items is None:
            self.items, self.at = tuple(self.inputs["in"]), 0
            self.failures_seen = []
        searching = self.inputs["until"] == "success"
        self.state = RUNNING
        if self.at < len(self.items):
            if self.child.state is IDLE:
                self.item.write(self.items[self.at])
            status = self.child.execute()
            if status is RUNNING:
                return RUNNING
            self.child.reset()
            if status is FAILURE and searching:
                self.failures_seen.append(self.failure_of(self.child))
            elif status.completed and (searching or status is FAILURE):
                self.items = None
                return self.pass_on(status)
            self.at += 1
            if self.at < len(self.items):
                return RUNNING
        self.items = None
        return self._found_none() if searching else SUCCESS

    def _found_none(self) -> Status:
        if self.failures_seen:
            return self.fail_with(with_beside(self.failures_seen))
        return self.fail(FAILED, "its list has no item for which the child could succeed")

    def clear(self) -> None:
        """Forget the list; the next start reads it again."""
        self.items = None


class RunOnce(Decorator):
    """Runs the child to its end once per run; after that returns SKIPPED, or the same result."""

    spec = decorator(
        "RunOnce",
        "run_once",
        "Runs the child only once in a run of the tree.",
        input_port("then_skip", bool, "skipped afterwards, instead of repeating the result", True),
        flow=_once,
        around=lambda node: "once only",
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.result: Status | None = None

    def step(self) -> Status:
        """Tick the child until its first end."""
        if self.result is not None:
            if self.inputs["then_skip"]:
                return SKIPPED
            return self.pass_on(self.result)
        self.state = RUNNING
        status = self.child.execute()
        if status.completed:
            self.result = status
            self.child.reset()
        return self.pass_on(status)
