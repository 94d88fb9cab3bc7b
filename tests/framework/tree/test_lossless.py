"""YAML and XML say the same: whatever goes from one to the other and back has lost nothing."""

import functools
import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import momantu_bt
from momantu_bt.record.report import Report
from momantu_bt.tree.convert import meaning
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.files.syntax import compose_with_comments
from momantu_bt.tree.files.xml import format as xml_format
from momantu_bt.tree.files.xml import writer as xml_writer
from momantu_bt.tree.files.yaml import format as yaml_format
from momantu_bt.tree.files.yaml import writer as yaml_writer
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry

BUNDLED = sorted(bundled().values())
CASES = Path(__file__).parent.parent / "engine" / "conformance_cases.jsonl"
MEANING = CASES.with_name("conformance_meaning.jsonl")


def _through_xml(document: Document, registry: Registry | None = None) -> Document:
    text = xml_writer.write(document, registry)
    again, problems = xml_format.read(text, "t.yaml", registry)
    assert problems.sorted() == [], text
    assert xml_writer.write(again, registry) == text
    return again


def _through_yaml(document: Document) -> Document:
    text = yaml_writer.write(document)
    again, problems = yaml_format.read(text, "t.yaml")
    assert problems.sorted() == [], text
    assert yaml_writer.write(again) == text
    return again


def test_random_documents_survive_both_ways(
    random_document: Callable[[random.Random], Document],
) -> None:
    for seed in range(120):
        document = random_document(random.Random(seed))
        wanted = meaning(document)
        through = _through_xml(document)
        assert meaning(through) == wanted, f"seed {seed}"
        again = _through_yaml(through)
        assert meaning(again) == wanted, f"seed {seed}"
        assert meaning(_through_xml(again)) == wanted, f"seed {seed}"


def test_types_that_a_skill_declares_decide_what_a_text_is(
    random_document: Callable[[random.Random], Document], registry: Registry
) -> None:
    for seed in range(60):
        document = random_document(random.Random(seed))
        assert meaning(_through_xml(document, registry)) == meaning(document), f"seed {seed}"


@pytest.mark.parametrize("path", BUNDLED, ids=lambda path: path.stem)
def test_a_bundled_tree_survives_with_its_comments(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    document, _ = yaml_format.read(text, "t.yaml")
    through = _through_xml(document)
    assert meaning(through) == meaning(document)
    written = yaml_writer.write(through)
    texts = [remark.text for remark in compose_with_comments(text, "t.yaml")[1]]
    assert [remark.text for remark in compose_with_comments(written, "t.yaml")[1]] == texts
    again, _ = yaml_format.read(written, "t.yaml")
    assert _commented(again) == _commented(document)


def _commented(document: Document) -> list[tuple[str, list[str]]]:
    """Comments by what they belong to; those of ports are their node's, as in XML."""
    found = [("header", [*document.header_comments]), ("end", [*document.comments])]
    found += [(name, [*texts]) for name, texts in document.value_comments.items()]
    for tree in document.trees.values():
        found.append((tree.name, [*tree.comments]))
        found += [(port.name, [*port.comments]) for port in tree.ports.values()]
        for node in tree.root.walk():
            ports = [text for texts in node.port_comments.values() for text in texts]
            found.append((node.type, [*node.comments, *ports]))
            found.append((f"end of {node.type}", [*node.end_comments]))
            found += [(str(h.codes), [*h.comments]) for h in node.handlers]
    return [(name, texts) for name, texts in found if texts]


@pytest.mark.parametrize("text", ["-- a --", "a -\\- b", "---", "", "  indented", "#1", "<&>", "ü"])
def test_any_comment_survives(text: str) -> None:
    document, _ = yaml_format.read("momantu_bt: 1\ntrees: {Main: [succeed]}\n", "t.yaml")
    document.trees["Main"].root.children[0].comments = (text,)
    again = _through_yaml(_through_xml(document))
    assert again.trees["Main"].root.children[0].comments == (text,)


@functools.cache
def _cases(file: Path = CASES) -> list[dict[str, Any]]:
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]


