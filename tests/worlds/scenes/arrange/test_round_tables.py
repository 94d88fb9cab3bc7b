"""Round tables: everything stands within the disc, and the robot is told that it is one."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from momantu_worlds.scenes.arrange.tabletop import disc_of
from momantu_worlds.scenes.arrange.variation import vary
from momantu_worlds.scenes.geometry.bodies import BodyTop
from momantu_worlds.scenes.geometry.solids import Scene
from momantu_worlds.scenes.geometry.support import SupportTop
from momantu_worlds.scenes.loading import draw_episode, load_world, nominal

from momantu_bt.descriptions.reading import DescriptionError
from momantu_bt.geometry import Transform

ROUND = {"round": True, "at": [4.0, 4.0, 0.3], "size": [0.9, 0.9, 0.72], "sides": [0.0, 1.57]}
PARTS: dict[str, Any] = {
    "tables": {"disc": ROUND},
    "item": {"name": "cola", "kind": "can", "on": "disc", "radius": 0.035, "height": 0.13},
    "objects": {"cup": {"kind": "mug", "on": "disc", "at": [0.44, 0.44], "shift": 0.1}},
    "tags": {"mark": {"id": 1, "edge": 0.12, "on": "disc", "at": [0.4, -0.4]}},
    "distractors": {"most": 4, "gap_to_item": 0.02},
}


@pytest.mark.parametrize("seed", range(12))
def test_all_that_stands_on_a_round_table_is_within_its_edge(
    write: Callable[..., Path], seed: int
) -> None:
    layout = vary(load_world(write(**PARTS)), seed)
    for placed in (*layout.objects, *layout.things):
        own = disc_of(placed)
        assert math.hypot(own.x, own.y) + own.radius <= 0.45 + 1e-9
    (tag,) = layout.tags
    assert math.hypot(tag.at.x, tag.at.y) <= 0.45 - 0.06


def test_the_top_of_a_round_table_ends_at_its_edge(write: Callable[..., Path]) -> None:
    body = draw_episode(write(**PARTS), 3).body("disc")
    top = SupportTop(body)
    for turn in (0.0, 0.8, 2.4):
        for away, inside in ((0.44, True), (0.46, False)):
            point = Transform((away * math.cos(turn), away * math.sin(turn), 0.72))
            pose = body.map_from_body @ point
            assert (top.margin(body.map_from_body, pose) > 0.0) is inside
    scene = Scene({"disc": body}, lambda name: body.map_from_body)
    (level,) = scene.tops
    assert level.margin(body.map_from_body.apply((0.4, 0.4, 0.72))) < 0.0


def test_the_robot_is_told_that_it_is_round(write: Callable[..., Path]) -> None:
    path = write(**PARTS)
    for _ in range(2):  # drawn, and then from the cache
        surface = nominal(path).site.surfaces["disc"]
        assert surface.round
        assert surface.size == (0.9, 0.9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"size": [0.9, 1.2, 0.7]}, "a round top is as deep as wide"),
        ({"kind": "desk"}, "a desk is not round"),
    ],
)
def test_what_cannot_be_round_is_refused(
    write: Callable[..., Path], change: dict[str, Any], words: str
) -> None:
    path = write(tables={"disc": {**ROUND, **change}})
    with pytest.raises(DescriptionError, match=words):
        load_world(path)


def test_a_body_may_have_a_round_top(write: Callable[..., Path]) -> None:
    surface = {"at": [2, 2, 0], "size": [1, 1], "height": 0.5, "sides": [0], "round": True}
    parts = [{"cylinder": {"radius": 0.5, "height": 0.5}, "at": [0, 0, 0.25]}]
    bodies = {"drum": {"at": [2, 2, 0], "parts": parts, "surface": surface}}
    path = write(bodies=bodies)
    assert nominal(path).site.surfaces["drum"].round
    body = draw_episode(path, 0).body("drum")
    assert body.top == BodyTop(body.top.body_from_top, (1.0, 1.0), True)  # type: ignore[union-attr]
    surface["size"] = [1, 2]
    with pytest.raises(DescriptionError, match="its diameter; this one is 1 x 2 m"):
        load_world(write(bodies=json.loads(json.dumps(bodies))))
