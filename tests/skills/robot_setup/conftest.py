"""Two small robots as URDF: a rolling one with a parallel gripper, a bolted one with a pincer."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from momantu_skills.robot_setup.find.base import find_base
from momantu_skills.robot_setup.find.proposal import Proposal, propose
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.prepare import Placed, prepare

MASS = (
    '<inertial><mass value="{m}"/>'
    '<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def link(
    name: str, shape: str = "", at: str = "0 0 0", mass: float = 1.0, rpy: str = "0 0 0"
) -> str:
    inertial = MASS.format(m=mass, i=0.01 * mass) if mass else ""
    placed = f'<origin xyz="{at}" rpy="{rpy}"/><geometry>{shape}</geometry>'
    both = f"<visual>{placed}</visual><collision>{placed}</collision>" if shape else ""
    return f'<link name="{name}">{inertial}{both}</link>'


def box(x: float, y: float, z: float) -> str:
    return f'<box size="{x} {y} {z}"/>'


def rod(length: float, radius: float = 0.03) -> str:
    return f'<cylinder radius="{radius}" length="{length}"/>'


def joint(
    name: str,
    parent: str,
    child: str,
    xyz: str = "0 0 0",
    axis: str = "0 0 1",
    kind: str = "revolute",
    limit: str = 'lower="-2" upper="2" velocity="1" effort="30"',
    extra: str = "",
    rpy: str = "0 0 0",
) -> str:
    bounds = f"<limit {limit}/>" if kind in ("revolute", "prismatic") else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{bounds}{extra}</joint>'
    )


def body_of(*elements: str) -> Body:
    """What a URDF of these links and joints is worked on as."""
    with TemporaryDirectory() as folder:
        source = Path(folder) / "given.urdf"
        source.write_text(f'<robot name="given">{"".join(elements)}</robot>')
        prepared = prepare(source, Path(folder))
        return Body(prepared.skeleton, Placed(prepared.urdf, find_base(prepared.skeleton).frame))


def rolling() -> str:
    """A box on two wheels, five joints, and fingers that slide 4 cm each: pads 3 cm by 2 cm."""
    wheel = '<cylinder radius="0.1" length="0.04"/>'
    slide = 'lower="0" upper="0.04" velocity="0.05" effort="20"'
    return "".join(
        [
            '<robot name="Rolling Arm">',
            link("base_link", box(0.5, 0.4, 0.2), "0 0 0.2", 30),
            link("left_wheel", wheel, rpy="1.5708 0 0"),
            link("right_wheel", wheel, rpy="1.5708 0 0"),
            joint(
                "left_wheel_joint", "base_link", "left_wheel", "0 0.2 0.1", "0 1 0", "continuous"
            ),
            joint(
                "right_wheel_joint", "base_link", "right_wheel", "0 -0.2 0.1", "0 1 0", "continuous"
            ),
            link("shoulder", rod(0.1, 0.05), "0 0 0.05"),
            link("upper", rod(0.35), "0 0 0.2"),
            link("fore", rod(0.3), "0 0 0.18"),
            link("wrist", rod(0.06, 0.025), "0 0 0.04", 0.3),
            link("palm", box(0.1, 0.04, 0.04), "0 0 0.04", 0.3),
            joint("pan", "base_link", "shoulder", "0.1 0 0.32"),
            joint("lift", "shoulder", "upper", "0 0 0.12", "0 1 0"),
            joint("elbow", "upper", "fore", "0 0 0.4", "0 1 0"),
            joint("flex", "fore", "wrist", "0 0 0.36", "0 1 0"),
            joint("roll", "wrist", "palm", "0 0 0.08", "0 0 1", "continuous"),
            link("left_finger", box(0.01, 0.02, 0.03), "0.005 0 0.085", 0.05),
            link("right_finger", box(0.01, 0.02, 0.03), "-0.005 0 0.085", 0.05),
            joint("left_slide", "palm", "left_finger", "0 0 0", "1 0 0", "prismatic", slide),
            joint("right_slide", "palm", "right_finger", "0 0 0", "-1 0 0", "prismatic", slide),
            link("mast", box(0.04, 0.04, 0.6), "-0.2 0 0.6"),
            joint("mast_joint", "base_link", "mast", kind="fixed"),
            link("head_pan_link", box(0.06, 0.1, 0.05), "0 0 0.03", 0.2),
            link("head_tilt_link", box(0.04, 0.1, 0.04), "0.03 0 0.05", 0.2),
            joint("head_pan", "mast", "head_pan_link", "-0.2 0 0.9"),
            joint("head_tilt", "head_pan_link", "head_tilt_link", "0 0 0.06", "0 1 0"),
            link("head_camera_link", mass=0),
            joint(
                "camera_joint", "head_tilt_link", "head_camera_link", "0.05 0 0.05", kind="fixed"
            ),
            link("base_laser_link", mass=0),
            joint("laser_joint", "base_link", "base_laser_link", "0.2 0 0.25", kind="fixed"),
            "</robot>",
        ]
    )


PINCER = "xmlns:xacro='http://www.ros.org/wiki/xacro'"


def bolted() -> str:
    """A xacro file: six joints on a post, two hinged fingers, one following, a hand camera."""
    turn = 'lower="0" upper="0.6" velocity="1" effort="5"'
    follow = '<mimic joint="left_hinge" multiplier="1"/>'
    return "".join(
        [
            f'<robot name="bolted" {PINCER}><xacro:property name="reach" value="0.35"/>',
            link("world", mass=0),
            link("base_link", box(0.2, 0.2, 0.3), "0 0 0.15", 10),
            joint("bolt", "world", "base_link", kind="fixed"),
            link("s1", rod(0.08, 0.05), "0 0 0.04"),
            link("s2", rod(0.3), "0 0 ${reach / 2}"),
            link("s3", rod(0.28), "0 0 ${reach / 2}"),
            link("s4", rod(0.05), "0 0 0.04", 0.4),
            link("s5", rod(0.05), "0 0 0.04", 0.4),
            link("s6", box(0.04, 0.1, 0.04), "0 0 0.04", 0.3),
            joint("a1", "base_link", "s1", "0 0 0.31", kind="continuous"),
            joint("a2", "s1", "s2", "0 0 0.1", "0 1 0"),
            joint("a3", "s2", "s3", "0 0 ${reach + 0.02}", "0 1 0"),
            joint("a4", "s3", "s4", "0 0 ${reach + 0.02}", "0 0 1", "continuous"),
            joint("a5", "s4", "s5", "0 0 0.09", "0 1 0"),
            joint("a6", "s5", "s6", "0 0 0.09", "0 0 1", "continuous"),
            link("left_finger", box(0.02, 0.01, 0.1), "0 -0.005 0.05", 0.05),
            link("right_finger", box(0.02, 0.01, 0.1), "0 0.005 0.05", 0.05),
            joint("left_hinge", "s6", "left_finger", "0 0.02 0.07", "-1 0 0", limit=turn),
            joint(
                "right_hinge",
                "s6",
                "right_finger",
                "0 -0.02 0.07",
                "1 0 0",
                limit=turn,
                extra=follow,
            ),
            link("hand_camera_optical_frame", mass=0),
            joint(
                "hand_camera_joint",
                "s6",
                "hand_camera_optical_frame",
                "0.06 0 0.05",
                kind="fixed",
            ),
            '<gazebo reference="hand_camera_optical_frame"><sensor type="depth"><camera>'
            "<horizontal_fov>1.2</horizontal_fov><image><width>320</width><height>240</height>"
            "</image></camera></sensor></gazebo>",
            "</robot>",
        ]
    )


@pytest.fixture(scope="session")
def rolling_urdf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("rolling") / "rolling.urdf"
    path.write_text(rolling())
    return path


@pytest.fixture(scope="session")
def bolted_xacro(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bolted") / "bolted.urdf.xacro"
    path.write_text(bolted())
    return path


@pytest.fixture(scope="session")
def rolling_proposal(rolling_urdf: Path) -> Proposal:
    return propose(rolling_urdf, samples=500)


@pytest.fixture(scope="session")
def bolted_proposal(bolted_xacro: Path) -> Proposal:
    return propose(bolted_xacro, samples=500)
