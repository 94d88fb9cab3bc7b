"""Writing a leaf's line in YAML: its name and its ports, which other nodes have as well."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.plugins import PluginError
from momantu_bt.tree.catalogue import MODIFIERS, NODES, SPELLED, SUBTREE
from momantu_bt.tree.files.scalars import CannotWrite, port_text
from momantu_bt.tree.files.yaml.lines import STEP, WIDTH, above, beside, is_nested, signed, spread
from momantu_bt.tree.files.yaml.misspelled import meant_above
from momantu_bt.tree.files.yaml.scripts import script_spelling, script_text
from momantu_bt.tree.files.yaml.words import NAMED
from momantu_bt.tree.language import AGAIN
from momantu_bt.tree.model import FIRST_INPUT, Literal, Node, PortValue
from momantu_bt.tree.registry import Registry
from momantu_bt.values.kinds import ScriptText


@dataclass(frozen=True, slots=True)
class LeafWriter:
    """Writes names and ports. trees: the names of trees. registry: the skills, if known."""

    trees: Collection[str]
    registry: Registry

    def lines(self, node: Node, lead: str, pad: str, more: bool) -> list[str]:
        """A leaf. lead: the text before its key. more: whether other keys follow."""
        key, remark = self.key(node), beside(node.comments)
        if not node.ports:
            colon = ":" if more or not lead.endswith("- ") else ""
            return [f"{lead}{key}{colon}{remark}"]
        line = f"{lead}{key}: {self.text(node)}"
        if len(line) <= WIDTH and not node.port_comments:
            return [line + remark]
        if self._is_bare(node):
            return [*(f"{pad}{signed(c)}" for cs in node.port_comments.values() for c in cs), line]
        return [f"{lead}{key}:{remark}", *self.ports(node, pad + STEP)]

    def text(self, node: Node, *, flow: bool = False) -> str:
        """The text after a leaf's `key:` on its line; empty if it has no ports."""
        if self._is_bare(node):
            ((name, value),) = node.ports.items()
            return self.port(node, name, value, flow=flow)
        return f"{{{', '.join(self.pairs(node))}}}" if node.ports else ""

    def pairs(self, node: Node) -> list[str]:
        """Its ports as `key: value`, to go inside braces."""
        return [
            f"{scalar(name, flow=True, typed=False)}: {self.port(node, name, value, flow=True)}"
            for name, value in node.ports.items()
        ]

    def ports(self, node: Node, pad: str) -> list[str]:
        """Its ports, each on a line of its own."""
        lines: list[str] = []
        for name, value in node.ports.items():
            comments = node.port_comments.get(name, ())
            lead = f"{pad}{scalar(name, typed=False)}:"
            lines += above(comments, pad)
            lines += spread(value, lead, self.port(node, name, value), comments)
        return lines

    def port(self, node: Node, name: str, value: PortValue, *, flow: bool = False) -> str:
        """One port's value. A script is in our spelling."""
        spec = NODES.get(node.type)
        port = spec.ports.get(name) if spec is not None else None
        if spec and port and port.type is ScriptText and isinstance(value, Literal):
            return script_text(str(value.value), asked=name in spec.asks, flow=flow)
        return port_text(value, flow=flow)

    def _is_bare(self, node: Node) -> bool:
        """Whether its one value is written without the port's name: `dock: bay_a`."""
        if len(node.ports) != 1:
            return False
        ((name, value),) = node.ports.items()
        if isinstance(value, Literal) and (value.value is None or is_nested(value)):
            return False
        spec = NODES.get(node.type)
        if spec is not None:
            script = spec.ports[name].type is ScriptText if name in spec.ports else False
            asked = name in spec.asks
            spelled = not script or script_spelling(_text(value), asked=asked) is not None
            return name == spec.first and spelled
        if name == FIRST_INPUT:
            return True
        place = node.port_places.get(name)
        was_bare = place is not None and place == node.port_name_places.get(name)
        return was_bare or (isinstance(value, Literal) and name == self._only_input(node))

    def _only_input(self, node: Node) -> str | None:
        """The first input of a known skill, if nothing else is required."""
        try:
            ports = self.registry.skills[node.type].ports.values()
        except (KeyError, PluginError):
            return None
        inputs = [port for port in ports if port.direction == "in"]
        if not inputs or any(port.required for port in inputs[1:]):
            return None
        return inputs[0].name if inputs[0].required else None

    def key(self, node: Node) -> str:
        """The node's name in YAML, as a key."""
        spec = NODES.get(node.type)
        if spec is not None:
            return spec.yaml[0]
        if not self.can_be_key(node):
            raise CannotWrite(f"no node in YAML is called {node.target or node.type!r}")
        return scalar(node.target or node.type)

    def can_be_key(self, node: Node) -> bool:
        """Whether the name of a skill or of a tree can be the key of its node.

        A name that is near to a word of the language cannot where the reader takes it for a slip.
        """
        tree = node.type == SUBTREE
        name = node.target if tree else node.type
        words = (*SPELLED, *NODES, *MODIFIERS, *NAMED, SUBTREE, AGAIN)
        if not name or "$" in name or name.startswith("_") or name in words:
            return False
        if tree:
            return name in self.trees
        having = {*node.ports, *(["children"] if node.children else [])}
        return name not in self.trees and meant_above(name, having) is None


def _text(value: PortValue) -> str:
    return str(value.value) if isinstance(value, Literal) else ""
