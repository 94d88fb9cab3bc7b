"""Write a document as a Mermaid flowchart, which many wikis show directly."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.drawing.boxes import COLOURS, Box, TreePicture, cut

_SHAPES = {
    "control": ("[", "]"),
    "decorator": ("([", "])"),
    "leaf": ("(", ")"),
    "skill": ("(", ")"),
    "subtree": ("[[", "]]"),
}
_PLAIN = frozenset("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 _.,:-")


def mermaid(trees: Sequence[TreePicture], *, wires: bool = True) -> str:
    """The source text of one flowchart: a subgraph for each tree, wires as dotted arrows."""
    lines = ["flowchart TD"]
    for index, tree in enumerate(trees):
        lines.append(f'  subgraph t{index}["{escaped(tree.title)}"]')
        lines += [f"    {_node(box)}" for box in tree.boxes]
        for box in tree.boxes:
            if box.parent is not None:
                label = f'|"{escaped(cut(box.role))}"|' if box.role else ""
                lines.append(f"    n{box.parent} -->{label} n{box.number}")
        if wires:
            lines += [
                f'    n{thread.writer} -.->|"{escaped(thread.key)}"| n{thread.reader}'
                for thread in tree.threads
            ]
        lines.append("  end")
    lines += [f"  classDef {kind} fill:{colour},stroke:#666" for kind, colour in COLOURS.items()]
    return "\n".join(lines) + "\n"


def _node(box: Box) -> str:
    left, right = _SHAPES[box.kind]
    label = "<br/>".join(map(escaped, (box.title, *box.lines)))
    return f'n{box.number}{left}"{label}"{right}:::{box.kind}'


def escaped(text: str) -> str:
    """Text inside quotes: whatever could mean something to Mermaid as its number."""
    return "".join(c if c in _PLAIN else f"#{ord(c)};" for c in text)
