"""Broken skills at the command line: the exit code, the report, and the robot that stands."""

from __future__ import annotations

import os
import signal

import pytest

FAILS = {
    "sys.exit(0)": (1, "FAILURE", "raised SystemExit: 0"),
    "os._exit(0)": (1, "FAILURE", "raised SystemExit: os._exit(0)"),
    "BaseException": (1, "FAILURE", "raised Odd: odd"),
}
GOES_ON = {
    "closes stdout": "",
    "closes sys.stdout": "",
    "redirects": "standard output redirected",
    "chdir": "changed the working directory to /",
    "thread": "the thread 'sleeper', which the run began, has not ended",
    "child": "(sleep), which the run began, has not ended",
}


@pytest.mark.parametrize("how", FAILS)
def test_a_skill_that_would_end_the_process_fails_and_the_robot_stands(breakers, tmp_path, how):
    code, status, words = FAILS[how]
    ended = breakers.run(tmp_path, how)
    assert (ended.code, ended.report["status"]) == (code, status)
    assert words in ended.report["failure"]["message"]
    assert ended.report["measures"]["stopped"] == 1.0
    assert "Traceback" not in ended.err


@pytest.mark.parametrize("how", GOES_ON)
def test_what_a_skill_does_to_the_process_is_told_and_keeps_it_from_nothing(
    breakers, tmp_path, how
):
    ended = breakers.run(tmp_path, how)
    assert (ended.code, ended.report["status"]) == (0, "SUCCESS")
    assert ended.report["measures"]["stopped"] == 1.0
    assert "tree succeeded" in ended.out
    said = " ".join(ended.report["remarks"])
    assert GOES_ON[how] in said
    assert said in ended.err.replace("momantu-bt: ", "").replace("\n", " ")
    if how == "child":
        os.kill(int(said.split("the process ")[1].split()[0]), signal.SIGKILL)


def test_a_killed_run_leaves_a_report_that_says_so(breakers, tmp_path):
    (tmp_path / "report.json").write_text('{"status": "SUCCESS"}')
    ended = breakers.run(tmp_path, "kill -9")
    assert ended.code in (-9, 137)
    assert ended.report["status"] == "ERROR"
    assert "the process ended in the middle of the run" in ended.report["error"]


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_signal_stops_the_robot_and_is_named(breakers, tmp_path, name):
    ended = breakers.run(tmp_path, name)
    assert (ended.code, ended.report["status"]) == (130, "INTERRUPTED")
    assert ended.report["interrupted_by"] == name
    assert ended.report["measures"]["stopped"] == 1.0
    assert f"was interrupted by {name}" in ended.out
