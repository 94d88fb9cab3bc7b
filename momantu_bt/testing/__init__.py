"""The test kit for skills and trees: `run_skill`, `check_skill`, scripted robots and worlds.

result = run_skill(Nod, robot=ScriptedRobot(), inputs={"angle": 0.2})
assert result.status == "SUCCESS" and result.phases == ("down", "up")
assert_skill(Nod)
"""

from momantu_bt.formats.problems import Problem
from momantu_bt.testing.check import assert_skill, check_skill
from momantu_bt.testing.description import armless_robot, small_robot
from momantu_bt.testing.example_world import ExampleWorld
from momantu_bt.testing.eye_in_hand import eye_in_hand_robot
from momantu_bt.testing.robot import ScriptedRobot
from momantu_bt.testing.service_check import assert_service, check_service
from momantu_bt.testing.skill_run import SkillResult, run_skill
from momantu_bt.testing.world import ManualClock, ScriptedWorld, scripted_site

__all__ = [
    "ExampleWorld",
    "ManualClock",
    "Problem",
    "ScriptedRobot",
    "ScriptedWorld",
    "SkillResult",
    "armless_robot",
    "assert_service",
    "assert_skill",
    "check_service",
    "check_skill",
    "eye_in_hand_robot",
    "run_skill",
    "scripted_site",
    "small_robot",
]
