"""Applies a file of rules to a document: checks the rules and finds the nodes that they replace."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from momantu_bt.failure import ENGINE_CODES
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.problems import errors
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.check.named_world import world_of
from momantu_bt.tree.check.root_keys import ROBOT_KEY, root_reads
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.files.text import read_text
from momantu_bt.tree.model import Document, Node
from momantu_bt.tree.problems import Problems, TreeError
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.substitute.btcpp import is_btcpp, read_test_configs
from momantu_bt.tree.substitute.rules import Rule, RuleFile, Status, read_rules
from momantu_bt.values.convert import convert
from momantu_bt.values.words import ConversionError


@dataclass(frozen=True, slots=True)
class Result:
    """A result that replaces the run of a node.

    delay: time of the world's clock until the end, s. times: number of starts that it replaces;
    None: all. outputs: values by port. test: the node that runs instead, at every start.
    """

    status: Status
    code: str
    message: str
    delay: float
    times: int | None
    outputs: Mapping[str, Any]
    test: Node | None = None


@dataclass(frozen=True, slots=True)
class Substitution:
    """The effect of a file of rules on one document.

    values: keys of the root's board that replace published values of services. source: the file's
    text by its name.
    """

    results: Mapping[int, tuple[Result, ...]] = field(default_factory=dict)
    values: Mapping[str, Any] = field(default_factory=dict)
    source: Mapping[str, str] = field(default_factory=dict)

    def of(self, node: Node) -> tuple[Result, ...]:
        """The results that replace the starts of a node, in order; after them it runs normally."""
        return self.results.get(id(node), ())

    def replaces(self, node: Node) -> bool:
        """Whether every start of the node is replaced."""
        results = self.of(node)
        return bool(results) and results[-1].times is None


def load_substitution(
    path: Path, document: Document, registry: Registry, world: str | None = None
) -> Substitution:
    """Read a file of rules for a checked document. world: of the run, if not the tree's own.

    Raises:
        TreeNotFound: the file cannot be opened.
        TreeError: the file has errors; the exception lists all of them.
    """
    text, name, problems = read_text(path, str(path)), str(path), Problems()
    source = {**document.source, name: text}
    try:
        raw = compose(text, name)
    except YamlSyntaxError as error:
        raise TreeError([error.problem], source) from None
    theirs = is_btcpp(raw)
    found = read_test_configs(raw, document, problems) if theirs else read_rules(raw, problems)
    context = Context(document, registry, problems)
    results = _match(context, found.rules)
    _check_used(context, found.rules)
    without_world = world_of(document, world) is None
    _check_values(context, found, results, without_world)
    if errors(problems.sorted()):
        raise TreeError(problems.sorted(), source)
    return Substitution(results, found.values, {name: text})


def reached(document: Document, replaced: Mapping[int, tuple[Result, ...]]) -> Iterator[Node]:
    """Nodes that can run, in file order, without disabled ones and those inside replaced ones.

    `replaced` may grow during the iteration.
    """
    waiting, seen = [document.main], {document.main}
    while waiting:
        tree = document.trees.get(waiting.pop(0))
        stack = [] if tree is None else [tree.root]
        while stack:
            node = stack.pop()
            if node.disabled:
                continue
            yield node
            results = replaced.get(id(node), ())
            if results and results[-1].times is None:
                continue
            if node.type == SUBTREE and node.target is not None and node.target not in seen:
                seen.add(node.target)
                waiting.append(node.target)
            handlers = [h.node for h in node.handlers if h.node is not None]
            stack.extend(reversed([*node.children, *handlers]))


def names(node: Node) -> list[str]:
    """The names by which a rule can select a node: its name, its tree's, its type or skill."""
    spec = NODES.get(node.type)
    spellings = spec.yaml if spec is not None else ()
    said = (node.name, node.target, node.type if node.type != SUBTREE else None, *spellings)
    return list(dict.fromkeys(word for word in said if word))


def _matches(rule: Rule, node: Node) -> bool:
    if rule.test is not None:
        return id(node) in rule.chosen
    if rule.line is not None and rule.line != node.place.line:
        return False
    return any(fnmatchcase(word, rule.node) for word in names(node))


