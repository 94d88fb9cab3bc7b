"""Control nodes agree with BehaviorTree.CPP 4.10 on recorded trees, to the tick.

Each case holds a tree of built-in nodes in BehaviorTree.CPP's XML, and what the reference engine
recorded, ticking exactly once per tick: the final status, the number of ticks, and v0 to v5 on
the root's board.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from lxml import etree

from momantu_bt.engine.build import build
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.status import RUNNING
from momantu_bt.testing import ManualClock
from momantu_bt.tree.catalogue import BUILT_IN
from momantu_bt.tree.model import Document, Literal, Node, Place, Reference, Tree

CASES = Path(__file__).parent / "conformance_cases.jsonl"
MOST_TICKS = 1000
CONDITIONS = {
    "_failureIf": "fail_if",
    "_successIf": "succeed_if",
    "_skipIf": "skip_if",
    "_while": "while",
    "_onSuccess": "on_success",
    "_onFailure": "on_failure",
    "_onHalted": "on_halt",
    "_post": "after",
}


def port_value(text):
    if text.startswith("{") and text.endswith("}"):
        return Reference(text[1:-1])
    try:
        return Literal(json.loads(text))
    except ValueError:
        return Literal(text)


def node(element):
    """As much of the XML dialect as the cases use."""
    made = Node(element.tag, Place("case", element.sourceline, 1))
    spec = BUILT_IN.get(element.tag)
    names = {xml: port for port, xml in (spec.xml if spec else {}).items()}
    for key, text in element.attrib.items():
        if key in CONDITIONS:
            made.conditions[CONDITIONS[key]] = text
        elif key == "ID":
            made.target = text
        elif key in ("code", "if", "else"):
            made.ports[key] = Literal(text)
        else:
            made.ports[names.get(key, key)] = port_value(text)
    made.children = [node(child) for child in element]
    return made


def document(xml):
    root = etree.fromstring(xml)
    found = {
        tree.get("ID"): Tree(tree.get("ID"), node(tree[0]), Place("case", tree.sourceline, 1))
        for tree in root.findall("BehaviorTree")
    }
    return Document("case", root.get("main_tree_to_execute"), found)


def outcome(xml):
    context = RunContext(ManualClock())
    built = build(document(xml), context, skill_of={}.__getitem__)
    for _ in range(MOST_TICKS):
        context.begin_tick()
        status = built.root.execute()
        if status is not RUNNING:
            break
    return status.value, context.tick, [built.board.get(f"v{i}") for i in range(6)]


def cases():
    return [json.loads(line) for line in CASES.read_text().splitlines()]


@pytest.mark.parametrize("case", cases(), ids=lambda case: case["id"])
def test_a_recorded_tree_ends_as_the_reference_engine_did(case):
    assert outcome(case["xml"]) == (case["status"], case["ticks"], case["v"])
