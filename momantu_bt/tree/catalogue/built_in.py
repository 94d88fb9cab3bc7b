"""The table of built-in nodes. A new one needs a file in `momantu_bt/nodes` and a line here.

The tree language imports its own nodes by name, as it does plug-ins. So the code that reads and
checks trees does not depend on the modules of nodes.
"""

from __future__ import annotations

from collections.abc import Mapping

BUILT_IN: Mapping[str, str] = {
    "Sequence": "sequences",
    "AsyncSequence": "sequences",
    "SequenceWithMemory": "sequences",
    "ReactiveSequence": "reactive",
    "Fallback": "fallbacks",
    "AsyncFallback": "fallbacks",
    "ReactiveFallback": "reactive",
    "Parallel": "parallel",
    "ParallelAll": "parallel",
    "IfThenElse": "branches",
    "WhileDoElse": "branches",
    "Switch2": "switch",
    "Switch3": "switch",
    "Switch4": "switch",
    "Switch5": "switch",
    "Switch6": "switch",
    "Recover": "recover",
    "Handle": "recover",
    "TryCatch": "try_catch",
    "RetryUntilSuccessful": "loops",
    "Repeat": "loops",
    "Timeout": "timing",
    "Delay": "timing",
    "Inverter": "forcing",
    "ForceSuccess": "forcing",
    "ForceFailure": "forcing",
    "ElseFail": "forcing",
    "KeepRunningUntilFailure": "loops",
    "RunOnce": "loops",
    "Precondition": "precondition",
    "ForEach": "loops",
    "LoopInt": "queues",
    "LoopDouble": "queues",
    "LoopString": "queues",
    "LoopBool": "queues",
    "SkipUnlessUpdated": "updates",
    "WaitValueUpdate": "updates",
    "AlwaysSuccess": "leaves",
    "AlwaysFailure": "leaves",
    "Fail": "leaves",
    "Ask": "asking",
    "Confirm": "asking",
    "Script": "scripts",
    "ScriptCondition": "scripts",
    "SetBlackboard": "leaves",
    "UnsetBlackboard": "leaves",
    "Sleep": "timing",
    "WasEntryUpdated": "updates",
    "TestNode": "scripted",
    "RecoveryNode": "recovery_node",
    "RoundRobin": "fallbacks",
    "PipelineSequence": "pipelines",
    "NonblockingSequence": "pipelines",
    "PersistentSequence": "pipelines",
    "RateController": "rates",
    "DistanceController": "rates",
    "SpeedController": "rates",
    "SingleTrigger": "rates",
    "GoalUpdatedController": "goals",
    "GoalUpdater": "goals",
    "PathLongerOnApproach": "approach",
    "GoalUpdated": "goals",
}
"""Type and module of each node, in the order in which lists show them; its class has that name."""

ADAPTERS: Mapping[str, str] = {"momantu_bt.behaviours": "behaviour"}
"""Entry point groups whose plug-ins are turned into leaves, and the module that does it."""
