"""Every mistake in a robot file or its URDFs is told at its place, with what would be right."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.robot import CAMERA_CARRIER, CameraSensor, LaserSensor, laser_band
from momantu_bt.robots import RobotFileError, read_robot

Write = Callable[..., Path]

WRONG: list[tuple[str, str, str]] = [
    ("linear: 1.0", "linear: 1.0\n  lateral: 0.5", "does not drive sideways"),
    ("linear: 1.0", "linear: 1.0\n  kind: hovering", "possible: 'differential', 'omnidirectional'"),
    ("momantu_robot: 1\n", "", "1:1|2:1: the robot needs a key 'momantu_robot'"),
    ("momantu_robot: 1", "momantu_robot: 2", "2:16: momantu_robot: 2 is not possible here"),
    ("name: carter", "name: Carter 1", "3:7: name: "),
    ("{urdf: cart.urdf}", "{}", "5:9: parts.cart: a part needs either `urdf: FILE`"),
    ("{urdf: cart.urdf}", "{urdf: cart.urdf, args: {a: 1}}", "`args` are for xacro files"),
    (
        "[10 cm, 0, 30 cm]",
        "[10 kg, 0, 30 cm]",
        "'10 kg' is a mass; expected a length, in: mm, cm",
    ),
    ("frame: lens", "frame: lense", "there is no link 'lense'; did you mean lens"),
    ("joints: [arm_turn, arm_bend]}", "joints: [arm_turn, bend]}", "no moving joint 'bend'"),
    ("arm_turn: {lower: -90 deg", "arm_turn: {lower: -9 cm", "'-9 cm', but arm_turn turns"),
    ("upper: 4 cm", "upper: 4 deg", "'4 deg', but arm_left_slide slides: write it in m"),
    ("lower: -90 deg, upper: 90 deg", "lower: 90 deg, upper: 0", "must be less than upper"),
    ("lower: -90 deg, ", "", "arm_turn has one limit; give `lower` and `upper`, or neither"),
    ("{lower: 0, upper: 4 cm, velocity", "{velocity", "arm_left_slide slides: it needs `lower`"),
    ("velocity: 60 deg/s", "velocity: 0", "joint_limits.arm_bend.velocity: .*greater than 0"),
    ("home: {arm_turn: 0", "home: {arm_turn: 2", "2 lies outside arm_turn's limits -1.5708 to"),
    ("home: {arm_turn: 0", "home: {arm_trun: 0", "no joint 'arm_trun'; did you mean arm_turn"),
    (
        "  carry:",
        "  carri:",
        "every robot with an arm has the poses home, ready, carry.*; missing: carry",
    ),
    ("tip: hand", "tip: mast", "the moving joints on that way are: none"),
    (
        "groups:\n  arm: {joints: [arm_turn, arm_bend]",
        "groups:\n  arm: {joints: [arm_bend, arm_turn]",
        "from the base outwards; .* are: arm_turn, arm_bend",
    ),
    (
        "touch_links: [arm_left",
        "touch_links: [arm_lef",
        "no link 'arm_lef'; did you mean arm_left",
    ),
    ("[[0.25, 0.2], [-0.25, 0.2]", "[[-0.25, 0.2], [0.25, 0.2]", "write them counter-clockwise"),
    ("  drive: {force: 200, torque: 50}\n", "", "needs `drive: {force: N, torque: Nm}`"),
    ("torque: 50}", "torque: 50, joints: {x: a, y: b, yaw: c}}", "there is no joint 'a'"),
    ("  arm_bend: {stiffness", "  arm_bnd: {stiffness", "no actuator or moving joint 'arm_bnd'"),
    ("floor_links: [base_link]", "floor_links: [wheel]", "there is no link 'wheel'"),
    ("    max_depth: 4.0", "    max_depth: 4.0\n    carrier: head", "no actuator 'head'"),
    (
        "kind: camera",
        "kind: camra",
        ":11: 'camra' is not possible here; possible: camera, imu,",
    ),
    ("    kind: camera\n", "", "sensors.camera needs a key 'kind'; possible: camera, imu, laser"),
    ("    frame: lens", "    fram: lens", "did you mean 'frame'\\? Keys: kind, frame, carrier"),
    ("  max_width: 8 cm", "  actuator: arm\n  max_width: 8 cm", "actuator of kind gripper 'arm'"),
    (
        "  max_width: 8 cm",
        "  opening: {arm_left_slide: [[0, 0], [0.08, 0.04]]}\n  max_width: 8 cm",
        "no table for arm_right_slide",
    ),
    (
        "joint_limits:\n",
        "joint_limits:\n  arm_trn: {velocity: 1, acceleration: 1}\n",
        "no moving joint 'arm_trn'",
    ),
    ("  arm: {kind: joints", "  manipulator: {kind: joints", "named 'arm' of kind joints; this"),
    ("base: {kind: base}", "base: {kind: gripper}", "skills take 'base' for one of kind base"),
    (
        "groups:\n  arm:",
        "groups:\n  hand:",
        "of the actuator 'arm' are planned for the group 'arm'; write its joints and its tip",
    ),
    (
        "kind: joints, joints: [arm_turn, arm_bend]",
        "kind: joints, joints: [arm_bend, arm_turn]",
        "of this name need the same joints in the same order",
    ),
]


@pytest.mark.parametrize(("old", "new", "words"), WRONG, ids=[w[2][-30:] for w in WRONG])
def test_a_mistake_is_told(carter: Write, old: str, new: str, words: str) -> None:
    with pytest.raises(RobotFileError, match=words) as caught:
        read_robot(carter(robot=(old, new)))
    assert all(problem.place.line > 0 for problem in caught.value.problems)


URDF_WRONG: list[tuple[str, tuple[str, str], str]] = [
    ("cart", ("<robot name", "<sdf name"), "cart.urdf is not a URDF file, for it is not XML"),
    ("cart", ('type="fixed"', 'type="floating"'), "cart.urdf:11: .*'floating'; possible: fixed, "),
    (
        "cart",
        ('<parent link="base_link"/>', '<parent link="base"/>'),
        "the parent 'base', and .*base_link",
    ),
    (
        "cart",
        ('xyz="-0.1 0 0.3"', 'xyz="-0.1 0"'),
        "cart.urdf:11: .*origin has xyz='-0.1 0'; expected 3 numbers",
    ),
    (
        "cart",
        ('<mass value="30"/>', '<mass value="-30"/>'),
        "has a mass of -30 kg; write <inertial>",
    ),
    (
        "cart",
        (
            '<box size="0.5 0.4 0.2"/></geometry></collision>',
            '<box size="0.5 0 0.2"/></geometry></collision>',
        ),
        "box whose size is not above 0",
    ),
    ("arm", ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>'), "'turn' has the axis 0 0 0"),
    (
        "arm",
        ('lower="-2" upper="2"', 'lower="2" upper="-2"'),
        "'turn' goes from lower=2 to upper=-2; lower must not be above upper",
    ),
    ("arm", ('lower="-2" upper="2" ', 'lower="1" '), "from lower=1 to upper=0; lower must not"),
    ("arm", ('lower="-2"', 'lower="low"'), "limit has lower='low'; expected a number"),
    (
        "arm",
        ('velocity="1" effort="50"/>', 'velocity="-1"/>'),
        "the limit velocity=-1; write one above 0",
    ),
    ("arm", ('effort="50"', 'effort="-50"'), "the limit effort=-50; write one above 0"),
    ("arm", ("${size / 2}", "${sise / 2}"), "xacro cannot expand .*arm.urdf.xacro: .*sise"),
    (
        "arm",
        ('<link name="foot"/>', '<link name="foot"/><link name="foot"/>'),
        "a second link is called 'foot'",
    ),
    ("arm", ('default="0.4"', 'default="0.4'), "xacro cannot expand .*arm.urdf.xacro"),
    (
        "arm",
        ('<inertia ixx="0.01"', '<inertia ixx="-0.01"'),
        "not positive definite .*; write <inertial>",
    ),
]


@pytest.mark.parametrize(("part", "change", "words"), URDF_WRONG)
def test_a_mistake_in_a_urdf_is_told_with_its_file(
    carter: Write, part: str, change: tuple[str, str], words: str
) -> None:
    with pytest.raises(RobotFileError, match=words):
        read_robot(carter(**{part: change}))


def test_what_programs_write_for_a_joint_without_ends_is_no_mistake(carter: Write) -> None:
    robot = read_robot(
        carter(arm=('<limit velocity="1"', '<limit lower="0" upper="-1" velocity="1"'))
    )
    bend = robot.joint_limits["arm_bend"]
    assert (bend.lower, bend.upper) == (None, None)


def test_links_in_a_ring_are_no_tree(carter: Write) -> None:
    ring = "".join(
        f'<link name="{a}"/><joint name="{a}{b}" type="fixed">'
        f'<parent link="{a}"/><child link="{b}"/></joint>'
        for a, b in (("one", "two"), ("two", "one"))
    )
    with pytest.raises(RobotFileError, match="joints in a ring carry one, two"):
        read_robot(carter(cart=('<link name="mast"/>', '<link name="mast"/>' + ring)))


def test_all_mistakes_are_told_at_once(carter: Write) -> None:
    file = carter(robot=("tip: hand", "tip: hnad"))
    file.write_text(file.read_text().replace("frame: lens", "frame: lense"))
    with pytest.raises(RobotFileError) as caught:
        read_robot(file)
    assert len(caught.value.problems) == 2


def test_a_fixed_camera_has_no_carrier(carter: Write) -> None:
    robot = read_robot(carter())
    _, camera = robot.camera()
    assert isinstance(camera, CameraSensor)
    assert camera.carrier is None
    assert robot.resolve_use(CAMERA_CARRIER) is None


LASERS = """  scan:
    {kind: laser, frame: level, angle_min: -90 deg, angle_max: 90 deg, beams: 181,
     range_min: 0.1, range_max: 10, source: turning, band: [10 cm, 60 cm]}
  turning:
    {kind: lidar, frame: mast, elevations: [-15 deg, 0, 15 deg], columns: 900,
     range_min: 0.3, range_max: 100}
