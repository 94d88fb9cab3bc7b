"""What goes wrong in a robot, a service or a value is told, and is never the record's fault."""

import json
import math

import pytest

from momantu_bt.engine.events import Events
from momantu_bt.engine.skills.actuators import Actuators, SensorRead
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject, WrenchReading
from momantu_bt.record.channels.sensors import Sensors
from momantu_bt.record.channels.ticks import Ticks
from momantu_bt.record.codec import Opaque
from momantu_bt.record.recorder import Recorder
from momantu_bt.service import HeldObject, Service
from momantu_bt.skill import Needs, Out, Run, Skill


def test_one_reading_a_second_of_each_sensor_is_kept(seeing_robot):
    events, kept = Events(), []
    sensors, lease = Sensors(events), Actuators(seeing_robot, events).lease("nobody", ())
    for _ in range(50):
        for sensor in ("camera", "laser"):
            lease.read(sensor)
        kept += [(name, round(reading.stamp, 2)) for name, reading in sensors.taken().items()]
        seeing_robot.advance(0.05)
    assert kept == [(name, at) for at in (0.0, 1.0, 2.0) for name in ("camera", "laser")]


def test_what_is_no_picture_and_no_scan_is_not_kept(seeing_robot):
    events = Events()
    sensors = Sensors(events)
    events.publish(SensorRead("wrench", WrenchReading(0.0, "gripper_link", None, None)))
    assert sensors.taken() == {}


class Broken(Service):
    publishes = {"x": int}
    asked = 0

    def start(self, context):
        pass

    def update(self, robot, now):
        pass

    def published(self):
        Broken.asked += 1
        raise RuntimeError("not today")


class Sees(Skill):
    """Has something to say that JSON cannot hold."""

    broken: object = Needs()
    planning_scene: object = Needs()
    odd: object = Out(doc="something that JSON cannot hold")

    def run(self, robot) -> Run:
        yield "looking"
        for _ in range(10):
            yield "looking"
        self.odd = (object(), {1: "a"})


class PlanningScene(Service):
    """Holds something whose size nobody knows."""

    def start(self, context):
        pose = Pose(Transform((1.0, 2.0, 0.5)), ODOM, 0.0)
        thing = DetectedObject("can", pose, (math.nan, 0.1, 0.1), "box", 0.9, 0.7)
        self.held = HeldObject(thing, Transform())

    def update(self, robot, now):
        pass


TREE = "trees: {Main: [{sees: {odd: $odd}}]}"


def test_what_cannot_be_drawn_or_asked_is_left_out(record_run):
    Broken.asked = 0
    services = {"broken": Broken, "planning_scene": PlanningScene}
    report, recording = record_run(TREE, Sees, services=services)
    assert report.status == "SUCCESS"
    assert recording.complete
    assert Broken.asked == 1
    assert "/service/broken" not in recording.topics()
    assert "/objects" not in recording.topics()
    (line,) = recording.messages("/log")
    assert "without what broken publishes: RuntimeError('not today')" in line[1]["message"]
    written = dict(pair for tick in recording.ticks for pair in tick.writes)
    assert written["odd"][0] == Opaque("builtins:object", "<object object>")
    assert written["odd"][1] == {1: "a"}
    for topic in recording.topics():
        for _, text in recording.raw[topic]:
            json.loads(text, parse_constant=pytest.fail)


def test_an_error_of_the_recorder_itself_ends_only_the_record(record_run, monkeypatch):
    said, once = [], []

    def breaks(ticks, run, file):
        if run.context.tick == 3:
            once.append(run.context.tick)
            raise ZeroDivisionError("oops")
        write(ticks, run, file)

    write = Ticks.write
    monkeypatch.setattr(Ticks, "write", breaks)
    monkeypatch.setattr(Recorder, "__init__", _telling(Recorder.__init__, said))
    report, recording = record_run("trees: {Main: [{wait: 0.5 s}]}", world="none")
    assert report.status == "SUCCESS"
    assert once == [3]
    assert [tick.number for tick in recording.ticks] == [0, 1, 2]
    assert not recording.complete
    assert ["breaks off here: ZeroDivisionError('oops')" in text for text in said] == [True]


def _telling(init, said):
    def made(self, folder, events, remark):
        init(self, folder, events, said.append)

    return made
