"""A JSON Schema of tree files, so that editors complete nodes, ports, codes and modifiers.

It checks less than the checker: a schema does not know the file's own trees or where a key
comes from. Whatever it refuses, the checker refuses too.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from momantu_bt.failure import CODE, ENGINE_CODES
from momantu_bt.skill import Port, Skill
from momantu_bt.tree.catalogue import CONDITIONS, FORCED, MODIFIERS, SPELLED, Kind, NodeSpec
from momantu_bt.tree.files.yaml.words import COMPANIONS, NODE, RUNS
from momantu_bt.tree.language import AGAIN, ANY, TREE_NAME
from momantu_bt.tree.show.schema_values import SCRIPT, Names, value_schema

DIALECT = "https://json-schema.org/draft/2020-12/schema"

Schema: TypeAlias = dict[str, Any]

_NODE: Schema = {"$ref": "#/$defs/node"}
_NODES: Schema = {"type": "array", "items": _NODE}
_BARE: Schema = {"$ref": "#/$defs/bare"}
_MAPPING: Schema = {"$ref": "#/$defs/mapping"}
_WORD = r"^[^\W\d]\w*$"
_TREE_NAME = f"^{TREE_NAME.pattern}$"
_SCRIPT: Schema = {**SCRIPT, "description": "a condition or script"}


def tree_schema(skills: Mapping[str, type[Skill]], names: Names | None = None) -> Schema:
    """The schema of a YAML tree file.

    skills: the skills that editors complete, by name. names: valid values of ports that name a
    part of the world or robot ("place", "surface", "named_pose"), if known.
    """
    having = names or {}
    return {
        "$schema": DIALECT,
        "title": "momantu-bt tree file",
        "type": "object",
        "properties": _header(),
        "required": ["momantu_bt", "trees"],
        "additionalProperties": False,
        "$defs": {
            "node": {"anyOf": [_BARE, _NODES, _MAPPING]},
            "bare": _bare(skills),
            "mapping": _mapping(skills, having),
            "tree": _tree(),
            "declarations": _declarations(),
            "catch": _catch(skills),
        },
    }


def _header() -> Schema:
    return {
        "momantu_bt": {"const": 1, "description": "the version of the language"},
        "include": {"type": "array", "items": {"type": ["string", "object"]}},
        "world": {"type": "string", "description": "the world that the tree is meant for"},
        "goal": {
            "type": ["string", "object", "array"],
            "description": "what the referee demands: world, none, or can on table_b beside tag",
        },
        "main": {"type": "string", "description": "the tree to run"},
        "values": {"type": "object", "description": "the first keys of the root's board"},
        "models": {"type": ["array", "null"], "description": "what an XML file says of nodes"},
        "xml": {"type": "object", "description": "what only an XML file says, kept for it"},
        "trees": {
            "type": "object",
            "propertyNames": {"pattern": _TREE_NAME},
            "additionalProperties": {"$ref": "#/$defs/tree"},
            "minProperties": 1,
        },
    }


def _tree() -> Schema:
    """A node, and the keys beside it (or among its entries) for the tree's ports."""
    header = {
        "inputs": {"$ref": "#/$defs/declarations"},
        "outputs": {"$ref": "#/$defs/declarations"},
        "inouts": {"$ref": "#/$defs/declarations"},
        "open": {"type": "boolean", "description": "takes any key as a port"},
        "doc": {"type": "string"},
        "metadata": {"type": ["object", "array", "null"], "description": "of the tree's model"},
        "tree": {"type": "object", "description": "attributes of the tree's element in XML"},
        "nodes": {"type": "array", "items": _NODE},
    }
    return {"anyOf": [_BARE, _NODES, {"allOf": [{"properties": header}, _MAPPING]}]}


def _declarations() -> Schema:
    one = {
        "anyOf": [
            {"type": "string", "description": "a type, such as text or list of pose"},
            {
                "type": "object",
                "properties": {"type": {"type": "string"}, "default": {}, "doc": {}},
                "additionalProperties": False,
            },
        ]
    }
    return {
        "anyOf": [
            {"type": "object", "propertyNames": {"pattern": _WORD}, "additionalProperties": one},
            {"type": "array", "items": {"type": "string"}},
        ]
    }


def _bare(skills: Mapping[str, type[Skill]]) -> Schema:
    """A name alone: a node that needs no ports, or a tree."""
    bare = {name: _may_stand_bare(spec.ports.values(), spec) for name, spec in SPELLED.items()}
    bare |= {name: _may_stand_bare(skill.ports.values()) for name, skill in skills.items()}
    names = [name for name, may in bare.items() if may]
    others = [name for name, may in bare.items() if not may]
    tree = {"type": "string", "pattern": _TREE_NAME, "not": {"enum": others}}
    return {
        "anyOf": [
            {"enum": names, "description": "a node without ports"},
            {**tree, "description": "the name of a tree"},
        ]
    }


