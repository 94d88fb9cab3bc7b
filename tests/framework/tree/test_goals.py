"""The goal of a tree file: how it is written, what is wrong with it, and where it comes from."""

from __future__ import annotations

import pytest

from momantu_bt.descriptions.goal import parse_demands
from momantu_bt.testing import ScriptedWorld
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files.xml import format as xml
from momantu_bt.tree.files.xml import writer as xml_writer
from momantu_bt.tree.files.yaml import format as yaml
from momantu_bt.tree.files.yaml import writer as yaml_writer
from momantu_bt.tree.goals import given_goal, goal_of, is_word
from momantu_bt.tree.registry import Registry

TREE = "momantu_bt: 1\nworld: flat\ngoal: {}\ntrees: {{Main: [succeed]}}\n"
NAMES = {"item": ("can", "mug"), "on": ("desk",), "beside": ("tag", "mug")}


class Flat:
    name, default_robot = "flat", "scripted"

    def site(self):
        return ScriptedWorld().site

    def open(self, description, seed, *, referee=True):
        raise AssertionError("a check opens no world")

    def goal_names(self):
        return NAMES


def document(goal):
    return yaml.read(TREE.format(goal), "t.yaml")[0]


def problems(goal):
    worlds = {"flat": Flat()}
    robots = {"scripted": lambda: ScriptedWorld().robot.description}
    found = check(document(goal), Registry(worlds=worlds, robots=robots)).problems
    return [(p.code, p.place.line, p.message, p.hint) for p in found]


def test_a_goal_is_one_demand_in_words_or_a_mapping_or_a_list_of_them():
    (short,) = parse_demands("can on desk beside tag")
    (long,) = parse_demands({"item": "can", "on": "desk", "beside": "tag", "distance": "40 cm"})
    assert short == long
    assert str(short) == "can on desk beside tag"
    both = parse_demands(["can on desk", {"item": "mug", "on": "desk", "tilt": "10 deg"}])
    assert [str(each) for each in both] == ["can on desk", "mug on desk"]


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("bring the can", "expected OBJECT on SURFACE"),
        ({"item": "can"}, "the key 'on' is missing"),
        (
            ["can on desk", {"item": "mug", "onn": "desk", "on": "desk"}],
            "demand 2.onn: unknown key",
        ),
        ({"item": "can", "on": "desk", "distance": "3 kg"}, "distance: '3 kg' is a mass"),
        (["can on desk", "can on shelf"], "'can' has two demands"),
        ([], "expected at least 1 value"),
        (5, "expected a mapping with the keys item, on, beside"),
    ],
)
def test_what_is_no_goal_is_told(value, words):
    with pytest.raises(ValueError, match=words.replace(".", r"\.")):
        parse_demands(value)


@pytest.mark.parametrize(
    "goal",
    ["world", "none", "can on desk beside tag", "[can on desk, {item: mug, on: desk, tilt: 0.1}]"],
)
def test_a_goal_survives_yaml_and_xml(goal):
    read = document(goal)
    assert read.goal is not None
    assert yaml.read(yaml_writer.write(read), "t.yaml")[0].goal == read.goal
    again = xml.read(xml_writer.write(read), "t.xml")[0]
    assert again.goal == read.goal
    assert again.world == "flat"
    assert problems(goal) == []


def test_a_goal_of_a_tree_knows_its_line_and_one_of_the_command_the_option():
    own = goal_of(document("can on desk"))
    assert own is not None
    assert own.place == "t.yaml:3"
    other = document("can on desk")
    given_goal(other, ["mug on desk"])
    told = goal_of(other)
    assert told is not None
    assert (str(told.demands[0]), told.place) == ("mug on desk", "--goal")
    for word in ("world", "none"):
        assert is_word(document(word))
        assert goal_of(document(word)) is None


def test_names_that_the_world_lacks_are_told_with_those_that_it_has():
    said = problems("kan on deks beside tga")
    assert [(code, line) for code, line, *_ in said] == [("wrong-goal", 3)] * 3
    assert [(message, hint) for _, _, message, hint in said] == [
        ("the world has no object 'kan'", "did you mean can?"),
        ("the world has no surface 'deks'", "did you mean desk?"),
        ("the world has no tag or body 'tga'", "did you mean tag?"),
    ]
    ((_, _, message, _),) = problems("mug on desk beside mug")
    assert message == "'mug' cannot stand beside itself"


def test_a_broken_goal_is_a_problem_at_its_place():
    ((code, line, message, hint),) = problems("bring it")
    assert (code, line) == ("wrong-goal", 3)
    assert message.startswith("this is no goal: expected OBJECT on SURFACE")
    assert "none" in hint
    wired = yaml.read(TREE.format("$here"), "t.yaml")[1].sorted()
    assert [problem.code for problem in wired] == ["wire-inside"]
