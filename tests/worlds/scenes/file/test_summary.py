"""What `worlds show` tells beside the site, in the file's own words, whatever sections it has."""

from pathlib import Path

import pytest
from momantu_worlds.scenes.file.summary import world_summary
from momantu_worlds.scenes.loading import world_path

from momantu_bt.descriptions.reading import DescriptionError


def test_four_rooms() -> None:
    told = world_summary(world_path("four_rooms"))
    assert list(told) == ["Tags", "Loose things", "What an episode varies", "Goal"]
    assert told["Tags"] == {"tag": "id 1, edge 150 mm, on table_b, at [0.1, 0], shift 15 cm"}
    assert told["What an episode varies"]["table_a"] == "shift 10 cm, turn 5 deg, lift 3 cm"
    assert told["Goal"]["beside"] == "tag"
    assert "chair_a" in told["What an episode varies"]["furniture that may be moved"]


def test_sections_that_are_missing_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "w.yaml"
    path.write_text("tags: {far: {id: 3, hung: [1, 2, 0.5]}}\nstart: {at: [0, 0, 0]}\n")
    assert world_summary(path) == {"Tags": {"far": "id 3, hung [1, 2, 0.5]"}}


def test_a_file_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(DescriptionError, match="cannot be read"):
        world_summary(tmp_path / "none.yaml")
