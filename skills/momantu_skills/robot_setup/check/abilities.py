"""Which installed skills a robot cannot run, and what it lacks for them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_bt.lacking import lacking
from momantu_bt.plugins import PREFIX, Group, PluginError
from momantu_bt.robot import RobotDescription
from momantu_skills.robot_setup.find.base import Stand

SKILLS: Group[Any] = Group(f"{PREFIX}skills", "skill")
SERVICES: Group[Any] = Group(f"{PREFIX}services", "service")
"""The framework has these groups too, above what skills may import."""
ROLLS = re.compile(r"wheel|track|caster|tyre|tire|roller", re.IGNORECASE)
"""Names of links that roll where the URDF has no joint that turns them."""
NAMED = 8
"""Most skills that a finding names."""


def check_abilities(
    description: RobotDescription, stand: Stand, *, virtual: bool
) -> Iterator[FindingAtKeys]:
    """What the robot lacks, with the skills that cannot run; what it has and cannot move by.

    virtual: the URDF has joints of its own that move the base.
    """
    unable: dict[str, list[str]] = {}
    for name, lack in _lacks(description):
        unable.setdefault(lack, []).append(name)
    for lack, names in unable.items():
        yield FindingAtKeys(
            Severity.WARNING,
            "cannot-run",
            f"the robot lacks {lack}: these skills cannot run: {_listed(names)}",
            "describe it if the robot has one; `momantu-bt check` refuses trees with these skills",
            ("sensors",) if lack.startswith("a ") else ("actuators",),
        )
    rolls = stand.wheels or any(ROLLS.search(link) for link in stand.fixed)
    if "base" in description.actuators and not rolls and not virtual:
        names = [name for name, kind in _skills() if "base" in kind.uses]
        yield FindingAtKeys(
            Severity.WARNING,
            "nothing-rolls",
            "nothing that rolls was found in the URDF: the actuator `base` moves the robot in "
            f"simulation only, and with it {_listed(names)}",
            "leave `base` out of `actuators` if the robot stands still",
            ("actuators", "base"),
        )
    if description.simulation is None:
        yield FindingAtKeys(
            Severity.WARNING,
            "not-simulated",
            "the robot cannot be simulated: no skill runs in a world that simulates",
            "give `base: {drive: {force: N, torque: Nm}}` and the section `simulation`",
            ("base",),
        )


def _listed(names: list[str]) -> str:
    more = len(names) - NAMED
    return ", ".join(names[:NAMED]) + (f" and {more} more" if more > 0 else "")


def _skills() -> Iterator[tuple[str, Any]]:
    """The installed skills that are not broken, the plainly named ones first."""
    for name in sorted(SKILLS, key=lambda name: (not name.islower(), name)):
        try:
            yield name, SKILLS[name]
        except PluginError:
            continue


def _lacks(description: RobotDescription) -> Iterator[tuple[str, str]]:
    """(skill, what it lacks) of every installed skill."""
    services: Mapping[str, Any] = SERVICES
    for name, kind in _skills():
        try:
            yield from ((name, lack) for lack in lacking(kind, services, description))
        except PluginError:
            continue
