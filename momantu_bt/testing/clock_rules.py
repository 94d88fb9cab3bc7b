"""Find uses of clocks and random numbers that are not the run's, in the source and at run time."""

from __future__ import annotations

import ast
import datetime
import os
import random
import sys
import time
from collections.abc import Iterator
from types import FrameType
from typing import Any

import numpy as np

from momantu_bt.formats.places import NOWHERE, Place
from momantu_bt.formats.problems import Problem
from momantu_bt.service import Service
from momantu_bt.skill import Skill
from momantu_bt.testing.source import family, reached

_TIMES = ("time", "monotonic", "perf_counter", "process_time", "thread_time")
_CLOCKS = frozenset(
    {
        *(f"time.{name}{end}" for name in _TIMES for end in ("", "_ns")),
        *(f"time.{name}" for name in ("sleep", "localtime", "gmtime", "ctime")),
        *(f"datetime.datetime.{name}" for name in ("now", "utcnow", "today")),
        "datetime.date.today",
    }
)
_RANDOM = frozenset({"os.urandom", "uuid.uuid1", "uuid.uuid4", "random.SystemRandom"})
_SEEDED = frozenset(
    {
        "random.Random",
        "numpy.random.default_rng",
        "numpy.random.RandomState",
        "numpy.random.SeedSequence",
        *(f"numpy.random.{bits}" for bits in ("PCG64", "MT19937", "Philox", "SFC64", "PCG64DXSM")),
    }
)
"""Functions that are allowed if the call passes a seed."""
_TYPES = frozenset({"numpy.random.Generator", "numpy.random.BitGenerator"})


def clocks_in_source(skill: type[Skill | Service]) -> Iterator[Problem]:
    """Calls in the skill's modules that read another clock or draw unseeded random numbers."""
    for module in reached(skill):
        names = _imports(module.tree)
        for node in ast.walk(module.tree):
            if isinstance(node, ast.Call):
                found = _called(node, names)
                rule = None if found is None else _rule(found, node)
                if found is not None and rule is not None:
                    yield _finding(rule, found, module.place(node))


def _finding(rule: str, called: str, place: Place) -> Problem:
    cure = "ask self.clock" if rule == "wall-clock" else "draw from self.random"
    return Problem(rule, f"calls {called}: runs would differ; {cure}", place)


def _imports(tree: ast.Module) -> dict[str, str]:
    """The dotted names that imported names stand for, in the module and its functions."""
    names: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                first = alias.name.partition(".")[0]
                names[alias.asname or first] = alias.name if alias.asname else first
        elif isinstance(node, ast.ImportFrom) and not node.level:
            for alias in node.names:
                names[alias.asname or alias.name] = f"{node.module}.{alias.name}"
    return names


def _called(node: ast.Call, names: dict[str, str]) -> str | None:
    """`numpy.random.rand` of `np.random.rand(…)`; None if the name was not imported."""
    parts: list[str] = []
    part: ast.expr = node.func
    while isinstance(part, ast.Attribute):
        parts.append(part.attr)
        part = part.value
    if not isinstance(part, ast.Name) or part.id not in names:
        return None
    return ".".join([names[part.id], *reversed(parts)])


def _rule(called: str, node: ast.Call) -> str | None:
    if called in _CLOCKS:
        return "wall-clock"
    if called in _RANDOM or called.startswith("secrets."):
        return "unseeded-random"
    if called in _SEEDED:
        return None if node.args or node.keywords else "unseeded-random"
    drawn = called.startswith(("random.", "numpy.random.")) and called not in _TYPES
    return "unseeded-random" if drawn else None


class ClockWatch:
    """A context manager that notes which clocks and random numbers a package uses.

    It sees the calls themselves, whatever names the source uses. For clocks, only calls from the
    package's own modules count. The shared random generators must not change at all.
    """

    def __init__(self, skill: type[Skill | Service]) -> None:
        self._tops = {kind.__module__.partition(".")[0] for kind in family(skill)}
        self._found: dict[tuple[str, str], Place] = {}
        self._before: tuple[Any, Any] = (None, None)
        self._profile: Any = None

    def __enter__(self) -> ClockWatch:
        self._before = _shared_generators()
        self._profile = sys.getprofile()
        sys.setprofile(self._called)
        return self

    def __exit__(self, *exception: object) -> None:
        sys.setprofile(self._profile)
        if _shared_generators() != self._before:
            self._found["unseeded-random", "a generator that all share"] = NOWHERE

    def findings(self) -> list[Problem]:
        """The problems that were noted."""
        return [_finding(rule, name, place) for (rule, name), place in self._found.items()]

    def _called(self, frame: FrameType, event: str, argument: Any) -> None:
        if (
            event != "c_call"
            or frame.f_globals.get("__name__", "").partition(".")[0] not in self._tops
        ):
            return
        rule, name = _of_builtin(argument)
        if rule:
            place = Place(frame.f_code.co_filename, frame.f_lineno)
            self._found.setdefault((rule, name), place)


_BUILTINS: dict[Any, tuple[str, str]] = {
    **{getattr(time, n): ("wall-clock", f"time.{n}") for n in (*_TIMES, "sleep")},
    **{getattr(time, f"{n}_ns"): ("wall-clock", f"time.{n}_ns") for n in _TIMES},
    os.urandom: ("unseeded-random", "os.urandom"),
}


def _of_builtin(function: Any) -> tuple[str, str]:
    """The rule that a call of a built-in function breaks and the function's name, or ("", "")."""
    owner = getattr(function, "__self__", None)
    if isinstance(owner, type) and issubclass(owner, datetime.date):
        name = getattr(function, "__name__", "")
        if name in ("now", "utcnow", "today"):
            return "wall-clock", f"datetime.{owner.__name__}.{name}"
        return "", ""
    try:
        return _BUILTINS.get(function, ("", ""))
    except TypeError:  # bound to an object that cannot be hashed
        return "", ""


def _shared_generators() -> tuple[Any, Any]:
    """The states of the generators that `random` and `numpy.random` share."""
    kind, keys, *rest = np.random.get_state(legacy=True)  # noqa: NPY002 - the generator to watch
    return random.getstate(), (kind, np.asarray(keys).tobytes(), *rest)
