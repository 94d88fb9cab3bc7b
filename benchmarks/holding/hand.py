"""One world in which states of the hand are made and asked for."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
from momantu_skills.check import Check
from momantu_skills.manipulation.scene.payload import Payload
from momantu_skills.manipulation.scene.service import PlanningSceneService
from momantu_skills.perception.camera.aiming import aim
from momantu_worlds.robots import fetch, kinova_jackal
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Part
from momantu_worlds.scenes.geometry.solids import PlacedBody, Scene
from momantu_worlds.testing import plain_episode

from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.messages import GripperCommand
from momantu_bt.robot import WristWrench
from momantu_bt.skill import Skill
from momantu_bt.testing import SkillResult, run_skill

ROBOTS = {"fetch": fetch, "kinova_jackal": kinova_jackal}
FORCE = 45.0
"""Closing force, N, as in `pick`."""
TOUCH = 0.5
"""Force of the fingers on a thing from which they touch it, N."""
FARAWAY = Transform((-6.0, 0.0, 0.2))
PADS = (7, 11, 5)
"""Points along, across and up at which the space between the pads is looked at."""
BESIDE = 0.02
"""How far beyond the pads a held thing may be, m."""
SPREAD = 0.12
"""Random change of the arm's joints, rad."""
HEAD = {"head_pan_joint": (-1.2, 1.2), "head_tilt_joint": (-0.3, 0.9)}


