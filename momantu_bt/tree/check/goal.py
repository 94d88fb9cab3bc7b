"""The check of a goal: it is one, and the world has what it names."""

from __future__ import annotations

from momantu_bt.formats.places import Place
from momantu_bt.goal import NO_GOAL, WORLDS_OWN, GoalNames
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.goals import goal_of, is_word, unknown_names
from momantu_bt.world import WorldEntry


def check_goal(context: Context, entry: WorldEntry | None) -> None:
    """Report a goal that cannot be judged. entry: the world that the tree is checked with."""
    document = context.document
    place = document.goal_place or Place(document.file, 1, 1)
    if is_word(document):
        return
    try:
        goal = goal_of(document)
    except ValueError as error:
        hint = f"write {WORLDS_OWN}, {NO_GOAL}, or `can on table_b beside tag`"
        context.problems.error("wrong-goal", place, f"this is no goal: {error}", hint)
        return
    if goal is None or not isinstance(entry, GoalNames):
        return
    for message, hint in unknown_names(goal, entry.goal_names()):
        context.problems.error("wrong-goal", place, message, hint)
