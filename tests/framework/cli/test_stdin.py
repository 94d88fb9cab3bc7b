"""`-` as a tree: every verb reads it from standard input, in both spellings."""

from __future__ import annotations

import subprocess
import sys

import pytest

YAML = "momantu_bt: 1\nmain: A\ntrees:\n  A: [{wait: 1 s}]\n"
XML = '<root BTCPP_format="4"><BehaviorTree ID="A"><Sleep msec="1000"/></BehaviorTree></root>'


def verb(words: list[str], given: bytes) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "momantu_bt", *words]
    return subprocess.run(command, input=given, capture_output=True, check=False, timeout=60)


@pytest.mark.parametrize("tree", [YAML, XML])
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["check", "-"], b"no errors in 1 tree"),
        (["show", "-"], b"wait"),
        (["run", "-", "--world", "none"], b"succeeded after"),
        (["convert", "-", "--to", "yaml"], b"wait: "),
    ],
)
def test_a_tree_on_standard_input(words: list[str], said: bytes, tree: str) -> None:
    done = verb(words, tree.encode())
    assert done.returncode == 0, done.stderr
    assert said in done.stdout


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (YAML.replace("wait", "wiat").encode(), b"<stdin>:4:8: error: no node is called 'wiat'"),
        (b"", b"<stdin>:1:1: error: the file is empty"),
        (b"\xff\xfe", b"not UTF-8"),
    ],
)
def test_mistakes_have_their_place_in_it(given: bytes, said: bytes) -> None:
    done = verb(["check", "-"], given)
    assert done.returncode == 2
    assert said in done.stderr
