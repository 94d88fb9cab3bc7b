from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from momantu_bt.engine.blackboard import Board, Cell
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.formats.places import Place
from momantu_bt.running.api import run
from momantu_bt.skill import Skill
from momantu_bt.testing import ManualClock, ScriptedWorld
from momantu_bt.tree.catalogue import NODES
from momantu_bt.tree.model import Node, Reference
from momantu_bt.tree.registry import Registry

LETTERS = {"R": RUNNING, "S": SUCCESS, "F": FAILURE, "K": SKIPPED, "I": IDLE}


class Leaf(TreeNode):
    """Returns the statuses of its script in turn, the last one for ever; counts halts."""

    def __init__(self, model: Node, context: RunContext, script: str) -> None:
        super().__init__(Parts(model, context, Board(context.writes)))
        self.script = [LETTERS[letter] for letter in script]
        self.given = 0
        self.halts = 0

    def step(self) -> Status:
        status = self.script[min(self.given, len(self.script) - 1)]
        self.given += 1
        if status is FAILURE:
            return self.fail("FAILED", f"{self.name} failed")
        return status

    def clear(self) -> None:
        self.halts += 1


class Bench:
    """Makes nodes by hand and ticks them; 0.05 s pass between two ticks."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.context = RunContext(self.clock)
        self.board = Board(self.context.writes)

    def model(self, type_: str, name: str | None = None) -> Node:
        return Node(type_, Place("test.yaml", 1, 1), name=name)

    def leaf(self, script: str, name: str = "leaf") -> Leaf:
        return Leaf(self.model("AlwaysSuccess", name), self.context, script)

    def node(self, kind: Any, kids: Sequence[TreeNode | str], /, **ports: Any) -> Any:
        children = [
            self.leaf(kid, f"leaf{i}") if isinstance(kid, str) else kid
            for i, kid in enumerate(kids)
        ]
        return kind(self.parts(self.model(kind.spec.type), children, **ports))

    def parts(
        self, model: Node, children: Sequence[TreeNode], /, answers: Any = (), **ports: Any
    ) -> Parts:
        """What a node is made of. ports: values, each on a key of its own, or References.

        answers: of a node with handlers, codes and the child that answers them.
        """
        for name, value in ports.items():
            reference = value
            if not isinstance(value, Reference):
                reference = Reference(f"{model.name or model.type}_{name}_{len(self.board.cells)}")
                self.board.cell(reference.key).value = value  # not in the journal of the run
            model.ports[name] = reference
        caught = Cell(f"{model.name}/failure", self.context.writes)
        spec = NODES[model.type]
        return Parts(
            model,
            self.context,
            self.board,
            spec.ports,
            tuple(children),
            answers=tuple(answers),
            caught=caught,
        )

    def tick(self, node: TreeNode) -> str:
        self.context.begin_tick()
        status = node.execute()
        self.clock.advance(0.05)
        return next(letter for letter, each in LETTERS.items() if each is status)

    def ticks(self, node: TreeNode, most: int = 8) -> str:
        """Letters of its statuses until it is no longer running."""
        letters = ""
        while len(letters) < most and (not letters or letters[-1] == "R"):
            letters += self.tick(node)
        return letters


@pytest.fixture
def bench() -> Bench:
    return Bench()


@pytest.fixture(scope="session")
def new_bench() -> type[Bench]:
    """For property tests, whose examples need a bench each."""
    return Bench


@pytest.fixture
def run_yaml(tmp_path):
    """Run a tree written in the test, with skills of the test, in a scripted world."""

    def start(text: str, *skills: type[Skill], world: Any = None, **options: Any) -> Any:
        file = tmp_path / "tree.yaml"
        file.write_text(f"momantu_bt: 1\nmain: Main\n{text}", encoding="utf-8")
        registry = Registry(
            skills={_snake(skill.__name__): skill for skill in skills},
            services=options.pop("services", {}),
        )
        place = world if world is not None else ScriptedWorld()
        return run(file, world=place, registry=registry, **options)

    return start


def _snake(name: str) -> str:
    return "".join(f"_{c.lower()}" if c.isupper() else c for c in name).lstrip("_")
