"""Pictures of heaps on the tables of worlds, rendered with the simulator's camera and its errors.

A picture depends on its seed, the worlds and the families alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import sapien

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.labelled import Label, Labelled
from momantu_bt.robot import CameraSensor
from momantu_bt.world import WorldError, seeded
from momantu_bt.world_plugins import WORLDS as ENTRIES
from momantu_worlds.labelled.heaps import USUAL, Laid, Manner, arm, heap
from momantu_worlds.labelled.own import OwnCategory
from momantu_worlds.labelled.shape import Draw, draw_color
from momantu_worlds.labelled.stock import Stock
from momantu_worlds.sapien.build.bodies import add_lights, look_of
from momantu_worlds.sapien.config import CameraErrors
from momantu_worlds.sapien.poses import pose_of
from momantu_worlds.sapien.sensors.camera import Camera
from momantu_worlds.sapien.simulator import render_system, tidy
from momantu_worlds.scenes.arrange import episode as episodes
from momantu_worlds.scenes.arrange import variation
from momantu_worlds.scenes.arrange.layout import PlacedTable
from momantu_worlds.scenes.geometry.bodies import Body, Episode, Part
from momantu_worlds.scenes.loading import load_world
from momantu_worlds.scenes.site import site as sites

WORLDS = ("four_rooms", "small_flat", "warehouse")
"""The worlds whose tables are used unless others are given."""
LAYOUT = 40
"""So many seeds share the layout of a world, as building one takes longer than a picture."""
TABLES = 1.6
"""Largest free height above a surface at which its board hides the view, m."""
ELEVATION = (math.radians(22), math.radians(65))
"""Range of the angle at which the camera looks down, rad."""
DISTANCE = (0.55, 1.5)
"""Range of the camera's distance from what it looks at, m."""
SIDE = math.radians(50)
"""How far from a surface's side the camera may stand, rad."""
LEAST_SEEN = 150
"""Pixels of a thing from which on it counts as seen."""
ATTEMPTS = 10
"""Views tried before a seed is said to have none."""
CAMERA = CameraSensor(
    frame="camera", horizontal_fov=math.radians(60), min_depth=0.35, max_depth=4.5
)
"""The camera: 640x480 with 60 degrees, as on most robots' heads."""
MOUNTING = CameraErrors()


@dataclass(slots=True)
class _Stand:
    """Stands for a link that carries a camera."""

    entity_pose: Any


