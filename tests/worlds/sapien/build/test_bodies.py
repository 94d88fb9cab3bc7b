"""Bodies weigh, lie and look as they are described; a concave mesh becomes fitting cells."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
import sapien
import trimesh
from momantu_worlds.robots import fetch, kinova_jackal
from momantu_worlds.sapien.build.bodies import add_bodies
from momantu_worlds.sapien.build.cells import convex_cells
from momantu_worlds.sapien.build.meshes import body_mesh, collision_mesh, map_triangles, volume
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Geometry, Hull, Mesh, Part
from momantu_worlds.testing import plain_episode

from momantu_bt.geometry import Transform, quaternion_from_rpy
from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import Cuts, RobotDescription

FETCH = fetch()
CORNERS = np.array([[x, y, z] for x in (0, 0.1) for y in (0, 0.2) for z in (0, 0.3)], dtype=float)


@pytest.mark.parametrize(
    ("geometry", "expected"),
    [
        (Box((0.1, 0.2, 0.3)), 0.006),
        (Cylinder(0.1, 0.5), math.pi * 0.005),
        (Hull(CORNERS), 0.006),
    ],
)
def test_volume_and_mesh_agree(geometry: Geometry, expected: float) -> None:
    assert volume(geometry) == pytest.approx(expected)
    assert trimesh.Trimesh(*collision_mesh(geometry)).volume == pytest.approx(expected, rel=0.02)


def test_what_is_only_to_look_at_has_no_collision_shape() -> None:
    with pytest.raises(TypeError, match="Mesh has no collision shape"):
        collision_mesh(Mesh(CORNERS, np.array([[0, 1, 2]])))


def test_a_body_of_parts_is_one_mesh_and_lies_in_the_map() -> None:
    legs = tuple(
        Part(Cylinder(0.02, 0.7), Transform((x, y, 0.35))) for x in (-0.3, 0.3) for y in (-0.2, 0.2)
    )
    top = Part(Box((0.8, 0.6, 0.04)), Transform((0, 0, 0.72)))
    pose = Transform((2, 1, 0), quaternion_from_rpy(0, 0, math.pi / 2))
    table = Body("table", "table", pose, (*legs, top))
    mesh = body_mesh(table)
    assert mesh is not None
    assert mesh.vertices[:, 2].max() == pytest.approx(0.74)
    triangles = map_triangles([table])
    assert triangles[..., 0].max() == pytest.approx(2.3)
    assert triangles[..., 1].max() == pytest.approx(1.4)


@pytest.mark.parametrize("geometry", [Box((0.1, 0.1, 0.2)), Cylinder(0.05, 0.2), Hull(CORNERS)])
def test_a_loose_body_has_its_mass_and_comes_to_rest_on_its_base(geometry: Geometry) -> None:
    low = float(collision_mesh(geometry).vertices[:, 2].min())
    part = Part(geometry, Transform((0, 0, -low)))
    thing = Body("thing", "thing", Transform((1, 0, 0.01)), (part,), False, 0.7)
    simulator = Simulator(FETCH, plain_episode(table=False), 0, render=False)
    add_bodies(simulator.scene, [thing], simulator.truth, visuals=False)
    kind = sapien.physx.PhysxRigidDynamicComponent
    entity = next(e for e in simulator.scene.entities if e.name == "thing")
    assert entity.find_component_by_type(kind).mass == pytest.approx(0.7, rel=0.03)
    for _ in range(30):
        simulator.step()
    assert simulator.truth.pose("thing").position[2] == pytest.approx(0.0, abs=1.5e-3)
    assert simulator.truth.speed("thing")[0] < 1e-3


def test_contact_forces_add_up_to_the_weight() -> None:
    simulator = Simulator(FETCH, plain_episode(), 0, render=False)
    simulator.truth.watch_contacts()
    for _ in range(10):
        simulator.step()
    (contact,) = simulator.truth.contacts()
    assert {contact.first, contact.second} == {"can", "table_a"}
    assert contact.force == pytest.approx(0.4 * 9.81, rel=0.1)


def test_cells_of_the_torso_fill_its_mesh_and_little_more() -> None:
    assert FETCH.simulation is not None
    cuts = FETCH.simulation.convex_cells["torso_lift_link"]
    folder = FETCH.mesh_directories[0] / "fetch_description" / "meshes"
    path = str(folder / "torso_lift_link_collision.STL")
    mesh = trimesh.load(path, force="mesh")
    hulls = [trimesh.convex.convex_hull(cell) for cell in convex_cells(path, cuts)]
    total = sum(hull.volume for hull in hulls)
    assert mesh.volume < total < 1.06 * mesh.volume
    assert total < 0.9 * mesh.convex_hull.volume


def test_cutting_a_box_gives_its_parts() -> None:
    folder = FETCH.mesh_directories[0] / "fetch_description" / "meshes"
    path = str(folder / "bellows_link_collision.STL")
    whole = trimesh.load(path, force="mesh").convex_hull.volume
    cells = convex_cells(path, Cuts(x=(0.0,), z=(-0.1,)))
    assert len(cells) == 4
    volumes = [trimesh.convex.convex_hull(cell).volume for cell in cells]
    assert sum(volumes) == pytest.approx(whole, rel=1e-3)


def test_links_that_are_fixed_to_each_other_never_push() -> None:
    robot = kinova_jackal()
    simulator = Simulator(robot, plain_episode(table=False), 0, render=False)
    groups = {
        name: link.collision_shapes[0].get_collision_groups()[2]
        for name, link in simulator.model.links.items()
        if link.collision_shapes
    }
    # the deck carries column and mast; the arm's foot stands on the plate, its shoulder turns
    for one, other in (
        ("chassis_link", "column_link"),
        ("chassis_link", "mast_link"),
        ("plate_link", "arm_link_base"),
        ("plate_link", "arm_link_1"),
        ("arm_camera_link", "arm_link_5"),
    ):
        assert groups[one] & groups[other]
    for one, other in (
        ("arm_link_1", "arm_link_3"),
        ("arm_link_2", "chassis_link"),
        ("arm_finger_2", "arm_finger_3"),
        ("arm_finger_tip_2", "arm_link_6"),
    ):
        assert not groups[one] & groups[other]


@pytest.mark.parametrize(("robot", "top"), [(fetch, 0.005), (fetch, 0.03), (kinova_jackal, 0.005)])
def test_the_base_rolls_over_a_slab_of_a_floor(
    robot: Callable[[], RobotDescription], top: float
) -> None:
    """A floor of an imported world may lie a little above the plane, with friction."""
    slab = Body("slab", "body", Transform(), (Part(Box((6.0, 6.0, 2 * top))),), friction=1.0)
    episode = plain_episode(table=False)
    episode = dataclasses.replace(episode, bodies=(*episode.bodies, slab))
    simulator = Simulator(robot(), episode, 0, render=False)
    try:
        for _ in range(30):
            simulator.robot.command("base", BaseVelocity(0.5, 0.0))
            simulator.step()
        assert simulator.truth.base().x > 0.4
    finally:
        simulator.close()
