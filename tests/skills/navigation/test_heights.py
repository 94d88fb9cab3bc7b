"""What may be tall: the map's walls and furniture, but no surface that arm and load get over."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.believed import believed_maps
from momantu_skills.navigation.map.costmap import of_site
from momantu_skills.navigation.map.heights import Tall, taller_than

from momantu_bt.geometry import Pose2D
from momantu_bt.world import Site, Surface, Surfaces
from tests.skills.scenery.flat import write_map

HAND = np.array([[0.0, 0.0, 0.1]])


@pytest.fixture
def site(tmp_path: Path) -> Site:
    """A desk of 0.7 m in the corner of two walls, and a shelf board of 1.4 m elsewhere."""
    walls = ((2.0, -1.0, 2.15, 3.0), (-1.0, 2.0, 3.0, 2.15))
    desk, shelf = (1.2, 1.0, 2.0, 2.0), (-0.8, 0.0, -0.4, 1.0)
    plan = write_map(tmp_path, (*walls, desk, shelf), (-1.0, -1.0, 3.0, 3.0))
    surfaces = {
        "desk": Surface(Pose2D(1.6, 1.5), (0.8, 1.0), 0.7, (0.0,)),
        "shelf": Surface(Pose2D(-0.6, 0.5), (0.4, 1.0), 1.4, (0.0,)),
    }
    return Site("corner", map_file=plan, surfaces=surfaces)


def tall(site: Site, height: float) -> Tall:
    return taller_than(believed_maps(site), site.surfaces.values(), height)


@pytest.mark.parametrize(
    ("x", "y", "room"),
    [(1.6, 1.5, 0.3), (1.9, 1.5, 0.0), (1.6, 1.95, -0.05), (1.0, 0.0, 0.9), (-0.6, 0.5, -0.1)],
)
def test_over_a_desk_a_hand_has_room_up_to_the_walls(
    site: Site, x: float, y: float, room: float
) -> None:
    assert tall(site, 0.7).room(Pose2D(x, y), HAND) == pytest.approx(room, abs=0.03)


def test_what_is_higher_than_the_hand_gets_is_in_its_way(site: Site) -> None:
    over_the_desk, over_the_shelf = Pose2D(1.6, 1.5), Pose2D(-0.6, 0.5)
    assert tall(site, 0.5).room(over_the_desk, HAND) < 0.0
    assert tall(site, 1.4).room(over_the_shelf, HAND) > 0.0


def test_on_a_plan_without_a_map_of_what_overhangs_it_its_surfaces_do(tmp_path: Path) -> None:
    plan = write_map(tmp_path, ((2.0, -1.0, 2.15, 3.0),), (-1.0, -1.0, 3.0, 3.0))
    surfaces = {
        "board": Surface(Pose2D(0.5, 1.5), (0.8, 1.0), 0.9, (0.0,)),
        "round": Surface(Pose2D(1.0, 0.0), (0.8, 0.8), 0.7, (0.0,), round=True),
    }
    site = Site("hall", map_file=plan, surfaces=Surfaces(surfaces))
    costs = of_site(site, NavigationConfig())
    assert costs.room(Pose2D(0.5, 1.5), HAND) < 0.0
    assert costs.room(Pose2D(0.5, 0.8), HAND) == pytest.approx(0.1, abs=0.06)
    assert costs.room(Pose2D(1.0, 0.3), HAND) < 0.0
    assert costs.room(Pose2D(1.39, 0.39), HAND) > 0.0
    site.surfaces.correct("board", replace(surfaces["board"], map_from_surface=Pose2D(-0.5, 1.5)))
    assert of_site(site, NavigationConfig()).room(Pose2D(0.7, 1.5), HAND) > 0.3
