"""`robots reach`: every cell of the map is reached, the picture is one, and each mistake."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from momantu_skills.robot_setup.reach import CELL, reach
from PIL import Image

from momantu_bt.cli import main
from momantu_bt.errors import InputError
from momantu_bt.robots.plugins import load_robot

FETCH = load_robot("fetch")


def test_poses_of_the_hand_lie_in_cells_that_are_reached() -> None:
    found = reach(FETCH, 60_000, seed=0)
    tree = FETCH.kinematics()
    for name in ("carry", "ready"):
        point = tree.base_from_frame(FETCH.hand.frame, FETCH.named_poses[name]).position
        cell = tuple(np.floor((point - found.low) / CELL).astype(int))
        assert found.sides[cell] > 0, name
    assert found.sides.max() <= 1.0
    middles = found.middles()
    assert (middles[:, 2] > 0).all()
    # Lifted as far as it goes and stretched out, the arm is no longer than its links.
    assert 1.0 < np.hypot(middles[:, 0], middles[:, 1]).max() < 1.3
    # It is as long on the left as on the right.
    assert middles[:, 1].max() == pytest.approx(-middles[:, 1].min(), abs=0.11)


def test_a_band_has_the_best_of_its_heights() -> None:
    found = reach(FETCH, 20_000, seed=0)
    low, high = found.band(0.6, 0.75), found.band(0.75, 0.9)
    assert np.array_equal(np.maximum(low, high), found.band(0.6, 0.9))
    assert found.band(5.0, 6.0).max() == 0.0
    assert found.side().shape == (found.sides.shape[0], found.sides.shape[2])


def test_the_same_seed_gives_the_same_map(tmp_path: Path) -> None:
    files = [tmp_path / "a.png", tmp_path / "b.png"]
    for file in files:
        assert main(["robots", "reach", "fetch", "-o", str(file), "--postures", "5000"]) == 0
    assert files[0].read_bytes() == files[1].read_bytes()
    assert Image.open(files[0]).size[0] > 800


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--bottom", "1m", "--top", "50cm"], "--bottom 1m is not below --top 50cm"),
        (["--bottom", "1"], "expected a length with its unit, such as 60cm"),
        (["--bottom", "3 kg"], "--bottom"),
    ],
)
def test_a_wrong_band_is_refused(
    options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["robots", "reach", "fetch", *options]) == 2
    assert message in capsys.readouterr().err


def test_a_robot_without_an_arm_is_refused() -> None:
    groups = {name: group for name, group in FETCH.groups.items() if name != "arm"}
    armless = FETCH.model_copy(update={"groups": groups})
    with pytest.raises(InputError, match="the robot fetch has no arm with a hand; actuators: base"):
        reach(armless, 1000, seed=0)
