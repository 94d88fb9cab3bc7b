"""What reached the tree from outside, replayed from a record."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, TypeVar, cast

from momantu_bt.engine.outside import PERSON, Outside, Refused, SkillNode, Starter
from momantu_bt.engine.person import Interrupted
from momantu_bt.engine.skills.body import Body
from momantu_bt.engine.status import Status
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.record.recording import StepRecord, TickRecord

T = TypeVar("T")


class NotRecorded(Exception):
    """The tree asks for something that the record does not have.

    what: the request in words. node: the node's index.
    """

    def __init__(self, what: str, node: int | None = None) -> None:
        super().__init__(what)
        self.what = what
        self.node = node


class RecordedOutside(Outside):
    """What was outside the tree. Before each tick of the tree, give the tick's record to `load`."""

    def __init__(self) -> None:
        self._steps: dict[int, deque[StepRecord]] = {}
        self._answers: dict[str, deque[Any]] = {}
        self._is_last = False

    def load(self, tick: TickRecord, *, last: bool) -> None:
        """Load the record of a tick. last: the run ended after it, perhaps interrupted."""
        self._steps, self._answers, self._is_last = {}, {}, last
        for step in tick.steps:
            self._steps.setdefault(step.node, deque()).append(step)
        for key, value in tick.reads:
            self._answers.setdefault(key, deque()).append(value)

    def left_over(self) -> tuple[str, int | None] | None:
        """The first recorded step or answer that the tree did not ask for, with its node."""
        for node, steps in self._steps.items():
            if steps:
                return f"a step of its skill, to {_words(steps[0])}", node
        for key, answers in self._answers.items():
            if answers:
                return f"a question for {key}", None
        return None

    def runs_skills(self, body: Body | None) -> bool:
        """True: skills do what the record says they did."""
        return True

    def starter(self, leaf: SkillNode) -> Starter:
        """What starts a skill as recorded."""
        return lambda inputs: _RecordedSession(self, leaf.index)

    def ask(self, key: str, ask: Callable[[], T]) -> T:
        """The recorded answer."""
        answers = self._answers.get(key)
        if not answers:
            if key == PERSON and self._is_last:
                raise Interrupted
            raise NotRecorded(f"a question for {key}")
        answer = answers.popleft()
        if isinstance(answer, Refused):
            raise _raised(answer.failure)
        return cast("T", answer)

    def step(self, node: int) -> StepRecord:
        """The next step of a leaf in this tick."""
        steps = self._steps.get(node)
        if not steps:
            raise NotRecorded("a step of its skill", node)
        return steps.popleft()


class _RecordedSession:
    """One start of one skill."""

    def __init__(self, outside: RecordedOutside, node: int) -> None:
        self._outside = outside
        self._node = node
        self.phase = ""
        self.failure: FailureValue | None = None
        self.took = 0.0
        self.outputs: dict[str, Any] = {}

    def step(self, live_inputs: Mapping[str, Any] | None = None) -> Status:
        """The recorded step of the skill in this tick."""
        step = self._outside.step(self._node)
        self.phase, self.failure = step.phase, step.failure
        self.outputs |= step.outputs
        return Status(step.status)

    def halt(self) -> None:
        """Do nothing: a recorded skill has nothing to end."""


def _words(step: StepRecord) -> str:
    return ", ".join(filter(None, (step.status, step.phase)))


def _raised(value: FailureValue) -> Failure:
    failure = Failure(value.code, value.message)
    failure.value = value
    return failure