def test_recorded_trees_survive_from_xml() -> None:
    for case in [*_cases(), *_cases(MEANING)]:
        document, _ = xml_format.read(case["xml"], "t.yaml")
        again, problems = yaml_format.read(yaml_writer.write(document), "t.yaml")
        assert problems.sorted() == []
        assert meaning(again) == meaning(document), case["id"]
        assert meaning(_through_xml(again)) == meaning(document), case["id"]


@pytest.mark.parametrize("case", _cases()[::4], ids=lambda case: case["id"])
def test_recorded_trees_run_the_same_in_yaml(tmp_path: Path, case: dict[str, Any]) -> None:
    document, _ = xml_format.read(case["xml"], "t.xml")
    report = _run(tmp_path / "t.yaml", yaml_writer.write(document))
    values = [report.blackboard.get(f"v{i}") for i in range(6)]
    assert (report.status, report.ticks, values) == (case["status"], case["ticks"], case["v"])


def test_recorded_trees_leave_the_same_keys_in_yaml(tmp_path: Path) -> None:
    for case in _cases(MEANING):
        document, _ = xml_format.read(case["xml"], "t.xml")
        report = _run(tmp_path / "t.yaml", yaml_writer.write(document))
        assert report.ticks == case["ticks"], case["id"]
        assert report.blackboard == pytest.approx(case["keys"]), case["id"]


def _run(path: Path, text: str) -> Report:
    path.write_text(text, encoding="utf-8")
    return momantu_bt.run(path, world="none", max_time=2.0, registry=Registry())


LEAVES = ("{set: {key: $a, value: 2}}", "{script: '$b += 1'}", "{condition: $a > 1}", "{wait: 0.1}")
LEAVES += (
    "{fail: OH}",
    "succeed",
    "always_failure",
    "{Sub: {n: $a, out: $b}}",
    "{wait: {msec: 50}}",
)
AROUND = ("retry: 2", "repeat: 2", "timeout: 0.1", "invert: ", "force: success", "run_once: ")
AROUND += (
    "skip_if: $a > 1 and not $b > 3",
    "while: $b < 5",
    "on_failure: '$a := 3'",
    "delay: 0.05",
)
KINDS = ("sequence", "fallback", "parallel", "reactive_fallback", "round_robin", "parallel_all")


def _runnable(seeded: random.Random, depth: int) -> str:
    """A node of a tree that runs, in YAML's flow style."""
    if depth == 0:
        return seeded.choice(LEAVES)
    below = [_runnable(seeded, depth - 1) for _ in range(3)]
    listed = ", ".join(below[: seeded.randint(1, 3)])
    forms = [f"{{{kind}: [{listed}]}}" for kind in KINDS]
    forms += [
        f"{{if: $a > 1, then: {below[0]}, else: {below[1]}}}",
        f"{{recover: {{attempts: 2, try: [{below[0]}, {{fail: OH}}], catch: {{OH: again}}}}}}",
        f"{{handle: {{try: [{below[0]}, {{fail: OH}}], catch: {{OH: {below[1]}}}}}}}",
        f"{{switch: $b, cases: {{1: {below[0]}, 4: {below[1]}}}, default: {below[2]}}}",
        f"{{sequence: [{listed}], {seeded.choice(AROUND)}}}",
    ]
    return seeded.choice(forms)


def test_trees_run_the_same_before_and_after(tmp_path: Path) -> None:
    sub = "  Sub: {inputs: {n: int}, outputs: {out: int}, set: {key: $out, value: $n}}\n"
    ended = set()
    for seed in range(40):
        main = _runnable(random.Random(seed), 3)
        text = f"momantu_bt: 1\nmain: Main\nvalues: {{a: 1, b: 3}}\ntrees:\n  Main: [{main}]\n{sub}"
        document, problems = yaml_format.read(text, "t.yaml")
        assert problems.sorted() == []
        first = _run(tmp_path / "a.yaml", text)
        second = _run(tmp_path / "b.xml", xml_writer.write(document))
        third = _run(tmp_path / "c.yaml", yaml_writer.write(_through_xml(document)))
        for other in (second, third):
            assert (other.status, other.ticks) == (first.status, first.ticks), text
            assert other.fingerprint == first.fingerprint, text
        ended.add(first.status)
    assert {"SUCCESS", "FAILURE"} <= ended
