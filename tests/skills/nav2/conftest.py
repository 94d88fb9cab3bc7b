"""Nav2's leaves in the flat world of navigation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from momantu_skills.nav2.service import Nav2Service
from momantu_skills.navigation.localize.service import LocalizationService

from momantu_bt.skill import Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.testing.skill_run import SkillResult, run_skill
from tests.skills.scenery.flat import FlatSceneOf

Act = Callable[..., SkillResult]


@pytest.fixture
def act(flat_scene: FlatSceneOf) -> Act:
    """`act(Kind, world, **inputs)`: with localization, a planning scene and the nav2 service."""

    def run(
        kind: type[Skill],
        world: ScriptedWorld,
        *,
        nav2: Nav2Service | None = None,
        on_tick: Any = None,
        max_time: float = 90.0,
        **inputs: Any,
    ) -> SkillResult:
        services = {
            "localization": LocalizationService(),
            "planning_scene": flat_scene(world),
            "nav2_servers": nav2 or Nav2Service(),
        }
        return run_skill(
            kind, world=world, services=services, inputs=inputs, max_time=max_time, on_tick=on_tick
        )

    return run
