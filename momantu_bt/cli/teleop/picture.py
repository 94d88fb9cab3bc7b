"""The screen of a person who drives: the keys, the speeds, and what each part of the robot does."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from rich.console import ConsoleDimensions, Group
from rich.text import Text

from momantu_bt.cli.teleop.controls import Controls
from momantu_bt.messages import RobotState

WIDE = 9
"""Columns of a heading."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What is shown besides the controls.

    headline: what runs. now: the world's clock, s. pace: its speed, times real time. state: the
    robot's; None before the first tick. doing: what each part does: base, arm, head, gripper.
    said: the newest remark, or "".
    """

    headline: str
    now: float
    pace: float
    state: RobotState | None
    doing: Mapping[str, str]
    said: str


def picture(controls: Controls, seen: Seen, size: ConsoleDimensions) -> Group:
    """The screen, at most as high as `size`: where that is low, gaps and then keys are left out."""
    rows = [_header(seen, size.width), *_rows(controls, seen)]
    leave, _ = _keys("", "x leave", "SPACE stop everything", "(Ctrl-D and Ctrl-C leave, too)")
    rows += [(Text(), 1), (leave, 3)]
    said = controls.said or seen.said
    rows.append((_thin(said, "bold yellow"), 3))
    for least in (1, 2):
        for at in reversed([i for i, row in enumerate(rows) if row[1] == least]):
            if len(rows) > size.height:
                del rows[at]
    return Group(*[text for text, _ in rows[: size.height]])


_Row = tuple[Text, int]
"""A line, and how much it matters: 1 a gap, 2 explanations, 3 what must be seen."""


def _header(seen: Seen, width: int) -> _Row:
    slow = f"  {seen.pace:.1f} x real time" if seen.pace < 0.9 else ""
    clock = f"{seen.now:.1f} s{slow}"
    room = max(0, width - len(clock) - 1)
    return _thin(f"{seen.headline[:room]:<{room}} {clock}", "bold"), 3


def _rows(controls: Controls, seen: Seen) -> Iterator[_Row]:
    able = controls.able
    parts: list[tuple[bool, Callable[[Controls, Seen], Iterator[_Row]]]] = [
        (able.base is not None, _base),
        (bool(able.joints), _arm),
        (able.pan is not None or able.tilt is not None, _head),
        (able.opening is not None, _gripper),
    ]
    for there, rows in parts:
        if there:
            yield Text(), 1
            yield from rows(controls, seen)


def _base(controls: Controls, seen: Seen) -> Iterator[_Row]:
    limits = controls.able.base
    assert limits is not None
    linear, angular = controls.base_speed
    yield _state(
        "BASE", seen.doing.get("base", ""), "" if seen.state is None else _speed(seen.state)
    )
    yield _keys("", "w ahead", "s back", "a left", "d right", "q e curves", "(or the arrows)")
    if limits.sideways:
        yield _keys("", "[ slide left", "] slide right")
    most = f"of {limits.linear:.2f}, {limits.angular:.2f}"
    yield _keys("", f"+ faster  - slower: {linear:.2f} m/s, {angular:.2f} rad/s ({most})")


def _speed(state: RobotState) -> str:
    return f"{state.linear:+.2f} m/s {state.angular:+.2f} rad/s"


def _arm(controls: Controls, seen: Seen) -> Iterator[_Row]:
    yield _state("ARM", seen.doing.get("arm", ""), "")
    if controls.by_joints:
        yield from _joint_rows(controls, seen)
    else:
        speed, turn = controls.hand_speed
        yield _keys("hand", "i ahead", "k back", "j left", "l right", "u up", "o down")
        yield _keys("", "with Shift, turn it: U O roll", "I K pitch", "J L yaw")
        yield _keys("", f". faster  , slower: {speed:.2f} m/s, {turn:.2f} rad/s", "m single joints")
    if controls.able.lift is not None:
        yield _keys("torso", "t up", "g down")


def _joint_rows(controls: Controls, seen: Seen) -> Iterator[_Row]:
    names = list(controls.able.joints)
    unit = "m" if controls.joint == controls.able.lift else "rad"
    at = "" if seen.state is None else f" {seen.state.position(controls.joint):+.2f} {unit}"
    number = names.index(controls.joint) + 1
    yield _keys("joint", f"{number} {controls.joint}{at}", "i forth", "k back")
    yield _keys("", f"1-{min(9, len(names))} or j l choose another")
    speed = f"{controls.joint_speed:.2f} {unit}/s"
    yield _keys("", f". faster  , slower: {speed}", "m move the hand")


def _head(controls: Controls, seen: Seen) -> Iterator[_Row]:
    able = controls.able
    yield _state("HEAD", seen.doing.get("head", ""), "")
    up = ["W up", "S down"] if able.tilt is not None else []
    sides = ["A left", "D right"] if able.pan is not None else []
    yield _keys("", "with Shift:", *up, *sides)


def _gripper(controls: Controls, seen: Seen) -> Iterator[_Row]:
    width = "" if seen.state is None else f"{seen.state.gripper_width * 1000:.0f} mm open"
    yield _state("GRIPPER", seen.doing.get("gripper", ""), width)
    yield _keys("", "c close", "v open")


def _state(heading: str, doing: str, measured: str) -> _Row:
    style = "bold red" if doing.startswith(("stopped", "failed")) else "bold cyan"
    style = "yellow" if doing.startswith("slowed") else style
    style = "dim" if doing == "standing" else style
    line = Text(f"{heading:<{WIDE}}", style="bold", no_wrap=True, overflow="ellipsis")
    line.append(doing, style=style)
    if measured:
        line.append(f"  {measured}", style="dim")
    return line, 3


def _keys(heading: str, *words: str) -> _Row:
    return _thin(f"{heading:<{WIDE}}{'   '.join(words)}", ""), 2


def _thin(words: str, style: str) -> Text:
    return Text(words, style=style, no_wrap=True, overflow="ellipsis")
