"""Check a skill against the rules for all skills, without a simulator."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias

from momantu_bt.formats.places import NOWHERE
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.skill import Skill
from momantu_bt.testing.clock_rules import ClockWatch, clocks_in_source
from momantu_bt.testing.rehearsal import CannotRehearse, Rehearsals, Take
from momantu_bt.testing.source_rules import codes, documented, ports

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
    """Everything that is wrong with a skill, from its source and from running it.

    example: keyword arguments of `run_skill` for a seed (inputs, world or robot, site,
    services), made anew at each call; those it leaves out, and all without one, are made from
    the types of the ports, in a scripted room with installed services. A skill may bring its
    own: `Skill.rehearsal`.
    max_time: simulated seconds of a run. halts: it is halted at each of its ticks; of a longer
    run at that many, those where its phase changes first.

    Returns: findings by rule; an empty list, or notes alone, for a skill that is right.
    """
    found = [*documented(skill), *ports(skill), *codes(skill), *clocks_in_source(skill)]
    rehearsals = Rehearsals(skill, example, seed, max_time)
    try:
        found += _run(rehearsals, halts)
    except CannotRehearse as error:
        found.append(Problem("not-rehearsed", str(error)))
    finally:
        rehearsals.close()
    return _distinct(found)


def assert_skill(skill: type[Skill], example: Example | None = None, **options: Any) -> None:
    """As `check_skill`; AssertionError that lists what is wrong, if anything is."""
    wrong = [
        finding
        for finding in check_skill(skill, example, **options)
        if finding.severity is not Severity.HINT
    ]
    if wrong:
        lines = "\n".join(f"  {finding}" for finding in wrong)
        raise AssertionError(f"{skill.__name__}:\n{lines}")


def _distinct(found: list[Problem]) -> list[Problem]:
    """The findings without duplicates: one for each line and rule."""
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
    """Two runs of one seed in two worlds that are alike."""
    difference = first.difference(second)
    if difference:
        yield Problem("not-deterministic", f"two runs with one seed differ in {difference}")


def _chosen(whole: Take, most: int) -> list[int]:
    """Ticks at which it is halted while it still runs."""
    running = range(1, whole.ticks + (1 if whole.status == "HALTED" else 0))
    if len(running) <= most:
        return list(running)
    turns = [tick for tick in whole.turns if tick in running]
    spread = [running[0], running[-1]]
    spread += [running[round(i * (len(running) - 1) / most)] for i in range(1, most)]
    return sorted(dict.fromkeys([*turns, *spread][:most]))
