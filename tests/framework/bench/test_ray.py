"""Benches on Ray: the same rows as without it, and nothing that runs on afterwards."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from momantu_bt.bench.episodes.parcel import Parcel
from momantu_bt.bench.episodes.process import ONE_THREAD
from momantu_bt.bench.episodes.ray_engine import MOST_DEATHS
from momantu_bt.bench.episodes.ray_task import errand, order
from momantu_bt.bench.planning.made_of import made_of
from momantu_bt.bench.planning.merge import DECIDED
from momantu_bt.bench.rows.spec import EpisodeSpec, Row
from momantu_bt.bench.rows.store import read_rows
from momantu_bt.cli import main
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry

Out = pytest.CaptureFixture[str]
FOLDERS = "momantu_ray_*"
AGENTS = ("ray::DashboardAgent", "ray::RuntimeEnvAgent")
"""Helpers of Ray's that look for a dead cluster for a minute before they end themselves."""


def bench(*words: object) -> int:
    return main(["bench", *map(str, words)])


def of_test(folder: Path) -> list[str]:
    """Command lines of processes that were started with the folder in their environment."""
    found = []
    for each in Path("/proc").glob("[0-9]*/environ"):
        try:
            if str(folder) in each.read_bytes().decode(errors="replace"):
                found.append((each.parent / "cmdline").read_text().replace("\0", " ").strip())
        except OSError:
            continue
    return list(filter(None, found))


def await_none(folder: Path, *, but: tuple[str, ...] = ()) -> None:
    for _ in range(200):
        running = [line for line in of_test(folder) if line not in but]
        if not running:
            return
        time.sleep(0.1)
    pytest.fail(f"still running: {running}")


@pytest.fixture(autouse=True)
def _no_folders() -> Iterator[None]:
    """What Ray keeps is gone with it, but for what was killed."""
    before = set(Path("/tmp").glob(FOLDERS))
    yield
    for folder in set(Path("/tmp").glob(FOLDERS)) - before:
        shutil.rmtree(folder, ignore_errors=True)


def decided(row: Row) -> dict[str, object]:
    fields = (*DECIDED, "key", "tree", "failure", "measures", "exit_code", "made_of")
    return {name: row.get(name) for name in fields}


@pytest.mark.slow
def test_rows_are_those_of_the_local_engine_and_dead_workers_are_replaced(
    stalling: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Out
) -> None:
    monkeypatch.setenv("OF_THIS_TEST", str(tmp_path))
    for name, value in ONE_THREAD.items():
        monkeypatch.setenv(name, value)
    folders = set(Path("/tmp").glob(FOLDERS))
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    ray, local = tmp_path / "ray", tmp_path / "local"
    words = (stalling, "--record", "all", "--jobs", 2)
    assert bench(*words, "--seeds", "3:5,8:10", "--out", ray, "--engine", "ray") == 0
    assert bench(*words, "--seeds", "3:5", "--out", local) == 0
    rows = {row["seed"]: row for row in read_rows(ray)}
    for row in read_rows(local):
        assert decided(rows[row["seed"]]) == decided(row)
        assert [n["place"] for n in rows[row["seed"]].get("nodes", [])] == [
            n["place"] for n in row.get("nodes", [])
        ]
    assert (rows[9]["ended"], rows[9]["status"]) == ("report", "SUCCESS"), rows[9]["failure"]
    assert (rows[8]["ended"], rows[8]["exit_code"]) == ("crashed", None)
    assert f"{MOST_DEATHS} workers died under this episode" in rows[8]["output"]
    assert "crashed, its workers died" in capsys.readouterr().out
    (record,) = (ray / "records").glob("seed-4-*")
    (other,) = (local / "records").glob("seed-4-*")
    assert {each.name for each in record.iterdir()} == {each.name for each in other.iterdir()}
    assert not [line for line in of_test(tmp_path) if "ray" in line and "pytest" not in line]
    assert set(Path("/tmp").glob(FOLDERS)) <= folders
    assert [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)] == handlers


LOOPBACK = {"0100007F", "00000000000000000000000001000000", "0000000000000000FFFF00000100007F"}
"""127.0.0.1, ::1 and ::ffff:127.0.0.1 as the kernel writes them."""
LISTENS = "0A"
"""The state of a TCP socket, in `/proc/net/tcp`."""


