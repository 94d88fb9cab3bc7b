"""The tree's rows: every node has one, except frames, whose children stand in their place."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.record.lines import is_frame
from momantu_bt.record.recording import NodeInfo


def rows_above(nodes: Sequence[NodeInfo]) -> tuple[list[int], list[int]]:
    """By node: the node in whose row it is shown, and the one whose row is above that, or -1."""
    own: list[int] = []
    above: list[int] = []
    for node in nodes:
        if node.parent is None:
            own.append(node.index)
            above.append(-1)
            continue
        around = own[node.parent]
        framed = is_frame(node.role, nodes[node.parent].role)
        own.append(around if framed else node.index)
        above.append(above[around] if framed else around)
    return own, above
