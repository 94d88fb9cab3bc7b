"""Names in lists, categories, goals on the map, and bounds of numbers with a hint at the unit."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import pytest

from momantu_bt import detector
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import ObjectClass
from momantu_bt.skill import In, Skill
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.registry import Registry
from momantu_bt.world import Site


@dataclass(frozen=True)
class Box:
    """A size with bounds."""

    side: float = field(metadata={"unit": "m", "least": 0.01, "most": 2.0})


class Wave(Skill):
    """Move through named poses."""

    poses: tuple[str, ...] = In(names="named_pose", doc="which")
    lift: float = In(0.1, unit="m", least=0, most=1, doc="how high")
    turn: float = In(0.1, unit="rad", least=-4, most=4, doc="how far")
    sizes: tuple[float, ...] = In((), unit="m", most=2, doc="of what")
    box: Box | None = In(None, doc="in which")
    goal: Pose2D | None = In(None, frame="map", doc="where")
    anywhere: Pose2D | None = In(None, doc="in another frame")
    object: ObjectClass | None = In(None, doc="what")


SITE = Site("rooms", objects={"jar": ObjectClass("jar")}, area=(-2.0, -1.0, 4.0, 3.0))


@pytest.fixture
def found(registry: Registry, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], list[Problem]]:
    """The problems of nodes for a world of 6 x 4 m."""
    classes: Mapping[str, Any] = {"shapes": SimpleNamespace(categories=("can", "mug"))}
    monkeypatch.setattr(detector, "DETECTORS", classes)
    rooms = SimpleNamespace(name="rooms", default_robot="toy", site=lambda: SITE)
    having = replace(registry, skills={"wave": Wave}, worlds={"rooms": rooms})

    def problems(nodes: str, more: str = "") -> list[Problem]:
        text = f"momantu_bt: 1\nworld: rooms\nmain: Main\n{more}\n  Main: [{nodes}]\n"
        document, reading = read(text if more else text.replace("\n\n", "\ntrees:\n"), "t.yaml")
        return check(document, having, reading=reading).problems

    return problems


Found = Callable[..., list[Problem]]


def test_names_in_a_list(found: Found) -> None:
    (problem,) = found("wave: {poses: [home, carri]}")
    assert (problem.code, problem.place.column) == ("unknown-named-pose", 31)
    assert "did you mean carry?" in problem.hint
    assert found("wave: {poses: [home, carry]}") == []


def test_names_in_a_list_behind_a_subtree(found: Found) -> None:
    sub = "trees:\n  Sub: {inputs: {p: list of text}, wave: {poses: $p}}"
    (problem,) = found("Sub: {p: [home, carri]}", sub)
    assert (problem.code, problem.place.line) == ("unknown-named-pose", 6)
    values = "values: {p: [home, carri]}\ntrees:"
    (problem,) = found("wave: {poses: $p}", values)
    assert (problem.code, problem.place.line) == ("unknown-named-pose", 4)


@pytest.mark.parametrize(
    ("port", "hint"),
    [
        (
            "lift: 12",
            "12 m is out of range; expected at least 0 and at most 1 m; did you mean 12",
        ),
        ("lift: 500", "did you mean 500 mm?"),
        (
            "turn: 90",
            "at least -4 and at most 4 rad; did you mean 90 deg?",
        ),
        ("sizes: [1, 7]", "7 m is out of range; expected at most 2 m; did you mean 7 cm or 7 mm?"),
        ("sizes: [1, 7 m]", "7 m is out of range; expected at most 2 m"),
        ("box: {side: 30}", "field 'side': 30 m is out of range"),
        ("goal: {x: 1, y: 2, yaw: 90}", "did you mean 90 deg?"),
        ("object: {category: can, diameter: 66}", "did you mean 66 cm or 66 mm?"),
        ("object: {category: can, height: 0}", "at least 0.001"),
    ],
)
def test_a_number_that_a_thing_of_this_world_cannot_have(
    found: Found, port: str, hint: str
) -> None:
    (problem,) = found(f"wave: {{poses: [home], {port}}}")
    assert problem.code == "wrong-value"
    assert hint in problem.message


def test_a_number_out_of_range_behind_a_subtree(found: Found) -> None:
    sub = "trees:\n  Sub: {inputs: {h: number}, wave: {poses: [home], lift: $h}}"
    (problem,) = found("Sub: {h: 12}", sub)
    assert (problem.code, problem.place.line) == ("wrong-value", 6)
    assert "did you mean 12 cm or 12 mm?" in problem.message
    assert found("Sub: {h: 12 cm}", sub) == []


def test_a_goal_outside_the_map(found: Found) -> None:
    (problem,) = found("wave: {poses: [home], goal: {x: 50, y: 3}}")
    assert problem.code == "outside-map"
    assert "x from -2 to 4 m, y from -1 to 3 m" in problem.hint
    values = "values: {g: {x: 5, y: 3}}\ntrees:"
    (problem,) = found("wave: {poses: [home], goal: $g}", values)
    assert (problem.code, problem.place.line) == ("outside-map", 4)
    assert found("wave: {poses: [home], goal: {x: 3, y: 3}, anywhere: {x: 50, y: 3}}") == []


def test_a_category_that_nothing_knows(found: Found) -> None:
    (problem,) = found("wave: {poses: [home], object: {category: mgu}}")
    assert (problem.code, problem.severity) == ("unknown-category", Severity.WARNING)
    assert "did you mean mug?" in problem.hint
    for known in ("mug", "can", "jar"):
        assert found(f"wave: {{poses: [home], object: {{category: {known}}}}}") == []


def test_a_detector_that_does_not_say_what_it_knows_may_know_all(
    found: Found, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(detector, "DETECTORS", {"any": SimpleNamespace()})
    assert found("wave: {poses: [home], object: {category: mgu}}") == []
