"""What is where on a plan: metres become pixels, and each thing has its colour."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.checking.measures import measured
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.preview.canvas import Canvas
from momantu_worlds.preview.plan import DARK, PAPER, WAY, draw_plan, extent
from momantu_worlds.robots import fetch
from momantu_worlds.scenes.geometry.bodies import Body, Box, Part
from momantu_worlds.scenes.loading import draw_episode
from PIL import Image

from momantu_bt.geometry import Transform
from momantu_bt.zone import ZONE_KINDS, Zone

WHITE, RED = (255, 255, 255), (255, 0, 0)


@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(2, 20), st.floats(2, 20), st.floats(0.2, 0.8))
def test_a_rectangle_covers_its_share_at_its_place(
    x: float, y: float, wide: float, high: float, share: float
) -> None:
    low, size = np.array([x, y]), np.array([wide, high])
    canvas = Canvas(low, low + size, 200, WHITE)
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * share * size + low
    canvas.polygon(corners, RED, None)
    green = np.asarray(canvas.picture())[..., 1] < 128
    rows, columns = np.nonzero(green)
    assert green.mean() == pytest.approx(share**2, abs=0.06)
    assert columns.min() <= 1
    assert rows.max() >= green.shape[0] - 2  # the least y is the lowest row


def test_walls_ways_and_what_nobody_gets_to() -> None:
    scenario = Scenario(draw_episode("four_rooms", 0), measured(fetch()), lambda name: ())
    plan = draw_plan(scenario, 1000)
    low, high = extent(scenario)

    def pixel(x: float, y: float) -> tuple[int, ...]:
        scale = plan.width / (high[0] - low[0])
        at = int((x - low[0]) * scale), int((high[1] - y) * scale)
        found = plan.getpixel(at)
        assert isinstance(found, tuple)
        return found

    wall = scenario.episode.body("wall_outer_west").map_from_body.position
    assert pixel(wall[0], wall[1]) == pytest.approx(DARK, abs=3)
    assert pixel(-1.0, 0.6) == pytest.approx(WAY, abs=3)
    assert pixel(-10.95, 7.9) == pytest.approx(PAPER, abs=3)
    table = scenario.episode.body("table_b").map_from_body.position
    brown = pixel(table[0] - 0.2, table[1] + 0.4)
    assert brown[0] > brown[1] > brown[2]


def test_a_floor_hides_no_way_and_a_carpet_is_drawn() -> None:
    episode = draw_episode("four_rooms", 0)
    for wide, hidden in ((6.0, False), (1.0, True)):
        part = Part(Box((wide, wide, 0.02)), color=(1.0, 0.0, 0.0), collision=False)
        slab = Body("slab", "body", Transform((-1.0, 0.6, 0.01)), (part,))
        whole = replace(episode, bodies=(*episode.bodies, slab))
        scenario = Scenario(whole, measured(fetch()), lambda name: ())
        plan, (low, high) = draw_plan(scenario, 1000), extent(scenario)
        scale = plan.width / (high[0] - low[0])
        found = plan.getpixel((int((-0.65 - low[0]) * scale), int((high[1] - 0.25) * scale)))
        assert (found != pytest.approx(WAY, abs=3)) == hidden


def test_words_keep_apart_and_are_left_out_where_there_is_no_room() -> None:
    def dark(*words: str, always: bool) -> int:
        canvas = Canvas(np.zeros(2), np.ones(2), 200, WHITE)
        for each in words:
            canvas.text(each, (0.5, 0.5), (0, 0, 0), 14, always=always)
        return int((np.asarray(canvas.picture().convert("L")) < 100).sum())

    one = dark("table", always=True)
    assert dark("table", "table", always=True) == pytest.approx(2 * one, rel=0.2)
    assert dark(*["table"] * 40, always=False) < dark(*["table"] * 40, always=True) + 8 * one
    assert dark(*["table"] * 40, always=False) <= 8 * one


def test_a_deep_floor_makes_no_endless_picture() -> None:
    canvas = Canvas(np.zeros(2), np.array([1.0, 500.0]), 1500, WHITE)
    assert isinstance(canvas.picture(), Image.Image)
    assert max(canvas.size) <= 2200


def test_zones_are_drawn_in_their_colours() -> None:
    corners = ((-6.0, 0.0), (-4.0, 0.0), (-4.0, 1.0), (-6.0, 1.0))
    drawn = {}
    for kind in ZONE_KINDS:
        episode = draw_episode("four_rooms", 0)
        zone = Zone(kind, corners, 0.3 if kind == "slow" else None)
        episode = replace(episode, site=replace(episode.site, zones={"z": zone}))
        scenario = Scenario(episode, measured(fetch()), lambda name: ())
        plan = np.asarray(draw_plan(scenario, 600), dtype=np.float64)
        low, high = extent(scenario)
        scale = plan.shape[1] / (high[0] - low[0])
        rows = slice(int((high[1] - 0.95) * scale), int((high[1] - 0.75) * scale))
        columns = slice(int((-5.9 - low[0]) * scale), int((-4.1 - low[0]) * scale))
        drawn[kind] = plan[rows, columns].mean(axis=(0, 1))
    assert drawn["keep_out"][0] > drawn["keep_out"][1] + 20
    assert drawn["preferred"][1] > drawn["preferred"][0] + 10
    assert drawn["slow"][0] > drawn["slow"][2] + 20
