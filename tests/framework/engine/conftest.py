from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from momantu_bt.engine.api import run
from momantu_bt.engine.blackboard import Board
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.formats.places import Place
from momantu_bt.skill import MISSING, Skill
from momantu_bt.testing import ManualClock, ScriptedWorld
from momantu_bt.tree.catalogue import BUILT_IN
from momantu_bt.tree.model import Node
from momantu_bt.tree.registry import Registry

LETTERS = {"R": RUNNING, "S": SUCCESS, "F": FAILURE, "K": SKIPPED, "I": IDLE}


class Leaf(TreeNode):
    """Returns the statuses of its script in turn, the last one for ever; counts halts."""

    def __init__(self, model: Node, context: RunContext, script: str) -> None:
        super().__init__(model, context)
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
        named: dict[str, Any] = {}
        spec = BUILT_IN.get(kind.__name__)
        declared = spec.ports.values() if spec is not None else ()
        defaults = {port.name: port.default for port in declared if port.default is not MISSING}
        given = {**defaults, **ports}
        if given:
            named["inputs"] = Inputs({name: (lambda v=value: v) for name, value in given.items()})
        return kind(self.model(kind.__name__), self.context, children, None, **named)

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