class Hand:
    """One world in which states of the hand are made and asked for."""

    def __init__(self, robot: str, seed: int, *, wrist: bool = True) -> None:
        """wrist: whether the robot keeps its sensor of the load on the wrist."""
        self.random = np.random.default_rng([seed, len(robot)])
        description = ROBOTS[robot]()
        if not wrist:
            kept = {n: s for n, s in description.sensors.items() if not isinstance(s, WristWrench)}
            description = description.model_copy(update={"sensors": kept})
        episode = plain_episode()
        self.things = dict(_things(self.random))
        bodies = [*(b for b in episode.bodies if b.name != "can"), *self.things.values()]
        episode = dataclasses.replace(episode, bodies=tuple(bodies))
        self._carry = dict(description.named_poses["carry"])
        self.simulator = Simulator(description, episode, seed, pose=self._carry)
        self.simulator.truth.watch_contacts()
        self.site, self.name = episode.site, "hand"
        self.hand = description.hand
        self.scene = PlanningSceneService()
        beliefs = SimpleNamespace(map_from_base=Pose2D(0, 0), covariance=np.eye(3), quality=1.0)
        self.services = {"planning_scene": self.scene, "localization": beliefs}
        started = self.ask(Check, None, what="gripper_open")
        self.frames: FrameBuffer = started.skill.frames
        self.ticks(110)
        self._empty = self.scene.payload

    @property
    def robot(self) -> Any:
        """The robot's driver."""
        return self.simulator.robot

    def now(self) -> float:
        """Seconds since the world began."""
        return self.simulator.now()

    def step(self) -> None:
        """Advance by one tick."""
        self.simulator.step()

    def ask(self, skill: type[Skill], frames: FrameBuffer | None, **inputs: Any) -> SkillResult:
        """Run a skill here."""
        return run_skill(skill, world=self, inputs=inputs, services=self.services, frames=frames)

    def ticks(self, count: int, each: Callable[[], None] = lambda: None) -> None:
        """Let time pass; each: called before every tick."""
        for _ in range(count):
            each()
            self.simulator.step()
            self.frames.add_state(self.robot.state())
            self.scene.update(self.robot, self.now())

    # making states

    def begin(self) -> None:
        """Open the hand, take everything away, go to another posture near `carry`."""
        for name in self.things:
            self.away(name)
        self.blocked(None)
        pose = self._carry
        for _ in range(50):
            tried = {n: q + SPREAD * self.random.standard_normal() for n, q in self._carry.items()}
            tried = {n: self._within(n, q) for n, q in tried.items()}
            group = self.scene.scene.model.group.names
            world = self.scene.scene.world(self.robot.state(), None, 0.02)
            if world.free(np.array([tried.get(n, 0.0) for n in group])):
                pose = tried
                break
        looking = self.random.random()
        if "head_pan_joint" in pose and looking < 0.35:
            pose = {**pose, **{n: self.random.uniform(*ends) for n, ends in HEAD.items()}}
        elif "head_pan_joint" in pose and looking < 0.65:
            names = tuple(HEAD)
            kinematics, limits = self.frames.kinematics, self.robot.description.joint_limits
            at = kinematics.base_from_frame(self.hand.frame, pose).position
            frame = self.robot.description.camera()[1].frame
            aimed = aim(kinematics, frame, names, limits, pose, at)
            pose = {**pose, **dict(zip(names, aimed.positions, strict=True))}
        self.robot._place(Pose2D(0.0, 0.0, 0.0), pose)
        self.scene.holding.release(self.now())
        self.scene.payload = self._empty
        if self.random.random() < 0.3:  # the empty hand's load has not been learned
            self.scene.payload = Payload(self.robot.description, self.frames)
        self.ticks(3)
        self.scene.payload._width = math.nan  # the hand was carried here

    def _within(self, joint: str, value: float) -> float:
        limit = self.robot.description.joint_limits[joint]
        low = -math.inf if limit.lower is None else limit.lower + 0.02
        high = math.inf if limit.upper is None else limit.upper - 0.02
        return float(np.clip(value, low, high))

    def away(self, name: str) -> None:
        """Take a thing out of reach."""
        place = Transform((0.0, 0.5 * list(self.things).index(name), 0.0))
        self.simulator.put(name, FARAWAY @ place)

    def map_from_grasp(self) -> Transform:
        """The place between the pads, as it is."""
        link = self.simulator.truth.link(self.hand.frame)
        return link @ Transform((self.hand.grasp_offset, 0.0, 0.0))

    def close(self, width: float = 0.0, force: float = FORCE) -> Callable[[], None]:
        """What commands an opening, m, once a tick."""
        goal = GripperCommand(width, min(force, self.hand.max_force))
        return lambda: self.robot.command(self.hand.actuator, goal)

    def blocked(self, width: float | None) -> None:
        """Keep the fingers from closing farther than an opening, m; None: free them."""
        limits = self.robot.description.joint_limits
        at = {} if width is None else self.hand.positions(width)
        shut = self.hand.positions(0.0)
        for name in self.hand.opening:
            low, high = limits[name].lower, limits[name].upper
            if name in at:
                low, high = (at[name], high) if shut[name] < at[name] else (low, at[name])
            joint = self.robot.gripper._fingers[name].joint
            joint.set_limits([[low, high]])

    def grasp(self, name: str, grasp_from_thing: Transform, *, on: bool = False) -> None:
        """Hold a thing in the hand until the fingers press on it, then let physics have it.

        on: it stands on a shelf, and upright.
        """
        there = self.map_from_grasp() @ grasp_from_thing
        if on:
            there = Transform(there.position)
            self.shelf(there.position, float(PlacedBody(self.things[name], there).lowest))
        pressed = 0

        def hold() -> None:
            self.simulator.put(name, there)
            shut()

        shut = self.close()
        for _ in range(16):
            self.ticks(3, hold)
            effort = self.scene.holding.fingers.effort
            pressed = pressed + 1 if effort > 0.7 * min(FORCE, self.hand.max_force) else 0
            if pressed >= 2:
                break
        self.ticks(14, shut)

    def shelf(self, at: Array, top: float, size: float = 0.2) -> None:
        """Put a shelf below a place (x, y, z), its top at a height."""
        part = Part(Box((size, size, 0.04)))
        pose = Transform((at[0], at[1], top - 0.02))
        self.simulator.add(Body("shelf", "shelf", pose, (part,)))

    # the truth

    def truth(self) -> bool | None:
        """Whether the hand holds something; None: it touches something that it does not hold."""
        touched, between = self._touched()
        if self._held(touched, between):
            return True
        return None if between or touched else False

    def weight(self) -> float:
        """Weight of what it holds, N."""
        return sum(9.81 * self.things[name].mass for name in self._held(*self._touched()))

    def _held(self, touched: Counter[str], between: set[str]) -> set[str]:
        """What the fingers press on between the pads, and what they carry otherwise."""
        pressed = {name for name, force in touched.items() if force > TOUCH}
        contacts = self.simulator.truth.contacts()
        alone = self.simulator.truth.robot_links | self.things.keys()
        stands = {c.first for c in contacts if c.second not in alone}
        stands |= {c.second for c in contacts if c.first not in alone}
        return {name for name in pressed if name in between or name not in stands}

    def _touched(self) -> tuple[Counter[str], set[str]]:
        """The force on each thing that the hand touches, N, and what is between the pads."""
        touched: Counter[str] = Counter()
        for contact in self.simulator.truth.contacts():
            if contact.first in self.hand.touch_links and contact.second in self.things:
                touched[contact.second] += contact.force
        hand, width = self.hand, self.robot.state().gripper_width
        half = np.array([hand.pad_length / 2 + BESIDE, width / 2, hand.pad_height / 2 + BESIDE])
        axes = [np.linspace(-h, h, n) for h, n in zip(half, PADS, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        points = self.map_from_grasp().apply(grid)
        scene = Scene(self.things, self.simulator.truth.pose)
        return touched, {n for n in self.things if scene.body(n).inside(points).any()}


def _things(random: np.random.Generator) -> Iterator[tuple[str, Body]]:
    """Cans, a bottle, boxes and a card, of random sizes, weights and friction."""
    w, h = random.uniform(0.025, 0.085), random.uniform(0.08, 0.2)
    shapes: dict[str, Any] = {
        "can": Cylinder(0.035, 0.13),
        "other": Cylinder(w / 2, h),
        "slim": Cylinder(random.uniform(0.008, 0.02), random.uniform(0.1, 0.2)),
        "box": Box((random.uniform(0.03, 0.08), random.uniform(0.03, 0.08), h)),
        "card": Box((0.10, random.uniform(0.004, 0.01), 0.12)),
    }
    for number, (name, shape) in enumerate(shapes.items()):
        mass = 0.4 if name == "can" else float(np.exp(random.uniform(*np.log((0.04, 1.0)))))
        pose = FARAWAY @ Transform((0.0, 0.5 * number, 0.0))
        part = Part(shape, color=tuple(random.uniform(0.05, 0.95, 3)))
        yield name, Body(name, "thing", pose, (part,), False, mass, random.uniform(0.4, 1.0))
