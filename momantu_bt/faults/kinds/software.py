"""Faults of the software: a skill that errs, a process that ends."""

from __future__ import annotations

from functools import partial
from math import inf

from momantu_bt.activity import Activity
from momantu_bt.failure import HUNG, SKILL_ERROR, TIMEOUT, WRONG_TYPE
from momantu_bt.fault_kind import FaultKind, Trigger, Where, count, fault_kind, lasting, number
from momantu_bt.symptom import Symptom

ANY = Trigger(Activity.ANY)
ANSWER = Trigger(Activity.ANSWER)
_TIMES = count("times", 1, "how many starts of the skill it hits", least=1)

_kind = partial(fault_kind, place=Where.SKILL)

KINDS: tuple[FaultKind, ...] = (
    _kind(
        "skill.exception",
        "The skill raises what it does not declare.",
        _TIMES,
        begins=(ANY,),
        notice=1.0,
        recoverable=True,
        codes={SKILL_ERROR},
    ),
    _kind(
        "skill.hang",
        "The skill runs in circles in Python and never gives a step back.",
        _TIMES,
        begins=(ANY,),
        notice=1.0,
        recoverable=True,
        codes={HUNG},
    ),
    _kind(
        "skill.hang_native",
        "The skill blocks in native code and keeps the interpreter's lock.",
        begins=(ANY,),
        notice=1.0,
        recoverable=False,
        ends_process=True,
    ),
    _kind(
        "skill.nan",
        "Every number among the skill's outputs is NaN.",
        _TIMES,
        begins=(ANSWER,),
        notice=60.0,
        recoverable=True,
        codes={WRONG_TYPE},
    ),
    _kind(
        "skill.wrong_type",
        "The skill's outputs are of types that it does not declare.",
        _TIMES,
        begins=(ANSWER,),
        notice=60.0,
        recoverable=True,
        codes={WRONG_TYPE},
    ),
    _kind(
        "skill.slow",
        "Each step of the skill takes longer, by the wall's clock and by the world's.",
        number("wall", 0.03, "s", "what each step works longer, in wall time", 0.0, 10.0),
        number("factor", 3.0, None, "ticks of a step over what they were", 1.0, 1000.0),
        lasting(inf),
        begins=(ANY,),
        notice=60.0,
        recoverable=True,
        symptoms={Symptom.SLOW},
        codes={TIMEOUT},
    ),
    fault_kind(
        "process.killed",
        "The process is ended by SIGKILL.",
        place=Where.PROCESS,
        begins=(Trigger(Activity.DRIVE), ANY),
        notice=1.0,
        recoverable=False,
        ends_process=True,
    ),
)
