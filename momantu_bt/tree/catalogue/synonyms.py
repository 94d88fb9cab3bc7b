"""Nodes of the language by the names that people and other frameworks use for them."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.tree.catalogue.nodes import NODES, SPELLED, is_ours

_SYNONYMS: Mapping[str, str] = {
    # older versions of BehaviorTree.CPP
    "sequencestar": "SequenceWithMemory",
    "fallbackstar": "Fallback",
    "selectorstar": "Fallback",
    "blackboardcheck": "Precondition",
    "blackboardcheckbool": "Precondition",
    "blackboardcheckdouble": "Precondition",
    "blackboardcheckint": "Precondition",
    "blackboardcheckstring": "Precondition",
    # py_trees
    "selector": "Fallback",
    "reactiveselector": "ReactiveFallback",
    "oneshot": "RunOnce",
    "success": "AlwaysSuccess",
    "failure": "AlwaysFailure",
    "failureissuccess": "ForceSuccess",
    "successisfailure": "ForceFailure",
    "setblackboardvariable": "SetBlackboard",
    "unsetblackboardvariable": "UnsetBlackboard",
    "checkblackboardvariablevalue": "ScriptCondition",
    "eternalguard": "Precondition",
    "timer": "Sleep",
    # FlexBE and SMACH
    "waitstate": "Sleep",
    "calculationstate": "Script",
    "checkconditionstate": "ScriptCondition",
    "decisionstate": "Confirm",
    "operatordecisionstate": "Confirm",
    "concurrencycontainer": "Parallel",
    "prioritycontainer": "ReactiveFallback",
    "concurrence": "Parallel",
    # Nav2, and what people say
    "recovery": "RecoveryNode",
    "pipeline": "PipelineSequence",
    "or": "Fallback",
    "and": "Sequence",
    "not": "Inverter",
    "invert": "Inverter",
    "negate": "Inverter",
    "succeeder": "ForceSuccess",
    "failer": "ForceFailure",
    "retryuntilsuccess": "RetryUntilSuccessful",
    "retryuntilsucceed": "RetryUntilSuccessful",
    "repeatuntilfailure": "KeepRunningUntilFailure",
    "repeater": "Repeat",
    "loop": "Repeat",
    "while": "WhileDoElse",
    "if": "IfThenElse",
    "ifelse": "IfThenElse",
    "sleep": "Sleep",
    "wait": "Sleep",
    "pause": "Sleep",
    "guard": "Precondition",
    "setvariable": "SetBlackboard",
}
"""Types by the names that other frameworks give them, in small letters without `_` and `-`."""


def meant_type(name: str) -> str | None:
    """The node of the language that another spelling, or another framework, means by a name."""
    small = _small(name)
    known = {_small(type_): type_ for type_ in NODES}
    known |= {_small(word): spec.type for word, spec in SPELLED.items()}
    return known.get(small) or _SYNONYMS.get(small)


def in_spelling(type_: str, *, xml: bool) -> str:
    """A node's name in the words of a file: its tag in XML, its first name in YAML."""
    if not xml:
        return NODES[type_].yaml[0]
    return f"momantu:{type_}" if is_ours(type_) else type_


def _small(name: str) -> str:
    return name.lower().replace("_", "").replace("-", "")
