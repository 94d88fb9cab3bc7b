"""What a run tells its world's referee to demand, and what its last line says of a denial."""

from __future__ import annotations

import pytest

from momantu_bt.cli.shared.given import given_goal
from momantu_bt.engine.ending import Ending
from momantu_bt.errors import ExitCode
from momantu_bt.record.text.ending import ending_text
from momantu_bt.running.goal import give_goal, undenied
from momantu_bt.running.needed import LaunchError
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.problems import TreeError
from momantu_bt.world import Demanded, Verdict

GOAL = "can on table_b beside tag"


class Told(ScriptedWorld):
    """A world whose referee denies whatever is demanded."""

    def __init__(self):
        super().__init__()
        self.told = "its own"

    def demand(self, goal):
        self.told = None if goal is None else (goal.place, *map(str, goal.demands))

    def verdict(self):
        if self.told is None:
            return Verdict(None)
        place, *demands = ("w.yaml:9", GOAL) if self.told == "its own" else self.told
        found = tuple(Demanded(each, place, False, ("the can fell",)) for each in demands)
        return Verdict(False, ("the can fell",), demands=found)


def document(goal):
    header = "" if goal is None else f"goal: {goal}\n"
    return read(f"momantu_bt: 1\n{header}trees: {{Main: [succeed]}}\n", "d/t.yaml")[0]


@pytest.mark.parametrize(
    ("goal", "told"),
    [
        (None, "its own"),
        ("none", None),
        ("world", "its own"),
        (GOAL, ("t.yaml:2", GOAL)),
        (f"[{GOAL}, mug on desk]", ("t.yaml:2", GOAL, "mug on desk")),
    ],
)
def test_the_tree_says_what_is_demanded(goal, told):
    world = Told()
    give_goal(world, document(goal))
    assert world.told == told


def test_a_world_that_cannot_be_told_keeps_its_own_goal_and_says_so():
    give_goal(ScriptedWorld(), document(None))
    give_goal(ScriptedWorld(), document("world"))
    with pytest.raises(LaunchError, match="judges by its own goal alone"):
        give_goal(ScriptedWorld(), document(GOAL))


def test_a_denial_says_what_was_demanded_where_it_stands_and_how_to_go_without(run_yaml):
    report = run_yaml(f"goal: {GOAL}\ntrees: {{Main: [succeed]}}", world=Told())
    assert report.exit_code is ExitCode.FAILURE
    (demanded,) = report.demands
    assert (demanded.demand, demanded.met) == (GOAL, False)
    said = ending_text(report)
    assert "the referee denies success: the can fell; demanded: can on table_b beside tag (" in said
    assert demanded.place in said
    assert said.endswith("; --no-referee leaves it to the tree")
    assert report.as_dict()["demands"][0]["unmet"] == ["the can fell"]


def test_without_a_goal_nothing_is_denied(run_yaml):
    report = run_yaml("goal: none\ntrees: {Main: [succeed]}", world=Told())
    assert (report.success, report.unmet, report.exit_code) == (None, (), ExitCode.SUCCESS)
    assert "referee" not in ending_text(report)


@pytest.mark.parametrize(
    ("goal", "met", "success"),
    [(None, False, None), (None, True, True), ("world", False, False), ("world", True, True)],
)
def test_a_worlds_own_goal_confirms_and_denies_only_where_the_tree_asks_for_it(goal, met, success):
    verdict = Verdict(met, () if met else ("the can fell",))
    ending = undenied(Ending("SUCCESS", None, verdict, 1.0, 1.0, 20, None), document(goal))
    assert ending.verdict is not None
    assert ending.verdict.success is success
    assert bool(ending.verdict.unmet) is (success is False)


def test_the_goal_of_the_command_wins_over_the_trees(run_yaml):
    world = Told()
    run_yaml("goal: none\ntrees: {Main: [succeed]}", world=world, goal=["mug on desk"])
    assert world.told == ("--goal", "mug on desk")


def test_the_option_takes_words_texts_mappings_and_files(tmp_path):
    file = tmp_path / "goal.yaml"
    file.write_text("- can on desk\n- {item: mug, on: desk}\n")
    assert given_goal(None) is None
    assert given_goal(["none"]) == "none"
    assert given_goal([GOAL]) == GOAL
    assert given_goal(["{item: can, on: desk}"]) == {"item": "can", "on": "desk"}
    assert given_goal([GOAL, "mug on desk"]) == [GOAL, "mug on desk"]
    assert given_goal([str(file)]) == ["can on desk", {"item": "mug", "on": "desk"}]
    with pytest.raises(TreeError, match="--goal"):
        given_goal(["{item: can"])
