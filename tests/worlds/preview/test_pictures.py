"""The plan and the view, against small pictures that are kept, and against what must be in them.

`python tests/worlds/preview/test_pictures.py` writes the kept pictures anew; look at them then.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from momantu_worlds.checking.measures import measured
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.preview.page import page
from momantu_worlds.preview.plan import draw_plan
from momantu_worlds.robots import fetch
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.loading import draw_episode
from momantu_worlds.testing import plain_episode
from numpy.typing import NDArray
from PIL import Image

FOLDER = Path(__file__).parent
KEPT = 96
"""px; width of the kept pictures: small enough that letters and drivers hardly matter."""
MOST = 1.5
"""of 255; the mean difference of two drivers' pictures is far less, what is missing makes more."""


def plan_of(episode: Episode, width: int = 600) -> Image.Image:
    return draw_plan(Scenario(episode, measured(fetch()), lambda name: ()), width)


@cache
def view_of(episode_without: str = "") -> Image.Image:
    """The view of a small scene, with all but one of its bodies."""
    from momantu_worlds.preview.view import draw_view

    episode = plain_episode()
    kept = tuple(body for body in episode.bodies if body.name != episode_without)
    low, high = np.array([-0.4, -0.8, 0.0]), np.array([1.7, 0.8, 1.2])
    return draw_view(replace(episode, bodies=kept), fetch(), low, high, 480)


def small(picture: Image.Image) -> NDArray[np.float64]:
    height = round(picture.height * KEPT / picture.width)
    shrunk = picture.convert("RGB").resize((KEPT, height), Image.Resampling.BOX)
    return np.asarray(shrunk, dtype=np.float64)


def difference(picture: Image.Image, name: str) -> float:
    with Image.open(FOLDER / name) as kept:
        expected = np.asarray(kept.convert("RGB"), dtype=np.float64)
    found = small(picture)
    assert found.shape == expected.shape
    return float(np.abs(found - expected).mean())


def test_the_plan_is_the_one_that_is_kept() -> None:
    assert difference(plan_of(draw_episode("four_rooms", 0)), "four_rooms_plan.png") < MOST


def test_another_episode_has_another_plan() -> None:
    assert difference(plan_of(draw_episode("four_rooms", 1)), "four_rooms_plan.png") > MOST


def test_the_view_is_the_one_that_is_kept() -> None:
    assert difference(view_of(), "plain_view.png") < MOST


@pytest.mark.parametrize("without", ["table_a", "floor"])
def test_a_view_without_a_body_differs(without: str) -> None:
    assert difference(view_of(without), "plain_view.png") > MOST


def test_a_page_is_a_png_with_the_plan_alone_where_no_view_is_wanted() -> None:
    import io

    data = page(plain_episode(), fetch(), view=False)
    with Image.open(io.BytesIO(data)) as picture:
        assert picture.format == "PNG"
        assert picture.width <= 1500
        colors = {color for _, color in picture.getcolors(1 << 24)}
    assert len(colors) > 50


if __name__ == "__main__":
    for name, made in (
        ("four_rooms_plan.png", plan_of(draw_episode("four_rooms", 0))),
        ("plain_view.png", view_of()),
    ):
        Image.fromarray(small(made).astype(np.uint8)).save(FOLDER / name, optimize=True)
