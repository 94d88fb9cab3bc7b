"""Poses in walls and furniture, by the map that a robot is told."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from momantu_bt.formats.maps import MapPicture, write_map
from momantu_bt.formats.problems import Problem
from momantu_bt.geometry import Pose2D
from momantu_bt.skill import In, Skill
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.check.floor import ROOM, floor_of
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.registry import Registry
from momantu_bt.world import Site, WorldError

FOOTPRINT = ((0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2))
CELL = 0.05


class Drive(Skill):
    """Drive somewhere, and ask about another pose."""

    goal: Pose2D | None = In(None, frame="map", doc="where to")
    to: str = In("", names="goal", doc="the same as a text")
    about: str = In("", names="spot", doc="a pose that is asked about")


@dataclass
class Hall:
    """A hall of 6 x 4 m from (-1, -2), with a wall at x 2 and a board at y 1 that no laser sees."""

    folder: Path
    drawn: list[str] = field(default_factory=list)
    name: str = "hall"
    default_robot: str = "toy"

    def site(self) -> Site:
        return Site("hall")

    def site_for(self, description: object) -> Site:
        self.drawn.append("map")
        levels = np.full((80, 120), 254)
        overhang = levels.copy()
        levels[:, 60:63] = 0
        overhang[15:20, :40] = 0  # row 0 is at the top: y from 1.0 to 1.25 m
        for name, cells in (("map", levels), ("overhang", overhang)):
            picture = MapPicture(cells, CELL, (-1.0, -2.0))
            write_map(self.folder / f"{name}.yaml", picture)
        return Site(
            "hall",
            map_file=self.folder / "map.yaml",
            overhang_file=self.folder / "overhang.yaml",
        )


@pytest.fixture
def hall(tmp_path: Path) -> Hall:
    return Hall(tmp_path)


Found = Callable[[str], list[Problem]]
ROBOT = SimpleNamespace(
    footprint=FOOTPRINT, named_poses={}, resolve_use=lambda use: use, sensors={}
)


@pytest.fixture
def found(registry: Registry, hall: Hall) -> Found:
    having = replace(
        registry, skills={"drive": Drive}, worlds={"hall": hall}, robots={"toy": lambda: ROBOT}
    )

    def problems(node: str) -> list[Problem]:
        text = f"momantu_bt: 1\nworld: hall\ntrees:\n  Main:\n    - drive: {node}\n"
        document, reading = read(text, "t.yaml")
        return check(document, having, reading=reading).problems

    return problems


def test_a_pose_in_a_wall_is_told_with_the_nearest_free_one(found: Found, hall: Hall) -> None:
    (problem,) = found("{goal: {x: 1.9, y: 0, yaw: 0}}")
    assert (problem.code, problem.place.line) == ("goal-blocked", 5)
    assert "x 1.9 m, y 0 m" in problem.message
    assert problem.hint == "the nearest free pose is {x: 1.6, y: 0, yaw: 0}"
    assert found("{goal: {x: 1.6, y: 0, yaw: 0}}") == []


def test_the_heading_counts(found: Found) -> None:
    assert found("{goal: {x: 1.75, y: 0, yaw: 90 deg}}") == []
    (problem,) = found("{goal: {x: 1.75, y: 0, yaw: 0 deg}}")
    assert problem.code == "goal-blocked"


def test_what_the_laser_does_not_see_is_occupied_too(found: Found) -> None:
    assert [p.code for p in found("{goal: {x: 0, y: 1.1}}")] == ["goal-blocked"]
    assert found("{goal: {x: 0, y: 0.7}}") == []


def test_a_goal_as_a_text_and_a_pose_that_is_only_asked_about(found: Found) -> None:
    assert [p.code for p in found('{to: "2.1;0;0"}')] == ["goal-blocked"]
    assert found('{about: "2.1;0;0"}') == []
    assert [p.code for p in found('{about: "20;0;0"}')] == ["outside-map"]


def test_a_world_without_an_area_has_that_of_its_map(found: Found) -> None:
    (problem,) = found("{goal: {x: 5.5, y: 0}}")
    assert problem.code == "outside-map"
    assert problem.hint == "it spans x from -1 to 5 m, y from -2 to 2 m"


def test_the_map_is_read_only_for_a_tree_with_poses(found: Found, hall: Hall) -> None:
    found("{}")
    assert hall.drawn == []
    found("{goal: {x: 0, y: 0}, to: '1;0;0'}")
    assert hall.drawn == ["map"]


def test_a_map_that_cannot_be_read_is_no_problem_of_the_tree(hall: Hall) -> None:
    def broken(description: object) -> Site:
        raise WorldError("no map")

    assert floor_of(SimpleNamespace(site_for=broken, **vars(hall)), ROBOT) is None  # type: ignore[arg-type]


@pytest.mark.parametrize("yaw", [0.0, 0.4, math.pi / 2, -2.0])
def test_the_nearest_free_pose_is_free_and_none_nearer_has_room(hall: Hall, yaw: float) -> None:
    floor = floor_of(hall, ROBOT)  # type: ignore[arg-type]
    assert floor is not None
    asked = Pose2D(2.0, 0.0, yaw)
    free = floor.nearest_free(asked)
    assert free is not None
    assert floor.is_free(free, ROOM)
    nearer = asked.distance_to(free) - 0.11
    for angle in np.linspace(0, 2 * math.pi, 16, endpoint=False):
        step = Pose2D(nearer * math.cos(angle), nearer * math.sin(angle))
        tried = Pose2D(asked.x + step.x, asked.y + step.y, yaw)
        assert not floor.is_free(tried, ROOM)
