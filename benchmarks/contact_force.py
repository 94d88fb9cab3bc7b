"""How hard an arm pushes before it notices a wall that it did not know, by speed.

    python benchmarks/contact_force.py

A joint of Fetch's arm swings the rest of it at a hard wall, as slowly and as fast as motions are.
Once the motors are watched (`momantu_skills/manipulation/motion/strain.py`, which feels only in
slow motions), once the arm presses on until its trajectory ends. The largest force is that of the
blow, which no watching makes less; the lasting one is the least within 0.25 s, at its largest.
"""

from __future__ import annotations

import dataclasses
import sys
from dataclasses import dataclass

import numpy as np
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.model.arm_model import arm_model
from momantu_skills.manipulation.motion.following import efforts_of
from momantu_skills.manipulation.motion.strain import Strain, slow
from momantu_skills.manipulation.motion.timing import timed
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.testing import WALL_FACE, plain_episode
from numpy.lib.stride_tricks import sliding_window_view

from momantu_bt.geometry import Pose2D
from momantu_bt.messages import JointTrajectory
from momantu_bt.world import TICK

SPEEDS = (0.1, 0.2, 0.4, 0.8)
AFTER = 10
"""Ticks after the end of the trajectory."""
LASTING = 5
"""Ticks for which a force lasts."""
POSTURES = {
    "shoulder": ({"shoulder_pan_joint": 1.3}, "shoulder_pan_joint", -1.3, 0.9),
    "elbow": (
        {"shoulder_pan_joint": 0.6, "elbow_flex_joint": -1.5, "upperarm_roll_joint": 1.57},
        "elbow_flex_joint",
        1.5,
        0.85,
    ),
    "wrist": (
        {"shoulder_pan_joint": 0.9, "wrist_flex_joint": 1.5, "forearm_roll_joint": 1.57},
        "wrist_flex_joint",
        -1.9,
        0.76,
    ),
}
"""Joints in rad, the joint that swings, by how much in rad, distance of the wall in m."""


@dataclass(frozen=True)
class Force:
    """The largest force on the wall, and the largest that lasts for `LASTING` ticks, N."""

    largest: float
    lasting: float


def pushed(
    pose: dict[str, float], joint: str, turn: float, gap: float, speed: float, *, watched: bool
) -> Force:
    """How hard the wall is pushed."""
    description = fetch()
    group = arm_model(description).group
    episode = dataclasses.replace(
        plain_episode(table=False), start=Pose2D(WALL_FACE - gap, 0.0, 0.0)
    )
    still = dict.fromkeys(group.names, 0.0)
    full = {**description.named_poses["carry"], **still, "torso_lift_joint": 0.3, **pose}
    simulator = Simulator(description, episode, 0, render=False, pose=full)
    try:
        simulator.truth.watch_contacts()
        start = np.array([simulator.robot.state().position(name) for name in group.names])
        end = start.copy()
        end[group.names.index(joint)] += turn
        path = np.array([start, end])
        trajectory = timed(group, path, PlanningConfig(), joint_speed=speed)
        return _measured(simulator, trajectory, watched=watched)
    finally:
        simulator.close()


def _measured(simulator: Simulator, trajectory: JointTrajectory, *, watched: bool) -> Force:
    strain = Strain(arm_model(fetch()).efforts)
    forces, stopped = [0.0] * LASTING, False
    for _ in range(int(trajectory.duration / TICK) + AFTER):
        robot = simulator.robot
        felt = strain.felt(efforts_of(robot, trajectory.names))
        if watched and not stopped and slow(trajectory) and felt is not None:
            robot.stop("arm")
            stopped = True
        if not stopped:
            robot.command("arm", trajectory)
        simulator.step()
        found = [c.force for c in simulator.truth.contacts() if c.second == "wall"]
        forces.append(max(found, default=0.0))
    lasting = sliding_window_view(np.array(forces), LASTING).min(axis=1)
    return Force(max(forces), float(lasting.max()))


def main() -> int:
    """Print one line for each posture and speed."""
    print(f"{'':16}{'':>8}{'pressing on, N':>22}{'watched, N':>22}")
    print(f"{'':16}{'rad/s':>8}" + f"{'largest':>12}{'lasting':>10}" * 2)
    for name, (pose, joint, turn, gap) in POSTURES.items():
        for speed in SPEEDS:
            both = (pushed(pose, joint, turn, gap, speed, watched=w) for w in (False, True))
            figures = "".join(f"{each.largest:12.0f}{each.lasting:10.0f}" for each in both)
            print(f"{name:16}{speed:8.1f}{figures}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
