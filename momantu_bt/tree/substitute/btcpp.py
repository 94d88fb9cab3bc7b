"""BehaviorTree.CPP's rules of substitution: JSON with `TestNodeConfigs` and `SubstitutionRules`.

{"TestNodeConfigs": {"Slow": {"return_status": "SUCCESS", "async_delay": 2000}},
 "SubstitutionRules": {"arm/grasp_*": "Slow"}}

A pattern is a node's name, its type, or a path with `*` and `?`. The path of a node is that of its
subtree, a `/` and its name; without a name it is `Type::7`, for the seventh node of the whole tree.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.yaml.values import Entries, Raw, plain_value
from momantu_bt.skill import Port
from momantu_bt.tree import model
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.catalogue.spec import by_name, input_port
from momantu_bt.tree.files.port_values import drop_duplicates
from momantu_bt.tree.model import Document, Node
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.script import ScriptSyntaxError, parse
from momantu_bt.tree.substitute.rules import Rule, RuleFile
from momantu_bt.values.convert import convert
from momantu_bt.values.words import ConversionError

CONFIGS, RULES = "TestNodeConfigs", "SubstitutionRules"
TEST_NODE = "TestNode"
_ENDS = Literal["SUCCESS", "FAILURE", "SKIPPED", "RUNNING"]
_SCRIPTS = ("return_status_script", "success_script", "failure_script", "post_script")
_KEYS: Mapping[str, Port] = by_name(
    input_port("return_status", _ENDS, "how it ends", None),
    input_port("async_delay", int, "ms before its end", None),
    *(input_port(name, str, "a script", None) for name in _SCRIPTS),
)
_LEAVES = ("AlwaysSuccess", "AlwaysFailure")
"""Nodes that a rule may name beside the file's own configurations."""
MOST_NODES = 100_000


@dataclass
class _Paths:
    """The nodes of a run with their paths, each as often as a subtree with it is used."""

    document: Document
    found: list[tuple[str, Node]] = field(default_factory=list)

    def walk(self) -> Iterator[tuple[str, Node]]:
        """Each node with its path."""
        self._tree(self.document.main, "", ())
        return iter(self.found)

    def _tree(self, name: str, prefix: str, above: tuple[str, ...]) -> None:
        if name in above or name not in self.document.trees:
            return
        for node in self.document.trees[name].root.walk():
            if len(self.found) >= MOST_NODES:
                return
            path = prefix + (node.name or f"{node.target or node.type}::{len(self.found) + 1}")
            self.found.append((path, node))
            if node.type == SUBTREE:
                self._tree(node.target or "", path + "/", (*above, name))


def is_btcpp(raw: Raw) -> bool:
    """Whether a composed file holds BehaviorTree.CPP's rules."""
    return isinstance(raw, Entries) and any(key.text in (CONFIGS, RULES) for key, _ in raw.entries)


def read_test_configs(raw: Raw, document: Document, problems: Problems) -> RuleFile:
    """Read the rules of a file; wrong ones are reported and left out."""
    found = RuleFile()
    top = _entries(raw, problems)
    for key in top:
        if key not in (CONFIGS, RULES):
            hint = valid_names(key, (CONFIGS, RULES), "keys of such a file")
            problems.error("unknown-key", raw.place, f"the file has no {key!r}", hint)
    configs: dict[str, Node | None] = {}
    for name, config in _entries(top.get(CONFIGS), problems).items():
        configs[name] = _test_node(name, config, problems)
    if RULES not in top:
        problems.error("missing-input", raw.place, f"{RULES!r} is missing")
    paths = list(_Paths(document).walk())
    for pattern, named in _entries(top.get(RULES), problems).items():
        value = str(plain_value(named))
        if value not in configs and value not in _LEAVES:
            message = f"{value!r} is none of the file's {CONFIGS}"
            hint = "nodes that are registered in C++ are not known here; "
            hint += valid_names(value, [*configs, *_LEAVES], "configurations")
            problems.error("unknown-node", named.place, message, hint)
            continue
        test = configs.get(value, Node(value, named.place))
        if test is not None:
            chosen = _chosen(pattern, paths, named, problems)
            rule = Rule(pattern, "SUCCESS", named.place, test=test, chosen=chosen)
            found.rules.append(rule)
    return found


def _entries(raw: Raw | None, problems: Problems) -> dict[str, Raw]:
    if raw is None:
        return {}
    if not isinstance(raw, Entries):
        problems.error("wrong-value", raw.place, "a mapping is expected here")
        return {}
    drop_duplicates(raw, problems)
    return {key.text: value for key, value in raw.entries}


def _test_node(name: str, raw: Raw, problems: Problems) -> Node | None:
    """The node that a configuration describes; None, with a report, if it is wrong."""
    ports: dict[str, Any] = {}
    given = _entries(raw, problems)
    before = len(problems.sorted())
    for key, value in given.items():
        if key not in _KEYS:
            hint = valid_names(key, _KEYS, "keys of a configuration")
            problems.error("unknown-key", value.place, f"{name!r} has no {key!r}", hint)
            continue
        try:
            ports[key] = convert(plain_value(value), _KEYS[key])
            if key in _SCRIPTS:
                parse(ports[key])
        except ConversionError as error:
            problems.error("wrong-value", value.place, f"{key!r}: {error}")
        except ScriptSyntaxError as error:
            problems.error("script", value.place, error.message, error.hint)
    if not {"return_status", "return_status_script"} & given.keys():
        message = f"{name!r} needs `return_status` or `return_status_script`"
        problems.error("missing-input", raw.place, message)
    if len(problems.sorted()) > before:
        return None
    if "async_delay" in ports:
        ports["async_delay"] = max(ports["async_delay"], 0) / 1000.0
    literals = {key: model.Literal(value) for key, value in ports.items()}
    places = dict.fromkeys(literals, raw.place)
    return Node(TEST_NODE, raw.place, ports=dict(literals), port_places=places)


def _chosen(
    pattern: str, paths: list[tuple[str, Node]], named: Raw, problems: Problems
) -> frozenset[int]:
    """The nodes that a pattern names, by their `id`."""
    signs = {"*": ".*", "?": "."}
    whole = re.compile("".join(signs.get(s, re.escape(s)) for s in pattern), re.DOTALL)
    chosen, others = set[int](), set[int]()
    for path, node in paths:
        words = (node.name or node.target or node.type, node.type)
        fits = pattern in words or whole.fullmatch(path) is not None
        (chosen if fits else others).add(id(node))
    if chosen & others:
        message = f"{pattern!r} names a node in some uses of its subtree, and not in others"
        hint = "name all of them: a rule here replaces a node of the file wherever it runs"
        problems.error("unmatched-rule", named.place, message, hint)
    return frozenset(chosen)
