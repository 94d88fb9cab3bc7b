"""Checks installed packages by their metadata: presence, bounds, tested versions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from momantu_bt.diagnosis import Diagnosis

DISTRIBUTION = "momantu-bt"
EXTRAS = {"": "packages", "skills": "packages for skills", "worlds": "packages for worlds"}

_REQUIREMENT = re.compile(
    r"(?P<name>[A-Za-z0-9._-]+)(\[[^]]*\])?\s*(?P<bounds>[^;]*)(;(?P<if>.*))?"
)
_EXTRA = re.compile(r"extra\s*==\s*['\"](?P<extra>[^'\"]+)['\"]")


@dataclass(frozen=True, slots=True)
class Requirement:
    """name of a package, bounds such as `>=14.0,<15`, and the extra that asks for it (or "")."""

    name: str
    bounds: str
    extra: str

    def allows(self, having: str) -> bool:
        """Whether a version lies within the bounds; only `>=`, `<` and `==` are understood."""
        number = release(having)
        for bound in filter(None, (part.strip() for part in self.bounds.split(","))):
            operator = bound.rstrip("0123456789.+abrc")
            wanted = release(bound[len(operator) :])
            holds = {">=": number >= wanted, "<": number < wanted, "==": number == wanted}
            if not holds.get(operator.strip(), True):
                return False
        return True


def release(text: str) -> tuple[int, ...]:
    """`2.13.0+cpu` -> (2, 13); trailing zeros do not count."""
    numbers = [int(n) for n in re.findall(r"\d+", re.split(r"[+abr]", text, maxsplit=1)[0])]
    while numbers and numbers[-1] == 0:
        numbers.pop()
    return tuple(numbers)


def packages() -> Iterator[Diagnosis]:
    """One diagnosis per group of dependencies: the core, and each extra."""
    wanted = requirements(requires(DISTRIBUTION) or [])
    tested = tested_versions()
    for extra, name in EXTRAS.items():
        mine = [one for one in wanted if one.extra == extra]
        yield judge(name, extra, mine, {one.name: _installed(one.name) for one in mine}, tested)


def judge(
    name: str,
    extra: str,
    wanted: list[Requirement],
    having: dict[str, str | None],
    tested: dict[str, str],
) -> Diagnosis:
    """Compare the required versions with the installed ones; an extra may be missing as a whole."""
    missing = [one.name for one in wanted if having[one.name] is None]
    wrong = [
        f"{one.name} {found} (wanted {one.bounds})"
        for one in wanted
        if (found := having[one.name]) is not None and not one.allows(found)
    ]
    if extra and len(missing) == len(wanted):
        return Diagnosis(name, True, "not installed: trees can be checked and shown, not run")
    if missing or wrong:
        parts = [f"missing: {', '.join(missing)}"] if missing else []
        parts += [f"wrong version: {', '.join(wrong)}"] if wrong else []
        target = f"{DISTRIBUTION}[{extra}]" if extra else DISTRIBUTION
        cure = f"`pip install '{target}'`, in a checkout `make setup`"
        return Diagnosis(name, False, "; ".join(parts), cure)
    other = [
        f"{one.name} {having[one.name]} (tested: {tested[one.name]})"
        for one in wanted
        if one.name in tested and release(having[one.name] or "") != release(tested[one.name])
    ]
    detail = f"other than tested: {', '.join(other)}" if other else f"{len(wanted)} as tested"
    return Diagnosis(name, True, detail)


def requirements(lines: list[str]) -> list[Requirement]:
    """Read `Requires-Dist` lines; leave out extras that ask for extras of the distribution."""
    found: list[Requirement] = []
    for line in lines:
        match = _REQUIREMENT.match(line)
        if match is None or match["name"] == DISTRIBUTION:
            continue
        extra = _EXTRA.search(match["if"] or "")
        found.append(
            Requirement(match["name"], match["bounds"].strip(), extra["extra"] if extra else "")
        )
    return found


def tested_versions() -> dict[str, str]:
    """Versions of constraints.txt by package name; it lies in the package or in the checkout."""
    package = Path(__file__).resolve().parents[1]
    for folder in (package, package.parent):
        file = folder / "constraints.txt"
        if file.is_file():
            lines = file.read_text(encoding="utf-8").splitlines()
            pairs = [line.split("==") for line in lines if "==" in line and line[0] != "#"]
            return {name.lower().replace("_", "-"): number for name, number in pairs}
    return {}


def _installed(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
