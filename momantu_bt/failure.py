"""A failure is a value: a code, a sentence, data and a cause."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any

CODE = re.compile(r"[A-Z][A-Z0-9]*(_[A-Z0-9]+)*")

SKILL_ERROR = "SKILL_ERROR"
"""A skill raised an exception that it does not declare; `data["traceback"]` is its traceback."""
TIMEOUT = "TIMEOUT"
"""A time limit ended the child; the failure's cause says what was running."""
ACTUATOR_BUSY = "ACTUATOR_BUSY"
"""Another skill owns the actuator; `data["owner"]` names it."""
FRAME_UNKNOWN = "FRAME_UNKNOWN"
"""The frame buffer cannot answer a lookup."""
SERVICE_MISSING = "SERVICE_MISSING"
"""A skill needs a service that this run does not have."""
INPUT_MISSING = "INPUT_MISSING"
"""A node started, but a key that one of its inputs reads had no value."""
WRONG_TYPE = "WRONG_TYPE"
"""A value at a port is not of the port's type."""
FAILED = "FAILED"
"""A node failed without a more specific code (AlwaysFailure, a false condition, a guard)."""
HALTED = "HALTED"
"""The cause of a TIMEOUT: the node that was running when time was up. No node fails with it."""
SENSOR_DEAD = "SENSOR_DEAD"
"""A sensor does not answer, or repeats the same reading; `data["sensor"]` names it."""
HUNG = "HUNG"
"""One step of a skill exceeded the run's time limit; `data["traceback"]` says where it was."""
CALL_FAILED = "CALL_FAILED"
"""A skill called another one, which failed with a code that the caller does not declare."""
SCRIPT_ERROR = "SCRIPT_ERROR"
"""A script or a condition could not be evaluated."""

NO_ANSWER = "NO_ANSWER"
"""From `ask` and `confirm`: nobody answered, and there is no default."""
DECLINED = "DECLINED"
"""From `confirm`: the answer is no."""

ENGINE_CODES: Mapping[str, str] = MappingProxyType(
    {
        SKILL_ERROR: "the skill raised an exception that it does not declare",
        TIMEOUT: "a time limit ended what was running",
        ACTUATOR_BUSY: "another skill owns the actuator",
        FRAME_UNKNOWN: "the frame buffer cannot answer a lookup",
        SERVICE_MISSING: "the skill needs a service that this run does not have",
        INPUT_MISSING: "an input reads a key that holds no value",
        WRONG_TYPE: "a value at a port is not of the port's type",
        FAILED: "the node failed without saying more",
        SENSOR_DEAD: "a sensor does not answer, or repeats itself",
        HUNG: "the skill took longer over one step than the run has patience for",
        CALL_FAILED: "a skill that this one called failed; the cause says which and why",
        SCRIPT_ERROR: "a script or a condition could not be evaluated",
    }
)
"""Codes that any node can fail with, in addition to those its skill declares."""


NO_DATA: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True, init=False)
class FailureValue:
    """A failure as a node passes it to its parent, the record and the terminal.

    code: upper-case words joined by underscores, from the skill's `failures`.
    message: one sentence for a person.
    data: details as plain values (numbers, text, lists), for programs.
    node: name of the node that failed. place: its `file:line` in the tree file.
    cause: the failure that led to this one; for a subtree node, the failure inside the subtree.
    beside: failures of siblings that were tried before (a fallback's earlier children).
    tries: how often a retry or recover node tried. most_tries: its limit (0: not such a node).
    node_type: the node's canonical type, or the name of its skill.
    """

    code: str
    message: str
    data: Mapping[str, Any]
    node: str
    place: str
    cause: FailureValue | None
    beside: tuple[FailureValue, ...]
    tries: int
    most_tries: int
    node_type: str

    def __init__(
        self,
        code: str,
        message: str,
        data: Mapping[str, Any] = NO_DATA,
        node: str = "",
        place: str = "",
        cause: FailureValue | None = None,
        beside: tuple[FailureValue, ...] = (),
        tries: int = 1,
        most_tries: int = 0,
        node_type: str = "",
    ) -> None:
        # Trees fail often. This costs a third of what a frozen dataclass does field by field.
        self.__dict__.update(
            code=code,
            message=message,
            data=data,
            node=node,
            place=place,
            cause=cause,
            beside=beside,
            tries=tries,
            most_tries=most_tries,
            node_type=node_type,
        )

    def at(self, node: str, place: str, node_type: str) -> FailureValue:
        """A copy that names another node."""
        copy = object.__new__(FailureValue)
        copy.__dict__.update(self.__dict__, node=node, place=place, node_type=node_type)
        return copy

    def chain(self) -> Iterator[FailureValue]:
        """Yield this failure, then its cause, then that one's cause, and so on."""
        link: FailureValue | None = self
        while link is not None:
            yield link
            link = link.cause

    def as_dict(self) -> dict[str, Any]:
        """The failure as plain data for JSON."""
        return {
            "code": self.code,
            "message": self.message,
            "node": self.node,
            "node_type": self.node_type,
            "place": self.place,
            "tries": self.tries,
            "most_tries": self.most_tries,
            "data": dict(self.data),
            "cause": None if self.cause is None else self.cause.as_dict(),
            "beside": [other.as_dict() for other in self.beside],
        }

    def __str__(self) -> str:
        """Return `CODE, message`."""
        return f"{self.code}, {self.message}" if self.message else self.code


@lru_cache
def checked_code(code: str) -> str:
    """The code itself; ValueError if it is not one."""
    if not CODE.fullmatch(code):
        raise ValueError(
            f"failure code {code!r} is not upper-case words joined by underscores, "
            "such as 'NOT_FOUND'"
        )
    return code


class Failure(Exception):
    """Raised by a skill to fail: `raise Failure("NOT_FOUND", "no can here", seen=3)`."""

    def __init__(self, code: str, message: str = "", /, **data: Any) -> None:
        checked_code(code)
        super().__init__(f"{code}, {message}" if message else code)
        self.value = FailureValue(code, message, MappingProxyType(data))

    @property
    def code(self) -> str:
        """The failure's code."""
        return self.value.code
