"""Tells the world's referee what the tree, or the command, demands."""

from __future__ import annotations

from dataclasses import replace

from momantu_bt.engine.ending import Ending
from momantu_bt.goal import NO_GOAL, DemandingWorld
from momantu_bt.running.needed import LaunchError
from momantu_bt.tree.goals import goal_of, is_word
from momantu_bt.tree.model import Document
from momantu_bt.world import World


def give_goal(world: World, document: Document) -> None:
    """Set what the referee demands: what the document does, or the world's own goal.

    Raises:
        LaunchError: the document has a goal of its own, and this world's cannot be set.
        WorldError: the episode lacks what the goal names.
    """
    goal, word = goal_of(document), is_word(document)
    if word and (document.goal is None or document.goal.value != NO_GOAL):
        return
    if isinstance(world, DemandingWorld):
        world.demand(goal)
    elif document.goal is not None:
        raise LaunchError(
            f"the world {world.name!r} judges by its own goal alone; leave the goal out, or write "
            "--goal world; --no-referee runs without its judgement"
        )


def undenied(ending: Ending, document: Document) -> Ending:
    """The ending of a run in a world that it has opened: without a goal nothing is denied.

    A world's own goal that is met all the same confirms the success.
    """
    verdict = ending.verdict
    if document.goal is not None or verdict is None or verdict.success:
        return ending
    return replace(ending, verdict=replace(verdict, success=None, unmet=(), demands=()))
