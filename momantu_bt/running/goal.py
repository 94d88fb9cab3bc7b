"""Tells the world's referee what the tree, or the command, demands."""

from __future__ import annotations

from momantu_bt.goal import NO_GOAL, DemandingWorld
from momantu_bt.running.needed import LaunchError
from momantu_bt.tree.goals import goal_of, is_word
from momantu_bt.tree.model import Document
from momantu_bt.world import World


def give_goal(world: World, document: Document, *, opened: bool) -> None:
    """Set what the referee demands: what the document does, or nothing if it says nothing.

    opened: this run has opened the world. The referee of a world that was open before, and that of
    a world whose goal cannot be set, keeps its own goal if the document says nothing.

    Raises:
        LaunchError: the document has a goal of its own, and this world's cannot be set.
        WorldError: the episode lacks what the goal names.
    """
    goal, word = goal_of(document), is_word(document)
    nothing = word and (document.goal.value == NO_GOAL if document.goal is not None else opened)
    if word and not nothing:
        return
    if isinstance(world, DemandingWorld):
        world.demand(goal)
    elif document.goal is not None:
        raise LaunchError(
            f"the world {world.name!r} judges by its own goal alone; leave the goal out, or write "
            "--goal world; --no-referee runs without its judgement"
        )
