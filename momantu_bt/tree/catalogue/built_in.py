"""The table of built-in nodes. A new one needs a file in `momantu_bt/nodes` and a line here.

The language finds its own nodes by name, as it finds plug-ins: what reads and checks trees imports
none of them.
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
"""Type and module of each, in the order of lists; the class is named as the type."""

ADAPTERS: Mapping[str, str] = {"momantu_bt.behaviours": "behaviour"}
"""Entry-point groups whose plug-ins are made into leaves, and the file that makes them."""
