"""The vehicle: where the base is and what it occupies, and the only code that commands it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias, cast

import numpy as np

from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.marker import Grid, Line
from momantu_bt.messages import BaseVelocity, JointPositions
from momantu_bt.robot import CAMERA_CARRIER, BaseLimits, Robot
from momantu_bt.service import HeldObject, Localization, offers
from momantu_bt.skill import Run, Skill
from momantu_bt.zone import ZoneKind
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.drive.body import Body, BodyScene
from momantu_skills.navigation.drive.caution import Caution
from momantu_skills.navigation.map.believed import believed_maps
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.own import OwnMap
from momantu_skills.perception.camera.aiming import aim

with lazily():
    from momantu_skills.navigation.control import footprint, guard
    from momantu_skills.navigation.drive import sight
    from momantu_skills.navigation.map import costmap, heights, rolling

GAZE = (2.0, 0.0, 0.1)
"""Point that the camera looks at while driving, base frame, m: two metres ahead, near the floor."""
POSTURE_CHANGE = 0.02
"""Joint motion after which the footprint is computed again, rad (or m)."""
OUTLINE_CHANGE = 0.01
"""Change of the footprint after which its discs are computed again, m."""
HANDS_OVER = 0.03
"""Height above a surface's nominal top from which arm and load count as being over it, m."""
PATH_HEIGHT = 0.03
"""Height above the floor at which a path is drawn, m."""
ZONE_COLORS: dict[ZoneKind, str] = {"keep_out": "red", "slow": "orange", "preferred": "green"}
"""Colours in which the outlines of zones are drawn."""
COSTLESS = 0.5
"""Clearance from which a cell is drawn as free, m."""
SHOWN = 3.0
"""Time for which a path and the costmap are shown, s; a base that drives plans more often."""
SLOW_NEAR = 2.5
"""Distance of slow zones whose limit manoeuvres expect, m: they are planned from not so far."""
AT_REST = 0.01
"""Speed below which the base counts as standing, m/s and rad/s."""


Speed: TypeAlias = tuple[float, float, float]
"""m/s ahead, rad/s, and m/s to the left."""


