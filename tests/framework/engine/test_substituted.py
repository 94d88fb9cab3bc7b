"""Nodes that do what a rule says: in turn, with their conditions, and halted like others."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import momantu_bt
from momantu_bt.cli import main
from momantu_bt.messages import BaseVelocity
from momantu_bt.running.launch import LaunchError
from momantu_bt.skill import In, Out, Run, Skill
from momantu_bt.testing import ScriptedWorld

DOCS = Path(__file__).parents[3] / "docs"


class Drive(Skill):
    """Drives for some ticks."""

    ticks: int = In(3, doc="how many")
    distance: float = Out(doc="m", unit="m")
    failures = {"BLOCKED": "something is there"}
    uses = {"base"}

    def run(self, robot) -> Run:
        for _ in range(self.ticks):
            robot.command("base", BaseVelocity(0.5, 0.0))
            yield "driving"
        self.distance = 1.0


TREE = """
trees:
  Main:
    - drive: {distance: $d}
      name: there
      skip_if: $@back == 'yes'
      on_success: $ends += 1
      on_failure: $ends += 1
      %s
values: {back: no, ends: 0}
"""


@pytest.fixture
def substituted(run_yaml, tmp_path):
    def start(text, *rules, **options):
        file = tmp_path / "rules.yaml"
        lines = "".join(f"  - {{{rule}}}\n" for rule in rules)
        file.write_text(f"momantu_bt: 1\nsubstitute:\n{lines}")
        return run_yaml(text, Drive, substitute=file, **options)

    return start


def tree(modifier="note: nothing"):
    return TREE % modifier


def test_success_writes_the_outputs_with_their_units(substituted):
    world = ScriptedWorld()
    report = substituted(
        tree(), "node: there, status: SUCCESS, delay: 1 s, outputs: {distance: 30 cm}", world=world
    )
    assert report.status == "SUCCESS"
    assert report.sim_time_s == pytest.approx(1.05)
    assert report.blackboard["d"] == pytest.approx(0.3)
    assert report.blackboard["ends"] == 1
    assert not [goal for _, _, goal in world.robot.commands if goal is not None]


def test_a_failure_is_the_nodes_own(substituted):
    report = substituted(
        tree("timeout: 5 s"),
        "node: drive, status: FAILURE, code: BLOCKED, message: a chair, delay: 0.5",
        world="none",
    )
    failure = report.failure
    assert (failure.code, failure.message) == ("BLOCKED", "a chair")
    assert (failure.node, failure.node_type) == ("there", "drive")
    assert report.sim_time_s == pytest.approx(0.55)


def test_times_then_the_next_rule_then_the_node_itself(substituted):
    report = substituted(
        tree("retry: 5"),
        "node: there, status: FAILURE, code: BLOCKED, times: 2",
        "node: drive, status: FAILURE, times: 1",
    )
    assert (report.status, report.blackboard["d"]) == ("SUCCESS", 1.0)
    assert report.blackboard["ends"] == 4
    runs = [(node.runs, node.failures) for node in report.nodes if node.type == "drive"]
    assert runs == [(4, 3), (1, 0)]


def test_running_is_halted_by_what_is_around_it(substituted):
    report = substituted(tree("timeout: 1 s"), "node: there, status: RUNNING", world="none")
    assert report.failure.code == "TIMEOUT"
    assert report.failure.cause.node == "there"


def test_skipped_and_the_nodes_own_conditions(substituted):
    skipping = substituted(tree(), "node: there, status: SKIPPED", world="none")
    assert (skipping.status, skipping.blackboard["ends"]) == ("SUCCESS", 0)
    text = tree().replace("back: no", "back: yes")
    report = substituted(text, "node: there, status: FAILURE", world="none")
    assert (report.status, report.blackboard["ends"]) == ("SUCCESS", 0)


def test_a_subtree_and_a_control_node_can_be_replaced(substituted):
    text = """
trees:
  Main:
    - Far: {far: $f}
    - fallback:
        - drive
  Far:
    outputs: {far: number}
    drive: {distance: $far}
"""
    rules = ("node: Far, status: SUCCESS, outputs: {far: 7}", "node: fallback, status: SUCCESS")
    report = substituted(text, *rules, world="none")
    assert (report.status, report.blackboard["f"]) == ("SUCCESS", 7)
    assert [node.type for node in report.nodes] == ["Sequence", "Far", "Fallback"]


def test_a_world_is_needed_for_what_is_not_replaced_for_good(substituted):
    with pytest.raises(LaunchError, match="needs a world for drive"):
        substituted(tree(), "node: drive, status: FAILURE, times: 1", world="none")


def test_the_page_on_testing_trees_is_true(tmp_path, monkeypatch, capsys):
    page = (DOCS / "testing_trees.md").read_text(encoding="utf-8")
    for text in re.findall(r"```yaml\n(.*?)```", page, re.DOTALL):
        (tmp_path / text.split()[1]).write_text(text)
    monkeypatch.chdir(tmp_path)
    (shown,) = re.findall(r"\$ momantu-bt (.*?)\n(.*?)```", page, re.DOTALL)
    assert main([*shown[0].split(), "--report", "report.json"]) == 0
    assert capsys.readouterr().out.startswith(shown[1])
    scope: dict[str, object] = {}
    (test,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(test, scope)
    scope["test_it_tries_again_when_the_can_slips"]()
    assert json.loads(Path("report.json").read_text())["sim_time_s"] == pytest.approx(6.05, abs=0.2)


CPP_TREE = """<root BTCPP_format="4" main_tree_to_execute="Main"><BehaviorTree ID="Main"><Sequence>
<Script code="tries := 0; seen := 0"/>
<RetryUntilSuccessful num_attempts="5"><AlwaysFailure name="open"/></RetryUntilSuccessful>
<SubTree ID="Arm" name="arm" _autoremap="true"/></Sequence></BehaviorTree>
<BehaviorTree ID="Arm"><Fallback><AlwaysFailure name="grasp_1" _skipIf="tries == 0"/>
</Fallback></BehaviorTree></root>"""
CPP_RULES = {
    "TestNodeConfigs": {
        "Slow": {"return_status": "SUCCESS", "async_delay": 100, "post_script": "seen = tries"},
        "Moody": {
            "return_status_script": "tries >= 2 ? SUCCESS : FAILURE",
            "failure_script": "tries += 1",
        },
    },
    "SubstitutionRules": {"open": "Moody", "arm/grasp_*": "Slow"},
}


def test_a_configuration_of_behaviortree_cpp_runs_instead(tmp_path):
    tree, rules = tmp_path / "tree.xml", tmp_path / "rules.json"
    tree.write_text(CPP_TREE)
    rules.write_text(json.dumps(CPP_RULES))
    report = momantu_bt.run(tree, substitute=rules, world="none")
    assert (report.status, report.blackboard) == ("SUCCESS", {"seen": 2, "tries": 2})
    assert report.ticks == 5
    runs = {node.name: node.runs for node in report.nodes}
    assert (runs["open"], runs["grasp_1"]) == (3, 1)
