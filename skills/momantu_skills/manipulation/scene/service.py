"""The planning-scene service: the robot, its surroundings and its held object, as believed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from momantu_bt.descriptions.tunables import configured
from momantu_bt.failure import FRAME_UNKNOWN, Failure
from momantu_bt.frames import MAP, ODOM, FrameBuffer
from momantu_bt.geometry import Array, Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import DetectedObject, RobotState, SupportPlane
from momantu_bt.robot import Robot
from momantu_bt.service import HeldObject, Service, ServiceContext, Snapshot
from momantu_bt.world import Surface, Surfaces
from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.scene.holding import Holding
from momantu_skills.manipulation.scene.payload import Payload

with lazily():
    from momantu_skills.manipulation.scene import columns, scene, site_obstacles, surroundings


class PlanningSceneService(Service):
    """Keeps the scene. By itself it reads only the robot's state; `observe` adds a depth picture.

    `$@planning_scene.holding` is the category of the held object, or "".
    """

    rate = 20.0
    publishes: ClassVar[Mapping[str, type]] = {"holding": str}

    def start(self, context: ServiceContext) -> None:
        """Build the robot's model. Parameters: see `SceneConfig`."""
        self.config = configured(SceneConfig, context.parameters, "planning_scene")
        self.frames: FrameBuffer = context.frames
        self.site = context.site
        self.holding = Holding(self.config)
        self.payload = Payload(context.description, context.frames)
        self.scene: scene.Scene = _scene(context, self.config)
        self.low_things: Array = np.empty((0, 2))

    @cached_property
    def floor_plan(self) -> site_obstacles.FloorPlan:
        """The obstacles that the site's maps know."""
        return site_obstacles.FloorPlan(self.site, self.frames)

    @cached_property
    def _columns(self) -> columns.Columns:
        """What the site's maps know and whose height nobody does."""
        return columns.Columns(self.site)

    def update(self, robot: Robot, now: float) -> None:
        """Check again whether the object is still held, and weigh the empty hand."""
        self._state, held = robot.state(), self.held
        self.scene.seen_space.moved(self._state.odom_from_base)
        self.holding.judge(self._state)
        if held is not None and self.held is None:
            self._fell(held)
        self.payload.update(robot, self._state)

    def published(self) -> Mapping[str, Any]:
        """See `publishes`."""
        held = self.held
        return {"holding": "" if held is None else held.object.category}

    @property
    def held(self) -> HeldObject | None:
        """The held object; each update checks whether the fingers still press on something."""
        return self.holding.held

    @property
    def last_contact(self) -> float:
        """Time when the hand last touched or released something, s; -inf if it never did."""
        return self.holding.last_contact

    def grasped(self, thing: DetectedObject, grasp_from_object: Transform) -> None:
        """Report the object just grasped; it is held while the fingers press on something."""
        held = HeldObject(thing, grasp_from_object)
        self.holding.claim(held, self._state.gripper_width, self._state.stamp)

    def touched(self) -> None:
        """Report that the hand has just touched or released something."""
        self.holding.touched(self._state.stamp)

    def released(self) -> None:
        """Report that the hand has just released the held object."""
        held = self.held
        self.holding.release(self._state.stamp)
        if held is not None:
            self._fell(held)

    def _fell(self, held: HeldObject) -> None:
        """Suppose that what the hand no longer holds lies on the floor below, unless on a top."""
        self.take_over_site()
        odom_from_map = self.scene.odom_from_map
        if odom_from_map is None:
            return
        flat = self.scene.dropped(self._state, held)
        there = np.column_stack([flat, np.zeros(len(flat))])
        there = odom_from_map.inverse().apply(there)[:, :2]
        self.low_things = np.vstack([self.low_things, there])

    def observe(self, snapshot: Snapshot) -> None:
        """Add a depth picture of the surroundings.

        The newest picture replaces what older ones showed of the same region.
        """
        self.take_over_site()
        self.scene.observe(snapshot, self.held)

    def support(self, plane: SupportPlane) -> None:
        """Add a measured surface."""
        self.take_over_site()
        self.scene.add_support(plane)

    def surface_found(self, name: str, surface: Surface) -> None:
        """From now on believe that a surface of the site is where it was found.

        Raises:
            TypeError: the surfaces of this site cannot be corrected; those of a run can.
        """
        if not isinstance(self.site.surfaces, Surfaces):
            raise TypeError(f"the surfaces of the site {self.site.name!r} are fixed")
        self.site.surfaces.correct(name, surface)
        for drawn in ("floor_plan", "_columns"):
            self.__dict__.pop(drawn, None)
        self.take_over_site()

    def take_over_site(self) -> None:
        """Place the site's surfaces and what hangs over them; none while not localized."""
        self.scene.known = self.scene.overhead = ()
        self.scene.columns = self.scene.odom_from_map = None
        try:
            odom_from_map = self.frames.lookup(ODOM, MAP)
        except Failure as failure:
            if failure.code != FRAME_UNKNOWN:
                raise
            return
        self.scene.columns, self.scene.odom_from_map = self._columns, odom_from_map
        surfaces = self.site.surfaces.values()
        self.scene.known = tuple(surroundings.known_support(s, odom_from_map) for s in surfaces)
        self.scene.overhead = tuple(
            o for s in surfaces for o in site_obstacles.overhead_of(s, odom_from_map)
        )

    def footprint(self, state: RobotState, below: float = math.inf) -> Array:
        """Convex outline (k, 2) of base, arm and held object on the floor, base frame, m.

        below: parts of arm and held object that are entirely above this height, m, are left out.
        """
        return self.scene.own.footprint(state, self.held, below)

    def overhang(self, state: RobotState) -> Array:
        """See `BodyScene.overhang`."""
        return self.scene.own.overhang(state, self.held)

    def solids(self, state: RobotState, hits: Array, reach: float) -> Array:
        """See `BodyScene.solids`."""
        self.take_over_site()
        return self.scene.solids(state, hits, reach)

    def not_free(self, state: RobotState, columns: Array) -> Array:
        """See `BodyScene.not_free`."""
        return self.scene.not_free(state, columns)

    def is_robot(self, points: Array, state: RobotState) -> Any:
        """(n,) bool: which points (n, 3) in the base frame are on the robot or its held object."""
        return self.scene.own.covers(points, state, self.held)


def _scene(context: ServiceContext, config: SceneConfig) -> scene.Scene:
    return scene.Scene(context.description, config)
