"""Write a document as a graph for Graphviz."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.drawing.boxes import COLOURS, Box, TreePicture, cut

_SHAPES = {
    "control": 'shape=box style="filled"',
    "decorator": 'shape=box style="filled,rounded"',
    "leaf": 'shape=box style="filled,rounded"',
    "skill": 'shape=box style="filled,rounded"',
    "subtree": 'shape=box3d style="filled"',
}


def dot(trees: Sequence[TreePicture], *, wires: bool = True) -> str:
    """The source text of one directed graph: a cluster for each tree, wires as dashed arrows."""
    lines = [
        "digraph trees {",
        "  ordering=out; rankdir=TB; compound=true;",
        '  node [fontname="Helvetica" fontsize=11];',
        '  edge [fontname="Helvetica" fontsize=9 arrowsize=0.6];',
    ]
    for index, tree in enumerate(trees):
        lines += [
            f"  subgraph cluster_{index} {{",
            f"    label={quoted(tree.title)}; labeljust=l; color=gray70;",
        ]
        lines += [f"    {_node(box)}" for box in tree.boxes]
        for box in tree.boxes:
            if box.parent is not None:
                label = f" [label={quoted(cut(box.role))}]" if box.role else ""
                lines.append(f"    n{box.parent} -> n{box.number}{label};")
        if wires:
            lines += [
                f"    n{thread.writer} -> n{thread.reader} [label={quoted(thread.key)} "
                'style=dashed color="#b3541e" fontcolor="#b3541e" constraint=false];'
                for thread in tree.threads
            ]
        lines.append("  }")
    return "\n".join([*lines, "}"]) + "\n"


def _node(box: Box) -> str:
    label = quoted("\n".join((box.title, *box.lines)))
    return f'n{box.number} [label={label} {_SHAPES[box.kind]} fillcolor="{COLOURS[box.kind]}"];'


def quoted(text: str) -> str:
    """A string of the language; a backslash stands for itself, and lines are centred."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
