"""The frame buffer answers at once, or says at once that it cannot."""

from pathlib import Path

import numpy as np
import pytest

from momantu_bt.failure import Failure
from momantu_bt.frames import HISTORY, FrameBuffer, KinematicTree
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import RobotState

URDF = """<robot name="r">
<link name="base"/><link name="arm"/><link name="slide"/><link name="eye"/><link name="world"/>
<joint name="root" type="fixed"><parent link="world"/><child link="base"/></joint>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
  <origin xyz="1 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="lift" type="prismatic"><parent link="arm"/><child link="slide"/>
  <origin xyz="0 0 1" rpy="0 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="glue" type="fixed"><parent link="slide"/><child link="eye"/>
  <origin xyz="0.5 0 0" rpy="0 0 1.5707963267948966"/></joint>
</robot>"""


@pytest.fixture
def tree(tmp_path: Path) -> KinematicTree:
    path = tmp_path / "r.urdf"
    path.write_text(URDF)
    return KinematicTree.from_urdf(path, "base")


def state(stamp: float, turn: float = 0.0, lift: float = 0.0, x: float = 0.0) -> RobotState:
    return RobotState(
        stamp, ("turn", "lift"), np.array([turn, lift]), np.zeros(2), np.zeros(2),
        Pose2D(x, 0, 0).transform(), 0.0, 0.0, 0.1, 0.0,
    )  # fmt: skip


def test_forward_kinematics_follows_the_chain(tree: KinematicTree) -> None:
    eye = tree.base_from_frame("eye", {"turn": np.pi / 2, "lift": 0.25})
    assert np.allclose(eye.position, (1.0, 0.5, 1.25))
    assert eye.yaw == pytest.approx(np.pi) or eye.yaw == pytest.approx(-np.pi)


def test_frames_above_the_base_are_not_the_robots(tree: KinematicTree) -> None:
    assert set(tree.frames()) == {"base", "arm", "slide", "eye"}
    with pytest.raises(Failure, match="frames: base") as caught:
        tree.base_from_frame("world", {})
    assert caught.value.code == "FRAME_UNKNOWN"


def test_lookup_composes_map_odometry_and_joints(tree: KinematicTree) -> None:
    buffer = FrameBuffer(tree)
    buffer.add_state(state(0.0, x=2.0))
    buffer.set_map_from_odom(Transform((0, 10, 0)), 0.0)
    assert np.allclose(buffer.lookup("map", "eye").position, (3.5, 10.0, 1.0))
    there_and_back = buffer.lookup("map", "eye") @ buffer.lookup("eye", "map")
    assert np.allclose(there_and_back.matrix, np.eye(4), atol=1e-12)


def test_lookup_between_two_states_interpolates(tree: KinematicTree) -> None:
    buffer = FrameBuffer(tree)
    buffer.add_state(state(0.0, lift=0.0, x=0.0))
    buffer.add_state(state(0.1, lift=0.2, x=1.0))
    assert np.allclose(buffer.lookup("odom", "slide", 0.025).position, (1.25, 0.0, 1.05))
    assert np.allclose(buffer.lookup("odom", "slide", 0.1).position, (2.0, 0.0, 1.2))


@pytest.mark.parametrize(
    ("target", "stamp", "words"),
    [
        ("map", None, "localization"),
        ("elbow", None, "no frame 'elbow'"),
        ("base", 7.0, "outside"),
        ("base", -1.0, "outside"),
    ],
)
def test_what_cannot_be_answered_fails_at_once(
    tree: KinematicTree, target: str, stamp: float | None, words: str
) -> None:
    buffer = FrameBuffer(tree)
    buffer.add_state(state(0.0))
    with pytest.raises(Failure, match=words) as caught:
        buffer.lookup(target, "odom", stamp)
    assert caught.value.code == "FRAME_UNKNOWN"


def test_an_empty_buffer_fails_at_once(tree: KinematicTree) -> None:
    with pytest.raises(Failure, match="not reported a state"):
        FrameBuffer(tree).lookup("odom", "base")


def test_memory_is_bounded(tree: KinematicTree) -> None:
    buffer = FrameBuffer(tree)
    for step in range(400):
        buffer.add_state(state(step * 0.05, x=float(step)))
        buffer.set_map_from_odom(Transform((float(step), 0, 0)), step * 0.05)
    newest = 399 * 0.05
    assert buffer.lookup("odom", "base", newest - HISTORY).position[0] == pytest.approx(199.0)
    with pytest.raises(Failure, match="outside"):
        buffer.lookup("odom", "base", newest - HISTORY - 0.06)


def test_time_does_not_run_backwards(tree: KinematicTree) -> None:
    buffer = FrameBuffer(tree)
    buffer.add_state(state(1.0))
    with pytest.raises(ValueError, match="after one of"):
        buffer.add_state(state(0.5))


def test_a_broken_urdf_is_named(tmp_path: Path) -> None:
    path = tmp_path / "broken.urdf"
    path.write_text("<robot><link name='a'>")
    with pytest.raises(ValueError, match=r"broken\.urdf is not a URDF"):
        KinematicTree.from_urdf(path, "a")
    path.write_text("<robot><link name='a'/></robot>")
    with pytest.raises(ValueError, match="no link 'b'; links: a"):
        KinematicTree.from_urdf(path, "b")


def test_a_joint_that_follows_another_is_where_its_leader_puts_it(tmp_path: Path) -> None:
    follows = '<mimic joint="turn" multiplier="0.5" offset="0.1"/></joint>\n<joint name="glue"'
    path = tmp_path / "r.urdf"
    path.write_text(URDF.replace('</joint>\n<joint name="glue"', follows))
    tree = KinematicTree.from_urdf(path, "base")
    assert tree.base_from_frame("slide", {"turn": 0.4}).position[2] == pytest.approx(1.3)
    assert tree.base_from_frame("slide", {"turn": 0.4, "lift": 0.2}).position[2] == pytest.approx(
        1.2
    )
