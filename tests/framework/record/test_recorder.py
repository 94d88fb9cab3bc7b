"""A recorded run: what is in its log, and that recording changes nothing."""

import base64
import io
import itertools
import json

import jsonschema
import numpy as np
import pytest
from mcap.reader import make_reader
from PIL import Image

from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import BaseVelocity, DetectedObject, JointTrajectory
from momantu_bt.record.codec import from_json
from momantu_bt.record.reader import ChangeRecord
from momantu_bt.running.api import run
from momantu_bt.service import HeldObject, Service
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill
from momantu_bt.testing import ScriptedRobot, ScriptedWorld
from momantu_bt.tree.registry import Registry


class Drive(Skill):
    """Drives for a second, looks each tick, and says what it saw."""

    uses = {"base"}
    localization: object = Needs()
    planning_scene: object = Needs()
    speed: float = In(unit="m/s", doc="how fast")
    found: DetectedObject = Out(doc="what was seen")

    def run(self, robot) -> Run:
        camera, laser = robot.description.camera()[0], robot.description.laser()[0]
        for _ in range(25):
            robot.read(camera)
            robot.read(laser)
            robot.command("base", BaseVelocity(self.speed, 0.0))
            yield "driving"
        pose = Pose(Transform((1.0, 2.0, 0.7)), ODOM, self.clock.now())
        self.found = DetectedObject("can", pose, (0.07, 0.07, 0.13), "cylinder", 0.9, 0.7)


class Wave(Skill):
    """Gives one trajectory again and again, then fails."""

    uses = {"arm"}
    failures = {"TIRED": "the arm is tired"}

    def run(self, robot) -> Run:
        joints = robot.description.actuators["arm"].joints
        times = np.linspace(0.0, 1.0, 30)
        still = np.zeros((30, len(joints)))
        goal = JointTrajectory(joints, times, still, still)
        for _ in range(3):
            robot.command("arm", goal)
            yield "waving"
        raise Failure("TIRED", "enough", n=3)


class Localization(Service):
    publishes = {"pose": Pose2D, "quality": float}

    def start(self, context):
        self.frames = context.frames
        self.x = 0.0

    def update(self, robot, now):
        self.x = round(now, 1)
        self.frames.set_map_from_odom(Transform((5.0, 0.0, 0.0)), now)

    def published(self):
        return {"pose": Pose2D(self.x, 0.0), "quality": 0.5}


class PlanningScene(Service):
    held = None

    def start(self, context):
        pose = Pose(Transform(), ODOM, 0.0)
        self.box = DetectedObject("box", pose, (0.1, 0.1, 0.1), "box", 0.8, 0.0)

    def update(self, robot, now):
        if 0.45 < now < 0.95:
            self.held = self.held or HeldObject(self.box, Transform((0.0, 0.0, 0.02)))
        else:
            self.held = None


TREE = """
values: {far: [1, 2.5]}
trees:
  Main:
    - drive: {speed: 0.5, found: $can}
    - script: $n := 1; $n := 2
    - condition: $@localization.quality > 0.4 and $@robot.gripper_width > 0
    - fallback:
        - wave
        - wait: 0.3 s
"""
SERVICES = {"localization": Localization, "planning_scene": PlanningScene}


@pytest.fixture
def recorded(record_run, seeing_robot):
    world = ScriptedWorld(seeing_robot)
    return record_run(TREE, Drive, Wave, world=world, services=SERVICES, seed=7)


def messages(recording, topic):
    return list(recording.messages(topic))


def node(recording, name):
    return next(n.index for n in recording.nodes if n.name == name)


