"""A record is as good as what was written before the crash, and never in the way of the run."""

import json
import shutil
import signal
import subprocess
import sys

import pytest

from momantu_bt.formats.files import OutputError
from momantu_bt.record.reader import RecordError, read_record
from momantu_bt.record.recorder import MOST_TICKS
from momantu_bt.running.api import run
from momantu_bt.running.launch import LaunchError
from momantu_bt.skill import Run, Skill
from momantu_bt.tree.registry import Registry

ENDLESS = "momantu_bt: 1\nmain: Main\ntrees: {Main: [{wait: 1000 h}]}\n"
COUNTING = """
momantu_bt: 1
main: Main
values: {n: 0}
trees:
  Main: [{repeat: 400, sequence: [{script: $n := $n + 1}, {wait: 0.1 s}]}]
"""
TELLING = """
import os, sys
from pathlib import Path
from momantu_bt.running.api import run

class Telling:
    def ticked(self, run):
        os.write(1, b"%d\\n" % run.context.tick)
    def close(self):
        pass

tree, record = sys.argv[1:]
run(tree, world="none", record=Path(record), max_time=1e9, watch=lambda run: [Telling()])
"""


@pytest.fixture
def tree(tmp_path):
    def write(text):
        file = tmp_path / "tree.yaml"
        file.write_text(text)
        return str(file)

    return write


def test_after_a_kill_all_but_the_last_moments_can_be_read(tree, tmp_path):
    record = tmp_path / "record"
    command = [sys.executable, "-c", TELLING, tree(ENDLESS), str(record)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if int(line) > 2000:
                break
        process.send_signal(signal.SIGKILL)
        *_, told, _ = (2000, *process.stdout.read().split(), b"maybe cut")
    recording = read_record(record)
    assert (recording.complete, recording.report) == (False, None)
    numbers = [tick.number for tick in recording.ticks]
    assert numbers == list(range(len(numbers)))
    assert numbers[-1] >= int(told) - MOST_TICKS
    assert recording.ticks[1].changes[-1].status == "RUNNING"
    assert recording.nodes
    assert list(recording.files.values()) == [ENDLESS]


def test_a_cut_off_log_is_read_up_to_the_cut(tree, tmp_path):
    run(tree(COUNTING), world="none", record=tmp_path / "record", max_time=2.0)
    path = tmp_path / "record" / "run.mcap"
    whole, data = read_record(tmp_path / "record"), path.read_bytes()
    start = data.index(b'{"nodes"')
    before = 0
    for cut in [*range(start, start + 400, 7), *range(len(data) - 600, len(data), 11)]:
        path.write_bytes(data[:cut])
        recording = read_record(tmp_path / "record")
        assert not recording.complete or recording.report is not None
        assert recording.ticks == whole.ticks[: len(recording.ticks)]
        assert len(recording.ticks) >= before
        before = len(recording.ticks)
    path.write_bytes(data[:300])
    with pytest.raises(RecordError, match="before it says which run it is|off at its beginning"):
        read_record(tmp_path / "record")


@pytest.mark.parametrize("content", [b"", b"no record", b"\x89MCAP0\r\n", None])
def test_what_is_no_record_is_told(tmp_path, content):
    if content is not None:
        (tmp_path / "run.mcap").write_bytes(content)
    with pytest.raises(RecordError, match="run.mcap"):
        read_record(tmp_path)


def test_a_record_of_another_format_is_told(tree, tmp_path):
    run(tree(COUNTING), world="none", record=tmp_path / "record", max_time=0.1)
    path = tmp_path / "record" / "run.mcap"
    path.write_bytes(path.read_bytes().replace(b'{"format":1,', b'{"format":9,'))
    with pytest.raises(RecordError, match="format 9, this version reads 1"):
        read_record(tmp_path / "record")


FULL = """
import resource, sys
from pathlib import Path
from momantu_bt.cli import main

resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, resource.RLIM_INFINITY))
sys.exit(main(["run", sys.argv[1], "--record", sys.argv[2], "--quiet"]))
"""


def test_a_full_disk_ends_the_record_and_not_the_run(tree, tmp_path):
    record = tmp_path / "record"
    command = [sys.executable, "-c", FULL, tree(COUNTING), str(record)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 4  # the tree succeeded, and what was asked for got lost
    assert "succeeded" in done.stdout
    assert json.loads((record / "report.json").read_text())["lost"] == [str(record)]
    assert done.stderr.count("breaks off here: File too large; the run goes on") == 1
    recording = read_record(record)
    assert not recording.complete
    assert 100 < len(recording.ticks) < 1300
    assert (record / "run.mcap").stat().st_size <= 60_000
    assert (record / "report.json").exists()


def test_a_folder_that_is_deleted_meanwhile_is_told(tree, tmp_path):
    record = tmp_path / "record"

    class Vandal:
        def ticked(self, run):
            if run.context.tick == 20:
                shutil.rmtree(record)

        def close(self):
            pass

    report = run(tree(COUNTING), world="none", record=record, watch=lambda run: [Vandal()])
    assert report.status == "SUCCESS"
    assert report.fingerprint == run(tree(COUNTING), world="none").fingerprint
    assert not record.exists()


class Idle(Skill):
    """Does nothing."""

    def run(self, robot) -> Run:
        yield "idle"


def test_a_run_that_never_began_leaves_no_log(tree, tmp_path):
    registry = Registry(skills={"idle": Idle})
    with pytest.raises(LaunchError):
        run(
            tree("momantu_bt: 1\nmain: Main\ntrees: {Main: [idle]}\n"),
            registry=registry,
            world="none",
            record=tmp_path / "record",
        )
    assert list((tmp_path / "record").iterdir()) == []


def test_a_record_is_not_written_over(tree, tmp_path):
    run(tree(COUNTING), world="none", record=tmp_path / "record", max_time=0.1)
    before = read_record(tmp_path / "record")
    with pytest.raises(OutputError, match="holds a record already"):
        run(tree(COUNTING), world="none", record=tmp_path / "record")
    assert read_record(tmp_path / "record") == before