"""


def test_a_laser_that_is_made_from_a_lidar_sees_its_band(carter: Write) -> None:
    file = carter(robot=("sensors:\n", f"sensors:\n{LASERS}"))
    file.write_text(file.read_text().replace("frames:\n", "frames:\n  level: {on: base_link}\n"))
    robot = read_robot(file)
    assert laser_band(robot) == (0.1, 0.6)
    name, laser = robot.laser()
    assert isinstance(laser, LaserSensor)
    assert (name, laser.source, robot.lidar()[0]) == ("scan", "turning", "turning")
    file.write_text(file.read_text().replace("source: turning, ", ""))
    with pytest.raises(RobotFileError, match="needs both `source` and `band`"):
        read_robot(file)
    file.write_text(file.read_text().replace("band:", "source: camera, band:"))
    with pytest.raises(RobotFileError, match="there is no lidar 'camera'"):
        read_robot(file)


def test_a_laser_of_its_own_sees_a_plane(carter: Write) -> None:
    laser = LASERS.partition("  turning")[0].replace(", source: turning, band: [10 cm, 60 cm]", "")
    robot = read_robot(carter(robot=("sensors:\n", "sensors:\n" + laser.replace("level", "mast"))))
    assert laser_band(robot) == pytest.approx((0.3, 0.3))


def test_without_a_laser_everything_below_the_robots_height_counts(carter: Write) -> None:
    assert laser_band(read_robot(carter())) == (0.0, 0.9)


def test_names_of_a_robots_files_mean_something_elsewhere(carter: Write, tmp_path: Path) -> None:
    file = carter()
    robot = read_robot(file)
    assert set(robot.files) == {"robot.yaml", "cart.urdf", "arm.urdf.xacro"}
    assert robot.texts()["robot.yaml"] == file.read_text()
    assert robot.source == file
