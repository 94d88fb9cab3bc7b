"""For tests of skills: a robot that does what the test scripts, and `run_skill`.

result = run_skill(Nod, robot=ScriptedRobot(), inputs={"angle": 0.2})
assert result.status == "SUCCESS" and result.phases == ("down", "up")
"""

from momantu_bt.testing.clock import ManualClock
from momantu_bt.testing.description import small_robot
from momantu_bt.testing.robot import ScriptedRobot
from momantu_bt.testing.skill_run import SkillResult, run_skill
from momantu_bt.testing.world import ScriptedWorld, scripted_site

__all__ = [
    "ManualClock",
    "ScriptedRobot",
    "ScriptedWorld",
    "SkillResult",
    "run_skill",
    "scripted_site",
    "small_robot",
]
