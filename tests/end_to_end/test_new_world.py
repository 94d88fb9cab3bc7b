"""The main job in a world that `worlds new` has just written."""

import json
from pathlib import Path

import pytest

from momantu_bt.cli import main


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_the_bundled_tree_succeeds_in_a_new_world(tmp_path: Path, seed: int) -> None:
    world, report = tmp_path / "flat.yaml", tmp_path / "report.json"
    assert main(["worlds", "new", str(world)]) == 0
    words = ["run", "bring_object", "--world", str(world), "--seed", str(seed), "--quiet"]
    assert main([*words, "--report", str(report)]) == 0
    assert json.loads(report.read_text(encoding="utf-8"))["success"] is True
