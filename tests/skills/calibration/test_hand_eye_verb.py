"""`calibrate hand-eye` on a command line: files to a mounting, and what each mistake is told."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_skills.calibration.poses import Poses, rotations_of

from momantu_bt.cli import main
from momantu_bt.geometry import Transform
from tests.skills.scenery.eyes import errors, motion, rows, vectors, write

EYE = Transform((0.05, -0.02, 0.08), (0.5, -0.5, 0.5, -0.5))
TARGET = Transform((0.9, 0.1, 0.3), (0.1, 0.2, -0.9, 0.3))
OFFSET = 0.173
MOST = 1.3
"""mm; twice the standard deviation of the position."""
HEADER = "t,x,y,z,qx,qy,qz,qw"


def seen_from(outer: Poses, seed: int = 0) -> Poses:
    """The target in the camera's frame, with noise of 0.2 deg and 1 mm."""
    rng = np.random.default_rng(seed)
    exact = Poses.of([EYE.inverse()]) @ outer.inverse() @ Poses.of([TARGET])
    turned = rotations_of(vectors(rng, len(outer), np.radians(0.2)))
    return Poses(exact.rotations @ turned, exact.positions + vectors(rng, len(outer), 0.001))


class Files:
    """Two files and what the verb makes of them."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self.folder, self.capsys, self.said = folder, capsys, ""
        self.hand_times, self.times = np.arange(0.0, 12.0, 0.02), np.arange(1.0, 11.0, 0.4)
        self.hand = rows(self.hand_times, motion(self.hand_times, 3))
        self.target = rows(self.times, seen_from(motion(self.times, 3)))

    def run(self, *options: str) -> tuple[int, str]:
        """The exit code, and standard output or else the error."""
        write(self.folder / "hand.csv", self.hand, HEADER)
        write(self.folder / "tag.csv", self.target)
        given = [option.replace("DIR", str(self.folder)) for option in options]
        if {"--base-from-hand", "--hand-from-base"}.isdisjoint(given):
            given += ["--base-from-hand", str(self.folder / "hand.csv")]
        if {"--camera-from-target", "--target-from-camera"}.isdisjoint(given):
            given += ["--camera-from-target", str(self.folder / "tag.csv")]
        code = main(["calibrate", "hand-eye", *given])
        shown = self.capsys.readouterr()
        return code, shown.out if code == 0 else shown.err

    def result(self, *options: str) -> dict[str, Any]:
        code, said = self.run("--json", "DIR/out.json", *options)
        assert code == 0, said
        self.said = said
        return json.loads((self.folder / "out.json").read_text())


@pytest.fixture
def files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Files:
    return Files(tmp_path, capsys)


def off(found: dict[str, Any], true: Transform) -> tuple[float, float]:
    return errors(Transform(found["position"], found["quaternion_wxyz"]), true)


def test_an_eye_in_the_hand(files: Files) -> None:
    found = files.result()
    angle, distance = off(found["hand_from_camera"], EYE)
    assert angle < 0.15
    assert distance < MOST
    assert off(found["base_from_target"], TARGET)[1] < 2.0
    assert found["time_offset"] == 0.0
    shares = found["noise"]["acts_at"]
    assert list(shares) == ["target", "camera", "hand", "base"]
    assert max(shares, key=lambda place: shares[place]) == "target"
    assert sum(shares.values()) == pytest.approx(1.0)
    assert "turns act " in files.said
    assert [method["name"] for method in found["methods"]][-1] == "joint"
    assert len(found["residuals"]) == found["views"] == 25
    assert found["outliers"] == []
    assert found["notes"] == []
    assert files.result() == found


def test_an_eye_on_the_base_and_inverted_files(files: Files) -> None:
    poses = motion(files.times, 3)
    files.hand = rows(files.hand_times, motion(files.hand_times, 3).inverse())
    found = files.result("--eye-on", "base")
    assert off(found["base_from_camera"], EYE)[1] < MOST
    assert off(found["hand_from_target"], TARGET)[1] < 2.0
    files.target = rows(files.times, seen_from(poses).inverse())
    found = files.result(
        "--hand-from-base", "DIR/hand.csv", "--target-from-camera", "DIR/tag.csv"
    )  # both files hold the inverse of what the defaults expect
    assert off(found["hand_from_camera"], EYE)[1] < MOST


def test_the_clocks_differ(files: Files) -> None:
    times = np.arange(1.0, 11.0, 0.1)
    files.target = rows(times - OFFSET, seen_from(motion(times, 3)))
    late = files.result()
    assert any("use --align-time" in note for note in late["notes"])
    found = files.result("--align-time")
    assert found["time_offset"] == pytest.approx(OFFSET, abs=0.001)
    assert off(found["hand_from_camera"], EYE)[1] < MOST


def test_wrong_views_are_named_by_their_lines(files: Files) -> None:
    files.target[[3, 11, 12, 20], 1:4] += 0.3
    found = files.result()
    assert "outliers, without influence: 4 of 25 views" in files.said
    assert found["outliers"] == [4, 12, 13, 21]
    assert off(found["hand_from_camera"], EYE)[1] < MOST


def test_the_terminal_says_the_result(files: Files) -> None:
    _, said = files.run()
    assert "eye in hand: 25 different views" in said
    assert "hand_from_camera\n  position         0.0" in said
    for word in ("Tsai", "Park", "Horaud", "Andreff", "Daniilidis", "joint", "rpy=", "outliers"):
        assert word in said


def scale_hand(files: Files) -> None:
    files.hand[:, 1:4] *= 1000.0


def scale_target(files: Files) -> None:
    files.target[:, 1:4] *= 1000.0


def scale_both(files: Files) -> None:
    scale_hand(files)
    scale_target(files)


def mirror_target(files: Files) -> None:
    files.target[:, [1, 5, 6]] *= -1.0


def turn_back_target(files: Files) -> None:
    files.target[:, 4:7] *= -1.0


def milliseconds(files: Files) -> None:
    files.target[:, 0] *= 1000.0


def invert_target(files: Files) -> None:
    files.target = rows(files.times, seen_from(motion(files.times, 3)).inverse())


def invert_hand(files: Files) -> None:
    files.hand = rows(files.hand_times, motion(files.hand_times, 3).inverse())


def w_first(files: Files) -> None:
    files.target[:, 4:] = files.target[:, [7, 4, 5, 6]]


def still(files: Files) -> None:
    files.hand[:, 1:] = files.hand[0, 1:]


def one_axis(files: Files) -> None:
    turns = np.zeros((len(files.hand), 3))
    turns[:, 2] = np.sin(files.hand_times)
    poses = Poses(rotations_of(turns), motion(files.hand_times, 3).positions)
    files.hand = rows(files.hand_times, poses)


def other_recording(files: Files) -> None:
    files.target = rows(files.times, seen_from(motion(files.times, 8)))


def few(files: Files) -> None:
    files.target = files.target[:4]


def the_same(files: Files) -> None:
    files.target = files.hand


def later(files: Files) -> None:
    files.target[:, 0] += 100.0


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (scale_hand, "positions in DIR/hand.csv are in millimetres; write metres"),
        (scale_target, "positions in DIR/tag.csv are in millimetres; write metres"),
        (scale_both, "positions in DIR/hand.csv and DIR/tag.csv are in millimetres or so; write"),
        (mirror_target, "far better if one of DIR/hand.csv and DIR/tag.csv is mirrored: is the"),
        (
            turn_back_target,
            "if quaternions, not positions, in DIR/tag.csv are inverted; write both",
        ),
        (milliseconds, "Stamps of DIR/tag.csv look like milliseconds; write s"),
        (invert_target, "DIR/tag.csv is inverted: swap --camera-from-target and --target-from-"),
        (invert_hand, "DIR/hand.csv is inverted: swap --base-from-hand and --hand-from-base, or"),
        (w_first, "quaternions in DIR/tag.csv begin with w; a first line t,x,y,z,qw,qx,qy,qz"),
        (still, "all views are alike: of 25 only 1 differ by 1 deg or 5 mm in the hand's pose"),
        (one_axis, "the hand turns about one axis only, (0.00, 0.00, 1.00) of the hand"),
        (other_recording, "the files do not fit together: half of the 25 views are off by more"),
        (few, "4 of 4 poses of DIR/tag.csv have a pose of the hand at the same time; at least 5"),
        (the_same, "DIR/hand.csv and DIR/tag.csv hold the same poses; expected those of the hand"),
        (later, "no overlap in time: DIR/hand.csv lasts from 0.000 to 11.980 s and DIR/tag.csv"),
    ],
)
def test_each_mistake_has_its_sentence(
    files: Files, spoil: Callable[[Files], None], message: str
) -> None:
    spoil(files)
    code, said = files.run()
    assert code == 2
    assert message.replace("DIR", str(files.folder)) in said


def test_swapped_files_fit_and_get_a_note(files: Files) -> None:
    files.hand, files.target = files.target, rows(files.times, motion(files.times, 3))
    assert any("the two files are swapped" in note for note in files.result()["notes"])


def test_a_wrong_size_of_the_tag_gets_a_note(files: Files) -> None:
    files.target[:, 1:4] *= 0.9
    notes = files.result()["notes"]
    assert any("fit better times 1.1" in note for note in notes)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--hand-from-base", "DIR/hand.csv", "--base-from-hand", "DIR/hand.csv"], "expected ei"),
        (["--base-from-hand", "DIR/no.csv"], "no.csv cannot be read: No such file"),
        (["--json", "DIR/no/out.json"], "there is no folder"),
        (["--eye-on", "head"], "'head' is not one of 'hand', 'base'"),
    ],
)
def test_wrong_arguments(files: Files, options: list[str], message: str) -> None:
    code, said = files.run(*options)
    assert code == 2
    assert message in said


def test_the_group_lists_its_verbs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["calibrate", "--help"]) == 0
    assert "hand-eye" in capsys.readouterr().out
    assert main(["calibrate"]) == 2
