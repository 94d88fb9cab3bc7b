"""Ask and Confirm: a person decides. The tick waits for the answer, so the world holds still."""

from __future__ import annotations

import time
from typing import Any

from momantu_bt.engine.blackboard import Cell
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.label import label
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.outside import PERSON
from momantu_bt.engine.person import Interrupted, Question, answer
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import RUNNING, SUCCESS, Status
from momantu_bt.failure import DECLINED, NO_ANSWER, WRONG_TYPE

YES, NO = "yes", "no"


class _Asking(TreeNode):
    """Asks in its first tick; RUNNING only where the run is interrupted instead."""

    def __init__(self, *arguments: Any, inputs: Inputs, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.inputs = inputs

    @property
    def role(self) -> Role:
        """Somebody has to do something."""
        return Role.ACT

    def step(self) -> Status:
        """Ask, and judge the answer."""
        values = self.inputs.all()
        self.label = label(self.model, values)
        self.state = RUNNING
        self.show(RUNNING)
        question = self.question(values)
        if question.default is not None and question.taken(question.default) is None:
            return self.fail(WRONG_TYPE, f"the default: {question.complaint(question.default)}")
        begun = time.perf_counter()
        try:
            with self.context.watchdog.paused():
                said = answer(_Heard(self.context), question)
        except Interrupted:
            return RUNNING
        finally:
            self.context.waited += time.perf_counter() - begun
        if said is None:
            return self.fail(NO_ANSWER, f"nobody answers {question.text!r}")
        return self.judge(said, question)

    def question(self, values: dict[str, Any]) -> Question:
        """What to ask, from the inputs."""
        raise NotImplementedError

    def judge(self, said: str, question: Question) -> Status:
        """What the answer makes of the node."""
        raise NotImplementedError


class _Heard:
    """The run's person, whose words come from outside."""

    def __init__(self, context: RunContext) -> None:
        self._context = context

    def ask(self, question: Question, complaint: str) -> str | None:
        """What the person says."""
        context = self._context
        return context.outside.ask(PERSON, lambda: context.person.ask(question, complaint))


class Ask(_Asking):
    """SUCCESS with the answer written; FAILURE with NO_ANSWER when there is none."""

    def __init__(self, *arguments: Any, answer: Cell, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.answer = answer

    def question(self, values: dict[str, Any]) -> Question:
        """As the tree file writes it."""
        return Question(values["question"], values["choices"], values["default"])

    def judge(self, said: str, question: Question) -> Status:
        """Write it."""
        self.answer.write(said)
        return SUCCESS


class Confirm(_Asking):
    """SUCCESS for yes; FAILURE with DECLINED for no, with NO_ANSWER when there is none."""

    def question(self, values: dict[str, Any]) -> Question:
        """A question of yes or no."""
        default = values["default"]
        said = None if default is None else YES if default else NO
        return Question(values["question"], (YES, NO), said)

    def judge(self, said: str, question: Question) -> Status:
        """Yes or no."""
        if said == YES:
            return SUCCESS
        return self.fail(DECLINED, f"the answer to {question.text!r} is no")
