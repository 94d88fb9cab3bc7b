"""name_place: names for places and surfaces, and each code."""

from __future__ import annotations

from typing import Any

import pytest
from momantu_skills.mapping.service import MappingService
from momantu_skills.name_place import NamePlace

from tests.skills.scenery.building import TOP, building_of, code, measured


@pytest.fixture
def building(run_tree: Any) -> Any:
    return building_of(run_tree)


def test_a_tree_may_use_the_names_that_it_teaches() -> None:
    """The checker takes names from ports that teach them."""
    assert NamePlace.name.names == "taught"


@pytest.mark.parametrize("name", ["'Table A'", "9th", "a-b", "''", "x" * 61])
def test_a_name_is_like_the_sites_names(building: Any, name: str) -> None:
    assert code(building(f"ahead\nname_place: {{name: {name}}}")) == "BAD_NAME"


def test_a_place_is_no_surface(building: Any) -> None:
    steps = "ahead\nname_place: {name: spot}\nmeasured: {plane: $plane}\n"
    steps += "name_place: {name: spot, plane: $plane}"
    assert code(building(steps, measured=measured(TOP))) == "BAD_NAME"


def test_a_sliver_is_no_surface(building: Any) -> None:
    steps = "ahead\nmeasured: {plane: $plane}\nname_place: {name: rim, plane: $plane}"
    sliver = ((0.0, 0.0), (0.5, 0.0), (0.5, 0.04))
    assert code(building(steps, measured=measured(sliver))) == "BAD_SURFACE"


def test_who_is_lost_names_nothing(building: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MappingService, "quality", 0.3)
    assert code(building("ahead\nname_place: {name: spot}")) == "NOT_LOCALIZED"


def test_a_taught_place_is_a_place_of_the_run(building: Any) -> None:
    report = building("name_place: {name: start}\nahead\nnavigate: {in_front_of: start}")
    assert report.status == "SUCCESS", report.failure or report.error