def _mapping(skills: Mapping[str, type[Skill]], names: Names) -> Schema:
    """One node key, its modifiers, and the keys beside it. Other keys are the file's trees."""
    keys: Schema = {name: _built_in(spec, names) for name, spec in SPELLED.items()}
    keys |= {name: _skill(skill, names) for name, skill in skills.items()}
    keys[NODE] = {"type": "string", "description": "a node by its name or its type in XML"}
    keys[RUNS] = {"type": "string", "description": "a tree by its name, of this file or another"}
    keys["ports"] = {"type": "object", "description": f"ports of `{NODE}:` or `{RUNS}:`"}
    keys["children"] = {**_NODES, "description": f"children of `{NODE}:` or `{RUNS}:`"}
    for companions in COMPANIONS.values():
        keys |= {name: _companion(name) for name in companions}
    keys |= _modifiers(names)
    return {
        "type": "object",
        "properties": keys,
        "propertyNames": {"pattern": _TREE_NAME},
        "minProperties": 1,
    }


def _companion(name: str) -> Schema:
    if name == "cases":
        return {"type": "object", "additionalProperties": _NODE, "minProperties": 1}
    return _NODE


def _may_stand_bare(ports: Iterable[Port], spec: NodeSpec | None = None) -> bool:
    return (spec is None or spec.kind is Kind.LEAF) and not any(port.required for port in ports)


def _skill(skill: type[Skill], names: Names) -> Schema:
    first = next((p for p in skill.ports.values() if p.direction == "in"), None)
    return _with_ports(skill.__doc__ or "", skill.ports.values(), first, names)


def _with_ports(doc: str, ports: Iterable[Port], first: Port | None, names: Names) -> Schema:
    """A leaf: its ports, one value alone for the first input, or nothing."""
    several = list(ports)
    forms: list[Schema] = [_ports(several, names)]
    if first is not None:
        forms.append(value_schema(first, names))
    if not any(port.required for port in several):
        forms.append({"type": "null"})
    return {"description": _line(doc), "anyOf": forms}


def _ports(ports: Iterable[Port], names: Names, more: Schema | None = None) -> Schema:
    """A mapping of ports. more: other keys among them, such as `children`."""
    several = list(ports)
    found: Schema = {
        "type": "object",
        "properties": {port.name: value_schema(port, names) for port in several} | (more or {}),
        "additionalProperties": False,
    }
    required = [port.name for port in several if port.required]
    if required:
        found["required"] = required
    return found


def _built_in(spec: NodeSpec, names: Names) -> Schema:
    ports = list(spec.ports.values())
    if spec.yaml[0] in COMPANIONS:
        return {"description": spec.doc, "anyOf": [_SCRIPT, _NODE, {}]}
    if spec.handlers:
        more = {"try": _NODE, "catch": {"$ref": "#/$defs/catch"}}
        return {"description": spec.doc, **_ports(ports, names, more)}
    if spec.kind is Kind.CONTROL:
        forms = [_NODES, _ports(ports, names, {"children": _NODES})]
        return {"description": spec.doc, "anyOf": forms}
    if spec.kind is Kind.DECORATOR:
        return _decorator(spec, names)
    first = spec.ports.get(spec.first or "")
    return _with_ports(spec.doc, ports, first, names)


def _decorator(spec: NodeSpec, names: Names) -> Schema:
    """A decorator: `child:` and its ports; or beside a node, its first port's value or nothing."""
    ports = list(spec.ports.values())
    forms = [_ports(ports, names, {"child": _NODE})]
    if spec.modifier and spec.first is not None:
        forms.append(value_schema(spec.ports[spec.first], names))
    if spec.modifier and not any(port.required for port in ports):
        forms.append({"type": ["null", "boolean"]})
    return {"description": spec.doc, "anyOf": forms}


def _modifiers(names: Names) -> Schema:
    found: Schema = {
        "name": {"type": ["string", "number"], "description": "the node's own name"},
        "note": {"type": ["string", "number"], "description": "a remark for people"},
        "attributes": {"type": "object", "description": "attributes as XML has them"},
        "xml": {"type": "object", "description": "what only XML says of the node"},
        "disabled": {"type": "boolean", "description": "skipped, with all below it"},
        "force": {"enum": list(FORCED), "description": "the result, whatever happens"},
    }
    found |= dict.fromkeys(CONDITIONS, _SCRIPT)
    rest = [name for name in MODIFIERS if name not in found]
    return found | {name: _decorator(SPELLED[name], names) for name in rest}


def _catch(skills: Mapping[str, type[Skill]]) -> Schema:
    """Handlers. Each code of each skill completes; `A | B` and `SKILL.CODE` are valid too."""
    answer: Schema = {"anyOf": [{"const": AGAIN, "description": "just try again"}, _NODE]}
    said: dict[str, str] = dict(ENGINE_CODES)
    for name, skill in skills.items():
        for code, sentence in skill.failures.items():
            said[code] = f"{said[code]}; {name}" if code in said else f"{sentence} ({name})"
    codes = {code: {"description": text, **answer} for code, text in sorted(said.items())}
    one = rf"([^\s|]+\.)?{CODE.pattern}|{ANY}"
    return {
        "type": "object",
        "properties": {**codes, ANY: {"description": "every other code", **answer}},
        "propertyNames": {"pattern": rf"^\s*({one})(\s*\|\s*({one}))*\s*$"},
        "additionalProperties": answer,
        "minProperties": 1,
    }


def _line(doc: str) -> str:
    return doc.strip().partition("\n")[0]
