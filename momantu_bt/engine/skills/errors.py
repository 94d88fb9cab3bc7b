"""Why a skill failed, as the tree sees it: what it declares, or an error of its own."""

from __future__ import annotations

import traceback

from momantu_bt.engine.raised import raised_at
from momantu_bt.errors import words_of
from momantu_bt.failure import (
    CALL_FAILED,
    ENGINE_CODES,
    HUNG,
    SKILL_ERROR,
    Failure,
    FailureValue,
)
from momantu_bt.skill import Skill


class CalledFailure(Failure):
    """The failure of a called skill, as it is raised in the skill that called it."""

    def __init__(self, value: FailureValue) -> None:
        super().__init__(value.code, value.message)
        self.value = value


def declared(kind: type[Skill], failure: Failure) -> FailureValue:
    """A failure that a skill raised, with its cause; SKILL_ERROR if the code is undeclared.

    A failure of a skill that it called becomes the cause: of the same code if the skill declares
    it, else of CALL_FAILED.
    """
    if isinstance(failure, CalledFailure):
        own = failure.code if failure.code in kind.failures else CALL_FAILED
        said = failure.value
        message = said.message if own == said.code else f"{said.node} failed with {said.code}"
        return FailureValue(own, message, said.data, cause=said)
    if failure.code in kind.failures or failure.code in ENGINE_CODES:
        value, before = failure.value, failure.__cause__
        if value.cause is not None or not isinstance(before, Failure):
            return value
        return FailureValue(value.code, value.message, value.data, cause=before.value)
    codes = ", ".join(kind.failures) or "none"
    return skill_error(kind, failure, f"raised {failure.code}, which it does not declare ({codes})")


def skill_error(
    kind: type[Skill], error: BaseException, sentence: str = "", cause: FailureValue | None = None
) -> FailureValue:
    """An exception of a skill. sentence: what the skill did, if the exception does not say it."""
    text = "".join(traceback.format_exception(error))
    said = sentence or f"raised {words_of(error)}"
    place = raised_at(error, kind.__module__)
    said += f", at {place}" if place else ""
    cause = error.value if isinstance(error, Failure) else cause
    data = {"traceback": text, "exception": type(error).__name__}
    return FailureValue(SKILL_ERROR, f"{kind.__name__} {said}", data, cause=cause)


def hung_failure(
    kind: type[Skill], hung: BaseException, cause: FailureValue | None = None
) -> FailureValue:
    """A step that the watchdog ended; where it was is in the data, for it is never twice there."""
    text = "".join(traceback.format_exception(hung))
    message = f"{kind.__name__} gave no step back within the run's patience"
    return FailureValue(HUNG, message, {"traceback": text}, cause=cause)
