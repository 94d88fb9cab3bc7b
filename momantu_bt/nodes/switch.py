"""Switch2 to Switch6: run the child of the case that equals a variable, else the last child.

The variable is read on each tick; when the choice changes, the child that was running is halted.
The chosen child's status is the node's status. A variable without a value selects the last child.
A boolean selects the case `true` or `false`; where no case is it, the case 1 or 0.
"""

from __future__ import annotations

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import FAILURE, RUNNING, Status
from momantu_bt.failure import INPUT_MISSING, Failure
from momantu_bt.tree.catalogue.flow import After, Walk, again
from momantu_bt.tree.catalogue.known import NEVER, Known, meet
from momantu_bt.tree.catalogue.spec import NodeSpec, control, input_port
from momantu_bt.tree.catalogue.wording import port_text, ports_in_words
from momantu_bt.tree.model import Node
from momantu_bt.tree.script.cases import is_case


def _cases(walk: Walk, node: Node, before: Known) -> After:
    ends = [walk(child, before) for child in node.children]
    return After(
        meet(NEVER, *(end.success for end in ends)),
        meet(before, *(end.failure for end in ends)),
        meet(NEVER, *(end.skipped for end in ends)),
    )


def _spec(cases: int) -> NodeSpec:
    ports = [input_port(f"case_{i}", object, "a value of `variable`") for i in range(1, cases + 1)]
    return control(
        f"Switch{cases}",
        "switch",
        "Runs the child of the case that equals the variable, else the last child.",
        input_port("variable", object, "what is compared, on each tick"),
        *ports,
        children=(cases + 1, cases + 1),
        switch=cases,
        flow=again(_cases),
        port_words=_variable,
        roles=_roles,
    )


def _variable(node: Node) -> list[str]:
    """Its ports in words, without the cases: displays show those beside the children."""
    plain = {name: value for name, value in node.ports.items() if not name.startswith("case_")}
    return ports_in_words(node, plain)


def _roles(node: Node) -> list[str]:
    count = int(node.type.removeprefix("Switch"))
    return [*(port_text(node, f"case_{i}") for i in range(1, count + 1)), "else"]


class Switch(TreeNode):
    """Children: one for each case, in order, then the default."""

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()
        self.at: int | None = None

    def step(self) -> Status:
        """Choose a child, halt the previous one if it is another, tick the chosen one."""
        chosen = self._chosen()
        if self.at is not None and self.at != chosen:
            self.kids[self.at].reset()
        child = self.kids[chosen]
        status = child.execute()
        self.at = chosen if status is RUNNING else None
        if not status.completed:
            return status
        if status is FAILURE:
            self.fail_with(self.failure_of(child))
        self.reset_children()
        return status

    def clear(self) -> None:
        """Forget which child was chosen."""
        self.at = None

    def _chosen(self) -> int:
        default = len(self.kids) - 1
        try:
            variable = self.inputs["variable"]
        except Failure as failure:
            if failure.value.code == INPUT_MISSING:
                return default
            raise
        cases = [self.inputs[f"case_{number}"] for number in range(1, default + 1)]
        found = next((i for i, case in enumerate(cases) if is_case(variable, case)), None)
        if found is None and isinstance(variable, bool):
            found = next((i for i, case in enumerate(cases) if is_case(int(variable), case)), None)
        return default if found is None else found


class Switch2(Switch):
    """A switch with two cases."""

    spec = _spec(2)


class Switch3(Switch):
    """A switch with three cases."""

    spec = _spec(3)


class Switch4(Switch):
    """A switch with four cases."""

    spec = _spec(4)


class Switch5(Switch):
    """A switch with five cases."""

    spec = _spec(5)


class Switch6(Switch):
    """A switch with six cases."""

    spec = _spec(6)
