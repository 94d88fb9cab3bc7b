"""Tags and bundles by their names, in pictures that are drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest
from momantu_skills.perception.tags import detector
from momantu_skills.perception.tags.covariances import difference
from momantu_skills.perception.tags.detector import IDS, Detection, find_all
from momantu_skills.perception.tags.places import place_of
from momantu_skills.perception.tags.recognise import recognise
from momantu_worlds.scenes.catalogue.tags import tag_cells

from momantu_bt.geometry import Transform, quaternion_from_rpy
from momantu_bt.messages import CameraImage
from momantu_bt.tags import FAMILIES, TagBundle, TagFamily, single_tag
from tests.skills.scenery.tag_pictures import K, before, grid, picture, without_depth

BOARD = grid()
NEAR = before(0.7, 0.4, 0.8, 0.3)


def off(found: Transform, true: Transform) -> tuple[float, float]:
    """Distance, m, and angle, rad."""
    return float(np.linalg.norm(found.position - true.position)), found.angle_to(true)


@pytest.mark.parametrize("family", FAMILIES)
def test_each_family_is_read_and_measured(family: TagFamily) -> None:
    bundle = grid(2, 2, 0.05, 0.06, family, first=3)
    shown = recognise([picture([(bundle, NEAR)])], {"board": bundle})
    found = shown.named("board")
    assert found is not None
    assert len(found.pose.used) == 4
    shift, turn = off(found.pose.camera_from_bundle, NEAR)
    assert shift < 0.002
    assert turn < 0.01


def test_families_beside_each_other_are_told_apart() -> None:
    one, other = single_tag(5, 0.06, "tag25h9"), single_tag(5, 0.06, "tag36h11")
    left, right = (before(0.7, 0.2, 0.0, 0.0, (x, 0.0)) for x in (-0.12, 0.12))
    shown = recognise([picture([(one, left), (other, right)])], {"one": one, "other": other})
    for name, pose in (("one", left), ("other", right)):
        found = shown.named(name)
        assert found is not None
        assert off(found.pose.camera_from_bundle, pose)[0] < 0.002


def test_every_family_has_as_many_ids_as_the_library_says() -> None:
    assert set(IDS) == set(FAMILIES)


def test_the_scatter_over_noisy_pictures_is_within_the_covariance() -> None:
    errors = []
    for seed in range(24):
        random = np.random.default_rng(seed)
        distance = float(random.uniform(0.5, 1.2))
        turns = random.uniform(-3, 3, 2)
        pose = before(distance, float(random.uniform(0, 0.9)), turns[0], turns[1])
        found = recognise([picture([(BOARD, pose)], seed=seed)], {"b": BOARD}).named("b")
        assert found is not None
        apart = difference(found.pose.camera_from_bundle, pose)
        errors.append(float(apart @ np.linalg.solve(found.pose.covariance, apart)))
    # chi-square of 6 degrees: a mean of 24 is below 8.6 in 999 of 1000 cases
    assert np.mean(errors) < 8.6
    assert np.mean(errors) > 0.5


def test_all_tags_of_a_picture_have_a_pose_at_once() -> None:
    known = {"board": BOARD, "mark": single_tag(30, 0.08)}
    loose = single_tag(40, 0.05)
    places = {
        "board": before(0.9, 0.3, 0.0, 0.0, (-0.15, 0.0)),
        "mark": before(0.9, 0.2, 1.0, 0.5, (0.2, 0.1)),
        "": before(0.9, 0.3, 2.0, 0.5, (0.2, -0.12)),
    }
    image = picture(
        [(BOARD, places["board"]), (known["mark"], places["mark"]), (loose, places[""])]
    )
    shown = recognise([image], known, edge=0.05, families=("tag36h11",))
    assert {each.name for each in shown.found} == set(places)
    for each in shown.found:
        assert off(each.pose.camera_from_bundle, places[each.name])[0] < 0.003
    assert [each.name for each in recognise([image], known).found] == ["board", "mark"]


def _small_blurred(ids: Sequence[int]) -> CameraImage:
    """Tags of 25 pixels with their white rims, white of 190 and black of 50 before grey of 110."""
    fine = np.full((4800, 6400), 110.0)
    for n, tag_id in enumerate(ids):
        row, column = 300 + 500 * (n // 8), 300 + 700 * (n % 8)
        cells = np.kron(tag_cells(tag_id) > 0, np.ones((20, 20)))
        fine[row : row + 200, column : column + 200] = np.where(cells > 0, 190.0, 50.0)
    blurred = cv2.GaussianBlur(fine, (0, 0), 8.0)
    gray = cv2.resize(blurred, (640, 480), interpolation=cv2.INTER_AREA).astype(np.uint8)
    color = np.ascontiguousarray(np.repeat(gray[..., None], 3, axis=2))
    return CameraImage(0.0, "camera", color, np.zeros(gray.shape, np.float32), K)


@pytest.mark.parametrize("pictures", [1, 3])
def test_small_blurred_tags_before_grey_are_found(pictures: int) -> None:
    ids = [2, 3, 4, 9, 19, 20, 30, 33, 34, 35, 36, 46, 47, 54, 58, 61, 63, 64, 66, 71, 72, 75, 76]
    found = find_all([_small_blurred(ids)] * pictures)
    assert [each.tag_id for each in found] == ids


def test_where_a_tag_is_found_the_picture_is_searched_once(monkeypatch: Any) -> None:
    looks, detect = [], detector._detect

    def counted(*given: Any) -> list[Detection]:
        looks.append(given)
        return detect(*given)

    monkeypatch.setattr(detector, "_detect", counted)
    assert len(find_all([picture([(BOARD, NEAR)])])) == 6
    assert len(looks) == 1
    assert find_all([picture([])]) == []
    assert len(looks) == 3


def test_a_mirrored_tag_is_no_tag() -> None:
    image = picture([(BOARD, NEAR)])
    flipped = replace(image, color=np.ascontiguousarray(image.color[:, ::-1]))
    assert find_all([flipped]) == []


def test_a_partly_hidden_bundle_is_measured_by_what_shows() -> None:
    image = picture([(BOARD, NEAR)])
    color = image.color.copy()
    color[:, 320:] = 90
    found = recognise([replace(image, color=color)], {"b": BOARD}).named("b")
    assert found is not None
    assert 1 <= len(found.pose.used) < 6
    assert off(found.pose.camera_from_bundle, NEAR)[0] < 0.006


def test_a_single_tag_that_shows_twice_is_refused() -> None:
    tag = single_tag(7, 0.06)
    twice = picture([(tag, before(0.7, 0.2, 0, 0, (x, 0.0))) for x in (-0.1, 0.1)])
    shown = recognise([twice], {"mark": tag})
    assert shown.found == ()
    assert shown.refused == {"mark": "the tag 7 shows 2 times"}
    assert len(recognise([twice], {}, edge=0.06, families=("tag36h11",)).found) == 2


def test_an_id_of_two_bundles_tells_neither_alone() -> None:
    one, other = grid(2, 1, first=0), grid(2, 1, first=1)
    known: Mapping[str, TagBundle] = {"one": one, "other": other}
    shared = picture([(single_tag(1, 0.06), NEAR)])
    shown = recognise([shared], known)
    assert shown.found == ()
    assert "belong to another bundle too" in shown.refused["one"]
    whole = recognise([picture([(one, NEAR)])], known)
    assert [each.name for each in whole.found] == ["one"]


def test_a_wrong_size_is_told_by_depth() -> None:
    image = picture([(single_tag(7, 0.06), NEAR)])
    shown = recognise([image], {"mark": single_tag(7, 0.09)})
    assert shown.refused == {"mark": "depth says that the edge is not 0.09 m"}
    blind = recognise([without_depth(image)], {"mark": single_tag(7, 0.09)}).named("mark")
    assert blind is not None
    assert blind.pose.camera_from_bundle.position[2] == pytest.approx(1.5 * 0.7, rel=0.02)


# the camera's place


HUNG = Transform((4.0, 1.0, 1.3), quaternion_from_rpy(np.pi / 2, 0.0, -np.pi / 2))


def placed(bundle: TagBundle, at: Transform) -> TagBundle:
    return replace(bundle, map_from_bundle=at)


def test_the_camera_is_where_a_known_bundle_says() -> None:
    found = place_of([picture([(BOARD, NEAR)])], {"b": placed(BOARD, HUNG)})
    assert found.map_from_camera is not None
    truth = HUNG @ NEAR.inverse()
    shift, turn = off(found.map_from_camera, truth)
    assert shift < 0.004
    assert turn < 0.006
    apart = difference(found.map_from_camera, truth)
    assert apart @ np.linalg.solve(found.covariance, apart) < 30.0
    assert found.used == (0, 1, 2, 3, 4, 5)


def test_a_tag_that_hangs_elsewhere_is_outvoted() -> None:
    tags = {f"t{n}": single_tag(n, 0.06) for n in range(3)}
    at = {name: Transform((0.1 * n - 0.1, 0.0, 0.0)) for n, name in enumerate(tags)}
    image = picture([(tags[name], NEAR @ at[name]) for name in tags])
    known = {name: placed(tags[name], HUNG @ at[name]) for name in tags}
    known["t0"] = placed(tags["t0"], HUNG @ Transform((-0.3, 0.2, 0.0)))
    found = place_of([image], known)
    assert found.map_from_camera is not None
    assert found.used == (1, 2)
    assert off(found.map_from_camera, HUNG @ NEAR.inverse())[0] < 0.01


def test_two_tags_that_contradict_each_other_are_no_place() -> None:
    tags = {f"t{n}": single_tag(n, 0.06) for n in range(2)}
    image = picture([(tags[f"t{n}"], NEAR @ Transform((0.1 * n, 0, 0))) for n in range(2)])
    known = {
        name: placed(tag, HUNG @ Transform((0.3 * n, 0.2 * n, 0)))
        for n, (name, tag) in enumerate(tags.items())
    }
    found = place_of([image], known)
    assert found.map_from_camera is None
    assert "do they hang where the site says" in found.unusable