def addresses_of(*programs: str) -> list[str]:
    """Local addresses at which processes of these programs listen, as the kernel writes them."""
    sockets = set()
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if (process / "comm").read_text().strip() in programs:
                sockets |= {str(fd.readlink()) for fd in (process / "fd").iterdir()}
    lines = [
        line.split()
        for table in (Path("/proc/net/tcp"), Path("/proc/net/tcp6"))
        if table.exists()
        for line in table.read_text().splitlines()[1:]
    ]
    return [
        words[1].partition(":")[0]
        for words in lines
        if words[3] == LISTENS and f"socket:[{words[9]}]" in sockets
    ]


@pytest.mark.slow
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_nothing_runs_on_when_the_bench_is_ended(
    stalling: str, tmp_path: Path, end: signal.Signals
) -> None:
    words = [stalling, "--seeds", "0,1", "--out", tmp_path / "out", "--engine", "ray"]
    running = subprocess.Popen(
        [sys.executable, "-m", "momantu_bt", "bench", *map(str, words), "--jobs", "2"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1", "OF_THIS_TEST": str(tmp_path)},
    )
    assert running.stdout is not None
    for line in running.stdout:
        if line.startswith("[1/2]"):
            break
    listening = addresses_of("raylet", "gcs_server")
    running.send_signal(end)
    said = running.communicate(timeout=60)[0]
    assert [row["seed"] for row in read_rows(tmp_path / "out")] == [0]
    if end is signal.SIGINT:
        assert running.returncode == 130, said
        assert "missing: seeds 1; the same command goes on there" in said
        await_none(tmp_path)
    else:
        await_none(tmp_path, but=AGENTS)
    assert listening
    assert set(listening) <= LOOPBACK


@pytest.fixture
def ordered(small: str) -> dict[str, Any]:
    registry = Registry.installed()
    made = made_of(load(small, registry).document, registry)
    return order(EpisodeSpec("k", small, 0, made_of=made), Parcel.of(small))


def test_a_worker_runs_an_episode_of_files_that_it_does_not_have(
    small: str, ordered: dict[str, Any]
) -> None:
    Path(small).unlink()
    answer = errand()(ordered)
    assert (answer["row"]["status"], answer["row"]["tree"]) == ("SUCCESS", "small.yaml")
    assert answer["row"]["nodes"][0]["place"].startswith(f"{small}:")
    assert answer["record"] == {}


def test_a_worker_with_other_versions_gives_no_row(
    ordered: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = {"momantu-bt": "0.1.0", "numpy": "1.0", "no-such": "1", "the code of momantu_bt": "ab"}
    spec = {**ordered["spec"], "made_of": made}
    said = errand()({**ordered, "spec": spec})["refused"]
    assert "the code of momantu_bt is " in said
    assert "numpy is 2" in said
    assert ", not 1.0" in said
    assert "no-such" not in said
    said = errand()({**ordered, "version": "9.9"})["refused"]
    assert "has momantu-bt 0.1.0, not 9.9; install 9.9 there" in said
    monkeypatch.setitem(sys.modules, "momantu_bt", None)
    said = errand()({**ordered, "version": "9.9"})["refused"]
    assert "cannot import momantu-bt" in said


def test_the_errand_travels_as_code() -> None:
    cloudpickle = pytest.importorskip("ray.cloudpickle")
    text = cloudpickle.dumps(errand())
    assert b"cannot import" in text
    assert "not 9.9" in cloudpickle.loads(text)({"version": "9.9"})["refused"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--ray-address", "here"], "write auto or HOST:PORT"),
        (["--ray-address", "127.0.0.1:1"], "no Ray cluster at 127.0.0.1:1"),
    ],
)
def test_a_cluster_that_is_not_there_is_a_sentence(
    small: str, tmp_path: Path, capsys: Out, words: list[str], said: str
) -> None:
    assert bench(small, "--out", tmp_path / "out", "--engine", "ray", *words) == 2
    assert said in capsys.readouterr().err


def test_without_the_package_it_is_said_how_to_get_it(
    small: str, tmp_path: Path, capsys: Out, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    assert bench(small, "--out", tmp_path / "out", "--engine", "ray") == 2
    assert "pip install 'momantu-bt[ray]'" in capsys.readouterr().err
    words = (small, "--out", tmp_path / "out", "--ray-address", "auto")
    assert bench(*words) == 2
    assert "--ray-address needs --engine ray" in capsys.readouterr().err
