"""A file of rules that replace nodes, for tests of trees.

momantu_bt: 1
substitute:
  - {node: grip, status: FAILURE, code: TOO_FAR, delay: 2 s, times: 1}
  - {node: "detect_*", status: SUCCESS, outputs: {found: {…}}}
values:
  battery: {charge: 0.9}
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from momantu_bt.failure import CODE, FAILED
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.values import Entries, Items, Raw, plain_value
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue.spec import by_name, input_port
from momantu_bt.tree.files.port_values import drop_duplicates
from momantu_bt.tree.files.side_file import top_values
from momantu_bt.tree.model import Node
from momantu_bt.tree.problems import Problems
from momantu_bt.values.convert import convert
from momantu_bt.values.kinds import CodeText
from momantu_bt.values.words import ConversionError

Status = Literal["SUCCESS", "FAILURE", "SKIPPED", "RUNNING"]

_KEYS: Mapping[str, Port] = by_name(
    input_port("node", str, "a node's name, type, skill or tree; * and ? stand for letters"),
    input_port("status", Status, "how it ends; RUNNING never does"),
    input_port("line", int, "only the node of that line of the tree file", None),
    input_port("code", CodeText, "what it fails with", FAILED),
    input_port("message", str, "the sentence that it fails with", ""),
    input_port("delay", float, "how long it runs before", 0.0, unit="s"),
    input_port("times", int, "how often, before the node itself runs again", None),
    input_port("outputs", object, "what it writes", None),
)
_ONLY_WITH = {"code": "FAILURE", "message": "FAILURE", "outputs": "SUCCESS"}


@dataclass(slots=True)
class Rule:
    """One rule. place: of the rule. places: of its keys' values. used: it replaces a node.

    test: the node that runs instead; then chosen has the `id` of each node that it replaces.
    """

    node: str
    status: Status
    place: Place
    line: int | None = None
    code: str = FAILED
    message: str = ""
    delay: float = 0.0
    times: int | None = None
    outputs: dict[str, Any] = field(default_factory=dict)
    places: dict[str, Place] = field(default_factory=dict)
    output_places: dict[str, Place] = field(default_factory=dict)
    used: bool = False
    test: Node | None = None
    chosen: frozenset[int] = frozenset()

    def place_of(self, key: str) -> Place:
        """The place of a key's value; that of the rule if it lacks the key."""
        return self.places.get(key, self.place)


@dataclass(slots=True)
class RuleFile:
    """A file of rules. values: keys of the root's blackboard that services would publish."""

    rules: list[Rule] = field(default_factory=list)
    values: dict[str, Any] = field(default_factory=dict)
    value_places: dict[str, Place] = field(default_factory=dict)


def read_rules(raw: Raw, problems: Problems) -> RuleFile:
    """Read the rules of a file; wrong ones are reported and left out."""
    found = RuleFile()
    having = top_values(raw, ("substitute", "values"), "a file of substitutions", problems)
    if having is None:
        return found
    listed = having.get("substitute")
    if not isinstance(listed, Items):
        hint = "write `substitute:` and under it rules such as `- {node: grip, status: SUCCESS}`"
        place = raw.place if listed is None else listed.place
        problems.error("missing-input", place, "`substitute` is a list of rules", hint)
        return found
    for item in listed.items:
        rule = _rule(item, problems)
        if rule is not None:
            found.rules.append(rule)
    _values(having.get("values"), found, problems)
    return found


def _values(raw: Raw | None, found: RuleFile, problems: Problems) -> None:
    if raw is None:
        return
    if not isinstance(raw, Entries):
        problems.error("wrong-value", raw.place, "`values` is a mapping of keys to values")
        return
    drop_duplicates(raw, problems)
    for key, value in raw.entries:
        found.values[key.text] = plain_value(value)
        found.value_places[key.text] = key.place


def _rule(raw: Raw, problems: Problems) -> Rule | None:
    if not isinstance(raw, Entries):
        hint = "such as {node: grip, status: FAILURE, code: TOO_FAR}"
        problems.error("wrong-value", raw.place, "a rule is a mapping", hint)
        return None
    drop_duplicates(raw, problems)
    given: dict[str, Any] = {}
    places: dict[str, Place] = {}
    whole = True
    for key, value in raw.entries:
        port = _KEYS.get(key.text)
        if port is None:
            hint = valid_names(key.text, _KEYS, "keys of a rule")
            problems.error("unknown-key", key.place, f"a rule has no {key.text!r}", hint)
            whole = False
            continue
        places[key.text] = value.place
        try:
            given[key.text] = convert(plain_value(value), port)
        except ConversionError as error:
            problems.error("wrong-value", value.place, f"{key.text!r}: {error}")
            whole = False
    for name, port in _KEYS.items():
        if port.required and name not in places:
            message = f"a rule needs {name!r}"
            problems.error("missing-input", raw.place, message, f"{name}: {port.doc}")
            whole = False
    if not whole:
        return None
    output_places: dict[str, Place] = {}
    outputs = next((value for key, value in raw.entries if key.text == "outputs"), None)
    if isinstance(outputs, Entries):
        drop_duplicates(outputs, problems)
        output_places = {key.text: value.place for key, value in outputs.entries}
    rule = Rule(place=raw.place, places=places, output_places=output_places, **given)
    return rule if _is_consistent(rule, problems) else None


def _is_consistent(rule: Rule, problems: Problems) -> bool:
    """Whether the keys of a rule can be combined."""
    said: list[tuple[str, str, str]] = []
    for key, status in _ONLY_WITH.items():
        if key in rule.places and rule.status != status:
            said.append((key, f"{key!r} has a meaning with {status} alone", f"remove `{key}`"))
    if "delay" in rule.places and rule.status in ("SKIPPED", "RUNNING"):
        why = "a skipped node never ran" if rule.status == "SKIPPED" else "RUNNING has no end"
        said.append(("delay", why, "remove `delay`"))
    if rule.delay < 0.0:
        said.append(("delay", "a delay is not negative", ""))
    if rule.times is not None and rule.times < 1:
        said.append(("times", "at least once", "leave `times` out for always"))
    if "outputs" in rule.places and not isinstance(rule.outputs, Mapping):
        said.append(("outputs", "`outputs` is a mapping of ports to values", ""))
    for key, message, hint in said:
        problems.error("wrong-value", rule.place_of(key), message, hint)
    if not CODE.fullmatch(rule.code):
        hint = "upper-case words joined by underscores, such as NOT_FOUND"
        message = f"{rule.code!r} is not a failure code"
        problems.error("bad-code", rule.place_of("code"), message, hint)
        return False
    return not said
