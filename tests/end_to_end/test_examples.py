"""Each example tree runs, and does what its comments say where things go wrong.

Skills are scripted: they take their time, and end as the test wants.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from momantu_bt import run
from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject, DetectedTag, SupportPlane
from momantu_bt.record.report import Report
from momantu_bt.robot import Robot
from momantu_bt.skill import MISSING, Run, Skill
from momantu_bt.tags import single_tag
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry
from momantu_bt.world_plugins import WORLDS

INSTALLED = Registry.installed()
EXAMPLES = sorted(name for name in bundled() if name.startswith("examples/"))
POSE = Pose(Transform((1.0, 0.0, 0.8)), "odom", 0.0)
OUTPUTS: dict[str, Any] = {
    "found": DetectedObject("can", POSE, (0.07, 0.07, 0.13), "cylinder", 1.0, 0.7),
    "tag_pose": POSE,
    "tag_sigma": 0.001,
    "tag_covariance": (0.0,) * 36,
    "seen": 2,
    "turned": 0.5,
    "pictures": 1,
    "covered": 50,
    "enough": False,
    "plane": SupportPlane(POSE, ((-1, -1), (1, -1), (1, 1), (-1, 1))),
    "spots": (POSE,),
    "tags": (
        DetectedTag("", "tag36h11", (1,), (0.15,), POSE, (0.0,) * 36),
        DetectedTag("", "tag36h11", (2,), (0.15,), POSE, (0.0,) * 36),
    ),
    "ids": (1, 2),
    "error_code_id": 0,
    "error_msg": "",
    "known": 50.0,
    "known_share": 100,
    "looked_share": 100,
}
Ends = Callable[[int, dict[str, Any]], str | None]


class Script:
    """How each start of a skill ends, and which have been started.

    ends: by skill, what decides from the count of its starts (from 1) and its inputs: a failure's
    code, or None. A list is one after the other, and success when it is used up. takes: seconds by
    skill, else one tick. started: (skill, the inputs that the tree gave), in order.
    """

    def __init__(self, takes: dict[str, float] | None = None, **ends: Ends | list[str | None]):
        self.takes = {"check": 0.0, **(takes or {})}
        self.ends = ends
        self.started: list[tuple[str, dict[str, Any]]] = []

    def names(self) -> list[str]:
        """The skills that were started, in order."""
        return [name for name, _ in self.started]

    def given(self, name: str, port: str) -> list[Any]:
        """What each start of a skill was given on one port; None where the tree gave nothing."""
        return [inputs.get(port) for skill, inputs in self.started if skill == name]

    def end(self, name: str, inputs: dict[str, Any]) -> str | None:
        """The code that this start fails with; None: it succeeds."""
        ends = self.ends.get(name, [])
        count = self.names().count(name)
        if isinstance(ends, list):
            return ends[count - 1] if count <= len(ends) else None
        return ends(count, inputs)

    def stand_in(self, name: str) -> type[Skill]:
        """A skill with the ports and codes of the real one."""
        real, script = INSTALLED.skills[name], self

        def work(self: Skill, robot: Robot) -> Run:
            inputs = {
                port.name: value
                for port in real.ports.values()
                if port.direction == "in"
                and (value := self.port_values.get(port.name, MISSING)) is not MISSING
            }
            script.started.append((name, inputs))
            code = script.end(name, inputs)
            until = self.clock.now() + script.takes.get(name, 0.05)
            while self.clock.now() < until - 1e-9:
                yield "working"
            if code is not None:
                raise Failure(code, f"the {name} of the test")
            for port in real.ports.values():
                if port.direction == "out":
                    setattr(self, port.name, OUTPUTS[port.name])

        return type(real.__name__, (real,), {"run": work, "needs": (), "__doc__": real.__doc__})


def go(example: str, script: Script, **options: Any) -> Report:
    """Run an example in the site that it is meant for, with scripted skills."""
    skills = {name: script.stand_in(name) for name in INSTALLED.skills}
    registry = Registry(skills, {}, {}, dict.fromkeys(INSTALLED.services))
    site = replace(WORLDS.load("four_rooms").site(), tags={"board": single_tag(1, 0.1)})
    world = ScriptedWorld(site=site)
    return run(f"examples/{example}", world=world, registry=registry, **options)


def codes(report: Report) -> list[str]:
    """The codes of a failure and its causes."""
    return [] if report.failure is None else [link.code for link in report.failure.chain()]


def said(report: Report, code: str) -> str:
    """The sentence of the failure, or cause, that has this code."""
    assert report.failure is not None
    return next(link.message for link in report.failure.chain() if link.code == code)


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_checker_has_nothing_to_say(name: str) -> None:
    assert load(name, INSTALLED).problems == []


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_example_succeeds_when_nothing_goes_wrong(name: str) -> None:
    example = name.removeprefix("examples/")
    report = go(example, Script())
    assert report.status == "SUCCESS", report.failure


ROUTE = ["corridor", "north_east_room", "entrance_hall", "south_room"]


def test_patrol_drives_its_rounds() -> None:
    script = Script()
    go("patrol", script)
    assert script.given("navigate", "in_front_of") == [*ROUTE, *ROUTE, "home"]


def test_patrol_charges_where_the_battery_runs_low_and_makes_up_for_the_stop() -> None:
    script = Script(takes={"navigate": 80.0})
    report = go("patrol", script, values={"rounds": 1}, max_time=2000.0)
    assert report.status == "SUCCESS", report.failure
    # 3 legs of 80 s are done when the fourth is given up after 300 s
    stops = script.given("navigate", "in_front_of")
    assert stops == [*ROUTE, "home", "south_room", "home"]
    charged = 4 * 80.0 - 20.0 + 80.0 + 60.0
    assert report.blackboard["charged_at"] == pytest.approx(charged, abs=2.0)


def test_patrol_gives_up_where_the_battery_does_not_last_for_one_leg() -> None:
    report = go("patrol", Script(takes={"navigate": 80.0}), values={"endurance": 40})
    assert report.status == "FAILURE"
    assert codes(report)[-2:] == ["BATTERY_LOW", "FAILED"]


def test_escalating_pick_tries_the_hand_then_the_stand_then_the_belief() -> None:
    script = Script(pick=["GRASP_MISSED"] * 6)
    report = go("escalating_pick", script)
    assert report.status == "SUCCESS", report.failure
    steps = [name for name in script.names() if name in ("pick", "release", "relocalize")]
    assert steps == ["pick", "release", "pick"] * 3 + ["relocalize", "pick"]
    sides = [side for side in script.given("navigate", "side") if side]
    assert sides == [1, 2]
    assert script.given("relocalize", "everywhere") == [True]


def test_escalating_pick_mends_a_missed_grasp_with_the_hand_alone() -> None:
    script = Script(pick=["SLIPPED"])
    assert go("escalating_pick", script).status == "SUCCESS"
    assert script.names().count("navigate") == 2
    assert "relocalize" not in script.names()


def test_escalating_pick_asks_for_help_when_all_levels_are_used_up() -> None:
    script = Script(pick=lambda count, inputs: "NO_GRASP")
    report = go("escalating_pick", script)
    assert report.status == "FAILURE"
    assert said(report, "HELP_NEEDED").startswith("the can on table_a: ")
    assert script.names().count("pick") == 6
    assert script.names()[-1] == "reset_pose"


def test_the_watched_drive_stops_when_the_can_is_lost_and_fetches_it_again() -> None:
    asked = {"holding": 0}

    def check(count: int, inputs: dict[str, Any]) -> str | None:
        asked[inputs["what"]] = asked.get(inputs["what"], 0) + 1
        return "NOT_HOLDING" if inputs["what"] == "holding" and asked["holding"] == 3 else None

    script = Script(takes={"navigate": 2.0}, check=check)
    report = go("watch_while_driving", script)
    assert report.status == "SUCCESS", report.failure
    assert script.names().count("pick") == 2
    assert script.given("navigate", "in_front_of").count("table_b") == 2
    assert asked["localized"] > 10, "asked on every tick of the drive"


def test_the_watched_drive_mends_a_lost_estimate_and_drives_on() -> None:
    script = Script(check=[None, "NOT_LOCALIZED"])
    assert go("watch_while_driving", script).status == "SUCCESS"
    assert script.names().count("relocalize") == 1
    assert script.names().count("pick") == 1


@pytest.mark.parametrize(
    ("seen", "stands_on"),
    [([None, "OBJECT_NOT_FOUND"], "table_a"), (["OBJECT_NOT_FOUND"], "table_b"),
     (["SURFACE_NOT_SEEN", "OBJECT_NOT_FOUND"], "table_b")],
)  # fmt: skip
def test_two_tables_are_inspected_by_one_subtree(seen: list[str | None], stands_on: str) -> None:
    script = Script(detect_object=seen)
    report = go("two_tables", script)
    assert report.blackboard["stands_on"] == stands_on
    second_look = len([code for code in seen if code]) == 2
    sides = [0, 0, 1] if second_look else [0, 0]
    assert script.given("navigate", "side")[:-1] == sides
    assert script.given("navigate", "in_front_of")[:2] == ["table_a", "table_b"]


def test_a_can_on_neither_table_is_a_failure() -> None:
    report = go("two_tables", Script(detect_object=["OBJECT_NOT_FOUND"] * 3))
    assert codes(report)[-1] == "ON_NEITHER"


@pytest.mark.parametrize(
    ("ends", "status", "last"),
    [
        ({"navigate": ["GOAL_BLOCKED"]}, "SUCCESS", "navigate"),
        ({"navigate": ["NO_PATH"]}, "FAILURE", "navigate"),
        ({"navigate": ["PATH_BLOCKED", "PATH_BLOCKED", "NO_PROGRESS"]}, "SUCCESS", "navigate"),
        ({"navigate": ["NOT_LOCALIZED", "NOT_LOCALIZED"]}, "SUCCESS", "navigate"),
        ({"reset_pose": ["NO_PLAN"]}, "SUCCESS", "reset_pose"),
    ],
)
def test_each_code_has_its_answer(ends: dict[str, Any], status: str, last: str) -> None:
    script = Script(**ends)
    report = go("answer_failures", script)
    assert (report.status, script.names()[-1]) == (status, last), report.failure
    if status == "FAILURE":
        assert "UNREACHABLE" in codes(report)
    if ends.get("navigate") == ["GOAL_BLOCKED"]:
        assert script.given("navigate", "in_front_of") == ["north_east_room", "corridor"]
    if "NOT_LOCALIZED" in ends.get("navigate", []):
        assert script.given("relocalize", "everywhere") == [False, True]
    if "reset_pose" in ends:
        assert script.given("navigate", "in_front_of") == ["corridor"]


def test_tidying_carries_what_is_there() -> None:
    script = Script(detect_object=[None, None, "OBJECT_NOT_FOUND"])
    report = go("tidy_table", script)
    assert report.status == "SUCCESS", report.failure
    assert (report.blackboard["moved"], report.blackboard["left"]) == (1, 0)
    assert [each.diameter for each in script.given("detect_object", "object")] == [0.07, 0.07, 0.05]


def test_tidying_goes_on_after_what_cannot_be_carried_and_tells() -> None:
    report = go("tidy_table", Script(pick=["HAND_FULL"]))
    assert report.status == "FAILURE"
    assert (report.blackboard["moved"], report.blackboard["left"]) == (1, 1)
    assert said(report, "NOT_TIDY") == "1 left on table_a, 1 moved"


def test_the_search_ends_with_the_first_surface_that_has_it() -> None:
    script = Script(detect_object=[None])
    report = go("search_surfaces", script)
    assert report.blackboard["place"] == "table_b"
    assert script.given("navigate", "in_front_of") == ["table_b"]


def test_the_search_goes_on_and_says_when_it_is_nowhere() -> None:
    script = Script(detect_object=["OBJECT_NOT_FOUND", "SURFACE_NOT_SEEN"])
    report = go("search_surfaces", script)
    assert script.given("navigate", "in_front_of") == ["table_b", "table_a"]
    assert codes(report)[-1] == "NOT_FOUND_ANYWHERE"


def test_exploring_ends_its_search_with_the_tables_that_have_can_and_tag() -> None:
    script = Script(
        detect_object=["OBJECT_NOT_FOUND", None], find_apriltag=["TAG_NOT_SEEN", "TAG_NOT_SEEN"]
    )
    report = go("explore_and_bring", script)
    assert report.status == "SUCCESS", report.failure
    assert script.given("name_place", "name") == ["start", "table_1", "table_2", "table_3"]
    assert script.given("detect_object", "on") == ["table_1", "table_2"]
    assert script.given("find_apriltag", "on")[:3] == ["table_1", "table_2", "table_3"]
    assert script.given("explore", "share") == [90]
    assert "table_3" in script.given("navigate", "in_front_of")
    assert (report.blackboard["can_on"], report.blackboard["tag_on"]) == ("table_2", "table_3")


def test_what_was_not_found_is_looked_for_from_elsewhere() -> None:
    script = Script(
        discover_surface=[None, "NO_NEW_SURFACE", "NO_NEW_SURFACE"],
        detect_object=["OBJECT_NOT_FOUND", None],
    )
    report = go("explore_and_bring", script)
    assert report.status == "SUCCESS", report.failure
    assert script.given("explore", "share") == [90, 100]
    assert script.given("navigate", "side")[:2] == [0, 3]
    assert script.given("reset_pose", "pose")[:2] == ["home", "home"]
    assert (report.blackboard["can_on"], report.blackboard["tag_on"]) == ("table_1", "table_1")


def test_the_camera_is_raised_where_tables_are_high() -> None:
    script = Script()
    report = go("explore_and_bring", script, values={"highest": 1.1})
    assert report.status == "SUCCESS", report.failure
    assert script.given("reset_pose", "pose")[:2] == ["home", "ready"]
    assert script.given("discover_surface", "highest")[0] == 1.1


def test_a_building_without_the_can_is_told() -> None:
    script = Script(discover_surface=["NO_NEW_SURFACE", "NO_NEW_SURFACE"], explore=["NO_PATH"] * 3)
    report = go("explore_and_bring", script)
    assert said(report, "NOT_FOUND_ANYWHERE") == (
        "looked on 0 tables, with tops 0.45 to 0.85 m high and at least 0.5 m wide: "
        "the can stands on '' and tag 1 is on '', where '' means none"
    )
    assert "pick" not in script.names()


def test_jobs_are_done_in_the_order_of_the_list() -> None:
    script = Script(detect_object=["OBJECT_NOT_FOUND"])
    assert go("jobs", script, values={"jobs": ["rest", "inspect", "look"]}).status == "SUCCESS"
    assert script.given("navigate", "in_front_of") == ["home", "table_a", "corridor"]
    assert script.names().count("detect_object") == 2
    assert script.names()[-1] == "look"


def test_an_unknown_job_ends_the_list() -> None:
    script = Script()
    report = go("jobs", script, values={"jobs": ["rest", "dance", "look"]})
    assert said(report, "UNKNOWN_JOB") == "nobody knows how to do dance"
    assert script.names()[-1] == "navigate"


def test_a_person_says_where_to_look_and_agrees() -> None:
    script = Script()
    report = go("ask_first", script, answers=["table_b", True])
    assert report.status == "SUCCESS", report.failure
    assert script.given("navigate", "in_front_of")[0] == "table_b"
    assert script.names().count("pick") == 1


def test_a_person_says_no() -> None:
    script = Script()
    assert go("ask_first", script, answers=["table_a", False]).status == "SUCCESS"
    assert "pick" not in script.names()
    assert script.given("navigate", "in_front_of") == ["table_a", "home"]


@pytest.mark.parametrize(
    ("answers", "picks", "home"),
    [(["try again", "try again"], 3, False), (["try again", "leave it"], 2, True), ([], 1, True)],
)
def test_a_person_says_what_to_do_when_it_did_not_work(
    answers: list[str], picks: int, home: bool
) -> None:
    script = Script(pick=["SLIPPED", "GRASP_MISSED"])
    report = go("ask_first", script, answers=["table_a", "yes", *answers])
    assert report.status == "SUCCESS", report.failure
    assert script.names().count("pick") == picks
    assert (script.given("navigate", "in_front_of")[-1] == "home") is home


def test_what_is_not_there_is_told() -> None:
    script = Script(detect_object=["OBJECT_NOT_FOUND"])
    report = go("ask_first", script)
    assert said(report, "NOT_THERE") == "no can on table_a"


def test_views_are_collected_and_one_without_a_tag_is_taken_again() -> None:
    script = Script(record_view=[None, "TAG_NOT_SEEN"])
    report = go("calibrate_robot", script, answers=["yes"] * 31)
    assert report.status == "SUCCESS", report.failure
    assert len(script.names()) == 31
    assert set(script.given("record_view", "file")) == {"views.jsonl"}


def test_a_robot_that_drives_looks_at_each_tag_that_it_sees_after_each_way() -> None:
    script = Script()
    assert go("calibrate_driving", script).status == "SUCCESS"
    ways = [name for name in script.names() if name in ("Spin", "DriveOnHeading", "BackUp")]
    assert ways == 3 * ["Spin", "DriveOnHeading", "Spin", "BackUp", "Spin"]
    assert sum(script.given("Spin", "spin_dist")) == pytest.approx(0.0)
    seen = len(OUTPUTS["tags"])
    assert script.names().count("record_view") == (1 + len(ways)) * (1 + seen)
    looked = [pose for pose in script.given("look", "at") if pose is not None]
    assert looked == (1 + len(ways)) * [tag.pose for tag in OUTPUTS["tags"]]


def test_a_robot_that_never_sees_a_tag_is_told() -> None:
    script = Script(record_view=["TAG_NOT_SEEN"] * 5)
    report = go("calibrate_robot", script)
    assert report.status == "FAILURE"
    assert "TAG_NOT_SEEN" in codes(report)
    assert len(script.names()) == 5
