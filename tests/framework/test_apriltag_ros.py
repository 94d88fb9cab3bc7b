"""tags.yaml of apriltag_ros: read as apriltag_ros reads it, and refused with the line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from momantu_bt.descriptions.apriltag_ros import TagsFileError, read_tags
from momantu_bt.tags import TagBundle

GOOD = """
standalone_tags:
  [
    {id: 10, size: 0.05},
    {id: 11, size: 0.1, name: dock},
  ]
tag_bundles:
  [
    {
      name: 'my_bundle',
      layout:
        [
          {id: 0, size: 0.05, x: 0.1, y: 0.2, z: 0.3, qw: 0.7071, qx: 0, qy: 0, qz: 0.7071},
          {id: 5, size: 0.06},
        ]
    },
    {layout: [{id: 5, size: 0.06}]},
  ]
"""


def read(tmp_path: Path, text: str) -> dict[str, TagBundle]:
    file = tmp_path / "tags.yaml"
    file.write_text(text, encoding="utf-8")
    return read_tags(file)


def test_tags_and_bundles_have_names_sizes_and_places(tmp_path: Path) -> None:
    found = read(tmp_path, GOOD)
    assert set(found) == {"tag_10", "dock", "my_bundle", "bundle_1"}
    assert found["dock"].plates[0].edge == 0.1
    bundle = found["my_bundle"]
    assert (bundle.family, bundle.ids) == ("tag36h11", (0, 5))
    assert bundle.plates[0].bundle_from_tag.position == pytest.approx((0.1, 0.2, 0.3))
    assert bundle.plates[0].bundle_from_tag.yaw == pytest.approx(np.pi / 2)
    assert bundle.plates[1].bundle_from_tag.position == pytest.approx((0, 0, 0))
    assert bundle.map_from_bundle is None


def test_settings_may_be_in_the_same_file(tmp_path: Path) -> None:
    settings = "tag_family: 'tag25h9'\ntag_threads: 2\npublish_tf: true\n"
    assert read(tmp_path, GOOD + settings)["dock"].family == "tag25h9"
    assert read(tmp_path, "standalone_tags: []\n") == {}


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("standalone_tags: [{id: 1}]", 1, "needs a key 'size'"),
        ("standalone_tags:\n  - {id: 1, size: 0}", 2, "size"),
        ("standalone_tags:\n  - {id: 1, sise: 0.1}", 2, "did you mean 'size'?"),
        ("standalone_tags:\n- {id: 1, size: 1}\n- {id: 1, size: 1}", 3, "the tag 1 is here twice"),
        (
            "tag_bundles:\n- layout:\n  - {id: 1, size: 1}\n  - {id: 1, size: 1}",
            4,
            "twice in the bundle 'bundle_0'",
        ),
        ("tag_bundles:\n- layout:\n  - {id: 1, size: 1, qw: 2}", 3, "the length 2; expected 1"),
        ("tag_bundles:\n- {layout: []}", 2, "layout"),
        ("tag_family: tag36h12", 1, "tag36h11"),
    ],
)
def test_a_mistake_is_shown_with_its_line(tmp_path: Path, text: str, line: int, said: str) -> None:
    with pytest.raises(TagsFileError) as caught:
        read(tmp_path, text + "\n")
    assert said in str(caught.value)
    assert caught.value.problems[0].place.line == line


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(TagsFileError, match="cannot be read"):
        read_tags(tmp_path / "none.yaml")
