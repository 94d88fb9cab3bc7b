"""Check a skill against the rules for all skills, without a simulator."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias

from momantu_bt.formats.places import NOWHERE
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.skill import Skill
from momantu_bt.testing.clock_rules import ClockWatch, clocks_in_source
from momantu_bt.testing.rehearsal import CannotRehearse, Rehearsals, Take
from momantu_bt.testing.source_rules import calls, codes, documented, ports

Example: TypeAlias = Callable[[int], Mapping[str, Any]]
"""Keyword arguments of `run_skill` for a seed, made anew at each call."""


def check_skill(
    skill: type[Skill],
    example: Example | None = None,
    *,
    seed: int = 0,
    max_time: float = 30.0,
    halts: int = 20,
) -> list[Problem]:
    """Find everything that is wrong with a skill, from its source and by running it.

    example: a function of the seed that returns keyword arguments for `run_skill` (inputs, world or
    robot, site, services), new ones at each call. Missing arguments are made from the types of the
    ports, in a scripted room with the installed services. The default is `Skill.rehearsal`.
    max_time: simulated time of a run, s. halts: the skill is halted at each of its ticks; in a
    longer run, only at this many, first of all at ticks where its phase changes.

    Returns: the problems; for a correct skill the list is empty or has only notes.
    """
    found = [*documented(skill), *ports(skill), *codes(skill), *calls(skill)]
    found += clocks_in_source(skill)
    rehearsals = Rehearsals(skill, example, seed, max_time)
    try:
        found += _run(rehearsals, halts)
    except CannotRehearse as error:
        found.append(Problem("not-rehearsed", str(error)))
    finally:
        rehearsals.close()
    return _distinct(found)


def assert_skill(skill: type[Skill], example: Example | None = None, **options: Any) -> None:
    """As `check_skill`, but raise an AssertionError that lists the problems, if there are any."""
    wrong = [
        finding
        for finding in check_skill(skill, example, **options)
        if finding.severity is not Severity.HINT
    ]
    if wrong:
        lines = "\n".join(f"  {finding}" for finding in wrong)
        raise AssertionError(f"{skill.__name__}:\n{lines}")


def _distinct(found: list[Problem]) -> list[Problem]:
    """The problems without duplicates: one for each line and rule."""
    first: dict[tuple[str, object], Problem] = {}
    for finding in found:
        nowhere = finding.place == NOWHERE
        first.setdefault((finding.code, finding.message if nowhere else finding.place), finding)
    return list(first.values())


def _run(rehearsals: Rehearsals, halts: int) -> Iterator[Problem]:
    with ClockWatch(rehearsals.skill) as watch:
        whole = rehearsals.whole()
    yield from watch.findings()
    yield from whole.findings()
    if whole.broken:
        return
    yield from _deterministic(whole, rehearsals.whole())
    if whole.ticks == 1 and whole.code is not None:
        sentence = f"it ended with {whole.code} in its first tick: nothing more was tried"
        yield Problem("not-rehearsed", sentence, severity=Severity.HINT)
    ticks = _chosen(whole, halts)
    for tick in ticks:
        yield from rehearsals.halted(tick, restart=tick in (ticks[0], ticks[-1]), whole=whole)
    yield from rehearsals.blind().findings("when no sensor answers")


def _deterministic(first: Take, second: Take) -> Iterator[Problem]:
    """Compare two runs with the same seed in two equal worlds."""
    difference = first.difference(second)
    if difference:
        yield Problem("not-deterministic", f"two runs with one seed differ in {difference}")


def _chosen(whole: Take, most: int) -> list[int]:
    """The ticks at which to halt the skill while it runs."""
    running = range(1, whole.ticks + (1 if whole.status == "HALTED" else 0))
    if len(running) <= most:
        return list(running)
    turns = [tick for tick in whole.turns if tick in running]
    spread = [running[0], running[-1]]
    spread += [running[round(i * (len(running) - 1) / most)] for i in range(1, most)]
    return sorted(dict.fromkeys([*turns, *spread][:most]))
