"""How far a run is from the fastest that its robot could have done along the same way.

    python benchmarks/floor.py --seeds 0:20

Of each tick that counts which its motion would have taken with every joint at its speed limit at
once: the base along its path and round its turns, the arm and the camera between the postures
they went through, the fingers. Their sum is the floor: no acceleration, no thinking, no looking,
no feeling, nothing waited for. What is above it is told by what the tree was doing.
"""

from __future__ import annotations

import argparse
import collections
import statistics
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

import momantu_bt
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.skill_leaf import SkillLeaf
from momantu_bt.engine.status import RUNNING
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import RobotState
from momantu_bt.robot import RobotDescription

NOISE = 1e-3
"""rad or m that a joint may seem to move in a tick while it stands."""
MOTIONS = ("base", "joints", "fingers")


@dataclass
class Floor:
    """Observer: adds up, for one run, the seconds that each tick's motion needs at least.

    of: by what moved slowest. above: seconds beyond the floor, by skill.
    """

    total: float = 0.0
    of: collections.Counter[str] = field(default_factory=collections.Counter)
    above: collections.Counter[str] = field(default_factory=collections.Counter)
    _last: RobotState | None = None

    def ticked(self, run: Executor) -> None:
        """Compare the state with the one before."""
        assert run.world is not None
        state, last = run.world.robot.state(), self._last
        self._last = state
        if last is None or run.settling:
            return
        seconds = needed(last, state, run.world.robot.description)
        slowest = int(np.argmax(seconds))
        self.total += seconds[slowest]
        self.of[MOTIONS[slowest]] += seconds[slowest]  # type: ignore[assignment]
        skill = next(
            (n.name for n in run.built.nodes if isinstance(n, SkillLeaf) and n.state is RUNNING),
            "between skills",
        )
        self.above[skill] += state.stamp - last.stamp - seconds[slowest]  # type: ignore[assignment]

    def close(self) -> None:
        """Nothing is open."""


def needed(before: RobotState, after: RobotState, robot: RobotDescription) -> tuple[float, ...]:
    """Seconds at the speed limits, of MOTIONS, for getting from one state to another."""
    way = Pose2D.from_transform(before.odom_from_base.inverse() @ after.odom_from_base)
    base = max(np.hypot(way.x, way.y) / robot.base.linear, abs(way.yaw) / robot.base.angular)
    moved = np.abs(after.positions - before.positions)
    limits = np.array([robot.joint_limits[name].velocity for name in after.names])
    joints = float(np.max(np.where(moved > NOISE, moved, 0.0) / limits))
    finger = robot.actuators[robot.end_effector.actuator].joints
    opened = abs(after.gripper_width - before.gripper_width)
    speed = sum(robot.joint_limits[name].velocity for name in finger)
    return float(base), joints, float(opened > 2 * NOISE) * opened / speed


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the seeds and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tree", default="bring_object")
    parser.add_argument("--seeds", default="0:20", help="first:end, end not included")
    told = parser.parse_args(arguments)
    first, end = (int(part) for part in told.seeds.split(":"))
    rows: list[tuple[float, Floor]] = []
    for seed in range(first, end):
        floor = Floor()
        report = momantu_bt.run(told.tree, seed=seed, watch=lambda _, floor=floor: [floor])
        if report.success:
            rows.append((report.sim_time_s, floor))
        print(f"seed {seed}: {report.sim_time_s:.1f} s, floor {floor.total:.1f} s", flush=True)
    times = statistics.median(time for time, _ in rows)
    floors = statistics.median(floor.total for _, floor in rows)
    print(f"\nmedian of {len(rows)} successes: {times:.1f} s; floor {floors:.1f} s", end="")
    print(f" ({floors / times:.0%})")
    for motion in MOTIONS:
        print(f"  {statistics.median(f.of[motion] for _, f in rows):6.1f} s floor of {motion}")
    skills = sorted({skill for _, floor in rows for skill in floor.above})
    for skill in sorted(skills, key=lambda s: -statistics.median(f.above[s] for _, f in rows)):
        print(f"  {statistics.median(f.above[skill] for _, f in rows):6.1f} s above it in {skill}")


if __name__ == "__main__":
    main()
