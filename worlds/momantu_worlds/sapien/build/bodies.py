"""Bodies and lights of an episode, built in SAPIEN."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import sapien

from momantu_bt.geometry import Array
from momantu_worlds.sapien.build.collision_filter import FLOOR_BIT
from momantu_worlds.sapien.build.collision_shapes import collision_shapes
from momantu_worlds.sapien.build.meshes import body_mesh, collision_mesh, map_triangles, volume
from momantu_worlds.sapien.build.moving import MovingBody
from momantu_worlds.sapien.build.render_shapes import render_shape
from momantu_worlds.sapien.build.truth import Truth
from momantu_worlds.sapien.poses import Z_FROM_X, pose_for_sapien, pose_of
from momantu_worlds.scenes.geometry.bodies import Body, Episode, Part

FLOOR = "floor"
"""Category of bodies that the robot's base rolls on, and the name of the plane at z = 0."""
FLOOR_FRICTION = 0.8
ROLLED_OVER = 0.03
"""Height above the floor, m, up to which the base rolls over what is fixed, such as a slab of an
imported floor: without wheels that turn, its friction would hold the base."""


def add_bodies(
    scene: Any, bodies: Iterable[Body], truth: Truth, *, visuals: bool
) -> tuple[Array, list[MovingBody]]:
    """Build every body and the floor, and register them with `truth`.

    Returns: triangles (k, 3, 3) in the map of all static bodies, and the loose bodies.
    """
    _add_floor(scene)
    still, moving = [], []
    for body in bodies:
        if body.static:
            _place(scene, body, truth, visuals)
            still.append(body)
            continue
        addition = add_body(scene, body, truth, visuals=visuals)
        if addition.moving is not None:
            moving.append(addition.moving)
    return map_triangles(still), moving


@dataclass(frozen=True, slots=True)
class Addition:
    """A body that may be added and removed. moving: as seen by the laser; None if invisible."""

    body: Body
    entity: Any
    moving: MovingBody | None


def add_body(scene: Any, body: Body, truth: Truth, *, visuals: bool) -> Addition:
    """Build one body and register it with `truth`."""
    entity = _place(scene, body, truth, visuals)
    mesh = body_mesh(body)
    return Addition(body, entity, None if mesh is None else MovingBody(entity, mesh))


def _place(scene: Any, body: Body, truth: Truth, visuals: bool) -> Any:
    entity = sapien.Entity()
    entity.name = body.name
    if visuals and any(part.visual for part in body.parts):
        entity.add_component(look_of(body))
    entity.add_component(_physics(body))
    entity.set_pose(pose_of(body.map_from_body))
    scene.add_entity(entity)
    truth.add(body.name, entity)
    return entity


def add_lights(scene: Any, episode: Episode) -> None:
    """Ambient light, suns and lamps, without shadows."""
    scene.set_ambient_light(list(episode.ambient))
    for sun in episode.suns:
        scene.add_directional_light(list(sun.direction), list(sun.color), shadow=False)
    for lamp in episode.lamps:
        scene.add_point_light(list(lamp.position), list(lamp.color), shadow=False)


def _add_floor(scene: Any) -> None:
    material = sapien.physx.PhysxMaterial(FLOOR_FRICTION, FLOOR_FRICTION, 0.0)
    shape = sapien.physx.PhysxCollisionShapePlane(material)
    shape.set_collision_groups([1, 1, FLOOR_BIT, 0])
    component = sapien.physx.PhysxRigidStaticComponent()
    component.attach(shape)
    component.name = FLOOR
    entity = sapien.Entity()
    entity.add_component(component)
    entity.name = FLOOR
    entity.set_pose(pose_of(Z_FROM_X))
    scene.add_entity(entity)


def look_of(body: Body) -> Any:
    """The component with all visual parts of a body, around the body's origin."""
    look = sapien.render.RenderBodyComponent()
    for part in body.parts:
        if part.visual:
            shape = render_shape(part)
            shape.local_pose = pose_of(pose_for_sapien(part))
            look.attach(shape)
    look.name = body.name
    return look


def _physics(body: Body) -> Any:
    physx = sapien.physx
    fixed = body.static and not body.kinematic
    component = physx.PhysxRigidStaticComponent() if fixed else physx.PhysxRigidDynamicComponent()
    if body.kinematic:
        component.kinematic = True
    material = physx.PhysxMaterial(body.friction, body.friction, 0.0)
    colliding = [part for part in body.parts if part.collision]
    total = 0.0 if body.static else sum(volume(part.geometry) for part in colliding)
    for part in colliding:
        floor = body.category == FLOOR or (fixed and _top(body, part) <= ROLLED_OVER)
        for shape in collision_shapes(part, material, static=body.static):
            shape.set_collision_groups([1, 1, FLOOR_BIT if floor else 0, 0])
            if not body.static:
                shape.set_density(body.mass / total)
            component.attach(shape)
    component.name = body.name
    return component


def _top(body: Body, part: Part) -> float:
    """Height of the highest point of a part, m."""
    corners = (body.map_from_body @ part.body_from_part).apply(
        collision_mesh(part.geometry).vertices
    )
    return float(corners[:, 2].max())
