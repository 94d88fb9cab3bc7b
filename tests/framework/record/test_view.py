"""What a view in a browser is told of a run: the tree, and what the robot believes, in layers."""

from __future__ import annotations

import numpy as np
import pytest

from momantu_bt.geometry import Transform
from momantu_bt.marker import Axes, Grid, Line
from momantu_bt.messages import DetectedObject, LaserScan, Pose
from momantu_bt.record.view import ViewObserver, hits
from momantu_bt.running.api import run
from momantu_bt.skill import Out, Run, Skill
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.registry import Registry
from momantu_bt.world import Layer


class Scene:
    """A view that remembers what it was told."""

    url = ""

    def __init__(self):
        self.shown, self.layers, self.headlines, self.closed = {}, {}, [], 0
        self.dismissed = False

    def update(self):
        pass

    def draw(self, name, marker, map_from_frame, layer=Layer.MARKERS):
        self.shown[name], self.layers[name] = (marker, map_from_frame), layer

    def erase(self, name):
        self.shown.pop(name, None)

    def tell(self, headline, lines):
        self.headlines.append((headline, [line.text for line in lines]))

    def end(self, text):
        pass

    def close(self):
        self.closed += 1


def can(x):
    pose = Pose(Transform((x, 0.0, 0.5)), "odom", 0.0)
    return DetectedObject("can", pose, (0.07, 0.07, 0.12), "cylinder", 0.9, 0.44)


class Finds(Skill):
    """Draw a path and a costmap, and find two cans, later one."""

    found: tuple[DetectedObject, ...] = Out(doc="the cans", live=True)

    def run(self, robot) -> Run:
        """Know where odom is, then draw."""
        self.frames.set_map_from_odom(Transform((1.0, 0.0, 0.0)), self.clock.now())
        self.draw(Line("path", np.zeros((2, 3)), frame="map"), Line("edge", np.zeros((2, 3))))
        self.draw(
            Grid("costs", np.zeros((3, 4)), (0.0, 0.0), 0.1, frame="map"), Axes("a", Transform())
        )
        self.found = (can(1.0), can(2.0))
        yield "two"
        yield "two"
        self.found = (can(3.0),)
        yield "one"


def watched(node, *, stays=False):
    """What a view was told of a run of one node."""
    scene = Scene()
    report = run(
        f"momantu_bt: 1\ntrees: {{Main: [{node}]}}",
        world=ScriptedWorld(),
        registry=Registry(skills={"finds": Finds}),
        watch=lambda run: [ViewObserver(scene, run, stays=stays)],
    )
    assert report.status == "SUCCESS"
    return scene


def test_each_thing_is_in_its_layer_and_what_is_gone_is_erased():
    scene = watched("{finds: {found: $cans}}")
    by_layer = {layer: {n for n in scene.layers if scene.layers[n] is layer} for layer in Layer}
    assert {name.split("/")[1] for name in by_layer[Layer.PATH]} == {"path"}
    assert {name.split("/")[1] for name in by_layer[Layer.COSTMAP]} == {"costs"}
    assert {name.split("/")[1] for name in by_layer[Layer.MARKERS]} == {"edge", "a"}
    objects = {name for name in scene.shown if name in by_layer[Layer.OBJECTS]}
    assert len(by_layer[Layer.OBJECTS]) == 4
    assert len(objects) == 2, "one can is left, with its box and its label"
    for name in objects:
        assert scene.shown[name][1].position[0] == 1.0
    assert any("finds" in line for _, lines in scene.headlines for line in lines)
    assert scene.headlines[-1][0].endswith("coming to rest") or "SUCCESS" in scene.headlines[-1][0]
    assert scene.closed == 1


def test_a_view_that_stays_is_not_closed_with_the_run():
    assert watched("{wait: 0.1 s}", stays=True).closed == 0


def test_the_hits_of_a_scan_are_where_its_beams_ended():
    ranges = np.array([1.0, 2.0, np.inf, 10.0, np.nan, 0.0])
    scan = LaserScan(0.0, "laser", 0.0, np.pi / 2, 0.1, 10.0, ranges)
    assert hits(scan) == pytest.approx(np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]))
