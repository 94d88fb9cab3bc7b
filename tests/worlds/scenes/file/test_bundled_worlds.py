"""The worlds of the package: every episode can be had, and values name what is there."""

from functools import cache
from pathlib import Path

import pytest
from momantu_worlds import worlds
from momantu_worlds.scenes.catalogue.random_objects import GRASPABLE
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.geometry.solids import Scene
from momantu_worlds.scenes.loading import draw_episode

from momantu_bt.messages import ObjectClass
from momantu_bt.tree.load import read_values

TREES = Path(__file__).parents[4] / "trees"
NAMES = ("small_flat", "warehouse")
SEEDS = range(8)


@cache
def episode(name: str, seed: int) -> Episode:
    return draw_episode(getattr(worlds, name).path, seed)


@pytest.mark.parametrize("name", NAMES)
def test_the_values_of_a_world_name_what_is_in_it(name: str) -> None:
    values = read_values(TREES / "values" / f"{name}.yaml")
    drawn = episode(name, 0)
    assert drawn.goal is not None
    assert values["from"] in drawn.site.surfaces
    assert values["to"] == drawn.goal.support
    assert values["to"] in drawn.site.surfaces


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", NAMES)
def test_what_is_brought_stands_on_a_surface_and_fits_a_hand(name: str, seed: int) -> None:
    drawn = episode(name, seed)
    assert drawn.goal is not None
    bodies = {body.name: body for body in drawn.bodies}
    scene = Scene(bodies, lambda body: bodies[body].map_from_body)
    item = scene.body(drawn.goal.item)
    below, gap = scene.below(item)
    assert below in drawn.site.surfaces
    assert abs(gap) < 1e-6
    assert below != drawn.goal.support
    assert min(item.size[:2]) <= GRASPABLE
    told = drawn.site.objects[drawn.goal.item]
    assert isinstance(told, ObjectClass)
    assert told.category == item.body.category


@pytest.mark.parametrize("name", NAMES)
def test_episodes_differ(name: str) -> None:
    starts = {(episode(name, seed).start.x, episode(name, seed).start.y) for seed in SEEDS}
    assert len(starts) == len(SEEDS)
    loose = {tuple(b.name for b in episode(name, s).bodies if not b.static) for s in SEEDS}
    assert len(loose) > 3


def test_the_flat_has_narrow_doors_and_the_warehouse_boards_of_all_heights() -> None:
    flat = episode("small_flat", 0)
    assert len(flat.doorways) == 5
    boards = episode("warehouse", 0).site.surfaces
    assert 0.4 <= boards["pick_board"].height <= 1.1
    assert 0.4 <= boards["place_board"].height <= 1.1
