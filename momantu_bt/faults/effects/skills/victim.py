"""Which start of which skill a fault hits, and how the skill's class is wrapped."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.skill_leaf import SkillLeaf
from momantu_bt.engine.skills.session import Session
from momantu_bt.fault import Fault
from momantu_bt.robot import Robot
from momantu_bt.skill import Compute, Run, Skill

UNBOUNDED = 10**9
"""How many starts a fault without a count may hit."""


class SkillFault:
    """Implements `Effect`. Skills whose class went through `wrapped` can be hit.

    The fault hits the skill that runs when the fault begins: first choice is a skill within the
    node that made it begin, then any running skill, then the next skill that makes a step. After
    that it hits further starts of the same skill, up to its count. Subclasses say what happens.
    """

    def __init__(self, fault: Fault) -> None:
        self.fault = fault
        self._active = False
        self._left = int(fault.parameters.get("times", UNBOUNDED))
        self._kind: type[Skill] | None = None
        self._victim: Skill | None = None

    def aim(self, node: TreeNode | None, nodes: Sequence[TreeNode]) -> None:
        """Choose the skill to hit. node: the one that made it begin; nodes: the whole tree."""
        within = () if node is None else (node, *node.below)
        for leaf in (*within, *nodes):
            if isinstance(leaf, SkillLeaf) and isinstance(leaf.session, Session):
                self._kind, self._victim = leaf.kind, leaf.session.skill
                self._left -= 1
                return

    def begin(self) -> None:
        """Start to hit."""
        self._active = True

    def end(self) -> None:
        """Stop hitting."""
        self._active = False

    def hits(self, skill: Skill) -> bool:
        """Whether the fault hits this skill now."""
        if not self._active:
            return False
        if skill is self._victim:
            return True
        if self._left < 1 or self._kind not in (None, type(skill)):
            return False
        self._kind, self._victim = type(skill), skill
        self._left -= 1
        return True

    def wrapped(self, kind: type[Skill]) -> type[Skill]:
        """The same skill with the effect built in."""

        def run(skill: Skill, robot: Robot) -> Run:
            return self._run(skill, kind.run(skill, robot))

        about = {"run": run, "__module__": kind.__module__, "__doc__": kind.__doc__}
        return type(kind.__name__, (kind,), {**about, "__qualname__": kind.__qualname__})

    def before(self, skill: Skill) -> None:
        """The effect on an affected skill before each of its steps."""

    def longer(self, said: str | Compute) -> Iterator[str | Compute]:
        """What an affected skill yields in place of `said`."""
        yield said

    def after(self, skill: Skill) -> None:
        """The effect on an affected skill after it has ended in SUCCESS."""

    def _run(self, skill: Skill, steps: Run) -> Run:
        answer: Any = None
        raised: Exception | None = None
        try:
            while True:
                if self.hits(skill):
                    self.before(skill)
                try:
                    said = steps.send(answer) if raised is None else steps.throw(raised)
                except StopIteration:
                    break
                raised = None
                for part in self.longer(said) if self.hits(skill) else (said,):
                    try:
                        answer = yield part
                    except Exception as error:
                        raised = error
        finally:
            steps.close()
        if self.hits(skill):
            self.after(skill)
