"""Bundles of tags: one pose from all corners, as sure as it says, whatever one tag says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.tags.bundles import (
    CORNER_SIGMA,
    PLANE_SIGMA,
    BundlePose,
    Seen,
    TagsDisagreeError,
    pose_of,
)
from momantu_skills.perception.tags.covariances import difference, inverted, moved, turned
from momantu_skills.perception.tags.depth import TagPlane

from momantu_bt.geometry import Array, Transform, quaternion_from_rpy
from momantu_bt.tags import TagBundle, TagPlate, single_tag
from tests.skills.scenery.tag_pictures import K, before, grid

BOARD = grid()
SOLID = replace(
    BOARD,
    plates=(
        *BOARD.plates,
        TagPlate(20, 0.06, Transform((0.2, 0.0, 0.05), quaternion_from_rpy(0.0, 0.6, 0.0))),
    ),
)
CHI2_99 = 16.81
"""Quantile of the chi-square distribution with 6 degrees of freedom."""


def corners_of(plate: TagPlate, pose: Transform) -> Array:
    points = pose.apply(plate.corners())
    return np.asarray((points / points[:, 2:]) @ K.T)[:, :2]


def seen_of(
    bundle: TagBundle, pose: Transform, random: np.random.Generator, depth: bool = False
) -> list[Seen]:
    """What is seen of a bundle, with the noise that the estimate expects."""
    found = []
    for plate in bundle.plates:
        tag = pose @ plate.bundle_from_tag
        if tag.rotation[:, 2] @ tag.position > -0.1 * np.linalg.norm(tag.position):
            continue  # it shows its back, or nothing
        noise = CORNER_SIGMA * random.standard_normal((4, 2))
        plane = None
        if depth:
            normal = tag.rotation[:, 2]
            tilt, share = PLANE_SIGMA
            turn = tilt * random.standard_normal(3)
            turn -= normal * (normal @ turn)
            scaled = (normal + np.cross(turn, normal)) / (normal @ tag.position)
            scaled = scaled * (1.0 + share * random.standard_normal())
            plane = TagPlane(scaled, 1e-8 * np.eye(3))
        found.append(Seen(plate, corners_of(plate, pose) + noise, plane))
    return found


def draw(random: np.random.Generator, tilt: float = 1.0) -> Transform:
    distance = float(random.uniform(0.4, 1.5))
    aside = 0.15 * distance * random.uniform(-1, 1, 2)
    turns = random.uniform(-np.pi, np.pi, 2)
    return before(distance, float(random.uniform(0, tilt)), turns[0], turns[1], aside)


def measured(seen: list[Seen]) -> BundlePose:
    found = pose_of(seen, K)
    assert found is not None
    return found


def squared_errors(bundle: TagBundle, depth: bool, count: int = 120, tilt: float = 1.0) -> Array:
    """Normalized errors squared of many estimates."""
    random = np.random.default_rng(5)
    found = []
    for _ in range(count):
        pose = draw(random, tilt)
        estimate = measured(seen_of(bundle, pose, random, depth))
        off = difference(estimate.camera_from_bundle, pose)
        found.append(off @ np.linalg.solve(estimate.covariance, off))
    return np.array(found)


@pytest.mark.parametrize("bundle", [BOARD, SOLID], ids=["flat", "solid"])
@pytest.mark.parametrize("depth", [False, True], ids=["corners", "depth"])
def test_the_covariance_is_that_of_the_errors(bundle: TagBundle, depth: bool) -> None:
    errors = squared_errors(bundle, depth)
    # the mean of 120 chi-square variables of 6 degrees is within 6 +- 1.04 in 999 of 1000 cases
    assert errors.mean() == pytest.approx(6.0, abs=1.05)
    assert (errors > CHI2_99).mean() < 0.04


def test_a_tag_that_could_lie_in_two_ways_says_so_in_its_covariance() -> None:
    single = single_tag(1, 0.05)
    errors = squared_errors(single, depth=False, tilt=0.5)
    assert (errors > CHI2_99).mean() < 0.04
    random = np.random.default_rng(2)
    doubts = []
    for _ in range(100):
        found = measured(seen_of(single, before(1.5, 0.25, 0.4, 0.0), random))
        doubts.append(found.doubt)
        deviation = np.sqrt(np.diag(found.covariance)[3:].max())
        assert found.doubt < 0.05 or deviation > 0.05
    assert max(doubts) > 0.1
    depths = [
        measured(seen_of(single, before(1.5, 0.25, 0.4, 0.0), random, depth=True)).doubt
        for _ in range(100)
    ]
    assert max(depths) < 1e-6


def test_a_bundle_is_measured_better_than_one_of_its_tags() -> None:
    random = np.random.default_rng(1)
    whole, alone = [], []
    for _ in range(100):
        pose = draw(random)
        seen = seen_of(BOARD, pose, random)
        for errors, some in ((whole, seen), (alone, seen[:1])):
            off = difference(measured(some).camera_from_bundle, pose)
            errors.append((np.linalg.norm(off[:3]), np.linalg.norm(off[3:])))
    better = np.median(alone, axis=0) / np.median(whole, axis=0)
    assert better[0] > 3.0
    assert better[1] > 3.0


@settings(max_examples=25, deadline=None)
@given(st.sets(st.integers(0, 6), min_size=1), st.integers(0, 1000))
def test_hidden_tags_do_not_matter(shown: set[int], seed: int) -> None:
    random = np.random.default_rng(seed)
    pose = draw(random)
    every = seen_of(SOLID, pose, random, depth=True)
    seen = [each for i, each in enumerate(every) if i in shown] or every
    found = measured(seen)
    off = difference(found.camera_from_bundle, pose)
    assert off @ np.linalg.solve(found.covariance, off) < 40.0
    assert found.used == tuple(seen)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 6), st.floats(15.0, 300.0), st.integers(0, 1000))
def test_one_misread_tag_changes_nothing(which: int, shift: float, seed: int) -> None:
    random = np.random.default_rng(seed)
    pose = draw(random)
    seen = seen_of(SOLID, pose, random)
    which = which % len(seen)
    others = [each for i, each in enumerate(seen) if i != which]
    away = shift * np.array([np.cos(seed), np.sin(seed)])
    wrong = replace(seen[which], corners=seen[which].corners + away)
    found = measured([*others, wrong])
    alone = measured(others)
    assert [each.plate.tag_id for each in found.misread] == [wrong.plate.tag_id]
    assert difference(found.camera_from_bundle, alone.camera_from_bundle) == pytest.approx(
        np.zeros(6), abs=1e-6
    )


def test_of_an_id_that_shows_twice_the_right_one_counts() -> None:
    random = np.random.default_rng(3)
    pose = draw(random)
    seen = seen_of(BOARD, pose, random)
    copy = replace(seen[2], corners=0.8 * seen[2].corners + 60.0)
    found = measured([copy, *seen])
    assert found.misread == (copy,)
    assert found.used == tuple(seen)


def test_two_tags_that_contradict_each_other_tell_nothing() -> None:
    random = np.random.default_rng(4)
    seen = seen_of(replace(BOARD, plates=BOARD.plates[:2]), draw(random, 0.3), random)
    moved_away = replace(seen[0], corners=seen[0].corners + np.array([90.0, 40.0]))
    with pytest.raises(TagsDisagreeError, match="the tags 0, 1 do not fit together"):
        pose_of([moved_away, seen[1]], K)


def test_a_layout_that_is_mirrored_is_refused() -> None:
    random = np.random.default_rng(6)
    seen = seen_of(BOARD, draw(random, 0.3), random)

    def mirrored(plate: TagPlate) -> TagPlate:
        at = plate.bundle_from_tag.position * (-1.0, 1.0, 1.0)
        return replace(plate, bundle_from_tag=Transform(at))

    with pytest.raises(TagsDisagreeError):
        pose_of([replace(each, plate=mirrored(each.plate)) for each in seen], K)


def test_a_tag_of_another_size_does_not_count_where_depth_tells() -> None:
    random = np.random.default_rng(7)
    pose = draw(random, 0.5)
    seen = seen_of(BOARD, pose, random, depth=True)
    small = replace(seen[0], plate=replace(seen[0].plate, edge=0.09))
    found = measured([small, *seen[1:]])
    assert found.wrong_size == (small,)
    assert pose_of([small], K) is None


# covariances


def test_a_covariance_turns_and_inverts_with_its_pose() -> None:
    random = np.random.default_rng(8)
    pose = Transform((0.3, -0.2, 1.1), quaternion_from_rpy(2.0, 0.3, -1.0))
    root = 0.002 * random.normal(size=(6, 6))
    covariance = root @ root.T
    steps = random.multivariate_normal(np.zeros(6), covariance, 20_000)
    frame = Transform((1.0, 2.0, 3.0), quaternion_from_rpy(0.4, -0.3, 1.2))
    cases = (
        (turned(covariance, frame.rotation), lambda there: frame @ there),
        (inverted(covariance, pose), lambda there: there.inverse()),
    )
    for expected, made in cases:
        scatter = [difference(made(pose), made(moved(pose, step))) for step in steps[:4000]]
        assert np.cov(np.transpose(scatter)) == pytest.approx(
            expected, abs=0.1 * np.abs(expected).max()
        )


def test_a_step_and_its_difference_undo_each_other() -> None:
    pose = Transform((0.3, -0.2, 1.1), quaternion_from_rpy(2.0, 0.3, -1.0))
    step = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])
    assert difference(pose, moved(pose, step)) == pytest.approx(step, abs=1e-9)
