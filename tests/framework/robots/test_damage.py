"""Whatever is wrong with a robot file or a URDF is told in words; nothing else is raised."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from momantu_bt.robot import RobotDescription
from momantu_bt.robots import RobotFileError, read_robot

Write = Callable[..., Path]
ANY = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
WORDS = re.compile(r"[\w.-]+")
STRANGE = st.sampled_from(
    [
        "",
        "0",
        "-1",
        "nan",
        "1e400",
        "x",
        "[]",
        "{}",
        "null",
        "[[",
        '"',
        "&a",
        "*a",
        "true",
        "é",
        "\t",
    ]
)


def damaged(text: str, at: float, new: str, cut: float | None) -> str:
    """One word of a text replaced, or the text cut off."""
    if cut is not None:
        return text[: int(cut * len(text))]
    words = list(WORDS.finditer(text))
    word = words[int(at * (len(words) - 1))]
    return text[: word.start()] + new + text[word.end() :]


def read(file: Path) -> RobotDescription | RobotFileError:
    try:
        return read_robot(file)
    except RobotFileError as error:
        return error


@ANY
@given(st.floats(0, 1), STRANGE, st.one_of(st.none(), st.none(), st.floats(0, 1)))
def test_a_damaged_robot_file(carter: Write, at: float, new: str, cut: float | None) -> None:
    file = carter()
    file.write_text(damaged(file.read_text(), at, new, cut))
    found = read(file)
    assert isinstance(found, RobotDescription) or str(found).startswith(str(file))


@ANY
@given(
    st.sampled_from(["cart.urdf", "arm.urdf.xacro"]),
    st.floats(0, 1),
    STRANGE,
    st.one_of(st.none(), st.none(), st.floats(0, 1)),
)
def test_a_damaged_urdf(carter: Write, name: str, at: float, new: str, cut: float | None) -> None:
    file = carter()
    part = file.parent / name
    part.write_text(damaged(part.read_text(), at, new, cut))
    found = read(file)
    if isinstance(found, RobotDescription):
        found.kinematics().base_from_frame(found.end_effector.frame, found.named_poses["home"])
