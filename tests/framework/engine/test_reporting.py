"""What a skill logs and draws: terminal, record, page, replay; the run itself does not change."""

from __future__ import annotations

import json

import numpy as np
import pytest

from momantu_bt.geometry import Pose, Transform
from momantu_bt.marker import Axes, Box, Line, Marker, Points, Text
from momantu_bt.page.data import page_data
from momantu_bt.record.reader import read_record
from momantu_bt.record.text.changes import ChangeLines
from momantu_bt.record.view import ViewObserver
from momantu_bt.replay.run_text import run_lines
from momantu_bt.skill import Run, Skill
from momantu_bt.testing import run_skill
from momantu_bt.world import Layer

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]


class Talk(Skill):
    """Say and draw something in each tick."""

    def run(self, robot) -> Run:
        """Talk."""
        self.log("it begins")
        for count in range(3):
            self.draw(
                Line("edge", SQUARE, closed=True, color="red"),
                Points(f"dots {count}", [(count, 0, 0), (np.nan, 0, 0)], size=0.02),
                Axes("pose", Transform((count, 2.0, 0.5)), length=0.2, frame="map"),
                Box("box", Transform((2.0, 2.0, 0.0)), (0.2, 0.4, 0.6), seconds=0.1),
                Text("words", (1.0, 1.0, 1.0), "here", color=(0.1, 0.2, 0.3, 0.5)),
                Text("hand", (0.0, 0.0, 0.0), "hand", frame="gripper_link"),
            )
            yield "talking"
        self.log("two\nlines")


class Quiet(Skill):
    """Do the same without a word."""

    def run(self, robot) -> Run:
        """Wait."""
        for _ in range(3):
            yield "talking"


TREE = "trees: {Main: [talk]}\n"
SILENT = "trees: {Main: [quiet]}\n"


def test_a_test_sees_what_was_logged_and_drawn():
    result = run_skill(Talk)
    assert result.logs == ("it begins", "two\nlines")
    assert {marker.name for marker in result.markers} >= {"edge", "dots 2", "pose", "box"}


def test_it_costs_nothing_and_changes_nothing(run_yaml, tmp_path):
    plain = run_yaml(SILENT, Quiet)
    talking = run_yaml(TREE, Talk)
    recorded = run_yaml(TREE, Talk, record=tmp_path / "r")
    assert plain.fingerprint == talking.fingerprint == recorded.fingerprint


def test_nobody_watches_unless_someone_does(run_yaml, tmp_path):
    seen = []

    class Talk(Skill):
        """Ask."""

        def run(self, robot) -> Run:
            """Ask whether somebody watches."""
            seen.append(self.host.watched)
            return
            yield ""

    run_yaml(TREE, Talk)
    run_yaml(TREE, Talk, record=tmp_path / "r")
    assert seen == [False, True]


def lines_of(run_yaml, tmp_path):
    said: list[str] = []
    run_yaml(
        TREE,
        Talk,
        record=tmp_path / "r",
        watch=lambda run: [ChangeLines(said.append)],
    )
    return said


def test_the_terminal_shows_lines_between_start_and_end(run_yaml, tmp_path):
    words = [line.split(" s ", 1)[1].strip() for line in lines_of(run_yaml, tmp_path)]
    at = words.index("talk: it begins")
    assert words[at - 1] == "talk starts"
    assert words[words.index("talk: two") :][:3] == ["talk: two", "talk: lines", "talk done"]


def test_a_replay_prints_the_same_lines_and_checks(run_yaml, tmp_path):
    said = lines_of(run_yaml, tmp_path)
    recording = read_record(tmp_path / "r")
    assert [line for _, line in run_lines(recording)] == said


GUARDS = """
trees:
  Main:
    - script: $rounds := 1
    - handle:
        try:
          fallback:
            - condition: $rounds == 2
            - precondition: {if: $rounds > 5, child: {wait: 1 s}}
        catch:
          any: {wait: 0.1 s}
    - recover:
        attempts: 2
        try: {condition: $rounds == 3}
        catch:
          any: {script: $rounds = 3}
"""


def test_the_reason_of_a_guard_stands_before_what_handles_it(run_yaml):
    said: list[str] = []
    run_yaml(GUARDS, watch=lambda run: [ChangeLines(said.append)])
    words = [line.split(" s ", 1)[1].strip() for line in said]
    assert words[:2] == [
        "precondition $rounds > 5 fails: FAILED, `rounds > 5` does not hold; rounds is 1",
        "handle: FAILED: wait 0.1 s",
    ]
    at = words.index(
        "condition $rounds == 3 fails: FAILED, `rounds == 3` does not hold; rounds is 1"
    )
    assert words[at + 1] == "recover: FAILED: script $rounds = 3"
    assert sum("does not hold" in line for line in words) == 2


