"""The person who answers a tree's questions, and a scripted one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Question:
    """A question of a tree. choices: the valid answers; if empty, every text is valid.

    default: the answer if nobody answers, or None.
    """

    text: str
    choices: tuple[str, ...] = ()
    default: str | None = None

    def taken(self, said: str) -> str | None:
        """The valid answer for what a person said, or None."""
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
        """Why what a person said is not a valid answer."""
        if not self.choices:
            return "an answer is needed"
        return f"{said.strip()!r} is not one of: {', '.join(self.choices)}"


class Interrupted(Exception):
    """The run was interrupted while it waited for an answer."""


class Person(Protocol):
    """A person who answers questions."""

    def ask(self, question: Question, complaint: str) -> str | None:
        """The person's answer, or None when nobody answers.

        complaint: why the previous answer was refused, empty at first.

        Raises:
            Interrupted: the person ended the run instead of answering.
        """
        ...


class Scripted:
    """A scripted person: gives its answers in order; after the last one, nobody answers."""

    def __init__(self, answers: Iterable[str | bool] = ()) -> None:
        self._answers = iter(answers)

    def ask(self, question: Question, complaint: str) -> str | None:
        """The next answer; True and False become yes and no."""
        said = next(self._answers, None)
        return {True: "yes", False: "no"}[said] if isinstance(said, bool) else said


def answer(person: Person, question: Question) -> str | None:
    """Ask until an answer is valid; if nobody answers, return the default or None.

    Raises:
        Interrupted: the person ended the run.
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
