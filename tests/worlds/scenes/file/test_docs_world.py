"""The page about world files is true: its world can be lived in, its tables name every key."""

import re
from pathlib import Path

import pytest
from momantu_worlds.checking.run import check_world
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.loading import draw_episode

PAGE = (Path(__file__).resolve().parents[4] / "docs" / "worlds.md").read_text(encoding="utf-8")


@pytest.fixture
def studio(tmp_path):
    (text,) = re.findall(r"```yaml\n(momantu_world: .*?)```", PAGE, re.DOTALL)
    path = tmp_path / "studio.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_nothing_is_wrong_with_its_world(studio):
    found = check_world(studio, lambda seed: draw_episode(studio, seed), fetch(), range(4))
    assert [finding.message for finding in found] == []


def test_what_stands_in_it_stays_where_it_is(studio):
    episode = draw_episode(studio, 2)
    simulator = Simulator(fetch(), episode, 2, render=False)
    for _ in range(20):
        simulator.step()
    for body in episode.bodies:
        moved = simulator.truth.pose(body.name).position - body.map_from_body.position
        assert abs(moved).max() < 1e-3, body.name


def test_the_tables_name_every_key():
    keys = set(WorldFile.model_fields)
    for part in WorldFile.model_json_schema()["$defs"].values():
        keys |= set(part.get("properties", {}))
    named = set(re.findall(r"`([a-z_]+)[`:]", PAGE))
    assert keys - named == set()
