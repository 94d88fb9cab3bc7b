"""Conditions on Nav2's error codes, the numbers that its actions write to `error_code_id`."""

from __future__ import annotations

from collections.abc import Collection
from typing import ClassVar

from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import SUCCESS, Status
from momantu_bt.failure import FAILED
from momantu_bt.nodes.goals import peek
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue.spec import Dialect, NodeSpec, input_port, leaf
from momantu_bt.values.kinds import Queue


def _condition(type_: str, yaml: str, doc: str) -> NodeSpec:
    return leaf(
        type_,
        yaml,
        doc,
        input_port("error_code", int, "the newest code; a key without a value counts as 0", 0),
        input_port("error_codes_to_check", Queue[int], "the codes that it is compared with", None),
        may_be_empty=("error_code",),
        dialect=Dialect.NAV2,
        condition=True,
    )


class AreErrorCodesPresent(TreeNode):
    """SUCCESS when the error code is one of those to check, else FAILURE.

    codes: compared with when the tree gives none.
    """

    spec = _condition(
        "AreErrorCodesPresent",
        "are_error_codes_present",
        "Succeeds when an error code is one of several.",
    )
    codes: ClassVar[Collection[int]] = ()

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self.inputs = parts.inputs()

    def step(self) -> Status:
        """Compare the code."""
        code = peek(self.inputs, "error_code")
        code = 0 if code is MISSING else code
        given = self.inputs["error_codes_to_check"]
        codes = self.codes if given is None else given
        if code in codes:
            return SUCCESS
        return self.fail(FAILED, f"the error code is {code}, none of {', '.join(map(str, codes))}")


class WouldAControllerRecoveryHelp(AreErrorCodesPresent):
    """SUCCESS when what the controller failed with may pass: clear, turn, wait, or back up."""

    spec = _condition(
        "WouldAControllerRecoveryHelp",
        "would_a_controller_recovery_help",
        "Succeeds when the controller's failure may pass by clearing, turning or waiting.",
    )
    codes = (100, 104, 105, 106)


class WouldAPlannerRecoveryHelp(AreErrorCodesPresent):
    """SUCCESS when what the planner failed with may pass."""

    spec = _condition(
        "WouldAPlannerRecoveryHelp",
        "would_a_planner_recovery_help",
        "Succeeds when the planner's failure may pass by clearing or waiting.",
    )
    codes = (200, 207, 208, 300, 307, 308)


class WouldASmootherRecoveryHelp(AreErrorCodesPresent):
    """SUCCESS when what the smoother failed with may pass."""

    spec = _condition(
        "WouldASmootherRecoveryHelp",
        "would_a_smoother_recovery_help",
        "Succeeds when the smoother's failure may pass.",
    )
    codes = (500, 502, 503, 504)
