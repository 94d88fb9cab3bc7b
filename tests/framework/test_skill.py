"""A skill's declarations are checked when its class is made."""

import numpy as np
import pytest

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from momantu_bt.robot import Robot
from momantu_bt.skill import In, Needs, Out, Run, Skill, compute


class Fetching(Skill):
    """Fetches."""

    count: int = In(doc="how many")
    spot: Pose2D | None = In(None, doc="where")
    found: tuple[Pose2D, ...] = Out(doc="what was found")
    failures = {"GONE": "it is gone"}
    localization: object = Needs()
    scene: object = Needs("planning_scene")


def test_ports_keep_order_direction_and_type() -> None:
    assert list(Fetching.ports) == ["count", "spot", "found"]
    assert Fetching.ports["count"].required
    assert not Fetching.ports["spot"].required
    assert Fetching.ports["found"].direction == "out"
    assert Fetching.ports["found"].type == tuple[Pose2D, ...]
    assert Fetching.needs == ("localization", "planning_scene")


def test_values_belong_to_the_instance() -> None:
    one, other = Fetching(), Fetching()
    one.count = 3
    assert one.count == 3
    with pytest.raises(AttributeError, match="'count' of Fetching has no value"):
        _ = other.count
    assert other.spot is None


def test_a_subclass_inherits_ports() -> None:
    class More(Fetching):
        """Fetches more."""

        extra: float = In(1.0, unit="m", doc="how much more")

    assert list(More.ports) == ["count", "spot", "found", "extra"]
    assert list(Fetching.ports) == ["count", "spot", "found"]


def test_a_port_without_type_is_refused() -> None:
    with pytest.raises(TypeError, match="port Bad.size has no type"):

        class Bad(Skill):
            size = In(doc="no annotation")


def test_a_port_whose_type_is_not_imported_is_refused() -> None:
    with pytest.raises(TypeError, match="must be imported at run time"):

        class Bad(Skill):
            size: "Nowhere" = In(doc="unknown")  # type: ignore[name-defined]  # noqa: F821


def test_a_code_in_lower_case_is_refused() -> None:
    with pytest.raises(TypeError, match="gone: not UPPER_CASE"):

        class Bad(Skill):
            failures = {"gone": "it is gone"}


def test_unknown_kinds_of_names_are_refused() -> None:
    with pytest.raises(TypeError, match="valid: place, surface, named_pose"):
        In(doc="which", names="room")


def test_a_service_is_found_by_name() -> None:
    skill = Fetching()
    skill.services = {"localization": 1, "planning_scene": 2}
    assert skill.localization == 1
    assert skill.scene == 2


def test_compute_hands_over_work_and_returns_its_result() -> None:
    work = compute(lambda: 42, budget=0.2)
    asked = next(work)
    assert asked.budget == 0.2
    assert asked.function() == 42
    with pytest.raises(StopIteration) as end:
        work.send(asked.function())
    assert end.value.value == 42


def test_a_skill_without_run_says_so() -> None:
    with pytest.raises(NotImplementedError, match="Fetching has no run"):
        next(Fetching().run(None))  # type: ignore[arg-type]


def test_failures_are_raised_from_run() -> None:
    class Gone(Skill):
        failures = {"GONE": "it is gone"}

        def run(self, robot: Robot) -> Run:
            yield "looking"
            raise Failure("GONE", "nothing here")

    steps = Gone().run(None)  # type: ignore[arg-type]
    assert next(steps) == "looking"
    with pytest.raises(Failure, match="GONE, nothing here"):
        next(steps)


def test_random_numbers_are_the_engines_or_the_tests() -> None:
    skill = Fetching()
    with pytest.raises(AttributeError, match="no random numbers"):
        _ = skill.random
    skill.random = np.random.default_rng(3)
    assert skill.random.random() == np.random.default_rng(3).random()