def _match(context: Context, rules: list[Rule]) -> dict[int, tuple[Result, ...]]:
    found: dict[int, tuple[Result, ...]] = {}
    for node in reached(context.document, found):
        results: list[Result] = []
        for rule in rules:
            if not _matches(rule, node):
                continue
            rule.used = True
            results.append(_result(context, rule, node))
            if rule.times is None:
                break
        if results:
            found[id(node)] = tuple(results)
    return found


def _result(context: Context, rule: Rule, node: Node) -> Result:
    """The result of a rule for a node, with converted outputs; problems are reported."""
    if rule.test is not None:
        return Result(rule.status, rule.code, "", 0.0, None, {}, rule.test)
    signature = context.signature(node)
    ports = signature.ports if signature is not None else {}
    said = signature.said if signature is not None else node.type
    outs = {name: port for name, port in ports.items() if port.direction != "in"}
    outputs: dict[str, Any] = {}
    for name, value in rule.outputs.items():
        place = rule.output_places[name]
        if name not in outs:
            hint = valid_names(name, outs, "outputs")
            context.problems.error("unknown-port", place, f"{said} has no output {name!r}", hint)
            continue
        try:
            outputs[name] = convert(value, outs[name])
        except ConversionError as error:
            context.problems.error("wrong-value", place, f"{name!r} of {said}: {error}")
    optional = signature is not None and signature.spec is not None
    needed = [name for name, port in outs.items() if port.direction == "out" or not optional]
    for name in needed:
        if rule.status == "SUCCESS" and name in node.ports and name not in rule.outputs:
            message = f"{said} in line {node.place.line} writes {name!r}, and the rule gives none"
            hint = f"write `outputs: {{{name}: …}}`"
            context.problems.error("unwritten-output", rule.place, message, hint)
    _check_code(context, rule, node)
    return Result(rule.status, rule.code, rule.message, rule.delay, rule.times, outputs)


def _check_code(context: Context, rule: Rule, node: Node) -> None:
    signature = context.signature(node)
    if rule.status != "FAILURE" or signature is None or signature.skill is None:
        return
    declared = signature.skill.failures
    if rule.code not in declared and rule.code not in ENGINE_CODES:
        message = f"{node.type} never fails with {rule.code}"
        hint = valid_names(rule.code, [*declared, *ENGINE_CODES], "its codes")
        context.problems.error("undeclared-code", rule.place_of("code"), message, hint)


def _check_used(context: Context, rules: list[Rule]) -> None:
    everything = [node for tree in context.document.trees.values() for node in tree.root.walk()]
    for rule in rules:
        if rule.used:
            continue
        if any(_matches(rule, node) for node in everything):
            message = f"no node that {rule.node!r} names is ever run"
            hint = (
                "it is disabled, in a tree that nothing runs, or another rule replaces it or a node"
                " above it (`*` names control nodes and trees too)"
            )
        else:
            at = "" if rule.line is None else f" in line {rule.line}"
            message = f"no node{at} is called {rule.node!r}"
            hint = valid_names(rule.node, _known(everything, rule), "nodes")
        context.problems.error("unmatched-rule", rule.place_of("node"), message, hint)


def _known(nodes: list[Node], rule: Rule) -> list[str]:
    """Names to offer in a hint; if the name fits but the line does not, the lines."""
    lines = [n.place.line for n in nodes if any(fnmatchcase(w, rule.node) for w in names(n))]
    if lines:
        return [f"{rule.node} in line {line}" for line in lines]
    return [names(node)[0] for node in nodes if names(node)]


def _check_values(
    context: Context,
    found: RuleFile,
    results: Mapping[int, tuple[Result, ...]],
    without_world: bool,
) -> None:
    """Check that values replace published keys; without a world, all such keys need a value."""
    published = {*context.registry.services, ROBOT_KEY}
    for key, place in found.value_places.items():
        if key not in published:
            hint = valid_names(key, sorted(published), "what is published")
            message = f"no service publishes {key!r}; other keys are given by --set"
            context.problems.error("unknown-value", place, message, hint)
        elif not without_world:
            message = f"the world's run publishes {key!r} itself"
            context.problems.error("unknown-value", place, message, "remove it, or --world none")
    if not without_world:
        return
    for node in reached(context.document, results):
        for key, _ in root_reads(context.document, node, replaced=id(node) in results):
            if key in published and key not in found.values:
                message = f"without a world nothing publishes $@{key}"
                hint = "give it under `values:` of the file of substitutions"
                context.problems.error("read-before-write", node.place, message, hint)