def test_every_message_fits_its_schema_and_the_file_has_its_summary(recorded):
    _, recording = recorded
    validators = {}
    with (recording.folder / "run.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        statistics = reader.get_summary().statistics
        counts = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            counts[channel.id] = counts.get(channel.id, 0) + 1
            if schema.id not in validators:
                text = json.loads(schema.data)
                jsonschema.Draft7Validator.check_schema(text)
                validators[schema.id] = jsonschema.Draft7Validator(text)
            assert channel.message_encoding == "json"
            validators[schema.id].validate(json.loads(message.data))
    assert statistics.channel_message_counts == counts
    assert statistics.message_count == sum(counts.values())
    assert statistics.message_end_time == max(round(t.now * 1e9) for t in recording.ticks)


def test_recording_changes_nothing(recorded, seeing_robot, tmp_path):
    report, _ = recorded
    registry = Registry(skills={"drive": Drive, "wave": Wave}, services=SERVICES)
    robot = ScriptedRobot(readings=seeing_robot.readings)
    plain = run(tmp_path / "tree.yaml", world=ScriptedWorld(robot), registry=registry, seed=7)
    assert plain.fingerprint == report.fingerprint
    assert plain.status == report.status == "SUCCESS"


def test_the_start_is_told(recorded, tmp_path):
    report, recording = recorded
    assert recording.complete
    assert recording.report == json.loads((recording.folder / "report.json").read_text())
    assert recording.report["fingerprint"] == report.fingerprint
    about = recording.about
    assert (about["seed"], about["world"], about["robot"]) == (7, "scripted", "small")
    assert from_json(about["values"]["far"]) == [1, 2.5]
    assert about["versions"]["momantu-bt"] == report.versions["momantu-bt"]
    tree = str(tmp_path / "tree.yaml")
    assert recording.kinds == {tree: "tree", "site.json": "site"}
    assert recording.files[tree] == (tmp_path / "tree.yaml").read_text()
    assert [n.index for n in recording.nodes] == list(range(len(recording.nodes)))
    drive = recording.nodes[node(recording, "drive")]
    assert (drive.type, drive.depth, drive.place) == ("drive", 1, f"{tree}:7")
    assert recording.nodes[drive.parent].parent is None


def test_ticks_are_told_with_all_that_happened_in_them(recorded):
    report, recording = recorded
    first, *ticks = recording.ticks
    assert (first.number, first.writes) == (0, (("far", (1, 2.5)),))
    running = [t for t in ticks if not t.settling]
    assert [t.number for t in running] == list(range(1, report.ticks + 1))
    assert len({t.state for t in running}) > 20
    drive, wave = node(recording, "drive"), node(recording, "wave")
    assert ticks[0].changes[0].node == drive
    assert ticks[0].changes[0].note == "driving"
    assert ticks[0].issued == (("base", BaseVelocity(0.5, 0.0)),)
    done = ChangeRecord(drive, "SUCCESS", "", None)
    ended = next(tick for tick in ticks if done in tick.changes)
    assert ("base", None) in ended.issued
    names = [name for name, _ in ended.writes]
    assert names == ["can", "n", "n"]
    assert [value for _, value in ended.writes][1:] == [1, 2]
    assert ended.writes[0][1] == dict(ended.steps[0].outputs)["found"]
    read = dict(ended.reads)
    assert read["localization"] == {"pose": Pose2D(1.3, 0.0), "quality": 0.5}
    assert read["robot"].stamp == pytest.approx(ended.now)
    steps = [s for t in ticks for s in t.steps if s.node == wave]
    assert [s.status for s in steps] == ["RUNNING"] * 3 + ["FAILURE"]
    assert steps[-1].failure.data == {"n": 3}


def test_what_is_commanded_again_is_one_object(recorded):
    _, recording = recorded
    arm = [goal for t in recording.ticks for name, goal in t.issued if name == "arm" and goal]
    assert len(arm) == 3
    assert arm[0] is arm[1] is arm[2]
    assert isinstance(arm[0], JointTrajectory)


def test_a_failure_is_told_once_and_is_one_value(recorded):
    _, recording = recorded
    (tick,) = (t for t in recording.ticks if any(c.failure for c in t.changes))
    raw = next(text for at, text in recording.raw["/tick"] if at == pytest.approx(tick.now))
    assert raw.count(b"FailureValue") == 2  # the node's own, and the one that its skill raised
    failure, *others = (c.failure for c in tick.changes if c.failure is not None)
    assert all(other is failure for other in others)
    assert (failure.code, failure.node) == ("TIRED", "wave")
    (line,) = messages(recording, "/log")
    assert line[1]["message"] == "TIRED, enough"
    assert line[1]["line"] == 11


def test_pictures_and_scans_are_those_that_somebody_read_one_each_second(recorded):
    _, recording = recorded
    pictures, scans = messages(recording, "/camera/camera"), messages(recording, "/scan/laser")
    assert [round(t, 2) for t, _ in pictures] == [round(t, 2) for t, _ in scans] == [0.05, 1.05]
    assert pictures[0][1]["format"] == "jpeg"
    image = Image.open(io.BytesIO(base64.b64decode(pictures[0][1]["data"])))
    assert image.size == (320, 240)
    assert np.allclose(np.asarray(image)[100, 100], (250, 20, 10), atol=8)
    ranges = scans[0][1]["ranges"]
    assert len(ranges) == 11
    assert ranges[3] == 10.0
    assert ranges[1] == 0.75
    assert scans[0][1]["end_angle"] == pytest.approx(1.0)


def test_poses_are_told_as_the_robot_believes_them(recorded, seeing_robot):
    _, recording = recorded
    poses = messages(recording, "/pose")
    assert {p["frame_id"] for _, p in poses} == {MAP}
    xs = [p["pose"]["position"]["x"] for _, p in poses]
    assert xs == sorted(xs)
    assert xs[0] == pytest.approx(5.0, abs=0.01)
    assert xs[-1] == pytest.approx(5.0 + seeing_robot.base.x, abs=0.02)
    transforms = [t for _, m in messages(recording, "/tf") for t in m["transforms"]]
    links = {(t["parent_frame_id"], t["child_frame_id"]) for t in transforms}
    joints = seeing_robot.description.kinematics().joints()
    assert links == {(MAP, ODOM), (ODOM, "base_link"), *((j.parent, j.child) for j in joints)}


def test_links_are_where_forward_kinematics_has_them(recorded, seeing_robot):
    _, recording = recorded
    kinematics = seeing_robot.description.kinematics()
    newest = {}
    for _, message in messages(recording, "/tf"):
        newest |= {t["child_frame_id"]: t for t in message["transforms"]}
    positions = seeing_robot.state().joints()
    for joint in kinematics.joints():
        told = newest[joint.child]
        expected = Transform.from_matrix(joint.transform(positions.get(joint.name, 0.0)))
        at, turn = told["translation"], told["rotation"]
        shown = Transform((at["x"], at["y"], at["z"]), (turn["w"], turn["x"], turn["y"], turn["z"]))
        assert np.allclose(shown.position, expected.position, atol=1e-4)
        assert shown.angle_to(expected) < 1e-4


def test_services_are_told_when_they_changed(recorded):
    _, recording = recorded
    told = messages(recording, "/service/localization")
    texts = [json.dumps(m) for _, m in told]
    assert len(texts) == len(set(texts)) > 3
    assert all(later - sooner > 0.19 for (sooner, _), (later, _) in itertools.pairwise(told))
    assert from_json(told[0][1])["quality"] == 0.5


def test_objects_are_told_when_they_appear_and_go(recorded):
    _, recording = recorded
    told = [
        ([e["id"] for e in m["entities"]], [d["id"] for d in m["deletions"]])
        for _, m in messages(recording, "/objects")
    ]
    assert told == [(["held"], []), ([], ["held"]), (["can"], [])]
    (can,) = messages(recording, "/objects")[-1][1]["entities"]
    assert can["frame_id"] == ODOM
    assert can["cylinders"][0]["size"] == {"x": 0.07, "y": 0.07, "z": 0.13}
    (box,) = messages(recording, "/objects")[0][1]["entities"]
    assert box["frame_id"] == "gripper_link"
    assert box["cubes"][0]["pose"]["position"]["z"] == pytest.approx(0.02)


def test_a_run_without_a_world_is_recorded_too(record_run, tmp_path):
    report, recording = record_run("trees: {Main: [{wait: 0.2 s}]}", world="none")
    assert recording.topics() == ("/end", "/files", "/nodes", "/run", "/tick")
    assert len(recording.ticks) == report.ticks + 1
    assert recording.ticks[1].state == ""
