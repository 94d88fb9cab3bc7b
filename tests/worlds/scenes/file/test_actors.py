"""Actors of a world file: read with units, and refused in words."""

from __future__ import annotations

from pathlib import Path

import pytest
from momantu_worlds.scenes.file.reader import WorldFileError, parse_world
from momantu_worlds.scenes.loading import FOLDER

TEXT = (FOLDER / "four_rooms.yaml").read_text(encoding="utf-8")


def _with(actors: str) -> str:
    return TEXT.replace("\ngoal:\n", f"\nactors: {actors}\n\ngoal:\n")


def test_units_and_usual_values() -> None:
    world = parse_world(_with("{anna: {stops: [[0, 0], [1 m, 50 cm]], group: 2}}"), Path("r.yaml"))
    anna = world.actors["anna"]
    assert anna.stops == ((0.0, 0.0), (1.0, 0.5))
    assert (anna.speed, anna.pause, anna.group) == ((0.7, 1.1), (1.0, 5.0), 2)


@pytest.mark.parametrize(
    ("actors", "says"),
    [
        ("{anna: {stops: [[0, 0]]}}", "actors.anna.stops"),
        ("{anna: {stops: [[0, 0], [0, 0]]}}", "two of its `stops` are the same"),
        ("{anna: {stops: [[0, 0], [1, 0]], speed: [1, 0.5]}}", "the least, 1, is more than"),
        ("{anna: {stops: [[0, 0], [1, 0]], speed: [1, 20]}}", "less than or equal to 2"),
        ("{anna: {stops: [[0, 0], [1, 0]], pace: 1}}", "unknown key 'pace'"),
        ("{can: {stops: [[0, 0], [1, 0]]}}", "'can' is"),
        ("{anna: {stops: [[0, 0], [1, 0]], group: 0}}", "greater than or equal to 1"),
    ],
)
def test_mistakes_are_told_at_their_line(actors: str, says: str) -> None:
    text = _with(actors)
    with pytest.raises(WorldFileError) as caught:
        parse_world(text, Path("rooms.yaml"))
    assert says in str(caught.value)
    line = text[: text.index("actors: {")].count("\n") + 1
    assert caught.value.problems[0].place.line == line
