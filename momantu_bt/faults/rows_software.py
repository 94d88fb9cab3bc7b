"""Faults of the software: a skill that errs, a process that ends."""

from __future__ import annotations

from math import inf
from typing import Any

from momantu_bt.failure import HUNG, SKILL_ERROR, TIMEOUT, WRONG_TYPE
from momantu_bt.faults.kind import (
    FIRST_ANSWER,
    FIRST_SKILL,
    FaultKind,
    Where,
    count,
    lasting,
    number,
)

_TIMES = count("times", 1, "how many starts of the skill it hits", least=1)


def _kind(name: str, doc: str, *parameters: Any, **more: Any) -> FaultKind:
    component, _, mode = name.partition(".")
    where = more.pop("place", Where.SKILL)
    return FaultKind(component, mode, doc, where, parameters=parameters, **more)


KINDS: tuple[FaultKind, ...] = (
    _kind(
        "skill.exception",
        "The skill raises what it does not declare.",
        _TIMES,
        phases=(FIRST_SKILL,),
        notice=1.0,
        recoverable=True,
        reasons=frozenset({SKILL_ERROR}),
    ),
    _kind(
        "skill.hang",
        "The skill runs in circles in Python and never gives a step back.",
        _TIMES,
        phases=(FIRST_SKILL,),
        notice=1.0,
        recoverable=True,
        reasons=frozenset({HUNG}),
    ),
    _kind(
        "skill.hang_native",
        "The skill blocks in native code and keeps the interpreter's lock.",
        phases=(FIRST_SKILL,),
        notice=1.0,
        recoverable=False,
        reasons=frozenset(),
        ends_process=True,
    ),
    _kind(
        "skill.nan",
        "Every number among the skill's outputs is NaN.",
        _TIMES,
        phases=(FIRST_ANSWER,),
        notice=60.0,
        recoverable=True,
        reasons=frozenset({WRONG_TYPE}),
    ),
    _kind(
        "skill.wrong_type",
        "The skill's outputs are of types that it does not declare.",
        _TIMES,
        phases=(FIRST_ANSWER,),
        notice=60.0,
        recoverable=True,
        reasons=frozenset({WRONG_TYPE}),
    ),
    _kind(
        "skill.slow",
        "Each step of the skill takes longer, by the wall's clock and by the world's.",
        number("wall", 0.03, "s", "what each step works longer, in wall time", 0.0, 10.0),
        number("factor", 3.0, None, "ticks of a step over what they were", 1.0, 1000.0),
        lasting(inf),
        phases=(FIRST_SKILL,),
        notice=60.0,
        recoverable=True,
        reasons=frozenset({TIMEOUT, "ARM_STUCK", "NO_PROGRESS"}),
    ),
    _kind(
        "process.killed",
        "The process is ended by SIGKILL.",
        place=Where.PROCESS,
        phases=("navigate+2 s", FIRST_SKILL),
        notice=1.0,
        recoverable=False,
        reasons=frozenset(),
        ends_process=True,
    ),
)
