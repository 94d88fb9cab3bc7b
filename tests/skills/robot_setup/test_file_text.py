"""What is written into a robot file is read as it was meant, whatever the URDF calls its parts."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.robot_setup.find.proposal import propose
from momantu_skills.robot_setup.write.file_text import comment, listed, number, scalar
from momantu_skills.robot_setup.write.writer import robot_file

from momantu_bt.formats.yaml.errors import YamlRules
from momantu_bt.formats.yaml.reader import compose
from momantu_bt.formats.yaml.values import plain_value
from momantu_bt.robots import read_robot


def read(text: str) -> object:
    rules = YamlRules("text", most_bytes=10_000, most_depth=10, most_values=1000)
    return plain_value(compose(text, "t.yaml", rules))


ODD = ["true", "null", "~", "1", "1e3", "0x1f", "2026-01-01", "-", "a: b", "a #b", "a,b", "[a]", ""]
NAMES = st.one_of(
    st.sampled_from(ODD), st.text(st.characters(min_codepoint=32, max_codepoint=126)),
    st.text(st.characters(categories=("L", "N", "P", "Zs"))),
)  # fmt: skip


@given(NAMES)
def test_a_name_is_read_as_it_is_wherever_it_stands(name: str) -> None:
    assert read(f"{{on: {scalar(name)}, xyz: 1}}") == {"on": name, "xyz": 1}
    assert read(f"top:\n  - {scalar(name)}\n  - x") == {"top": [name, "x"]}
    assert read(f"frame: {scalar(name)}    # guessed") == {"frame": name}


@given(NAMES.filter(lambda name: name != "<<"))
def test_a_name_may_be_a_key(name: str) -> None:
    assert read(f"top:\n  {scalar(name)}: [1, 2]") == {"top": {name: [1, 2]}}


@given(st.lists(NAMES))
def test_names_are_listed_in_one_line(names: list[str]) -> None:
    assert read(f"links: {listed(names)}") == {"links": names}


def test_usual_names_are_not_quoted() -> None:
    for name in ("base_link", "../arm-2/robot.urdf.xacro", "/opt/ros/a.urdf", "joint_1"):
        assert scalar(name) == name


@given(st.floats(-1e6, 1e6), st.integers(1, 9))
def test_a_number_is_read_as_near_as_its_digits_say(value: float, digits: int) -> None:
    text = number(value, digits)
    assert float(text) == pytest.approx(value, abs=0.5001 * 10**-digits)
    assert re.fullmatch(r"-?\d+(\.\d*[1-9])?", text)
    assert text != "-0"


@given(st.lists(st.text("abc", min_size=1, max_size=30), min_size=1), st.sampled_from(["", "    "]))
def test_comments_keep_every_word_within_the_width(words: list[str], indent: str) -> None:
    lines = list(comment(" ".join(words), indent, width=40))
    assert all(line.startswith(f"{indent}# ") and len(line) <= 40 for line in lines)
    assert " ".join(line.removeprefix(f"{indent}# ") for line in lines).split() == words


def test_a_robot_with_odd_names_is_read_back(rolling_urdf: Path, tmp_path: Path) -> None:
    text = rolling_urdf.read_text()
    odd = {"pan": "1", "lift": "true", "palm": "hand, right", "roll": "6e0", "mast": "#mast"}
    odd |= {"left_finger": "finger: left", "head_camera_link": "[camera]", "left_slide": "~"}
    for plain, name in odd.items():
        assert f'"{plain}"' in text
        text = text.replace(f'"{plain}"', f'"{name}"')
    source = tmp_path / "1e3"
    source.write_text(text)
    found = propose(source, samples=20)
    (tmp_path / "robot.yaml").write_text(robot_file(found, tmp_path))
    robot = read_robot(tmp_path)
    assert robot.groups["arm"].joints == ("1", "true", "elbow", "flex", "6e0")
    assert robot.end_effector.touch_links == ("hand, right", "finger: left", "right_finger")
    assert set(robot.end_effector.opening) == {"~", "right_slide"}
    assert robot.named_poses == {name: pose.joints for name, pose in found.poses.items()}
    assert robot.ignored_collisions == found.matrix.ignored
