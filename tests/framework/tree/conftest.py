"""A small registry of skills, one world and one robot, and ways to check a text against it."""

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from momantu_bt.formats.problems import Problem
from momantu_bt.geometry import Pose, Pose2D
from momantu_bt.messages import DetectedObject, ObjectClass, SupportPlane
from momantu_bt.robot import CAMERA_CARRIER
from momantu_bt.skill import In, Out, Skill
from momantu_bt.tree.check.checker import check as check_document
from momantu_bt.tree.files.xml.format import read as read_xml
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.world import Site, Surface


class Navigate(Skill):
    """Drive."""

    in_front_of: str | None = In(None, doc="where", names="place")
    goal: Pose2D | None = In(None, doc="or there")
    within_reach_of: Pose | None = In(None, doc="or near this")
    side: int = In(0, doc="which side")
    tolerance: float = In(0.05, unit="m", doc="how near")
    recovery: bool = In(True, doc="whether it helps itself")
    failures = {"NO_PATH": "no way", "PATH_BLOCKED": "closed", "NOT_LOCALIZED": "lost"}
    uses = {"base", CAMERA_CARRIER}


class DetectObject(Skill):
    """See."""

    object: ObjectClass = In(doc="what")
    on: str = In(doc="where", names="surface")
    views: int = In(2, doc="how often")
    found: DetectedObject = Out(doc="it")
    failures = {"OBJECT_NOT_FOUND": "not there"}
    uses = {CAMERA_CARRIER}


class DetectPlane(Skill):
    """Measure."""

    near: Pose = In(doc="where")
    plane: SupportPlane = Out(doc="it")
    spots: tuple[Pose, ...] = Out(doc="free ones")
    failures = {"PLANE_NOT_FOUND": "none"}
    uses = {CAMERA_CARRIER}


class Pick(Skill):
    """Grasp."""

    object: DetectedObject = In(doc="what")
    lift: float = In(0.12, unit="m", doc="how high")
    failures = {"GRASP_MISSED": "missed", "SLIPPED": "slipped", "STALE_POSE": "old"}
    uses = {"arm", "gripper"}


class ResetPose(Skill):
    """Move to a named pose."""

    pose: str = In(doc="which", names="named_pose")
    failures = {"NO_PLAN": "no way"}
    uses = {"arm"}


class Say(Skill):
    """Speak; commands nothing."""

    text: str = In(doc="what")
    pace: float = In(1.0, unit="Hz", doc="how fast")


class Save(Skill):
    """Write down what the world is like, in one of the formats that are read."""

    kind: str = In(doc="the format", names="momantu_bt.world_files")


class Count(Skill):
    """Give a number, and a list of poses."""

    number: int = Out(doc="it")
    poses: tuple[Pose2D, ...] = Out(doc="them")


class Relocalize(Skill):
    """Turn on the spot."""

    failures = {"NOT_LOCALIZED": "lost"}
    uses = {"base"}


def _site() -> Site:
    top = Surface(Pose2D(0.0, 0.0), (1.0, 0.6), 0.7, (0.0,))
    surfaces = {"table_a": top, "table_b": top}
    return Site("rooms", places={"door": Pose2D(1.0, 0.0)}, surfaces=surfaces)


def _robot() -> SimpleNamespace:
    def resolve(use: str) -> str:
        return "head" if use == CAMERA_CARRIER else use

    poses: dict[str, dict[str, float]] = {"home": {}, "carry": {}}
    return SimpleNamespace(named_poses=poses, resolve_use=resolve, sensors={})


@pytest.fixture(scope="session")
def registry() -> Registry:
    """Nine skills, the world `rooms`, the robot `toy`, the service `localization`."""
    skills: dict[str, type[Skill]] = {
        "navigate": Navigate,
        "detect_object": DetectObject,
        "detect_plane": DetectPlane,
        "pick": Pick,
        "reset_pose": ResetPose,
        "say": Say,
        "count": Count,
        "save": Save,
        "relocalize": Relocalize,
    }
    rooms = SimpleNamespace(name="rooms", default_robot="toy", site=_site)
    return Registry(skills, {"rooms": rooms}, {"toy": _robot}, {"localization": object})


Check = Callable[[str], list[Problem]]


@pytest.fixture(scope="session")
def check(registry: Registry) -> Check:
    """Every problem of a text in either spelling, as if it were a file `t.yaml` or `t.xml`."""

    def problems(text: str) -> list[Problem]:
        try:
            if text.startswith("<"):
                document, found = read_xml(text, "t.xml", registry)
            else:
                document, found = read(text, "t.yaml")
        except TreeError as error:
            return error.problems
        return check_document(document, registry, reading=found).problems

    return problems


HEAD = "momantu_bt: 1\nworld: rooms\nmain: Main\n"


@pytest.fixture(scope="session")
def expect(check: Check) -> Callable[..., None]:
    """Check a tree in which «…» marks the one place that is wrong.

    expect(code, body, message=part of it, hint=part of it): one problem, of that code, exactly
    there. The body follows a header with the world `rooms` and `main: Main`; whole=True: it is
    the whole file.
    """

    def one(code: str, body: str, message: str = "", hint: str = "", whole: bool = False) -> None:
        text = body if whole else HEAD + body
        start, end = text.index("«"), text.index("»") - 1
        clean = text.replace("«", "").replace("»", "")
        found = check(clean)
        assert [p.code for p in found] == [code], found
        place = found[0].place
        line = clean.count("\n", 0, start) + 1
        column = start - (clean.rfind("\n", 0, start) + 1) + 1
        assert (place.line, place.column) == (line, column), found
        assert place.length == end - start, found
        assert message in found[0].message
        assert hint in found[0].hint

    return one


@pytest.fixture(scope="session")
def fine(check: Check) -> Callable[[str], None]:
    """Check a tree in which nothing is wrong; the same header goes before it."""

    def none(body: str) -> None:
        assert check(HEAD + body) == []

    return none
