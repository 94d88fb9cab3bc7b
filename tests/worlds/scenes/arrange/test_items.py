"""Anything loose may be what is brought: it is placed, judged, and nothing else is like it."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from momantu_worlds.scenes.arrange.episode import bodies
from momantu_worlds.scenes.arrange.layout import Layout
from momantu_worlds.scenes.arrange.variation import vary
from momantu_worlds.scenes.catalogue.objects import LYING_KINDS, OBJECT_KINDS, ObjectKind, Thing
from momantu_worlds.scenes.file.objects import Item
from momantu_worlds.scenes.file.references import dangling
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.scenes.geometry.solids import PlacedBody
from momantu_worlds.scenes.geometry.support import UprightCylinder
from momantu_worlds.scenes.loading import load_world
from momantu_worlds.worlds import four_rooms

from momantu_bt.geometry import Transform
from momantu_bt.world import WorldError

SIZES: dict[str, tuple[float, float, float]] = {
    "can": (0.07, 0.07, 0.13),
    "bottle": (0.068, 0.068, 0.24),
    "box": (0.06, 0.10, 0.14),
    "mug": (0.08, 0.08, 0.09),
    "bowl": (0.13, 0.13, 0.06),
}


def world_with(item: dict[str, Any]) -> WorldFile:
    """four_rooms with another item."""
    world = load_world(four_rooms.path)
    given = {"name": "thing", "on": "table_a", "at": (-0.19, 0.54), "shift": 0.15, **item}
    assert world.goal is not None
    goal = world.goal.model_copy(update={"item": "thing"})
    return world.model_copy(update={"item": Item.model_validate(given), "goal": goal})


def sizes(kind: ObjectKind) -> dict[str, Any]:
    x, _, z = SIZES[kind]
    return {"size": SIZES[kind]} if kind == "box" else {"radius": x / 2, "height": z}


def drawn(item: dict[str, Any], seed: int) -> Layout:
    return vary(world_with(item), seed)


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_the_item_is_judged_by_the_cylinder_around_it(kind: ObjectKind) -> None:
    thing = Thing(kind, SIZES[kind], 0.3, (0.5, 0.5, 0.5))
    body = Body("thing", kind, Transform(), thing.parts(), static=False, mass=0.3)
    around = UprightCylinder(body)
    assert around.height == pytest.approx(thing.height)
    assert around.radius == pytest.approx(thing.reach, abs=0.002)
    beside = Transform((around.radius + 0.2, 0.0, thing.height / 2))
    assert around.distance(Transform(), beside) == pytest.approx(0.2)


def test_a_body_of_air_is_no_item() -> None:
    with pytest.raises(ValueError, match="'ghost' has nothing solid"):
        UprightCylinder(Body("ghost", "can", Transform(), ()))


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_an_item_has_the_sizes_that_are_given(kind: ObjectKind) -> None:
    placed = drawn({"kind": kind, **sizes(kind)}, 0).objects[0]
    assert placed.name == "thing"
    assert placed.thing.size == pytest.approx(SIZES[kind])


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_an_item_without_sizes_is_drawn_anew_in_every_episode(kind: ObjectKind) -> None:
    found = {drawn({"kind": kind}, seed).objects[0].thing.size for seed in range(5)}
    assert len(found) == 5


@pytest.mark.parametrize("kind", OBJECT_KINDS)
def test_nothing_of_its_kind_is_like_it(kind: ObjectKind) -> None:
    likes = 0
    for seed in range(12):
        for placed in drawn({"kind": kind, **sizes(kind)}, seed).things:
            if placed.thing.kind == kind:
                likes += 1
                ratios = [a / b for a, b in zip(placed.thing.size, SIZES[kind], strict=True)]
                assert max(abs(ratio - 1.0) for ratio in ratios) > 0.20
    assert likes > 0


def test_a_box_with_a_radius_is_refused_with_what_it_has() -> None:
    with pytest.raises(ValueError, match="a box has a size, no radius and height"):
        world_with({"kind": "box", "radius": 0.03, "height": 0.1})


@pytest.fixture
def tin(tmp_path: Path) -> Path:
    """A mesh of 66 x 66 x 102 mm whose origin lies beside it."""
    mesh = trimesh.creation.cylinder(0.033, 0.102)
    mesh.apply_translation((0.2, -0.1, 0.03))
    mesh.export(tmp_path / "tin.ply")
    return tmp_path / "tin.ply"


def test_a_mesh_stands_on_its_table_as_what_its_kind_says(tin: Path) -> None:
    for seed in range(4):
        world = world_with({"kind": "can", "mesh": str(tin), "mass": 0.35})
        assert world.mesh_files()[-1] == tin
        layout = vary(world, seed)
        placed = layout.object("thing")
        assert placed.thing.size == pytest.approx((0.066, 0.066, 0.102), abs=1e-4)
        item = next(b for b in bodies(world, layout) if b.name == "thing")
        assert (item.category, item.mass, item.static) == ("can", 0.35, False)
        table = layout.tables[placed.table]
        solid = PlacedBody(item, table.map_from_top.inverse() @ item.map_from_body)
        assert solid.lowest == pytest.approx(0.0, abs=1e-6)
        assert solid.centre[:2] == pytest.approx((placed.at.x, placed.at.y), abs=1e-4)
        assert UprightCylinder(item).height == pytest.approx(0.102, abs=1e-4)


def test_a_mesh_as_an_object_is_refused_with_what_it_cannot_have(tin: Path) -> None:
    mesh = {"file": str(tin), "collision": "none"}
    for wrong, told in (
        ({"mesh": str(tin), "radius": 0.03, "height": 0.1}, "a mesh has its own sizes"),
        ({"mesh": str(tin), "lying": True}, "a mesh does not lie here"),
        ({"mesh": mesh}, "leave out mesh.collision"),
        ({"mesh": "tin.blend"}, "not a mesh file"),
    ):
        with pytest.raises(ValueError, match=told):
            world_with({"kind": "can", **wrong})
    with pytest.raises(WorldError, match=r"nowhere\.ply"):
        vary(world_with({"kind": "can", "mesh": str(tin.with_name("nowhere.ply"))}), 0)
    [(place, message)] = dangling(world_with({"kind": "can", "mesh": "nowhere.ply"}))
    assert place == ("item", "mesh", "file")
    assert "there is no file 'nowhere.ply'" in message


@pytest.mark.parametrize("kind", LYING_KINDS)
def test_what_lies_touches_its_table_all_along_and_stays_on_it(kind: ObjectKind) -> None:
    for seed in range(6):
        world = world_with({"kind": kind, **sizes(kind), "lying": True})
        layout = vary(world, seed)
        placed = layout.object("thing")
        table = layout.tables[placed.table]
        assert placed.thing.height == pytest.approx(SIZES[kind][0])
        item = next(b for b in bodies(world, layout) if b.name == "thing")
        solid = PlacedBody(item, table.map_from_top.inverse() @ item.map_from_body)
        assert solid.lowest == pytest.approx(0.0, abs=1e-6)
        assert solid.pose.rotation[2, 2] == pytest.approx(0.0, abs=1e-9)
        half = np.array(table.size) / 2
        for each in solid.solids:
            assert (np.abs(each.vertices[:, :2]) <= half).all()
        # the top of the thing is towards its yaw
        assert np.allclose(
            solid.pose.rotation[:2, 2], (math.cos(placed.at.yaw), math.sin(placed.at.yaw))
        )


def test_a_bowl_does_not_lie() -> None:
    with pytest.raises(ValueError, match="a bowl does not lie here; lying things: bottle, can"):
        world_with({"kind": "bowl", **sizes("bowl"), "lying": True})
