"""Nav2's selectors: they write the name of a planner, a controller or a checker to a key.

In Nav2 a message on a topic may replace the default; there are no topics here, so the default is
what is selected.
"""

from __future__ import annotations

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED
from momantu_bt.tree.catalogue.spec import Dialect, NodeSpec, input_port, leaf, output_port


def _selector(type_: str, yaml: str, what: str, words: str) -> NodeSpec:
    return leaf(
        type_,
        yaml,
        f"Writes the name of the default {words} to a key.",
        input_port(f"default_{what}", str, "the name that is selected", ""),
        input_port("topic_name", str, "Nav2's topic for another name; there are none here", None),
        output_port(f"selected_{what}", str, "the key that gets the name", None),
        dialect=Dialect.NAV2,
    )


class _Selector(TreeNode):
    """SUCCESS with the default's name; FAILURE without a default."""

    what = ""

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs, self.outputs = parts.inputs(), parts.outputs()

    def step(self) -> Status:
        """Write the name."""
        name = self.inputs[f"default_{self.what}"]
        if not name:
            return self.fail(FAILED, f"default_{self.what} is empty, and nothing else selects one")
        output = self.outputs.get(f"selected_{self.what}")
        if output is not None:
            output.write(name)
        return SUCCESS


class PlannerSelector(_Selector):
    """Selects a planner."""

    what = "planner"
    spec = _selector("PlannerSelector", "planner_selector", what, "planner")


class ControllerSelector(_Selector):
    """Selects a controller."""

    what = "controller"
    spec = _selector("ControllerSelector", "controller_selector", what, "controller")


class SmootherSelector(_Selector):
    """Selects a smoother of paths."""

    what = "smoother"
    spec = _selector("SmootherSelector", "smoother_selector", what, "smoother")


class GoalCheckerSelector(_Selector):
    """Selects how near to the goal counts as there."""

    what = "goal_checker"
    spec = _selector("GoalCheckerSelector", "goal_checker_selector", what, "goal checker")


class ProgressCheckerSelector(_Selector):
    """Selects what counts as progress."""

    what = "progress_checker"
    spec = _selector(
        "ProgressCheckerSelector", "progress_checker_selector", what, "progress checker"
    )


class PathHandlerSelector(_Selector):
    """Selects how the controller takes over a path."""

    what = "path_handler"
    spec = _selector("PathHandlerSelector", "path_handler_selector", what, "path handler")
