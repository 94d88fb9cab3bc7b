"""Detectors are plug-ins: the one in the docs is found by its name, a wrong name by `check`."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest
from momantu_skills.detect_object import DetectObject
from momantu_skills.perception.objects.config import DetectionConfig
from momantu_skills.perception.objects.geometric import GeometricDetector

from momantu_bt import plugins
from momantu_bt.descriptions.tunables import configured
from momantu_bt.detector import DETECTORS, View
from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_bt.plugins import PluginError
from momantu_bt.testing import ScriptedRobot, SkillResult, run_skill, scripted_site
from momantu_bt.testing.painting import Block, Round
from momantu_bt.tree.load import load
from momantu_bt.tree.problems import TreeError
from momantu_bt.world import Site, Surface

PAGE = Path(__file__).resolve().parents[2] / "docs" / "detectors.md"
TOP = 0.72
THINGS = [Block((0.6, 1.2, 0.03), (1.0, 0.0, TOP - 0.015)), Round((0.95, 0.2, TOP), 0.13, 0.035)]
SITE = scripted_site(
    surfaces={"table": Surface(Pose2D(1.0, 0.0, 0.0), (0.6, 1.2), TOP, (math.pi,))}
)
TREE = """momantu_bt: 1
trees:
  Main:
    - detect_object: {{object: {{category: can}}, on: table, detector: {}, found: $can}}
    - pick: $can
"""


@pytest.fixture
def highest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The page's detector, installed."""
    text = PAGE.read_text(encoding="utf-8")
    files = dict(re.findall(r"```\w+ title=(\S+)\n(.*?)```", text, flags=re.DOTALL))
    (tmp_path / "highest.py").write_text(files["highest.py"], encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    value = re.search(r'highest = "([\w.:]+)"', files["pyproject.toml"])
    assert value is not None
    install(monkeypatch, value[1])
    yield
    sys.modules.pop("highest", None)


def install(monkeypatch: pytest.MonkeyPatch, value: str) -> None:
    entry, find = EntryPoint("highest", value, DETECTORS.name), plugins.entry_points

    def found(group: str) -> list[EntryPoint]:
        return [*find(group=group), *([entry] if group == DETECTORS.name else [])]

    monkeypatch.setattr(plugins, "entry_points", found)


@pytest.fixture
def look(
    onlooker: Callable[..., ScriptedRobot], seen_scene: Callable[[], object]
) -> Callable[..., SkillResult]:
    """Looks for a mug on the table."""

    def looked(detector: str | None = "highest", site: Site = SITE) -> SkillResult:
        return run_skill(
            DetectObject,
            robot=onlooker(THINGS),
            site=site,
            services={"planning_scene": seen_scene(), "localization": object()},
            inputs={"object": ObjectClass("mug"), "on": "table", "detector": detector},
        )

    return looked


@pytest.mark.usefixtures("highest")
def test_the_pages_detector_finds_what_it_is_named_for(look: Callable[..., SkillResult]) -> None:
    result = look()
    assert result.status == "SUCCESS", result.explain()
    found = result.outputs["found"]
    assert found.category == "mug"
    assert np.linalg.norm(found.pose.position - (0.95, 0.2, TOP + 0.065)) < 0.03


@pytest.mark.usefixtures("highest")
def test_check_knows_an_installed_detector(tmp_path: Path) -> None:
    assert load(tree(tmp_path, "highest")).problems == []


def test_check_finds_a_detector_that_is_not_installed(tmp_path: Path) -> None:
    with pytest.raises(TreeError) as caught:
        load(tree(tmp_path, "geometrik"))
    found = [(problem.code, problem.hint) for problem in caught.value.problems]
    assert found == [("unknown-plugin", "did you mean geometric?")]


def tree(folder: Path, detector: str) -> str:
    path = folder / "tree.yaml"
    path.write_text(TREE.format(detector), encoding="utf-8")
    return str(path)


def test_what_is_not_a_detector_is_refused_with_what_it_lacks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    install(monkeypatch, "pathlib:Path")
    with pytest.raises(PluginError, match="has no accepted and no budget and no detect"):
        DETECTORS.load("highest")


def test_the_usual_detector_is_the_geometric_one() -> None:
    assert DetectObject.ports["detector"].default is None
    assert DETECTORS.load(DetectionConfig().detector) is GeometricDetector


@pytest.mark.usefixtures("highest")
@pytest.mark.parametrize("named", [None, "geometric"])
def test_the_site_chooses_where_the_tree_does_not(
    named: str | None, look: Callable[..., SkillResult]
) -> None:
    site = replace(SITE, services={"detect_object": {"detector": "highest"}})
    result = look(named, site)
    if named is None:  # it takes whatever stands highest for a mug
        assert result.status == "SUCCESS", result.explain()
    else:
        assert result.failure.code == "OBJECT_NOT_FOUND"


class Guessing:
    """Is sure of what it sees from its third view on, if it ever is."""

    accepted, sure, budget = 0.5, 0.9, 0.05
    ever = True

    def detect(
        self, views: Sequence[View], low: float, high: float, asked: ObjectClass
    ) -> tuple[DetectedObject, ...]:
        certain = self.ever and len(views) >= 3
        pose = Pose(Transform((1.0, 0.2 if certain else -0.3, TOP + 0.05)), "odom", 0.0)
        score = 1.0 if certain else 0.6
        return (DetectedObject("mug", pose, (0.07, 0.07, 0.1), "cylinder", score, TOP),)


class Guess(Guessing):
    """Is never sure."""

    ever = False


@pytest.mark.parametrize(("named", "y"), [("Guessing", 0.2), ("Guess", -0.3)])
def test_a_match_that_is_not_sure_counts_if_no_look_shows_a_better_one(
    named: str, y: float, monkeypatch: pytest.MonkeyPatch, look: Callable[..., SkillResult]
) -> None:
    install(monkeypatch, f"{__name__}:{named}")
    result = look()
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["found"].pose.position[1] == pytest.approx(y)


def test_a_site_that_names_no_detector_is_told() -> None:
    with pytest.raises(ValueError, match="detect_object") as caught:
        configured(DetectionConfig, {"detector": "geometrik"}, "detect_object")
    said = "detect_object.detector: no detector is called 'geometrik'; did you mean geometric?"
    assert str(caught.value) == said
