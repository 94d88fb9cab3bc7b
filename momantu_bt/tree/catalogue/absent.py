"""Nodes of Nav2 that exist nowhere here, and why: the hint of an unknown node."""

from __future__ import annotations

from collections.abc import Mapping

_ROUTE = "it needs Nav2's route server and a graph of routes, and a site here has none"
_DOCK = "it needs Nav2's docking server and a dock, and no world here has one"
_TELEOP = "it needs somebody who steers, and nothing here takes commands for the base"
_FOLLOW = "it needs Nav2's following server, which tracks a moving object"
_BATTERY = (
    "no robot here reports a battery; if a service of yours publishes its charge, write a "
    "condition on that, such as <ScriptCondition code=…/>, or `condition: $@battery.charge < 0.2`"
)

ABSENT: Mapping[str, str] = {
    "AssistedTeleop": _TELEOP,
    "CancelAssistedTeleop": _TELEOP,
    "CancelComputeAndTrackRoute": _ROUTE,
    "CancelFollowObject": _FOLLOW,
    "ComputeAndTrackRoute": _ROUTE,
    "ComputeRoute": _ROUTE,
    "DockRobot": _DOCK,
    "ExtractRouteNodesAsGoals": _ROUTE,
    "FollowObject": _FOLLOW,
    "IsBatteryCharging": _BATTERY,
    "IsBatteryLow": _BATTERY,
    "PauseResumeController": "it needs services that pause and resume; a run here has none",
    "ToggleCollisionMonitor": "the base always brakes before what its laser sees",
    "UndockRobot": _DOCK,
    "WouldARouteRecoveryHelp": _ROUTE,
}
"""Why each node is absent, as the rest of a sentence that begins with its name."""


def why_absent(name: str) -> str | None:
    """Why a node of Nav2 is absent; None for other names."""
    reason = ABSENT.get(name)
    return None if reason is None else f"{name} is a node of Nav2: {reason}"
