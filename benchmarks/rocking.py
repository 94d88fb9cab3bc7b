"""How long what is let go leaning rocks on a table in simulation, beside the same on the floor.

    python benchmarks/rocking.py
    python benchmarks/rocking.py --lean 5 --seconds 4

A thing stands on its rim, leaning, and is let go, turning or not. Real ones come to rest in about a
second. The tilt is printed twice a second; 90 degrees: it has fallen.
"""

from __future__ import annotations

import argparse
import math
from itertools import product
from types import SimpleNamespace
from typing import Any

import sapien
from momantu_worlds.sapien.build import bodies
from momantu_worlds.sapien.config import STEP, Physics
from momantu_worlds.sapien.simulator import _new_scene
from momantu_worlds.scenes.catalogue.objects import Thing

from momantu_bt.geometry import Transform

THINGS = {"bottle": (0.07, 0.07, 0.23), "can": (0.07, 0.07, 0.13)}
SPEEDS = (0.0, 0.5, 1.5)
TOP = 0.72
"""Height of the table, m."""
FRICTION = 0.6


def main() -> None:
    """Print the tilts of each thing, on a table and on the floor."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--lean", type=float, default=10.0, help="at first, deg")
    parser.add_argument("--seconds", type=float, default=6.0)
    told = parser.parse_args()
    for kind, on, speed in product(THINGS, ("table", "floor"), SPEEDS):
        tilts = rocking(kind, on, math.radians(told.lean), speed, told.seconds)
        print(f"{kind} on the {on}, {speed:g} rad/s:", " ".join(f"{tilt:.0f}" for tilt in tilts))


def rocking(kind: Any, on: str, lean: float, speed: float, seconds: float) -> list[float]:
    """Tilts, deg, twice a second. lean: rad. speed: at which it turns aside at first, rad/s."""
    scene = _new_scene(Physics(), render=False)
    bodies._add_floor(scene)
    if on == "table":
        scene.add_entity(_top())
    thing = Thing(kind, THINGS[kind], 0.4, (0.8, 0.1, 0.1))
    part = bodies._physics(_body(thing))
    entity = sapien.Entity()
    entity.add_component(part)
    height = (TOP if on == "table" else 0.0) + thing.size[0] / 2 * math.sin(lean) + 1e-4
    entity.set_pose(
        sapien.Pose([0.05, 0.1, height], [math.cos(lean / 2), math.sin(lean / 2), 0, 0])
    )
    scene.add_entity(entity)
    part.set_angular_velocity([0.0, speed, 0.0])
    tilts = []
    for step in range(int(seconds / STEP)):
        scene.step()
        if step % round(0.5 / STEP) == 0:
            _, x, y, _ = entity.pose.q
            tilts.append(math.degrees(math.acos(max(-1.0, 1 - 2 * (x * x + y * y)))))
    return tilts


def _body(thing: Thing) -> Any:
    """What `bodies._physics` reads of a body."""
    return SimpleNamespace(
        static=False,
        kinematic=False,
        friction=FRICTION,
        mass=thing.mass,
        category=thing.kind,
        name=thing.kind,
        parts=thing.parts(),
        map_from_body=Transform(),
    )


def _top() -> Any:
    """A table's top, turned by 0.3 rad."""
    material = sapien.physx.PhysxMaterial(FRICTION, FRICTION, 0.0)
    shape = sapien.physx.PhysxCollisionShapeBox([0.35, 0.5, 0.02], material)
    shape.set_collision_groups([1, 1, 0, 0])
    part = sapien.physx.PhysxRigidStaticComponent()
    part.attach(shape)
    top = sapien.Entity()
    top.add_component(part)
    top.set_pose(sapien.Pose([0, 0, TOP - 0.02], [math.cos(0.15), 0, 0, math.sin(0.15)]))
    return top


if __name__ == "__main__":
    main()