class Vehicle:
    """Sense once per control period and drive for one. Poses are in the map unless said otherwise.

    base_discs: discs of the base alone, which collides with every obstacle. low_discs: with the
    parts of arm and load that are lower than the surface that the base drives up to. discs: with
    all of arm and load. glides: whether the base drives sideways. sight: what it senses.
    """

    def __init__(
        self,
        skill: Skill,
        robot: Robot,
        localization: Localization,
        scene: BodyScene,
        config: NavigationConfig,
        top: float = 0.0,
        *,
        shared: costmap.Costmap | None = None,
        gazes: bool = True,
        goals: Sequence[tuple[float, float]] = (),
    ) -> None:
        """Start with an empty costmap, or with one that other vehicles see and clear too.

        A localization that makes the map itself has one of those. Without a map it is free until
        something is seen, and has room for ways to the goals.

        top: height of the surface that the base drives up to, m; the arm may reach over it.
        gazes: turn a head to the floor ahead while driving; the skill must use CAMERA_CARRIER.
        goals: points of the map to which it may drive, m.
        """
        description = robot.description
        self.config, self._limits = config, description.base
        self.glides = description.base.sideways > 0.0
        if shared is None and offers(localization, OwnMap):
            shared = cast(OwnMap, localization).costmap
        self.mapped = skill.site.map_file is not None or offers(localization, OwnMap)
        earlier = scene.low_things if shared is None else np.zeros((0, 2))
        self._top = top
        self.localization = localization
        self._skill, self._robot, self._scene = skill, robot, scene
        self._frames, self._clock = skill.frames, skill.clock
        self.costmap = self._own_costmap(goals) if shared is None else shared
        self.caution = Caution(self.costmap)
        self._slows = self.costmap.zones.slow
        outline = np.array(description.footprint)
        self.base_discs = self.low_discs = self.discs = footprint.discs(outline)
        self.half_width = footprint.half_width(outline)
        self._outline = self._low_outline = outline
        self._body = Body(scene, description.base)
        self._low = top + HANDS_OVER
        self._tall: tuple[GridMap, heights.Tall] | None = None
        self._posture: Array | None = None
        self._held: HeldObject | None = None
        self.sight = sight.Sight(skill, robot, scene, config, self.costmap, earlier)
        resolved = description.resolve_use(CAMERA_CARRIER) if self.sight.pictures else None
        self._head = None if description.eye_in_hand or not gazes else resolved
        self._gaze = self._gaze_goal()
        self.blocked_for = 0.0
        self.blocked_total = 0.0

    @property
    def limits(self) -> BaseLimits:
        """The base's limits here: near slow zones its top speed is theirs."""
        slowest = self.costmap.zones.slowest(self.pose(), SLOW_NEAR) if self._slows else math.inf
        if slowest >= self._limits.linear:
            return self._limits
        return self._limits.model_copy(update={"linear": slowest})

    def _own_costmap(self, goals: Sequence[tuple[float, float]]) -> costmap.Costmap:
        if self.mapped:
            return costmap.of_site(self._skill.site, self.config)
        here = self.pose()
        return rolling.unmapped(((here.x, here.y), *goals), self.config)

    def now(self) -> float:
        """Return the world's clock, s."""
        return self._clock.now()

    def pose(self) -> Pose2D:
        """Return the current `map_from_base`."""
        return self.map_from_odom() @ self.odom_from_base()

    def odom_from_base(self) -> Pose2D:
        """Return the current odometry."""
        return Pose2D.from_transform(self._robot.state().odom_from_base)

    def map_from_odom(self) -> Pose2D:
        """Return the newest result of localization."""
        return Pose2D.from_transform(self._frames.lookup(MAP, ODOM))

    def show(self, path: Array) -> None:
        """Draw a path (n, 2), the costmap and zones, if somebody watches; it changes nothing."""
        if not self._skill.host.watched:
            return
        points = _over_floor(path)
        costs = 1.0 - self.costmap.field / COSTLESS
        x, y, cell = (float(part) for part in self.costmap.frame)
        self._skill.draw(
            Line("path", points, frame=MAP, color="blue", width=0.05, seconds=SHOWN),
            Grid("costmap", costs, (x, y), cell, frame=MAP, color="purple", seconds=SHOWN),
            *(
                Line(
                    f"zone {name}",
                    _over_floor(corners),
                    frame=MAP,
                    closed=True,
                    color=ZONE_COLORS[kind],
                    width=0.05,
                    seconds=SHOWN,
                )
                for name, (kind, corners) in self.costmap.zones.outlines.items()
            ),
        )

    def speed(self) -> Speed:
        """Return the measured m/s ahead, rad/s, and m/s to the left."""
        state = self._robot.state()
        return state.linear, state.angular, state.lateral

    def sense(self, *, depth: bool = True) -> None:
        """Add a scan to the costmap, and a depth picture if the last one was taken far behind."""
        self._follow_footprint()
        self.sight.see(self.map_from_odom(), self._body, self.base_discs, depth=depth)

    def _follow_footprint(self) -> None:
        state = self._robot.state()
        before, held = self._posture, self._scene.held
        if before is not None and _moved_little(state.positions, before) and held is self._held:
            return
        if held is None and self._held is not None:
            self._beware()
        self._posture, self._held = state.positions, held
        self._body.follow(state)
        outline = np.asarray(self._scene.footprint(state))
        if not _same(outline, self._outline):
            self._outline, self.discs = outline, footprint.discs(outline)
            self.half_width = footprint.half_width(outline)
        low = np.asarray(self._scene.footprint(state, self._low))
        if not _same(low, self._low_outline):
            self._low_outline, self.low_discs = low, footprint.discs(low)

    def _beware(self) -> None:
        """Take over where what the hand has just lost may lie."""
        self.sight.earlier = self._scene.low_things

    def _gaze_goal(self) -> JointPositions | None:
        """Return where a head looks while driving; None for a camera on the arm or a fixed one."""
        description = self._robot.description
        if self._head is None:
            return None
        joints = description.actuators[self._head].joints
        aimed = aim(
            self._frames.kinematics,
            description.camera()[1].frame,
            joints,
            description.joint_limits,
            self._robot.state().joints(),
            np.array(GAZE),
        )
        return JointPositions(joints, aimed.positions)

    def allowed(self, linear: float, angular: float, lateral: float = 0.0) -> float:
        """Return the share of a command, as of `drive`, at which nothing is met; 0: none.

        The base must not meet a hit of the newest scan, nor what pictures showed beside it; arm and
        load nothing that stands at their height.
        """
        command, speed = (linear, angular, lateral), self.speed()
        hits = self.sight.near(self.map_from_odom())
        share = guard.safe_share(command, speed, self._limits, self.base_discs, hits)
        if share > 0.0:
            share = min(share, self._body.share(command, speed))
        if share > 0.0 and self.costmap.zones.keep_out:
            border = self.costmap.zones.border(self.pose())
            allowed = guard.safe_share(command, speed, self._limits, self.low_discs, border)
            share = min(share, allowed)
        return share

    def drive(self, linear: float, angular: float, phase: str, lateral: float = 0.0) -> Run:
        """Command the base for one control period, as far as `allowed` says.

        linear, angular, lateral: m/s ahead, rad/s, and m/s to the left of an omnidirectional base.
        """
        linear, angular, lateral = self._slowed((linear, angular, lateral))
        share = self.allowed(linear, angular, lateral)
        period = self.config.period
        stuck = share == 0.0 and (linear, angular, lateral) != (0.0, 0.0, 0.0)
        self.blocked_for = self.blocked_for + period if stuck else 0.0
        self.blocked_total += period if stuck else 0.0
        goal = BaseVelocity(linear * share, angular * share, lateral * share)
        yield from self._command(goal, phase)

    def _slowed(self, command: Speed) -> Speed:
        """The command at the speed that slow zones allow, on the same way."""
        if not self._slows:
            return command
        linear, angular, lateral = command
        fast = math.hypot(linear, lateral)
        most = self.costmap.zones.limit(
            self.pose(), self.low_discs, self._limits.linear_acceleration
        )
        if fast <= most:
            return command
        return linear * most / fast, angular * most / fast, lateral * most / fast

    def _command(self, goal: BaseVelocity, phase: str) -> Run:
        slot = self._slot()
        while self._slot() == slot:
            self._robot.command("base", goal)
            if self._gaze is not None and self._head is not None:
                self._robot.command(self._head, self._gaze)
            yield phase

    def _slot(self) -> int:
        return int(self.now() / self.config.period + 1e-6)

    def stop(self, phase: str) -> Run:
        """Brake and wait until the base stands, at most twice the braking time."""
        longest = 2.0 * max(
            self._limits.linear / self._limits.linear_acceleration,
            self._limits.angular / self._limits.angular_acceleration,
        )
        begun = self.now()
        while not self.stands() and self.now() < begun + longest:
            yield from self._command(BaseVelocity(0.0, 0.0), phase)

    def stands(self) -> bool:
        """Return whether the base is at rest."""
        return all(abs(speed) < AT_REST for speed in self.speed())

    def wait(self, seconds: float, phase: str) -> Run:
        """Wait without moving."""
        end = self.now() + seconds - 1e-6
        while self.now() < end:
            yield from self._command(BaseVelocity(0.0, 0.0), phase)

    def room(self, pose: Pose2D, *, whole: bool) -> float:
        """Return the clearance at a pose, m: with all of arm and load (`whole`), or low parts.

        High parts then only keep clear of what the map knows besides surfaces that they get over.
        """
        if whole:
            return self.costmap.room(pose, self.discs)
        low = self.costmap.room(pose, self.low_discs)
        return min(low, self.tall.room(pose, self.discs)) if self.reaches_over else low

    @property
    def reaches_over(self) -> bool:
        """Whether arm or load have parts that get over the surface that the base drives up to."""
        return self.discs is not self.low_discs and not np.array_equal(self.discs, self.low_discs)

    @property
    def tall(self) -> heights.Tall:
        """What the map knows and what may be higher than that surface; without a map all seen."""
        if not self.mapped:
            return heights.Tall(self.costmap.field, self.costmap.frame)
        grid, site = self.costmap.grid, self._skill.site
        if self._tall is None or self._tall[0] is not grid:
            grids = [grid] if self.costmap.grows else believed_maps(site)
            self._tall = grid, heights.taller_than(grids, site.surfaces.values(), self._top)
        return self._tall[1]


def _over_floor(points: Array) -> Array:
    """Points (n, 2) of the floor plan where they are drawn, (n, 3)."""
    return np.column_stack([points, np.full(len(points), PATH_HEIGHT)])


def _moved_little(positions: Array, before: Array) -> bool:
    """Whether no joint has left its position; a robot may have no joints at all."""
    return float(np.abs(positions - before).max(initial=0.0)) < POSTURE_CHANGE


def _same(outline: Array, other: Array) -> bool:
    return outline.shape == other.shape and float(np.abs(outline - other).max()) < OUTLINE_CHANGE
