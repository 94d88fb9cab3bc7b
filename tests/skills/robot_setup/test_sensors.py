"""Sensors of a URDF, written or named, and sections that can be read whatever was written."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree
from momantu_skills.robot_setup.find.proposal import Proposal
from momantu_skills.robot_setup.find.sensors import FoundSensor, find_sensors
from momantu_skills.robot_setup.urdf.skeleton import read_skeleton
from momantu_skills.robot_setup.write.sensor_writer import LIDAR_SCAN, sensor_frames, sensor_lines
from pydantic import TypeAdapter
from ruamel.yaml import YAML

from momantu_bt.formats.urdf import Urdf
from momantu_bt.robot_parts import CameraSensor, LaserSensor, LidarSensor, Sensor
from tests.skills.robot_setup.conftest import joint, link


def found(*names: str, extra: str = "") -> list[FoundSensor]:
    """Sensors of a base with links of these names on it."""
    links = "".join(
        link(name, mass=0) + joint(f"j{i}", "base_link", name, kind="fixed")
        for i, name in enumerate(names)
    )
    root = etree.fromstring(f'<robot name="r">{link("base_link")}{links}{extra}</robot>')
    skeleton = read_skeleton(Urdf(root))
    return find_sensors(root, skeleton, set(skeleton.links))


def written(kind: str, inside: str, on: str = "thing", holder: str = "gazebo") -> str:
    sensor = f'<sensor name="s" type="{kind}">{inside}</sensor>'
    if holder == "gazebo":
        return f'<gazebo reference="{on}">{sensor}</gazebo>'
    return f'<sensor name="s" type="{kind}"><parent link="{on}"/>{inside}</sensor>'


@pytest.mark.parametrize(
    ("names", "kind", "on"),
    [
        (("camera_link", "camera_depth_optical_frame", "camera_rgb_optical_frame"),
         "camera", "camera_rgb_optical_frame"),
        (("wrist_cam",), "camera", "wrist_cam"),
        (("head_realsense_link",), "camera", "head_realsense_link"),
        (("laser", "base_laser_link"), "laser", "base_laser_link"),
        (("rplidar_frame",), "laser", "rplidar_frame"),
        (("velodyne_base", "velodyne"), "lidar", "velodyne_base"),
        (("tool_force_torque",), "wrench", "tool_force_torque"),
    ],
)  # fmt: skip
def test_links_tell_by_their_names(names: tuple[str, ...], kind: str, on: str) -> None:
    (sensor,) = found(*names)
    assert (sensor.kind, sensor.link, sensor.written) == (kind, on, False)
    assert sensor.optical == ("optical" in on)


@pytest.mark.parametrize(
    "name", ["camera_mount", "laser_pointer", "imu_camera", "camera_bracket", "arm", "left_link"]
)
def test_what_only_holds_a_sensor_is_none(name: str) -> None:
    assert found(name) == []


def test_a_three_dimensional_lidar_is_not_taken_for_a_laser_too() -> None:
    assert [s.kind for s in found("velodyne_lidar")] == ["lidar"]
    assert [s.kind for s in found("velodyne_lidar", "sick_front")] == ["lidar", "laser"]


@pytest.mark.parametrize("holder", ["gazebo", "parent"])
@pytest.mark.parametrize("kind", ["ray", "gpu_ray", "lidar", "gpu_lidar"])
def test_a_written_laser_has_its_numbers(kind: str, holder: str) -> None:
    inside = (
        "<ray><scan><horizontal><samples>720</samples><min_angle>-1.5</min_angle>"
        "<max_angle>1.5</max_angle></horizontal></scan>"
        "<range><min>0.1</min><max>12</max></range></ray>"
    )
    (laser,) = found("thing", extra=written(kind, inside, holder=holder))
    assert (laser.kind, laser.link, laser.written) == ("laser", "thing", True)
    assert (laser.angles, laser.beams, laser.near, laser.far) == ((-1.5, 1.5), 720, 0.1, 12.0)
    assert laser.rings is None


@given(st.integers(2, 128), st.floats(-1, 0), st.floats(0.01, 1))
def test_a_laser_of_several_rings_is_a_lidar(rings: int, low: float, high: float) -> None:
    inside = (
        f"<ray><scan><vertical><samples>{rings}</samples><min_angle>{low!r}</min_angle>"
        f"<max_angle>{high!r}</max_angle></vertical></scan></ray>"
    )
    (lidar,) = found("thing", extra=written("ray", inside))
    assert lidar.kind == "lidar"
    assert lidar.rings is not None
    assert len(lidar.rings) == rings
    assert (lidar.rings[0], lidar.rings[-1]) == pytest.approx((low, high), abs=1e-5)
    assert list(lidar.rings) == sorted(lidar.rings)


def test_a_written_sensor_wins_over_names_and_stands_on_a_link_there_is() -> None:
    camera = written("depth", "<camera><horizontal_fov>1.2</horizontal_fov></camera>")
    (only,) = found("thing", "other_camera", extra=camera)
    assert (only.link, only.fov, only.size) == ("thing", 1.2, None)
    assert found("thing", extra=written("depth", "", on="nowhere")) == []
    assert found("thing", extra=written("imu", "")) == []
    assert len(found("thing", extra=2 * camera)) == 1


def test_urdfdoms_sensors_go_by_the_element_inside() -> None:
    assert found("thing", extra=written("", "<camera/>", holder="parent"))[0].kind == "camera"
    assert found("thing", extra=written("", "<ray/>", holder="parent"))[0].kind == "laser"
    assert found("thing", extra=written("force_torque", ""))[0].kind == "wrench"


def test_a_written_camera_uses_its_own_optical_frame() -> None:
    extra = written("camera", "", on="thing")
    assert found("thing", "thing_optical", extra=extra)[0].link == "thing_optical"
    assert found("thing", extra=extra)[0].optical is False


NUMBER = st.one_of(st.sampled_from([0.0, -1.0, 3.2, 1e6, 2e5]), st.floats(-10, 1e4))


@st.composite
def sensors(draw: st.DrawFn) -> list[FoundSensor]:
    """Whatever somebody may write into a `<sensor>`."""

    def tag(name: str, inside: str | None = None) -> str:
        value = draw(st.one_of(st.none(), NUMBER))
        text = f"{value!r}" if inside is None else inside
        return "" if value is None and inside is None else f"<{name}>{text}</{name}>"

    ends = tag("samples") + tag("min_angle") + tag("max_angle")
    scan = tag("scan", tag("horizontal", ends) + tag("vertical", ends.replace("e+", "e")))
    inside = scan + tag("range", tag("min") + tag("max")) + tag("width") + tag("height")
    inside += tag("horizontal_fov") + tag("clip", tag("near") + tag("far"))
    kind = draw(st.sampled_from(["depth", "ray"]))
    return found("thing", extra=written(kind, inside))


def read_with(proposal: Proposal, some: list[FoundSensor]) -> dict[str, Sensor]:
    """What is read of the sensors when a proposal has these."""
    lines = sensor_lines(dataclasses.replace(proposal, sensors=tuple(some)))
    section = YAML(typ="safe", pure=True).load("\n".join(lines))["sensors"]
    return TypeAdapter(dict[str, Sensor]).validate_python(section)


@given(some=sensors())
@settings(max_examples=80)
def test_whatever_a_sensor_says_the_file_can_be_read(
    some: list[FoundSensor], rolling_proposal: Proposal
) -> None:
    read = read_with(rolling_proposal, some)
    for sensor, own in zip(some, read.values(), strict=False):
        if isinstance(own, CameraSensor):
            assert own.horizontal_fov == pytest.approx(sensor.fov or 1.05, rel=1e-5)
            assert (own.width, own.height) == (sensor.size or (640, 480))
        elif isinstance(own, LaserSensor):
            assert own.beams == (sensor.beams or 662)
            assert own.range_min < own.range_max
        else:
            assert isinstance(own, LidarSensor)
            assert own.range_min < own.range_max
            assert own.elevations == pytest.approx(
                sensor.rings[:: math.ceil(len(sensor.rings) / 256)] if sensor.rings else (),
                abs=1e-5,
            )


def test_a_scan_is_made_from_a_lidar_where_there_is_no_laser(rolling_proposal: Proposal) -> None:
    lidar, plain = *found("velodyne"), *found("base_scan")
    laser = read_with(rolling_proposal, [lidar])["laser"]
    assert isinstance(laser, LaserSensor)
    assert (laser.source, laser.frame) == ("lidar", LIDAR_SCAN)
    alone = dataclasses.replace(rolling_proposal, sensors=(lidar,))
    (frame,) = (place for name, place in sensor_frames(alone) if name == LIDAR_SCAN)
    assert frame[0] == "base_link"
    assert frame[1].rotation == pytest.approx(np.eye(3))
    own = read_with(rolling_proposal, [lidar, plain])
    assert isinstance(own["laser"], LaserSensor)
    assert own["laser"].source is None
    assert read_with(rolling_proposal, []) == {}


def test_sensors_of_one_kind_are_numbered(rolling_proposal: Proposal) -> None:
    lasers = [*found("base_laser"), *found("base_scan"), *found("hokuyo")]
    assert list(read_with(rolling_proposal, lasers)) == ["laser", "laser_2", "laser_3"]


@pytest.mark.parametrize(
    ("on", "swept"),
    [("thing", 0.5), ("sonar_03_link", 3.0), ("cliff_left", 3.0), ("ir_front", 2.0)],
)
def test_what_measures_one_distance_ahead_is_no_scanner(on: str, swept: float) -> None:
    inside = (
        f"<ray><scan><horizontal><samples>5</samples><min_angle>{-swept / 2}</min_angle>"
        f"<max_angle>{swept / 2}</max_angle></horizontal><vertical><samples>5</samples>"
        "<min_angle>-0.2</min_angle><max_angle>0.2</max_angle></vertical></scan></ray>"
    )
    assert found(on, extra=written("ray", inside, on)) == []
