"""A service's description, for the terminal and for programs."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from momantu_bt.descriptions.tunables import TUNABLES, Tunable, Tunables, groups_of, tunables_of
from momantu_bt.service import Service
from momantu_bt.values.types import label


def as_text(name: str, service: type[Service]) -> str:
    """For the terminal."""
    lines = [f"{name}: {inspect.getdoc(service) or ''}"]
    if service.publishes:
        lines += ["", "Trees read"]
        lines += [f"  $@{name}.{key}: {label(kind)}" for key, kind in service.publishes.items()]
    lines += ["", f"Rate      {service.rate:g} Hz"]
    lines += [f"Needs     {', '.join(service.needs) or 'no other service'}"]
    lines += [f"Senses    {', '.join(service.senses) or 'no kind of sensor in particular'}"]
    tunables = list(_tunables(name))
    if tunables:
        lines += ["", f"A world file sets, under `site.services.{name}`"]
        lines += [f"  {_line(each)}" for each in tunables]
    return "\n".join(lines)


def as_data(name: str, service: type[Service]) -> dict[str, Any]:
    """For programs, as JSON."""
    return {
        "name": name,
        "doc": inspect.getdoc(service) or "",
        "publishes": {key: label(kind) for key, kind in service.publishes.items()},
        "rate": service.rate,
        "needs": list(service.needs),
        "senses": list(service.senses),
        "tunables": [asdict(each) for each in _tunables(name)],
    }


def _tunables(name: str) -> Iterator[Tunable]:
    if name in TUNABLES:
        yield from _all(TUNABLES.load(name), "")


def _all(kind: type[Tunables], before: str) -> Iterator[Tunable]:
    for each in tunables_of(kind):
        yield Tunable(before + each.name, each.unit, each.default, each.range, each.meaning)
    for group, inner in groups_of(kind):
        yield from _all(inner, f"{before}{group}.")


def _line(each: Tunable) -> str:
    unit = f" {each.unit}" if each.unit else ""
    limits = f"; {each.range}" if each.range else ""
    return f"{each.name}: {each.meaning} (default {each.default}{unit}{limits})"
