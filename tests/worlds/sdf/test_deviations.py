"""Each thing that does not come over is said with its place, and is not said once it is mended."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from momantu_worlds.sdf.body.bodies import MOST_PARTS
from momantu_worlds.sdf.errors import SdfError
from momantu_worlds.sdf.importing import Import

from tests.worlds.sdf.conftest import box

Imported = Callable[..., Import]
TABLE = box("table", "1 1 0.7", "3 0 0.35 0 0 0")
CUBE = "<geometry><box><size>0.1 0.1 0.1</size></box></geometry>"

RUBS = "<surface><friction><ode><mu>{}</mu></ode></friction></surface>"


def loose(name: str, inside: str, pose: str = "1 1 0.05 0 0 0") -> str:
    return f"<model name='{name}'><pose>{pose}</pose><link name='l'>{inside}</link></model>"


def cubes(count: int) -> str:
    return "".join(
        f"<collision name='c{i}'><pose>0 0 {0.2 * i} 0 0 0</pose>{CUBE}</collision>"
        for i in range(count)
    )


def state(inside: str) -> str:
    return f"<state world_name='room'>{inside}</state>"


def saved(name: str, inside: str = "<pose>2 0 0.35 0 0 0</pose>") -> str:
    return state(f"<model name='{name}'>{inside}</model>")


SAID = {
    "a state of nothing": (
        TABLE + saved("chair"), TABLE + saved("table"), "chair", "a state of a model that is not",
    ),
    "a scale": (
        TABLE + saved("table", "<scale>2 1 1</scale>"),
        TABLE + saved("table", "<scale>1 1 1</scale>"),
        "table", "a state with scale 2 1 1",
    ),
    "a ghost": (
        TABLE + loose("ghost", f"<visual name='v'>{CUBE}</visual>"),
        TABLE + loose("ghost", f"<visual name='v'>{CUBE}</visual>{cubes(1)}"),
        "ghost/l", "it can move but not be touched",
    ),
    "no friction at all": (
        box("table", "1 1 0.7", extra=RUBS.format(0)),
        box("table", "1 1 0.7", extra=RUBS.format(1)),
        "table/link", "friction 0",
    ),
    "too many parts": (
        TABLE + loose("pile", cubes(MOST_PARTS + 1)), TABLE + loose("pile", cubes(MOST_PARTS)),
        "pile/l", f"{MOST_PARTS + 1} parts of one loose body",
    ),
    "a joint to nothing": (
        TABLE + "<model name='m'><link name='l'/><joint name='j' type='fixed'>"
        "<parent>l</parent><child>k</child></joint></model>",
        TABLE + "<model name='m'><link name='l'/><link name='k'/><joint name='j' type='fixed'>"
        "<parent>l</parent><child>k</child></joint></model>",
        "m/j", "a joint from 'l' to 'k', which are not both there",
    ),
    "a tight start": (
        "".join(
            box(f"w{i}", "0.2 0.9 1", f"{x} {y} 0.5 0 0 {turn}")
            for i, (x, y, turn) in enumerate(
                [(0.4, 0, 0), (-0.4, 0, 0), (0, 0.4, 1.5708), (0, -0.4, 1.5708)]
            )
        )
        + "<model name='r'><link name='l'><sensor name='s' type='camera'/></link><link name='a'/>"
        "<link name='b'/><joint name='j' type='revolute'><parent>l</parent><child>a</child></joint>"
        "<joint name='k' type='revolute'><parent>a</parent><child>b</child></joint></model>",
        TABLE, "world", "m around the start",
    ),
}  # fmt: skip
"""What is wrong, the same mended, whose it is, and what is said of it."""


@pytest.mark.parametrize("case", SAID)
def test_what_does_not_come_over_is_said_until_it_is_mended(case: str, imported: Imported) -> None:
    wrong, mended, subject, words = SAID[case]
    found = [f for f in imported(wrong).deviations if words in f.what]
    assert [f.subject for f in found] == [subject]
    assert found[0].instead
    assert found[0].place.line >= 1
    assert [f for f in imported(mended).deviations if words in f.what] == []


def test_a_body_of_which_no_shape_is_left_is_said(imported: Imported, tmp_path: Path) -> None:
    (tmp_path / "broken.stl").write_text("solid nothing")
    mesh = "<mesh><uri>broken.stl</uri></mesh>"
    lost = f"<collision name='c'><geometry>{mesh}</geometry></collision>"
    said = [
        f.what for f in imported(TABLE + loose("gone", lost)).deviations if f.subject == "gone/l"
    ]
    assert "a body of which no shape is left" in said
    assert all("no shape" not in f.what for f in imported(TABLE + loose("bare", "")).deviations)


def test_a_still_body_of_many_parts_becomes_several(imported: Imported) -> None:
    """Loose bodies lose parts, those that stand do not."""
    many = loose("pile", cubes(2 * MOST_PARTS + 3)).replace("<link", "<static>1</static><link", 1)
    piles = [body for body in imported(many).world.bodies if body.title.startswith("pile")]
    assert [len(body.parts) for body in piles] == [MOST_PARTS, MOST_PARTS, 3]
    assert len({body.name for body in piles}) == 3


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ("<pose>2e5 0 0 0 0 0</pose>", "<pose> is more than 100000 m away"),
        ("<pose rotation_format='quat_xyzw'>0 0 0 0 0 0 0</pose>", "a quaternion without length"),
        (
            "<pose rotation_format='matrix'>1 0 0 0 0 0</pose>",
            "expected 'euler_rpy' or 'quat_xyzw'",
        ),
        ("<pose>0 0 0 0 0 inf</pose>", "expected a finite number"),
        (
            "<pose relative_to='nowhere'>0 0 0 0 0 0</pose>",
            "there is no frame 'nowhere'; frames here",
        ),
        ("<static>maybe</static>", "<static> has 'maybe'; expected true or false"),
    ],
)
def test_what_cannot_be_read_is_told_with_line_and_column(
    imported: Imported, wrong: str, words: str
) -> None:
    lines = [TABLE, "<model name='m'>", wrong, f"<link name='l'>{cubes(1)}</link></model>"]
    found = imported("\n".join(lines))
    assert [body.name for body in found.world.bodies] == ["table"]
    (told,) = (f for f in found.deviations if f.subject == "m")
    assert words in told.what
    assert told.instead == "this model is left out"
    # two lines stand before what the world holds, and the fault is in its third
    assert (Path(told.place.file).name, told.place.line) == ("room.sdf", 5)
    with pytest.raises(SdfError, match=r"nothing is left of this world.*\n.*room\.sdf:4:\d+: m: "):
        imported("\n".join(lines[1:]))
