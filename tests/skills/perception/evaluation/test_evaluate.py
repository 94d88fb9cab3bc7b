"""`perception evaluate`: the figures of a detector that knows the truth, and of others."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_skills.perception.evaluation.measure import measured
from momantu_skills.perception.evaluation.precision import MEASURES, average_precisions

from momantu_bt import labelled
from momantu_bt.cli import main
from momantu_bt.detector import View
from momantu_bt.geometry import Pose, Transform
from momantu_bt.labelled import Label, Labelled
from momantu_bt.messages import CameraImage, DetectedObject, ObjectClass

HEIGHT = 0.7
LOOK_DOWN = Transform.from_rotation(
    np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]), (0.0, 0.0, HEIGHT + 1.0)
)
"""`odom_from_camera` of a camera 1 m above the surface, which looks straight down."""


def picture(seed: int = 0) -> Labelled:
    """Two cans on a surface, seen from above; the labels alone are exact."""
    depth = np.full((480, 640), 1.0, dtype=np.float32)
    numbers = np.zeros((480, 640), dtype=np.uint8)
    things = []
    for number, x in ((1, -0.2), (2, 0.2)):
        left = round(320 + 550 * x)
        depth[220:260, left - 20 : left + 20] = 0.88
        numbers[220:260, left - 20 : left + 20] = number
        pose = LOOK_DOWN.inverse() @ Transform((x, 0.0, HEIGHT + 0.06))
        things.append(Label(number, "can", "tin", pose, (0.07, 0.07, 0.12), 1600))
    k = np.array([[550.0, 0.0, 319.5], [0.0, 550.0, 239.5], [0.0, 0.0, 1.0]])
    color = np.full((480, 640, 3), 128, dtype=np.uint8)
    image = CameraImage(float(seed), "camera", color, depth, k)
    outline = np.array([(-0.5, -0.4), (0.5, -0.4), (0.5, 0.4), (-0.5, 0.4)])
    return Labelled(seed, image, LOOK_DOWN, HEIGHT, outline, numbers, tuple(things))


class Knowing:
    """Answers with the first can, as it is."""

    accepted, budget = 0.5, 0.1

    def detect(
        self, views: Sequence[View], low: float, high: float, asked: ObjectClass
    ) -> tuple[DetectedObject, ...]:
        assert low < HEIGHT < high
        assert len(views[0].points) > 1000
        pose = Pose(Transform((-0.2, 0.0, HEIGHT + 0.06)), "odom", 0.0)
        return (DetectedObject("can", pose, (0.07, 0.07, 0.12), "cylinder", 0.9, HEIGHT),)


def test_a_detector_that_knows_one_of_two_gets_half() -> None:
    found = average_precisions([measured(picture(), Knowing())], ("can",))
    assert found["can"] == pytest.approx(dict.fromkeys(MEASURES, 0.5))


def test_evaluate_writes_all_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    labelled.write(tmp_path, picture(4))
    out = tmp_path / "figures.json"
    command = ["perception", "evaluate", "--detector", "geometric", "--seeds", "4"]
    assert main([*command, "--pictures", str(tmp_path), "--json", str(out)]) == 0
    said: dict[str, Any] = json.loads(out.read_text())
    assert said["detector"] == "geometric"
    assert said["things"] == 2
    assert set(said["mean"]) == set(said["can"]) == set(MEASURES)
    assert all(0.0 <= value <= 1.0 for value in said["mean"].values())
    assert "iou50" in capsys.readouterr().out


def test_what_is_wrong_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["perception", "evaluate", "--detector", "geometrik"]) == 2
    assert "geometric" in capsys.readouterr().err
    assert main(["perception", "evaluate", "--seeds", "5:5"]) == 2
    assert "empty" in capsys.readouterr().err
    nothing = ["--detector", "geometric", "--seeds", "0", "--pictures", str(tmp_path)]
    assert main(["perception", "evaluate", *nothing]) == 2
    assert "render seed 0 again" in capsys.readouterr().err
