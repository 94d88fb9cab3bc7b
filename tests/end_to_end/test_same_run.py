"""Same tree, world and seed: the same run to the bit, whoever watches."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import momantu_bt

TREE = """
momantu_bt: 1
world: four_rooms
main: LookAtTable
trees:
  LookAtTable:
    - reset_pose: home
    - navigate: {in_front_of: table_a}
    - detect_object:
        object: {category: can, diameter: 70 mm, height: 130 mm}
        on: table_a
        found: $found
    - check: {what: near, place: table_a}
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    path = tmp_path / "look.yaml"
    path.write_text(TREE)
    return path


def test_watching_changes_nothing(run: Callable[..., Any], tree: Path, tmp_path: Path) -> None:
    plain = run(tree, "--seed", "4", report="plain.json")
    watched = run(
        tree, "--seed", "4", "--record", tmp_path / "record", "--video", tmp_path / "v.mp4",
        "--view", "--view-port", "0", "--no-referee", report="watched.json",
    )  # fmt: skip
    assert plain.report["status"] == watched.report["status"]
    assert plain.report["fingerprint"] == watched.report["fingerprint"]
    assert plain.report["blackboard"] == watched.report["blackboard"]
    assert watched.report["success"] is None


def test_an_audit_changes_nothing_and_finds_what_is_claimed_to_be_true(tree: Path) -> None:
    plain = momantu_bt.run(tree, seed=4)
    judged = momantu_bt.run(tree, seed=4, audit=True)
    assert plain.fingerprint == judged.fingerprint
    assert plain.claims is None
    assert judged.claims is not None
    assert list(judged.claims) == ["reset_pose", "navigate", "detect_object", "check"]
    for count in judged.claims.values():
        assert (count.successes, count.judged_successes, count.lies) == (1, 1, ())


def test_another_seed_is_another_run(run: Callable[..., Any], tree: Path) -> None:
    prints = {
        run(tree, "--seed", str(seed), "--max-time", "3", report=f"{seed}.json").report[
            "fingerprint"
        ]
        for seed in (1, 2)
    }
    assert len(prints) == 2
