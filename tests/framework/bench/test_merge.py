"""Folders of results become one: nothing twice, nothing hidden, what is missing by its name."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

import pytest

from momantu_bt.bench.planning.merge import merge
from momantu_bt.bench.planning.plan import RECORDS, Wanted, record_name
from momantu_bt.bench.rows.spec import Row
from momantu_bt.bench.rows.store import Store, StoreError, read_rows
from momantu_bt.cli import main

Out = pytest.CaptureFixture[str]
MADE = {"momantu-bt": "0.1.0", "the file t.yaml": "ab"}
FAULTS = (None, "camera.dead")


def wanted(seeds: range, made: dict[str, str] = MADE) -> Wanted:
    return Wanted(tuple((seed, fault) for seed in seeds for fault in FAULTS), made)


def row_of(plan: Wanted, episode: tuple[int, str | None], **more: Any) -> Row:
    seed, fault = episode
    told = {"key": plan.key(episode), "seed": seed, "fault": fault, "tree": "t.yaml"}
    told |= {"made_of": dict(plan.made_of), "ended": "report", "status": "SUCCESS"}
    told |= {"success": True, "failure": None, "unmet": [], "tries": 0, "sim_time_s": 2.0}
    told |= {"fingerprint": f"{seed}{fault}", "wall_time_s": 1.0, "process_time_s": 1.5}
    return told | {"memory_mb": 60.0, "exit_code": 0, "error": None} | more


def store(folder: Path, plan: Wanted, rows: list[Row]) -> Path:
    with Store(folder) as opened:
        plan.write(folder)
        for row in rows:
            opened.add(row)
    return folder


def bench_merge(*words: object) -> int:
    return main(["bench", "--merge", *map(str, words)])


@pytest.mark.parametrize("seed", range(20))
def test_rows_and_missing_ones_are_together_what_was_wanted(tmp_path: Path, seed: int) -> None:
    random_ = random.Random(seed)
    plan = wanted(range(random_.randint(1, 9)))
    folders, had = [], set()
    for number in range(random_.randint(1, 4)):
        part = plan.shard(1, 1) if random_.random() < 0.3 else plan.shard(1 + number % 2, 2)
        kept = [each for each in part.episodes if random_.random() < 0.7]
        had |= set(kept)
        rows = [row_of(plan, each, wall_time_s=random_.random()) for each in kept]
        folders.append(store(tmp_path / str(number), plan, rows))
    merged = merge(folders)
    assert [(r["seed"], r["fault"]) for r in merged.rows.values()] == [
        (seed, fault) for fault in FAULTS for seed in range(9) if (seed, fault) in had
    ]
    assert merged.conflicts == ()
    assert merged.doubles == sum(len(read_rows(folder)) for folder in folders) - len(had)
    gone = [each for each in plan.episodes if each not in had]
    assert bool(merged.wanted.missing(merged.rows)) == bool(gone)
    assert merge(list(reversed(folders))).rows.keys() == merged.rows.keys()


def test_shards_of_different_ranges_make_one_whole(tmp_path: Path) -> None:
    first, second = wanted(range(3)), wanted(range(6, 9))
    a = store(tmp_path / "a", first, [row_of(first, each) for each in first.episodes])
    b = store(tmp_path / "b", second, [row_of(second, (6, None))])
    merged = merge([a, b])
    assert len(merged.rows) == 7
    assert merged.wanted.missing(merged.rows) == ["seeds 7, 8", "seeds 6-8 of camera.dead"]


@pytest.mark.parametrize(
    ("more", "fields"),
    [
        ({"fingerprint": "other"}, ("fingerprint",)),
        ({"success": False, "unmet": ["it fell"]}, ("success", "unmet")),
        ({"ended": "hung", "status": None}, ("ended", "status")),
        ({"memory_mb": 99.0, "process_time_s": 7.0, "wall_time_s": 6.0}, ()),
    ],
)
def test_an_episode_that_differs_is_told_and_counts_as_missing(
    tmp_path: Path, capsys: Out, more: dict[str, Any], fields: tuple[str, ...]
) -> None:
    plan = Wanted(((0, None), (1, None)), MADE)
    a = store(tmp_path / "a", plan, [row_of(plan, each) for each in plan.episodes])
    b = store(tmp_path / "b", plan, [row_of(plan, (1, None), **more)])
    out = tmp_path / "out"
    assert bench_merge(a, b, "--out", out) == (1 if fields else 0)
    said = capsys.readouterr()
    assert [row["seed"] for row in read_rows(out)] == ([0] if fields else [0, 1])
    if fields:
        assert f"seed 1 differs between {a} and {b}: {', '.join(fields)}" in said.err
        assert "missing: seeds 1" in said.err
        assert [each.fields for each in merge([a, b]).conflicts] == [fields]
    else:
        assert "1 episodes were in two folders, with equal results" in said.out


def test_it_can_be_done_again_with_more(tmp_path: Path, capsys: Out) -> None:
    plan = Wanted(tuple((seed, None) for seed in range(4)), MADE)
    parts = [
        store(tmp_path / str(k), plan, [row_of(plan, each) for each in plan.shard(k, 2).episodes])
        for k in (1, 2)
    ]
    out, report = tmp_path / "out", tmp_path / "report.json"
    name = record_name(2, None, plan.key((2, None)))
    (parts[0] / RECORDS / name).mkdir(parents=True)
    (parts[0] / RECORDS / name / "run.mcap").write_text("x")
    assert bench_merge(parts[0], "--out", out) == 1
    assert "missing: seeds 1, 3" in capsys.readouterr().err
    assert bench_merge(parts[1], "--out", out, "--report", report) == 0
    assert "4 of 4" in capsys.readouterr().out
    assert bench_merge(*parts, "--out", out) == 0
    assert sorted(row["seed"] for row in read_rows(out)) == [0, 1, 2, 3]
    assert (out / RECORDS / name / "run.mcap").read_text() == "x"
    assert [row["seed"] for row in json.loads(report.read_text())["rows"]] == [0, 1, 2, 3]


def test_rows_of_something_else_stay_where_they_are(tmp_path: Path, capsys: Out) -> None:
    plan, old = Wanted(((0, None),), MADE), Wanted(((0, None),), {**MADE, "the world": "moon"})
    a = store(tmp_path / "a", plan, [row_of(plan, (0, None)), row_of(old, (0, None))])
    assert bench_merge(a, "--out", tmp_path / "out") == 0
    assert "1 rows of other files or options are left out" in capsys.readouterr().err
    assert len(read_rows(tmp_path / "out")) == 1


def test_what_cannot_be_merged_is_a_sentence(tmp_path: Path, capsys: Out) -> None:
    plan, other = wanted(range(2)), wanted(range(2), {**MADE, "the file t.yaml": "cd"})
    a, b = store(tmp_path / "a", plan, []), store(tmp_path / "b", other, [])
    with pytest.raises(StoreError, match="different benches: the file t.yaml"):
        merge([a, b])
    assert bench_merge(a, tmp_path, "--out", tmp_path / "out") == 2
    assert "holds no results of a bench" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    assert bench_merge(a) == 2
    assert "--merge needs --out" in capsys.readouterr().err
    assert main(["bench", str(a), str(b)]) == 2
    assert "a bench is of one tree, not of" in capsys.readouterr().err
