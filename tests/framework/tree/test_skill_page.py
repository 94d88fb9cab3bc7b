"""What is told of a skill is all there is, its examples are right, and the docs have it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from textwrap import indent
from typing import Any, Literal

import pytest

from momantu_bt.formats.problems import errors
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_bt.skill import In, Out, Skill
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files.xml.format import read as read_xml
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.show.skill_example import Wire, example_ports, xml_example, yaml_example
from momantu_bt.tree.show.skill_page import as_data, as_markdown, as_text, pages
from momantu_bt.values.types import label

DOCS = Path(__file__).parents[3] / "docs" / "skills"
BUNDLED = {
    name: kind
    for name, kind in Registry.installed().skills.items()
    if kind.__module__.startswith("momantu_skills.")
}


class Everything(Skill):
    """Takes one of each."""

    what: ObjectClass = In(doc="what to look for")
    seen: DetectedObject = In(doc="what was seen")
    how: Literal["fast", "slow"] = In(doc="how")
    angle: float = In(unit="rad", doc="how far")
    share: float = In(0.5, doc="how much")
    count: int = In(doc="how many", live=True)
    bold: bool = In(doc="whether")
    text: str = In(doc="what to say")
    found: DetectedObject = Out(doc="it")
    failures = {"TOO_FAR": "it is too far"}
    uses = {"base"}


class Speak(Skill):
    """Says one thing."""

    text: str = In(doc="what to say")


def checked(name: str, kind: type[Skill], example: str) -> list[object]:
    """Problems of a tree of the example alone, whose keys are the tree's inputs."""
    wires = {port: v for port, v in example_ports(kind).items() if isinstance(v, Wire)}
    inputs = [
        f"      {port}: {label(kind.ports[port].type)}\n"
        for port in wires
        if kind.ports[port].direction == "in"
    ]
    body = indent(example, " " * 8).lstrip()
    text = "momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n"
    text += f"    inputs:\n{''.join(inputs)}" if inputs else ""
    text += f"    sequence:\n      - {body}\n"
    document, reading = read(text, "t.yaml")
    found = check(document, Registry(skills={name: kind}), reading=reading).problems
    return [problem for problem in errors(found) if problem.code != "read-before-write"]


@pytest.mark.parametrize("name", [*BUNDLED, "everything", "speak"])
def test_the_yaml_example_is_right(name: str) -> None:
    kind = {**BUNDLED, "everything": Everything, "speak": Speak}[name]
    assert checked(name, kind, yaml_example(name, kind)) == []


@pytest.mark.parametrize("name", [*BUNDLED, "everything", "speak"])
def test_the_xml_example_says_the_same(name: str) -> None:
    kind = {**BUNDLED, "everything": Everything, "speak": Speak}[name]
    registry = Registry(skills={name: kind})
    xml = '<root BTCPP_format="4" xmlns:momantu="urn:momantu-bt:1"><BehaviorTree ID="Main">'
    xml += f"{xml_example(name, kind)}</BehaviorTree></root>"
    yaml = "momantu_bt: 1\ntrees:\n  Main:\n    - "
    yaml += indent(yaml_example(name, kind), " " * 6).lstrip() + "\n"
    trees = []
    for document, reading in (
        read_xml(xml, "t.xml", registry),
        read(yaml, "t.yaml"),
    ):
        assert errors(reading.sorted()) == []
        checked = check(document, registry, reading=reading)
        trees.append(checked.document.trees["Main"].root)
    assert trees[0] == (trees[1].children[0] if trees[1].type == "Sequence" else trees[1])


def test_how_examples_are_spelled() -> None:
    assert yaml_example("speak", Speak) == "speak: text"
    assert xml_example("speak", Speak) == '<speak text="text"/>'
    lines = yaml_example("everything", Everything).splitlines()
    assert "  what: {category: can, diameter: 66 mm, height: 12 cm}" in lines
    assert "  seen: $seen" in lines
    assert "  angle: 30 deg" in lines
    assert "  how: fast" in lines
    assert not any("share" in line for line in lines)


def test_what_differs_from_rehearsal_to_rehearsal_is_no_example() -> None:
    class Write(Skill):
        """Writes to a folder."""

        folder: str = In(doc="where to")
        often: int = In(doc="how often")
        names = iter("abcdef")

        @classmethod
        def rehearsal(cls, seed: int) -> Mapping[str, Any]:
            """Write to a folder of its own each time."""
            return {"inputs": {"folder": next(cls.names), "often": 7}}

    assert example_ports(Write) == {"folder": "text", "often": 7}


def test_the_skills_that_it_calls_are_told() -> None:
    class Calling(Skill):
        """Calls others."""

        calls = ("dock", Speak)

    assert "Calls     dock, Speak" in as_text("calling", Calling)
    assert "It calls the skills `dock`, `Speak`." in as_markdown("calling", Calling)
    assert as_data("calling", Calling)["calls"] == ["dock", "Speak"]


def test_a_range_is_told_and_kept() -> None:
    class Ranged(Skill):
        """Has a range."""

        one_of = (("a", "b"),)
        a: int | None = In(None, doc="first", least=3)
        c: float = In(unit="m", doc="third", least=0.01, most=0.5)
        b: int | None = In(None, doc="second")

    assert "c: number in m, at least 0.01 and at most 0.5, required" in as_text("ranged", Ranged)
    assert "| `c` | number in m, at least 0.01 and at most 0.5 |" in as_markdown("ranged", Ranged)
    assert "exactly one of a, b" in as_text("ranged", Ranged)
    assert "Exactly one of `a`, `b`" in as_markdown("ranged", Ranged)
    assert yaml_example("ranged", Ranged) == "ranged: {a: 3, c: 0.5 m}"


def test_an_example_that_raises_hides_nothing() -> None:
    class Raising(Speak):
        """Raises when it is asked for an example."""

        @classmethod
        def rehearsal(cls, seed: int) -> dict[str, object]:
            raise RuntimeError("no")

    assert yaml_example("raising", Raising) == "raising: text"


@pytest.mark.parametrize("name", BUNDLED)
def test_a_page_has_every_port_and_code(name: str) -> None:
    page, data = as_markdown(name, BUNDLED[name]), as_data(name, BUNDLED[name])
    assert all(f"| `{port['name']}` | {port['type']}" in page for port in data["ports"])
    assert all(f"| `{code}` | {said} |" in page for code, said in data["failures"].items())


def test_the_docs_are_up_to_date() -> None:
    """Else: `momantu-bt skills pages docs/skills`."""
    written = {path.name: path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")}
    assert written == pages(BUNDLED)