class Studio:
    """Renders labelled pictures in some worlds."""

    def __init__(
        self,
        worlds: Sequence[str],
        *,
        testing: bool,
        own: tuple[OwnCategory, ...] = (),
        manner: Manner = USUAL,
    ) -> None:
        """worlds: names or files; none: WORLDS. testing: with the families kept for testing.

        own: categories beside the usual ones. manner: how heaps are made.

        Raises:
            PluginError: there is no such world.
            WorldError: a world is not described by a file.
        """
        self._worlds = [_file(world) for world in worlds or WORLDS]
        self._stock, self._manner = Stock(testing, own), manner
        self._set: _Set | None = None

    def picture(self, seed: int) -> Labelled:
        """The picture of a seed; raises what `pictures` raises."""
        return self.pictures(seed, 1)[0]

    def pictures(self, seed: int, count: int) -> tuple[Labelled, ...]:
        """The picture of a seed, and more of the same heap from elsewhere; `count` at most.

        Raises:
            WorldError: the world has no open surface, no view shows a thing, or SAPIEN cannot
                render.
        """
        world = self._worlds[(seed // LAYOUT) % len(self._worlds)]
        layout = seed // (LAYOUT * len(self._worlds))
        if self._set is None or (self._set.world, self._set.layout) != (world, layout):
            if self._set is not None:
                self._set.close()
            self._set = _Set(world, layout)
        for attempt in range(ATTEMPTS):
            draw = seeded(seed, "picture", attempt, "test" if self._stock.testing else "train")
            made = self._set.take(draw, seed, self._stock, self._manner, count)
            if made:
                return tuple(replace(one, categories=self._stock.categories) for one in made)
        raise WorldError(f"no view of seed {seed} in {world} shows a thing; leave this seed out")


class _Set:
    """One layout of a world, with its furniture and without what stood on it."""

    def __init__(self, world: Path, layout: int) -> None:
        self.world, self.layout = world, layout
        loaded = load_world(world)
        placed = variation.vary(loaded, layout)
        episode = episodes.build(loaded, placed, sites.site_of(loaded, placed.believed_start))
        self.tables = [t for t in placed.tables.values() if t.above > TABLES]
        if not self.tables:
            raise WorldError(f"{world} has no open surface to put things on")
        tidy()
        self.scene = sapien.Scene([render_system()])
        self._light(episode)
        for body in episode.bodies:
            if body.static and any(part.visual for part in body.parts):
                self._add(body.parts, body.map_from_body)
        self._stand = _Stand(sapien.Pose())
        errors = CameraErrors(mounting_position=0.0, mounting_angle=0.0)
        self.camera = Camera(self.scene, self._stand, "camera", CAMERA, 0, errors, [])

    def _light(self, episode: Episode) -> None:
        add_lights(self.scene, episode)
        self._ambient = np.array(episode.ambient)
        self._sun = self.scene.add_directional_light([0, 0, -1], [0, 0, 0], shadow=False)

    def close(self) -> None:
        """Empty the scene."""
        for entity in list(self.scene.entities):
            self.scene.remove_entity(entity)

    def take(
        self, draw: Draw, seed: int, stock: Stock, manner: Manner, count: int
    ) -> list[Labelled]:
        """Pictures of a new heap; none if the first one shows nothing of it."""
        table = self.tables[int(draw.integers(len(self.tables)))]
        half = np.array(table.size) / 2
        if table.round:
            half = half / math.sqrt(2)
        spot = draw.uniform(-1.0, 1.0, 2) * np.maximum(half - 0.22, 0.0)
        map_from_top = table.map_from_top @ Transform((*spot, 0.0))
        room = (float(half[0] - abs(spot[0])), float(half[1] - abs(spot[1])))
        laid = heap(draw, room, stock, manner)
        top_from_camera = _viewpoint(draw, table)
        if draw.random() < manner.arm:
            laid = [*laid, arm(draw, top_from_camera.position)]
        self._relight(draw)
        entities = [self._add(each.parts, map_from_top @ each.top_from_thing) for each in laid]
        try:
            made: list[Labelled] = []
            while len(made) < count:
                one = self._shoot(draw, seed, laid, entities, map_from_top, top_from_camera, table)
                if one is None:
                    break
                made.append(one)
                top_from_camera = _viewpoint(draw, table)
            return made
        finally:
            for entity in entities:
                self.scene.remove_entity(entity)

    def _relight(self, draw: Draw) -> None:
        """Another light: brighter or darker, and a sun from anywhere above."""
        self.scene.set_ambient_light((self._ambient * draw.uniform(0.5, 1.5)).tolist())
        level = draw.uniform(0.0, 2.0 * math.pi)
        turn = Transform.from_rpy((0, 0, 0), (0.0, draw.uniform(0.5, 1.5), level))
        self._sun.entity.set_pose(pose_of(turn))
        color = np.array(draw_color(draw)) * 0.3 + 0.7
        self._sun.color = (color * draw.uniform(0.0, 1.6)).tolist()

    def _add(self, parts: tuple[Part, ...], pose: Transform) -> Any:
        entity = sapien.Entity()
        entity.add_component(look_of(Body("", "", pose, parts)))
        entity.set_pose(pose_of(pose))
        self.scene.add_entity(entity)
        return entity

    def _shoot(
        self,
        draw: Draw,
        seed: int,
        laid: list[Laid],
        entities: list[Any],
        map_from_top: Transform,
        top_from_camera: Transform,
        table: PlacedTable,
    ) -> Labelled | None:
        self._stand.entity_pose = pose_of(map_from_top @ top_from_camera)
        image = self.camera.read(float(seed))
        ids = self.camera.bodies()
        numbers = np.zeros(ids.shape, dtype=np.uint8)
        things = []
        camera_from_top = top_from_camera.inverse()
        for number, (each, entity) in enumerate(zip(laid, entities, strict=True), 1):
            mask = ids == entity.per_scene_id
            seen = int(np.count_nonzero(mask))
            if each.shape is None or seen < LEAST_SEEN:
                continue
            numbers[mask] = number
            pose = camera_from_top @ each.top_from_thing
            things.append(
                Label(number, each.shape.category, each.shape.family, pose, each.shape.size, seen)
            )
        if not things:
            return None
        odom_from_top = Transform((0.0, 0.0, table.height))
        error = Transform(
            MOUNTING.mounting_position * draw.standard_normal(3),
            _small_turn(MOUNTING.mounting_angle * draw.standard_normal(3)),
        )
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * np.array(table.size) / 2
        shift = (table.map_from_top.inverse() @ map_from_top).position[:2]
        return Labelled(
            seed,
            image,
            odom_from_top @ top_from_camera @ error,
            table.height,
            corners - shift,
            numbers,
            tuple(things),
        )


def _file(world: str) -> Path:
    """The file of a world that is given by its name or file."""
    path = getattr(ENTRIES.load(world), "path", None)
    if not isinstance(path, Path):
        raise WorldError(f"the world {world!r} is not described by a file, which this needs")
    return path


def _viewpoint(draw: Draw, table: PlacedTable) -> Transform:
    """`top_from_camera`: an optical frame that looks at a point near the origin of the heap."""
    side = table.sides[int(draw.integers(len(table.sides)))] if table.sides else 0.0
    turn = side + draw.uniform(-SIDE, SIDE)
    rise, far = draw.uniform(*ELEVATION), draw.uniform(*DISTANCE)
    target = np.array([*draw.uniform(-0.12, 0.12, 2), draw.uniform(0.0, 0.1)])
    ahead = -np.array(
        [math.cos(rise) * math.cos(turn), math.cos(rise) * math.sin(turn), math.sin(rise)]
    )
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    roll = draw.normal(0.0, 0.03)
    down = np.cross(ahead, right)
    tilted = math.cos(roll) * right + math.sin(roll) * down
    rotation = np.column_stack([tilted, np.cross(ahead, tilted), ahead])
    return Transform.from_rotation(rotation, target - far * ahead)


def _small_turn(turn: Array) -> Array:
    angle = float(np.linalg.norm(turn))
    return quaternion_from_axis_angle(turn, angle)
