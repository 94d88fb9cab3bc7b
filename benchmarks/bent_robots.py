"""How exactly `calibrate robot` makes bent robots straight again.

    python benchmarks/bent_robots.py --robots 20
    python benchmarks/bent_robots.py --robots 20 --robot kinova_jackal --stands 12 --way 0.3

Invented views of robots that are not as their descriptions say: 40 views, corners with noise of
0.2 pixels, a tag on the hand (a camera on the arm needs none), four that stand around, four stands.
A camera on the arm tells where the arm is on the base only as far as the base drives.
The error is how far the hand is from its place in the camera's frame, in 60 other postures; with a
camera on the arm, how far a point half a metre before the camera is from its place on the base.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from momantu_skills.calibration.robot.estimate import Calibrated, Settings, calibrate
from momantu_skills.calibration.robot.parameters import columns, mounted
from momantu_skills.calibration.robot.rows import read_rows

from momantu_bt.geometry import Array
from momantu_bt.robot import RobotDescription
from momantu_bt.robots.plugins import load_robot
from tests.skills.scenery.bent import Bent, Measuring, write

GOAL = 0.25, 0.004
"""Of the error before, and m."""
ENOUGH = 0.001
"""m; where nothing was off by much before, so much may be after."""


def turn(rng: np.random.Generator, degrees: float) -> tuple[float, float, float]:
    """A turn about a random axis, rad."""
    axis = rng.normal(size=3)
    x, y, z = (float(v) for v in np.radians(degrees) * axis / np.linalg.norm(axis))
    return x, y, z


def one_joint(robot: RobotDescription, rng: np.random.Generator) -> Bent:
    joints = robot.groups["arm"].joints
    return Bent(zeros={str(rng.choice(joints)): float(rng.choice([-0.03, 0.03]))})


def camera(robot: RobotDescription, rng: np.random.Generator) -> Bent:
    return Bent(turn=turn(rng, 2.0))


def wheel(robot: RobotDescription, rng: np.random.Generator) -> Bent:
    return Bent(wheels=(1.02, 1.0))


def everything(robot: RobotDescription, rng: np.random.Generator) -> Bent:
    joints = robot.groups["arm"].joints
    zeros = {joint: float(rng.choice([-0.02, 0.02])) for joint in joints}
    return Bent(zeros=zeros, turn=turn(rng, 2.0), wheels=(1.02, 1.0))


KINDS: dict[str, Callable[[RobotDescription, np.random.Generator], Bent]] = {
    "one joint of the arm by 0.03 rad": one_joint,
    "the camera turned by 2 degrees": camera,
    "one wheel too large by 2 %": wheel,
    "all joints by 0.02 rad, the camera and a wheel": everything,
}


def errors(measuring: Measuring, found: Calibrated | None, count: int = 60) -> Array:
    """How far a point is from where the robot believes it, m, in new postures."""
    postures = (
        measuring.positions(count) if not measuring.robot.eye_in_hand else _free(measuring, count)
    )
    believed, mount = postures.copy(), np.eye(4)
    if found is not None:
        told, joints = found.solution.state.told, found.parameters.joints
        believed[:, columns(joints, measuring.joints)] += told[: len(joints)]
        mount = mounted(told[found.parameters.mount]).matrix
    eye = columns(measuring.camera.names, measuring.joints)
    here = measuring.camera.matrices(believed[:, eye]) @ mount
    there = measuring.base_from_camera(postures)
    if measuring.robot.eye_in_hand:
        ahead = np.array([0.0, 0.0, 0.5, 1.0])
        return np.asarray(np.linalg.norm((here - there) @ ahead, axis=1))
    at = columns(measuring.hand.names, measuring.joints)
    true = measuring.hand.matrices(measuring.true(postures)[:, at])
    off = (
        np.linalg.inv(here) @ measuring.hand.matrices(believed[:, at]) - np.linalg.inv(there) @ true
    )
    return np.asarray(np.linalg.norm(off[:, :3, 3], axis=1))


def _free(measuring: Measuring, count: int) -> Array:
    """Postures of a robot with a camera on the arm: anywhere in its joints' limits."""
    limits = [measuring.robot.joint_limits[name] for name in measuring.joints]
    low = [-np.pi if each.lower is None else each.lower for each in limits]
    high = [np.pi if each.upper is None else each.upper for each in limits]
    return np.asarray(measuring.random.uniform(low, high, (count, len(limits))))


def measure(robot: RobotDescription, kind: str, given: argparse.Namespace, folder: Path) -> str:
    """A row of the table."""
    before, after, good, robots = [], [], 0, given.robots
    for seed in range(robots):
        bent = KINDS[kind](robot, np.random.default_rng(seed))
        measuring = Measuring(robot, bent, seed, stands=given.stands, there_and_back=given.way)
        rows = read_rows(write(folder / "views.jsonl", measuring.rows(40)))
        found = calibrate(rows, robot, Settings())
        before.append(float(np.median(errors(measuring, None))))
        after.append(errors(measuring, found))
        middle = float(np.median(after[-1]))
        good += middle <= max(GOAL[0] * before[-1], ENOUGH) and middle <= GOAL[1]
    middles, worst = [np.median(each) for each in after], max(each.max() for each in after)
    return (
        f"| {robot.name} | {kind} | {1e3 * np.median(before):.1f} mm | "
        f"{1e3 * np.median(middles):.2f} mm | {1e3 * worst:.1f} mm | {good} of {robots} |"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--robots", type=int, default=20, help="bent robots of each kind")
    parser.add_argument("--robot", default="fetch", help="which robot is bent")
    parser.add_argument("--stands", type=int, default=4, help="how many stands of the base")
    parser.add_argument(
        "--way", type=float, help="m from stand to stand, ahead and back in turn (10 cm ahead)"
    )
    given = parser.parse_args(arguments)
    robot = load_robot(given.robot)
    print("| robot | what is wrong | before | after | largest after | reach the goal |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for kind in KINDS:
            print(measure(robot, kind, given, Path(folder)), flush=True)


if __name__ == "__main__":
    main()
