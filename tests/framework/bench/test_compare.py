"""Two trees on the same seeds."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from momantu_bt.bench.rows.store import read_rows
from momantu_bt.bench.statistics.paired import Paired, paired_text
from momantu_bt.cli import main

Out = pytest.CaptureFixture[str]


def compare(*words: object) -> int:
    return main(["compare", *map(str, words)])


def row(seed: int, good: bool, time: float = 1.0) -> dict[str, object]:
    status = "SUCCESS" if good else "FAILURE"
    return {"seed": seed, "ended": "report", "status": status, "success": None, "sim_time_s": time}


def test_every_seed_that_both_have_is_in_one_cell_and_sides_turn_with_the_trees() -> None:
    draw = random.Random(0)
    for _ in range(50):
        a = [row(seed, draw.random() < 0.7, draw.random()) for seed in range(draw.randrange(20))]
        b = [row(seed, draw.random() < 0.5, draw.random()) for seed in range(draw.randrange(20))]
        there, back = Paired.of(a, b), Paired.of(b, a)
        cells = (there.both, there.only_a, there.only_b, there.neither)
        assert sorted(seed for cell in cells for seed in cell) == list(range(min(len(a), len(b))))
        assert (back.only_a, back.only_b, back.p) == (there.only_b, there.only_a, there.p)
        assert back.difference == -there.difference
        assert len(there.slower) == len(there.both)


def test_the_words_say_the_figures() -> None:
    a = [row(seed, seed != 7, 10.0) for seed in range(20)]
    b = [row(seed, seed not in (2, 3, 4, 5, 6, 8), 12.0) for seed in range(20)]
    told = paired_text(Paired.of(a, b), "new", "old")
    assert "on the same 20 seeds" in told
    assert "p = 0.125" in told
    assert "+25.0 %" in told
    assert "median -2.0 s" in told
    assert "only new succeeded on seeds 2-6, 8" in told
    assert "only old succeeded on seeds 7" in told


def test_both_are_run_once_and_rows_are_shared_with_bench(
    small: str, tmp_path: Path, capsys: Out
) -> None:
    other = tmp_path / "worse.yaml"
    other.write_text(Path(small).read_text().replace("attempts: 2", "attempts: 1"))
    out, report = tmp_path / "out", tmp_path / "report.json"
    assert main(["bench", small, "--seeds", "0:2", "--out", str(out / "small")]) == 0
    capsys.readouterr()
    assert compare(small, other, "--seeds", "0:3", "--out", out, "--report", report) == 0
    said = capsys.readouterr().out
    assert "2 episodes are there already; 4 to run" in said
    assert "only small succeeded on seeds 0-2" in said
    told = json.loads(report.read_text())
    assert (told["a"]["successes"], told["b"]["successes"]) == (3, 0)
    assert told["paired"]["only_a"] == [0, 1, 2]
    assert told["paired"]["p"] == 0.25
    assert len(read_rows(out / "small")) == len(read_rows(out / "worse")) == 3
    assert compare(small, other, "--seeds", "0:3", "--out", out) == 0
    assert "0 to run" in capsys.readouterr().out


def test_trees_of_one_name_do_not_share_a_folder(small: str, tmp_path: Path) -> None:
    other = tmp_path / "new" / "small.yaml"
    other.parent.mkdir()
    other.write_text(Path(small).read_text().replace("attempts: 2", "attempts: 1"))
    assert compare(small, other, "--seeds", "0", "--out", tmp_path / "out") == 0
    found = {name: read_rows(tmp_path / "out" / name)[0] for name in ("small", "small-2")}
    assert [row["status"] for row in found.values()] == ["SUCCESS", "FAILURE"]


def test_a_tree_and_itself_are_no_comparison(small: str, tmp_path: Path, capsys: Out) -> None:
    assert compare(small, small, "--seeds", "0:2", "--out", tmp_path / "out") == 2
    assert "are the same; name two different trees" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_map_that_is_not_there_is_told_before_anything_runs(
    small: str, tmp_path: Path, capsys: Out
) -> None:
    other, out = tmp_path / "worse.yaml", tmp_path / "out"
    other.write_text(Path(small).read_text().replace("attempts: 2", "attempts: 1"))
    assert compare(small, other, "--map", tmp_path / "nowhere", "--out", out) == 2
    assert "there is no such folder or file" in capsys.readouterr().err
    assert not out.exists()
