"""Making an object of each built-in node, from its parts.

`Recover`, `Handle`, subtrees and skills need more than their parts, and are made by `build`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

from momantu_bt.engine.blackboard import Board, Cell
from momantu_bt.engine.conditions import Conditions
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.node import TreeNode
from momantu_bt.engine.nodes import (
    approach,
    asking,
    branches,
    fallbacks,
    forcing,
    goals,
    guards,
    leaves,
    loops,
    parallel,
    pipelines,
    queues,
    rates,
    reactive,
    retreat,
    scripted,
    scripts,
    sequences,
    switch,
    timing,
    try_catch,
    updates,
)
from momantu_bt.engine.ports import Inputs, cell_of, inputs_of, outputs_of
from momantu_bt.errors import MomantuError
from momantu_bt.tree.catalogue import SWITCHES, NodeSpec
from momantu_bt.tree.model import Node, Reference
from momantu_bt.values.kinds import ScriptText


class BuildError(MomantuError):
    """The model cannot become nodes: the checker would have said so."""


@dataclass(frozen=True, slots=True)
class Parts:
    """What a built-in node is made of."""

    model: Node
    spec: NodeSpec
    context: RunContext
    kids: list[TreeNode]
    conditions: Conditions | None
    board: Board

    def make(self, kind: Callable[..., TreeNode], **named: Any) -> TreeNode:
        """A node of a class with these parts."""
        return kind(self.model, self.context, self.kids, self.conditions, **named)

    def inputs(self) -> Inputs:
        """Readers of its inputs.

        Raises:
            ConversionError: a literal does not fit its port.
        """
        return inputs_of(self.spec.ports, self.model.ports, self.board)

    def inputs_or_keys(self, *names: str) -> Inputs:
        """The same, where some inputs mean the keys of their names unless they are given."""
        defaults = {name: Reference(name) for name in names}
        return inputs_of(self.spec.ports, {**defaults, **self.model.ports}, self.board)

    def key(self, port: str) -> Cell:
        """The cell that a port is wired to; BuildError where it is not wired to a key."""
        value = self.model.ports.get(port)
        if not isinstance(value, Reference):
            raise BuildError(f"{self.model.place}: {self.model.type} needs `{port}: $key`")
        return cell_of(value, self.board)

    def outputs(self) -> dict[str, Cell]:
        """The cells of its outputs that are wired."""
        return outputs_of(self.spec.ports, self.model.ports, self.board)

    def scripts(self) -> dict[str, scripts.Code]:
        """Its scripts that are given, by port."""
        readers = self.inputs().readers
        return {
            name: scripts.Code(readers[name], self.board)
            for name, port in self.spec.ports.items()
            if port.type is ScriptText and name in self.model.ports
        }


Maker: TypeAlias = Callable[[Parts], TreeNode]


def _plain(kind: Callable[..., TreeNode]) -> Maker:
    return lambda parts: parts.make(kind)


def _with_inputs(kind: Callable[..., TreeNode]) -> Maker:
    return lambda parts: parts.make(kind, inputs=parts.inputs())


def _with_entry(kind: Callable[..., TreeNode]) -> Maker:
    return lambda parts: parts.make(kind, entry=parts.key("entry"))


def _with_code(kind: Callable[..., TreeNode]) -> Maker:
    return lambda parts: parts.make(kind, code=parts.scripts()["code"])


def _with_goals(kind: Callable[..., TreeNode]) -> Maker:
    return lambda parts: parts.make(kind, inputs=parts.inputs_or_keys("goal", "goals"))


def _queue_loop(parts: Parts) -> TreeNode:
    value = parts.outputs().get("value")
    return parts.make(queues.QueueLoop, inputs=parts.inputs(), value=value)


def _precondition(parts: Parts) -> TreeNode:
    return parts.make(guards.Precondition, inputs=parts.inputs(), code=parts.scripts()["if"])


MAKERS: Mapping[str, Maker] = MappingProxyType(
    {
        "Sequence": _plain(sequences.Sequence),
        "AsyncSequence": _plain(sequences.AsyncSequence),
        "SequenceWithMemory": _plain(sequences.SequenceWithMemory),
        "ReactiveSequence": _plain(reactive.ReactiveSequence),
        "Fallback": _plain(fallbacks.Fallback),
        "AsyncFallback": _plain(fallbacks.AsyncFallback),
        "ReactiveFallback": _plain(reactive.ReactiveFallback),
        "RoundRobin": _with_inputs(fallbacks.RoundRobin),
        "Parallel": _with_inputs(parallel.Parallel),
        "ParallelAll": _with_inputs(parallel.ParallelAll),
        "IfThenElse": _plain(branches.IfThenElse),
        "WhileDoElse": _plain(branches.WhileDoElse),
        **{spec.type: _with_inputs(switch.Switch) for spec in SWITCHES.values()},
        "TryCatch": _with_inputs(try_catch.TryCatch),
        "RecoveryNode": _with_inputs(retreat.RecoveryNode),
        "PipelineSequence": _plain(pipelines.PipelineSequence),
        "NonblockingSequence": _plain(pipelines.NonblockingSequence),
        "PersistentSequence": lambda parts: parts.make(
            pipelines.PersistentSequence,
            inputs=parts.inputs(),
            place=parts.key("current_child_idx"),
        ),
        "RetryUntilSuccessful": _with_inputs(loops.RetryUntilSuccessful),
        "Repeat": _with_inputs(loops.Repeat),
        "Timeout": _with_inputs(timing.Timeout),
        "Delay": _with_inputs(timing.Delay),
        "Inverter": _plain(forcing.Inverter),
        "ForceSuccess": _plain(forcing.ForceSuccess),
        "ForceFailure": _plain(forcing.ForceFailure),
        "ElseFail": _with_inputs(forcing.ElseFail),
        "KeepRunningUntilFailure": _plain(loops.KeepRunningUntilFailure),
        "RunOnce": _with_inputs(loops.RunOnce),
        "Precondition": _precondition,
        "ForEach": lambda parts: parts.make(
            loops.ForEach, inputs=parts.inputs(), item=parts.key("as")
        ),
        "LoopInt": _queue_loop,
        "LoopDouble": _queue_loop,
        "LoopString": _queue_loop,
        "LoopBool": _queue_loop,
        "SkipUnlessUpdated": _with_entry(updates.SkipUnlessUpdated),
        "WaitValueUpdate": _with_entry(updates.WaitValueUpdate),
        "RateController": _with_inputs(rates.RateController),
        "DistanceController": _with_inputs(rates.DistanceController),
        "SpeedController": _with_goals(rates.SpeedController),
        "SingleTrigger": _plain(rates.SingleTrigger),
        "GoalUpdatedController": _with_goals(goals.GoalUpdatedController),
        "GoalUpdater": lambda parts: parts.make(
            goals.GoalUpdater, inputs=parts.inputs(), outputs=parts.outputs()
        ),
        "PathLongerOnApproach": _with_inputs(approach.PathLongerOnApproach),
        "AlwaysSuccess": _plain(leaves.AlwaysSuccess),
        "AlwaysFailure": _plain(leaves.AlwaysFailure),
        "Fail": _with_inputs(leaves.Fail),
        "Ask": lambda parts: parts.make(
            asking.Ask, inputs=parts.inputs(), answer=parts.key("answer")
        ),
        "Confirm": _with_inputs(asking.Confirm),
        "Script": _with_code(scripts.ScriptNode),
        "ScriptCondition": _with_code(scripts.ScriptCondition),
        "SetBlackboard": lambda parts: parts.make(
            leaves.SetBlackboard, inputs=parts.inputs(), key=parts.key("key")
        ),
        "UnsetBlackboard": lambda parts: parts.make(leaves.UnsetBlackboard, key=parts.key("key")),
        "Sleep": _with_inputs(timing.Sleep),
        "WasEntryUpdated": _with_entry(updates.WasEntryUpdated),
        "TestNode": lambda parts: parts.make(
            scripted.TestNode, inputs=parts.inputs(), scripts=parts.scripts()
        ),
        "GoalUpdated": _with_goals(goals.GoalUpdated),
    }
)
"""By canonical type."""