def test_viewers_get_the_markers_and_the_lines(run_yaml, tmp_path):
    lines_of(run_yaml, tmp_path)
    recording = read_record(tmp_path / "r")
    messages = [message for _, message in recording.messages("/markers")]
    assert len(messages) == 3
    entities = {each["id"]: each for each in messages[-1]["entities"]}
    talk = next(node for node in recording.nodes if node.type == "talk")
    edge = entities[f"{talk.index} talk/edge"]
    assert (edge["frame_id"], edge["lines"][0]["type"]) == ("odom", 1)
    assert len(entities[f"{talk.index} talk/dots 2"]["spheres"]) == 1  # without the NaN
    assert entities[f"{talk.index} talk/box"]["lifetime"] == {"sec": 0, "nsec": 100000000}
    assert entities[f"{talk.index} talk/words"]["texts"][0]["text"] == "here"
    assert len(entities[f"{talk.index} talk/pose"]["lines"][0]["colors"]) == 6
    said = [message["message"] for _, message in recording.messages("/log")]
    assert said == ["it begins", "two", "lines"]


def test_the_page_has_a_lane_of_lines_and_shapes_on_its_map(run_yaml, tmp_path):
    lines_of(run_yaml, tmp_path)
    data = json.loads(json.dumps(page_data(read_record(tmp_path / "r"))))
    (lane,) = [lane for lane in data["lanes"] if lane["name"] == "log"]
    assert "talk: it begins" in lane["bars"][0]["words"]
    assert "talk: two\ntalk: lines" in lane["bars"][1]["words"]
    shapes = data["floor"]["markers"]
    boxes = [s for s in shapes if len(s["points"]) == 4]
    assert boxes[0]["points"][0] == [1.9, 1.8]
    assert boxes[-1]["end"] == pytest.approx(boxes[-1]["begin"] + 0.1, abs=0.01)
    edges = [s for s in shapes if s.get("closed") and len(s["points"]) == 3]
    assert [a["end"] for a in edges[:-1]] == [b["begin"] for b in edges[1:]]
    assert not any(s.get("text") == "hand" for s in shapes)


class Scene:
    """A view that keeps what it shows."""

    url = ""

    def __init__(self):
        self.shown, self.erased = {}, []

    def update(self):
        pass

    def close(self):
        pass

    def draw(self, name, marker, map_from_frame, layer=Layer.MARKERS):
        self.shown[name] = map_from_frame

    def erase(self, name):
        self.erased.append(name)
        del self.shown[name]


class Waits(Skill):
    """Draw once, and wait."""

    def run(self, robot) -> Run:
        """Draw in a frame that is known, in one that is not, and something that goes."""
        self.frames.set_map_from_odom(Transform((1.0, 0.0, 0.0)), self.clock.now())
        self.draw(Axes("stays", Transform()), Axes("lost", Transform(), frame="nowhere"))
        self.draw(Axes("goes", Transform(), seconds=0.1))
        for _ in range(10):
            yield "waiting"


def test_a_view_shows_markers_where_they_are_believed_and_erases_old_ones(run_yaml):
    scene = Scene()
    run_yaml("trees: {Main: [waits]}", Waits, watch=lambda run: [ViewObserver(scene, run)])
    assert [name.split("/")[1] for name in scene.shown] == ["stays"]
    assert [name.split("/")[1] for name in scene.erased] == ["goes"]
    assert next(iter(scene.shown.values())).position[0] == 1.0


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: Line("a", [(0, 0)]), r"'a' have shape \(1, 2\), expected \(n, 3\)"),
        (lambda: Points("a", SQUARE, color="rod"), "no color 'rod'; colors: red, green"),
        (lambda: Points("a", SQUARE, color=(1, 2, 3, 4)), "four numbers from 0 to 1"),
        (lambda: Text("a", (0, 0, 0), "b", seconds=-1.0), "expected 0 or more"),
        (
            lambda: Text("a", "b", (0, 0, 0)),
            "position of marker 'a' is 'b', expected three",
        ),
        (lambda: Text("a", (0, 0, 0), 5), "the text of marker 'a' is 5, expected a str"),
        (lambda: Axes("a", (0, 0, 0)), "pose of marker 'a' .* expected a Transform"),
        (lambda: Axes("a", Pose(Transform((0, 0, 0)), "odom", 0.0)), "write pose.transform"),
        (lambda: Box("a", Transform((0, 0, 0)), (0, 0)), "size of marker 'a' is .*three numbers"),
    ],
)
def test_a_wrong_marker_says_what_is_right(wrong, said):
    with pytest.raises(ValueError, match=said):
        wrong()


def test_points_are_copied_and_read_only():
    points = np.zeros((2, 3))
    marker: Marker = Points("a", points)
    points[0] = 1.0
    assert marker.points.sum() == 0.0
    with pytest.raises(ValueError, match="read-only"):
        marker.points[0] = 1.0
