"""Ask and Confirm: a person decides. The tick waits for the answer, and simulated time stops."""

from __future__ import annotations

from typing import Any

from momantu_bt.engine.context import RunContext
from momantu_bt.engine.label import ShowsValues
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.outside import PERSON
from momantu_bt.engine.person import Interrupted, Question, answer
from momantu_bt.engine.role import Role
from momantu_bt.engine.status import RUNNING, SUCCESS, Status
from momantu_bt.failure import DECLINED, NO_ANSWER, WRONG_TYPE
from momantu_bt.formats.names import valid_names
from momantu_bt.tree.catalogue.codes import and_also
from momantu_bt.tree.catalogue.spec import Dialect, Objection, input_port, leaf, output_port
from momantu_bt.tree.model import Literal, Node

YES, NO = "yes", "no"


def _wrong_default(node: Node) -> Objection | None:
    """The default must be one of the choices; checked when both are literals."""
    choices, default = node.ports.get("choices"), node.ports.get("default")
    if not isinstance(choices, Literal) or not isinstance(default, Literal):
        return None
    known = choices.value
    if not isinstance(known, list) or not known or default.value in [*known, None]:
        return None
    hint = valid_names(str(default.value), map(str, known), "choices")
    return Objection("default", f"{default.value!r} is not among the choices", hint)


class _Asking(ShowsValues, TreeNode):
    """Asks in its first tick; RUNNING only when the run is interrupted instead of answered."""

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()

    @property
    def role(self) -> Role:
        """Its role in displays: an action, by a person."""
        return Role.ACT

    def step(self) -> Status:
        """Ask, and turn the answer into a status."""
        values = self.inputs.all()
        self.show_values(values)
        self.state = RUNNING
        self.show(RUNNING)
        question = self.question(values)
        if question.default is not None and question.taken(question.default) is None:
            return self.fail(WRONG_TYPE, f"the default: {question.complaint(question.default)}")
        try:
            with self.context.watchdog.paused():
                said = answer(_PersonOutside(self.context), question)
        except Interrupted:
            return RUNNING
        if said is None:
            return self.fail(NO_ANSWER, f"nobody answers {question.text!r}")
        return self.judge(said, question)

    def question(self, values: dict[str, Any]) -> Question:
        """The question, from the inputs."""
        raise NotImplementedError

    def judge(self, said: str, question: Question) -> Status:
        """The node's status after an answer."""
        raise NotImplementedError


class _PersonOutside:
    """Asks the person, and records the answer so that a replay can give it again."""

    def __init__(self, context: RunContext) -> None:
        self._context = context

    def ask(self, question: Question, complaint: str) -> str | None:
        """The person's answer."""
        context = self._context
        return context.ask(PERSON, lambda: context.person.ask(question, complaint))


class Ask(_Asking):
    """Writes the answer and returns SUCCESS; FAILURE with NO_ANSWER when nobody answers."""

    spec = leaf(
        "Ask",
        "ask",
        "Asks the person at the terminal.",
        input_port("question", str, "what to ask"),
        output_port("answer", str, "the key of the answer"),
        input_port("choices", tuple[str, ...], "the answers it takes; none: any text", ()),
        input_port("default", str | None, "the answer when nobody gives one", None),
        dialect=Dialect.OURS,
        choices={"answer": "choices"},
        codes=and_also(NO_ANSWER),
        objection=_wrong_default,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.answer = parts.key("answer")

    def question(self, values: dict[str, Any]) -> Question:
        """The question as the tree file has it."""
        return Question(values["question"], values["choices"], values["default"])

    def judge(self, said: str, question: Question) -> Status:
        """Write the answer."""
        self.answer.write(said)
        return SUCCESS


class Confirm(_Asking):
    """SUCCESS for yes; FAILURE with DECLINED for no, with NO_ANSWER when nobody answers."""

    spec = leaf(
        "Confirm",
        "confirm",
        "Asks the person at the terminal; yes is success, no is failure.",
        input_port("question", str, "what to ask, for yes or no"),
        input_port("default", bool | None, "the answer when nobody gives one", None),
        dialect=Dialect.OURS,
        codes=and_also(DECLINED, NO_ANSWER),
    )

    def question(self, values: dict[str, Any]) -> Question:
        """A question whose choices are yes and no."""
        default = values["default"]
        said = None if default is None else YES if default else NO
        return Question(values["question"], (YES, NO), said)

    def judge(self, said: str, question: Question) -> Status:
        """SUCCESS for yes, FAILURE for no."""
        if said == YES:
            return SUCCESS
        return self.fail(DECLINED, f"the answer to {question.text!r} is no")
