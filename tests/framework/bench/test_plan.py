"""Which episodes are wanted, what names them, and which are missing."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

import pytest

from momantu_bt.bench.planning import made_of as module
from momantu_bt.bench.planning.made_of import difference, key_of, made_of
from momantu_bt.bench.planning.plan import Plan, Wanted, record_name
from momantu_bt.bench.rows.spec import EpisodeSpec
from momantu_bt.tree.files.settings import Given
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry

MADE = {"the file t.yaml": "1", "numpy": "2.0"}


def wanted(draw: random.Random, made: dict[str, str] = MADE) -> Wanted:
    faults = [None, "camera.dead", "laser.stuck"]
    pairs = {(draw.randrange(30), draw.choice(faults)) for _ in range(draw.randrange(40))}
    return Wanted(tuple(draw.sample(sorted(pairs, key=str), len(pairs))), made)


def test_shards_are_the_whole_and_no_episode_is_in_two() -> None:
    draw = random.Random(0)
    for _ in range(50):
        whole, of = wanted(draw), draw.randint(1, 7)
        parts = [whole.shard(number, of).episodes for number in range(1, of + 1)]
        assert sorted(sum(parts, ()), key=str) == sorted(whole.episodes, key=str)
        assert max(map(len, parts)) - min(map(len, parts)) <= 1


def test_what_is_kept_is_read_again_and_joins_what_was_there(tmp_path: Path) -> None:
    draw = random.Random(1)
    for _ in range(50):
        one, two = wanted(draw), wanted(draw)
        one.write(tmp_path)
        read = Wanted.read(tmp_path)
        assert read is not None
        assert set(read.episodes) == set(one.episodes)
        both = two.united(read)
        assert set(both.episodes) == {*one.episodes, *two.episodes}
        assert len(both.episodes) == len(set(both.episodes))
        other = Wanted(two.episodes, {**MADE, "numpy": "3.0"})
        assert other.united(read) == other
    assert Wanted.read(tmp_path / "none") is None


def test_present_and_missing_are_all_of_it() -> None:
    draw = random.Random(2)
    for _ in range(50):
        whole = wanted(draw)
        rows = {whole.key(e): {"key": whole.key(e)} for e in whole.episodes if draw.random() < 0.5}
        assert {row["key"] for row in whole.present(rows)} == set(rows)
        plan = Plan("t.yaml", whole)
        specs = plan.specs(rows, Path("out"))
        assert {spec.key for spec in specs} | set(rows) == set(map(whole.key, whole.episodes))
        assert not {spec.key for spec in specs} & set(rows)
        told = whole.missing(rows)
        assert len(told) == len({spec.fault for spec in specs})
        assert (told == []) == (specs == [])
    several = Wanted(tuple((seed, "camera.dead") for seed in (12, *range(40, 48))), MADE)
    assert several.missing({}) == ["seeds 12, 40-47 of camera.dead"]


def test_a_spec_travels_as_json_and_one_of_another_version_does_not() -> None:
    plan = Plan("t.yaml", Wanted(((3, "a.b"),), MADE), values={"x": [1, "2 mm"]}, record="all")
    (spec,) = plan.specs({}, Path("out"))
    assert EpisodeSpec.from_dict(json.loads(json.dumps(spec.as_dict()))) == spec
    assert spec.record == f"out/records/{record_name(3, 'a.b', spec.key)}"
    with pytest.raises(TypeError, match="another version"):
        EpisodeSpec.from_dict({**spec.as_dict(), "colour": "red"})


def test_a_key_is_new_when_anything_is() -> None:
    keys = {
        key_of(made, seed, fault)
        for made in (MADE, {**MADE, "numpy": "2.1"}, {"numpy": "2.0"})
        for seed in (1, 11)
        for fault in (None, "camera.dead")
    }
    assert len(keys) == 12
    assert key_of(dict(reversed(MADE.items())), 1, None) == key_of(MADE, 1, None)


def made(file: Path, **more: Any) -> dict[str, str]:
    registry = Registry.installed()
    values = more.pop("values", None)
    document = load(str(file), registry, values=values).document
    return made_of(document, registry, values=values, **more)


def test_what_an_episode_is_made_of_names_what_was_changed(small: str, tmp_path: Path) -> None:
    file = Path(small)
    before = made(file)
    assert {"python", "numpy", "the code of momantu_bt", "the file small.yaml"} <= set(before)
    assert difference(before, made(file)) == ()
    assert difference(before, made(file, max_time=5.0)) == ("the time limit",)
    given = Given()
    given.set(["n=3"])
    assert difference(before, made(file, values=given)) == ("the values",)
    assert made(file, values=given) == made(file, values={"n": 3})
    elsewhere = tmp_path / "elsewhere" / file.name
    elsewhere.parent.mkdir()
    elsewhere.write_text(file.read_text())
    assert difference(before, made(elsewhere)) == ()
    file.write_text(file.read_text() + "# a remark\n")
    assert difference(before, made(file)) == ("the file small.yaml",)


def test_the_file_of_faults_counts_too(small: str) -> None:
    file = Path(small)
    before = made(file)
    file.with_suffix(".faults.yaml").write_text("momantu_bt: 1\nbegins: {camera.dead: Check}\n")
    assert difference(before, made(file)) == ("the file small.faults.yaml",)


def test_the_code_of_plug_ins_counts_byte_for_byte(stalling: str, tmp_path: Path) -> None:
    before = made(Path(stalling))
    assert "the code of stall_plugins" in before
    assert "the code of momantu_worlds" not in before
    source = tmp_path / "site" / "stall_plugins.py"
    source.write_text(source.read_text() + "\n")
    module._code.cache_clear()
    changed = made(Path(stalling))
    module._code.cache_clear()
    assert difference(before, changed) == ("the code of stall_plugins",)
