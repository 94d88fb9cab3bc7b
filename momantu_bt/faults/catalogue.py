"""Every kind of fault, by its name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from momantu_bt.faults import rows_robot, rows_software, rows_world
from momantu_bt.faults.kind import FaultKind

KINDS: Mapping[str, FaultKind] = MappingProxyType(
    {kind.name: kind for kind in (*rows_robot.KINDS, *rows_world.KINDS, *rows_software.KINDS)}
)
"""By `component.mode`."""
