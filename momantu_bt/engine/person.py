"""Who answers the questions of a tree: a person at the terminal, a script, or nobody."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Question:
    """What a tree wants to know. choices: the answers it takes, any text where there are none.

    default: what counts when nobody answers; None: then there is no answer.
    """

    text: str
    choices: tuple[str, ...] = ()
    default: str | None = None

    def taken(self, said: str) -> str | None:
        """The answer that something said means; None where it means none."""
        said = said.strip()
        if not self.choices:
            return said or None
        if said in self.choices:
            return said
        near = [choice for choice in self.choices if choice.lower() == said.lower()]
        if not near and said:
            near = [choice for choice in self.choices if choice.lower().startswith(said.lower())]
        return near[0] if len(near) == 1 else None

    def complaint(self, said: str) -> str:
        """Why something said is not an answer."""
        if not self.choices:
            return "an answer is needed"
        return f"{said.strip()!r} is not one of: {', '.join(self.choices)}"


class Interrupted(Exception):
    """The run was interrupted while a person was thinking."""


class Person(Protocol):
    """Somebody who can be asked."""

    def ask(self, question: Question, complaint: str) -> str | None:
        """What the person says, or None when nobody answers.

        complaint: why the previous answer was refused, empty at first.

        Raises:
            Interrupted: instead of answering, the person ended the run.
        """
        ...


class Scripted:
    """Says its answers in turn, and nothing after the last; without any it is nobody."""

    def __init__(self, answers: Iterable[str | bool] = ()) -> None:
        self._answers = iter(answers)

    def ask(self, question: Question, complaint: str) -> str | None:
        """The next answer; True and False are yes and no."""
        said = next(self._answers, None)
        return {True: "yes", False: "no"}[said] if isinstance(said, bool) else said


def answer(person: Person, question: Question) -> str | None:
    """Ask until the answer is one; the default, or None, when nobody answers.

    Raises:
        Interrupted: the run is to end.
    """
    complaint = ""
    while True:
        said = person.ask(question, complaint)
        if said is None:
            return question.default
        if not said.strip() and question.default is not None:
            return question.default
        taken = question.taken(said)
        if taken is not None:
            return taken
        complaint = question.complaint(said)
