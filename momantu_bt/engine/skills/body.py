"""The robot and what belongs to it, for the skills of a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.frames import FrameBuffer
from momantu_bt.skill import Skill
from momantu_bt.world import Site


@dataclass(frozen=True, slots=True)
class Body:
    """What skills need beside their inputs; absent in a run without a world.

    skills: those that skills may call by name.
    """

    actuators: Actuators
    frames: FrameBuffer
    site: Site
    services: Mapping[str, Any]
    skills: Mapping[str, type[Skill]] = field(default_factory=dict)
