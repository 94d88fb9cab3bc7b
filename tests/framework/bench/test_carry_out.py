"""From an engine's rows to the disk, with an engine that does what the test says."""

from __future__ import annotations

import signal
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from momantu_bt.bench.episodes.carry_out import MOST_REFUSED, carry_out
from momantu_bt.bench.episodes.engine import Engine
from momantu_bt.bench.episodes.episode import Refused, run
from momantu_bt.bench.episodes.process import EpisodeProcess
from momantu_bt.bench.planning.plan import Plan, Wanted
from momantu_bt.bench.rows.spec import EpisodeSpec, Row
from momantu_bt.bench.rows.store import Store, read_rows

MADE = {"the file t.yaml": "1"}


class Scripted:
    """An engine that ends each episode as `ends` says. closed: whether its generator was."""

    workers = 1

    def __init__(self, ends: Callable[[EpisodeSpec], str]) -> None:
        self.ends = ends
        self.begun: list[int] = []
        self.closed = False

    def running(self) -> tuple[EpisodeSpec, ...]:
        return ()

    def run(self, specs: Iterable[EpisodeSpec]) -> Generator[Row, None, None]:
        try:
            for spec in specs:
                self.begun.append(spec.seed)
                ended = self.ends(spec)
                more = {"status": "SUCCESS", "success": True, "output": "why"}
                yield {**spec.row(), "ended": ended, "exit_code": 0, **more}
        finally:
            self.closed = True


class Silent:
    """A watcher that remembers. shown: seeds of rows."""

    def __init__(self) -> None:
        self.waiting = -1
        self.shown: list[int] = []
        self.closed = False

    def begin(self, rows: Sequence[Row], waiting: int, engine: Engine) -> None:
        self.waiting = waiting

    def row(self, row: Row) -> None:
        self.shown.append(row["seed"])

    def close(self) -> None:
        self.closed = True


def plan(*seeds: int, tree: str = "t.yaml", **more: str) -> Plan:
    wanted = Wanted(tuple((seed, None) for seed in seeds), {**MADE, "tree": tree})
    return Plan(tree, wanted, **more)


def test_two_plans_take_turns_and_each_row_goes_to_its_folder(tmp_path: Path) -> None:
    engine, watcher = Scripted(lambda spec: "report"), Silent()
    with Store(tmp_path / "a") as a, Store(tmp_path / "b") as b:
        work = [(plan(1, 2, 3), a), (plan(11, 12, tree="u.yaml"), b)]
        ended = carry_out(work, engine, watcher)
        assert not ended.interrupted
        assert engine.begun == watcher.shown == [1, 11, 2, 12, 3]
        assert watcher.closed
        carry_out(work, engine, watcher)
        assert watcher.waiting == 0
    assert [row["seed"] for row in read_rows(tmp_path / "a")] == [1, 2, 3]
    assert [row["seed"] for row in read_rows(tmp_path / "b")] == [11, 12]


def test_refused_episodes_leave_no_row_and_several_in_a_row_stop_it(tmp_path: Path) -> None:
    engine = Scripted(lambda spec: "report" if spec.seed in (0, 2) else "refused")
    with Store(tmp_path) as store:
        ended = carry_out([(plan(*range(30)), store)], engine, Silent())
    assert engine.begun == [0, 1, 2, *range(3, 3 + MOST_REFUSED)]
    assert [row["seed"] for row in ended.refused] == [1, *range(3, 3 + MOST_REFUSED)]
    assert [row["seed"] for row in read_rows(tmp_path)] == [0, 2]
    assert engine.closed


def test_ctrl_c_keeps_the_row_that_has_come_and_ends_the_engine(tmp_path: Path) -> None:
    class Pressing(Silent):
        def row(self, row: Row) -> None:
            super().row(row)
            if row["seed"] == 2:
                signal.raise_signal(signal.SIGINT)

    engine, watcher = Scripted(lambda spec: "report"), Pressing()
    with Store(tmp_path) as store:
        assert carry_out([(plan(*range(9)), store)], engine, watcher).interrupted
    assert [row["seed"] for row in read_rows(tmp_path)] == engine.begun == [0, 1, 2]
    assert engine.closed
    assert watcher.closed


@pytest.mark.parametrize(("kind", "left"), [("failures", {1}), ("all", {0, 1}), ("none", {0, 1})])
def test_records_of_successes_are_kept_when_all_are_wanted(
    tmp_path: Path, kind: str, left: set[int]
) -> None:
    """With "none" no episode is told a place, and what lies there is nobody's business."""
    wanted = plan(0, 1, record=kind)
    folders = {spec.seed: spec.record for spec in replace(wanted, record="all").specs({}, tmp_path)}
    for folder in folders.values():
        assert folder is not None
        Path(folder).mkdir(parents=True)
    engine = Scripted(lambda spec: "report" if spec.seed == 0 else "crashed")
    with Store(tmp_path) as store:
        carry_out([(wanted, store)], engine, Silent())
    assert {seed for seed, folder in folders.items() if Path(str(folder)).exists()} == left


def test_an_episode_of_other_files_or_code_does_not_begin(small: str) -> None:
    spec = EpisodeSpec("k", small, 0, made_of={"the code of momantu_bt": "other"})
    with pytest.raises(Refused, match="the code of momantu_bt, .*not what it was when"):
        run(spec)
    with EpisodeProcess(spec) as process:
        row = process.wait()
    assert row["ended"] == "refused"
    assert "not what it was when the bench began" in row["output"]
