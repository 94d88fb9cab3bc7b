"""Whatever is done to a world file: it is read and drawn, or refused in words, never a crash."""

import copy
import json
import random
import re
from pathlib import Path

import numpy as np
import pytest
from momantu_worlds.scenes.arrange.episode import build
from momantu_worlds.scenes.arrange.variation import vary
from momantu_worlds.scenes.file.reader import parse_world
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.loading import nominal_site
from momantu_worlds.scenes.site.floor_plan import FREE, OCCUPIED, UNKNOWN, draw_plans
from ruamel.yaml import YAML

from momantu_bt.descriptions.reading import DescriptionError
from momantu_bt.formats.maps import MapPicture
from momantu_bt.world import WorldError

WORLD = """momantu_world: 1
name: studio
rooms:
  hall: {corner: [0, 0], size: [6, 4]}
  store: {outline: [[6, 0], [9, 0], [9, 4], [6, 4]]}
doors:
  out: {at: [3, 0]}
  middle: {at: [6, 2], width: 1.2}
  shut: {at: [0, 3], closed: true}
furniture:
  rack: {kind: shelf, at: [1, 1, 0], size: [0.4, 1, 1.2], boards: [0.1, 0.6], shift: 2 cm}
  sofa: {kind: sofa, at: [4, 3.4, -90 deg], moves: true}
tables:
  desk: {at: [4.8, 0.8, 0], size: [0.8, 1.2, 0.7], sides: [180 deg]}
  low: {board_of: rack, board: 2, sides: [0 deg]}
objects:
  cup: {kind: mug, on: [desk, low]}
  cola: {kind: can, on: desk, at: [0, 0.3], radius: 3 cm, height: 12 cm}
tags:
  mark: {id: 1, edge: 10 cm, on: low, at: [0, 0]}
  sign: {id: 2, edge: 10 cm, hung: [1, 2, 1, 90 deg]}
bodies:
  post:
    at: [8, 3, 0]
    parts: [{sphere: 10 cm}, {box: [1, 1, 1], at: [0, 0, 1, 10 deg, 0, 0]}]
    surface: {at: [8, 3, 0], size: [1, 1], height: 1.5, sides: [180 deg]}
  ball:
    static: false
    mass: 1
    at: [8, 1, 0.5]
    parts: [{cylinder: {radius: 1 cm, height: 1}}]
start: {at: [3, 2, 0], shift: 10 cm}
unknown: {moved: {most: 1}, extra: {most: 2}, areas: [[0,0,6,4]]}
light:
  lamps: [[1, 1]]
  suns: [{direction: [0, 0, -1]}]
  bulbs: [{at: [1, 1, 2], color: [1, 1, 1]}]
distractors: {most: 2, on: [desk]}
goal: {item: cola, on: low, beside: mark}
site:
  places: {home: [3, 2, 0]}
  objects: {can: {category: can, height: 12 cm}}
  services: {localization: {beams: 40}}
"""
VALUES = [
    *(None, True, -1, 0, 1, 3, 1e9, -0.5, "", "x", "none", "5 cm", "90 deg", "2 kg", "desk"),
    *([], [0], [0, 0], [1, 2, 3], [[0, 0], [1, 1]], {}, {"x": 1}, {"kind": "can"}, "../../x.glb"),
]


def spoilt(plain, chance: random.Random):
    """The same values with one to three of them changed, left out, doubled or misnamed."""
    for _ in range(chance.randint(1, 3)):
        here, parent, key = plain, None, None
        while isinstance(here, dict | list) and here and chance.random() < 0.85:
            parent = here
            key = chance.choice(list(here) if isinstance(here, dict) else range(len(here)))
            here = parent[key]
        if parent is None:
            continue
        way = chance.random()
        if way < 0.6:
            parent[key] = chance.choice(VALUES)
        elif way < 0.8:
            del parent[key]
        elif isinstance(parent, dict):
            parent[f"{key}_x" if way < 0.9 else key[:-1]] = parent.pop(key)
        else:
            parent.append(here)
    return plain


def drawn(plain, seed: int) -> tuple[Episode, MapPicture]:
    """An episode and the map of a world of these values."""
    world = parse_world(json.dumps(plain), Path("spoilt.yaml"))
    episode = build(world, vary(world, seed), nominal_site(world))
    plan, _ = draw_plans(world, (0.2, 0.3), 1.0)
    return episode, plan


PLAIN = YAML(typ="safe", pure=True).load(WORLD)


def test_the_world_itself_is_drawn():
    episode, plan = drawn(PLAIN, 0)
    names = {body.name for body in episode.bodies}
    assert {"floor", "desk", "rack", "sofa", "cup", "cola", "mark", "sign", "post", "ball"} <= names
    assert set(episode.site.surfaces) == {"desk", "low", "post"}
    assert set(episode.doorways) == {"out", "middle"}
    assert {OCCUPIED, FREE, UNKNOWN} == set(np.unique(plan.levels).tolist())


def test_a_spoilt_world_is_drawn_or_refused_in_words():
    seeds = range(60)
    refused = [
        seed
        for seed in seeds
        if refusal(spoilt(copy.deepcopy(PLAIN), random.Random(seed)), seed) is not None
    ]
    assert 30 < len(refused) < len(seeds), "most of these worlds are impossible, some are not"


def refusal(plain, seed: int) -> str | None:
    """Why a world is refused; None when it is drawn whole."""
    try:
        episode, plan = drawn(plain, seed)
    except DescriptionError as error:
        places = re.findall(r"^spoilt\.yaml:(\d+):(\d+): \S+ \S+", str(error), re.MULTILINE)
        if len(places) != len(error.problems) or not places:
            pytest.fail(f"a problem has no place or no sentence: {error}")
        return str(error)
    except WorldError as error:
        if repr(plain["name"]) not in str(error):
            pytest.fail(f"it is not said which world is refused: {error}")
        return str(error)
    names = [body.name for body in episode.bodies]
    assert len(set(names)) == len(names)
    assert all(np.isfinite(body.map_from_body.matrix).all() for body in episode.bodies)
    assert plan.levels.size > 0
    return None
