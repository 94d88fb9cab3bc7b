"""AlwaysSuccess, AlwaysFailure, Fail, SetBlackboard, UnsetBlackboard."""

from __future__ import annotations

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.flow import After, Walk
from momantu_bt.tree.catalogue.known import NEVER, Known
from momantu_bt.tree.catalogue.spec import Dialect, input_port, leaf, output_port
from momantu_bt.tree.model import Node, Reference
from momantu_bt.values.kinds import CodeText


def _always(walk: Walk, node: Node, before: Known) -> After:
    return After(walk.outputs(node, before), NEVER)


def _never(walk: Walk, node: Node, before: Known) -> After:
    return After(NEVER, before)


def _removed(walk: Walk, node: Node, before: Known) -> After:
    key = node.ports.get("key")
    return After(before.lacking([key.key]) if isinstance(key, Reference) else before, before)


class AlwaysSuccess(TreeNode):
    """Succeeds at once."""

    spec = leaf("AlwaysSuccess", ("succeed", "always_success"), "Succeeds at once.", flow=_always)

    def step(self) -> Status:
        """SUCCESS."""
        return SUCCESS


class AlwaysFailure(TreeNode):
    """Fails at once, with FAILED."""

    spec = leaf("AlwaysFailure", "always_failure", "Fails at once, with FAILED.", flow=_never)

    def step(self) -> Status:
        """FAILURE."""
        return self.fail(FAILED, "always fails")


class Fail(TreeNode):
    """Fails at once with the code and sentence that the tree gives."""

    spec = leaf(
        "Fail",
        "fail",
        "Fails at once with a code.",
        input_port("code", CodeText, "upper-case words joined by underscores"),
        input_port("message", str, "one sentence for a person", ""),
        dialect=Dialect.OURS,
        flow=_never,
        codes=lambda node, failing: failing.named,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()

    def step(self) -> Status:
        """FAILURE."""
        return self.fail(str(self.inputs["code"]), self.inputs["message"])


class SetBlackboard(TreeNode):
    """Writes a value to a key."""

    spec = leaf(
        "SetBlackboard",
        "set",
        "Writes a value to a key.",
        output_port("key", object, "the key"),
        input_port("value", object, "what it becomes"),
        xml={"key": "output_key"},
        keys=("key",),
        copies={"key": "value"},
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.key = parts.key("key")

    def step(self) -> Status:
        """Write the value."""
        self.key.write(self.inputs["value"])
        return SUCCESS


class UnsetBlackboard(TreeNode):
    """Removes a key's value."""

    spec = leaf(
        "UnsetBlackboard",
        "unset",
        "Removes a key.",
        output_port("key", object, "the key"),
        keys=("key",),
        removes="key",
        flow=_removed,
    )

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.key = parts.key("key")

    def step(self) -> Status:
        """Remove the value."""
        self.key.write(MISSING)
        return SUCCESS
