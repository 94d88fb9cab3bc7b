"""The public names for writing your own nodes. The built-in nodes are in the modules here.

A node is a subclass of `TreeNode` or `Decorator` with a `spec` and a method `step`. Make the spec
with `control`, `decorator` or `leaf`. See docs/writing_a_node.md.
"""

from __future__ import annotations

from momantu_bt.engine.causes import running_as_cause, with_beside, with_root_cause, with_tries
from momantu_bt.engine.decorator import Decorator
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.ports import Inputs
from momantu_bt.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Status
from momantu_bt.tree.catalogue.codes import and_also, passed_on
from momantu_bt.tree.catalogue.flow import (
    After,
    Flow,
    Walk,
    again,
    around,
    as_child,
    as_written,
    in_turn,
    perhaps,
    unsure,
    until_success,
)
from momantu_bt.tree.catalogue.known import NEVER, Known, both, meet
from momantu_bt.tree.catalogue.spec import (
    Kind,
    NodeSpec,
    Objection,
    control,
    decorator,
    input_port,
    leaf,
    output_port,
)
from momantu_bt.tree.catalogue.wording import duration_text, port_text, tries_text, value_text
from momantu_bt.tree.model import Literal, Node, Reference
from momantu_bt.values.kinds import CodeText, ScriptText

__all__ = [
    "FAILURE",
    "IDLE",
    "NEVER",
    "RUNNING",
    "SKIPPED",
    "SUCCESS",
    "After",
    "CodeText",
    "Decorator",
    "Flow",
    "Inputs",
    "Kind",
    "Known",
    "Literal",
    "Node",
    "NodeSpec",
    "Objection",
    "Parts",
    "Reference",
    "ScriptText",
    "Status",
    "TreeNode",
    "Walk",
    "again",
    "and_also",
    "around",
    "as_child",
    "as_written",
    "both",
    "control",
    "decorator",
    "duration_text",
    "in_turn",
    "input_port",
    "leaf",
    "meet",
    "output_port",
    "passed_on",
    "perhaps",
    "port_text",
    "running_as_cause",
    "tries_text",
    "unsure",
    "until_success",
    "value_text",
    "with_beside",
    "with_root_cause",
    "with_tries",
]
