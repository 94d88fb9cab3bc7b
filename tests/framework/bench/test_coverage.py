"""What ran, beside the tree's own lines."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, cast

import pytest

import momantu_bt
from momantu_bt.bench.reports.coverage_text import coverage_text
from momantu_bt.bench.statistics.coverage import (
    GUARD,
    HANDLER,
    NODE,
    Point,
    coverage,
    running_order,
)
from momantu_bt.cli import main
from momantu_bt.engine.build import build
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.skills.body import Body
from momantu_bt.testing import ManualClock
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.load import load, read_file
from momantu_bt.tree.registry import Registry

TREE = """momantu_bt: 1
main: Main
values: {n: 0, odd: true}
trees:
  Main:
    - sequence:
        - script: $n += 1
        - Half: {k: $n}
          skip_if: $n == 2
        - succeed:
          skip_if: $odd
        - fallback:
            - succeed
            - wait: 1 s
      repeat: 4
    - recover:
        attempts: 3
        try: {Half: {k: 5}}
        catch:
          ODD: again
          EVEN: succeed
      force: success
  Half:
    inputs: {k: int}
    if: $k == 5
    then: {fail: {code: ODD}}
    else:
      if: $k < 100
      then: succeed
      else: {fail: {code: EVEN}}
"""


def counted(tree: Path, *seeds: int) -> tuple[Any, list[Point]]:
    """The document, and its points over runs."""
    rows = [momantu_bt.run(tree, seed=seed, world="none").as_dict() for seed in seeds]
    document = load(str(tree)).document
    return document, coverage(document, rows)


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    file = tmp_path / "counted.yaml"
    file.write_text(TREE)
    return file


def test_nodes_handlers_and_guards_are_counted_over_runs_and_uses(tree: Path) -> None:
    _, points = counted(tree, 0, 1)
    found = {(point.kind, point.place.line, point.text): point for point in points}
    runs = {line: point.count for (kind, line, _), point in found.items() if kind == NODE}
    assert (runs[7], runs[8], runs[10]) == (8, 6, 0)
    assert (runs[13], runs[14]) == (8, 0)
    answered = {text: p.count for (kind, _, text), p in found.items() if kind == HANDLER}
    assert answered == {"ODD": 4, "EVEN": 0}
    guards = {line: p for (kind, line, _), p in found.items() if kind == GUARD}
    assert (guards[9].count, guards[9].asked, guards[9].covered) == (2, 8, True)
    assert (guards[11].count, guards[11].asked, guards[11].covered) == (8, 8, False)


def test_the_text_is_the_file_with_marks_at_what_never_happened(tree: Path) -> None:
    document, points = counted(tree, 0)
    head, *lines = coverage_text(points, document.source).splitlines()
    assert "1 of 2 handlers answered, 1 of 2 guards decided both ways" in head
    assert [line.partition("| ")[2] for line in lines] == tree.read_text().splitlines()
    marked = {int(line.partition("|")[0].split()[-1]) for line in lines if line[0] == "!"}
    assert marked == {10, 11, 14, 21, 30}


def test_nothing_has_run_when_there_are_no_rows(tree: Path) -> None:
    document = load(str(tree)).document
    points = coverage(document, [])
    assert points
    assert not any(point.covered for point in points)


@pytest.mark.parametrize("name", sorted(bundled()))
def test_nodes_come_in_the_order_of_a_reports(name: str) -> None:
    """Counts go to the right lines only then."""
    registry = Registry.installed()
    document, _ = read_file(bundled()[name], registry)
    context = RunContext(ManualClock())
    context.body = cast(Body, object())
    built = build(document, context, registry.skills.__getitem__)
    assert [id(node) for node in running_order(document)] == [id(n.model) for n in built.nodes]


def test_bench_prints_it_with_included_files(tmp_path: Path, capsys: Any) -> None:
    (tmp_path / "parts.yaml").write_text(
        "momantu_bt: 1\ntrees:\n  Part:\n    - fallback: [succeed, {fail: NEVER}]\n"
    )
    main_file = tmp_path / "whole.yaml"
    main_file.write_text(
        "momantu_bt: 1\nmain: Main\nworld: none\ninclude: [parts.yaml]\n"
        "trees:\n  Main:\n    - Part\n    - Part\n"
    )
    report = tmp_path / "report.json"
    words = ["bench", str(main_file), "--seeds", "0:2", "--out", str(tmp_path / "out")]
    assert main([*words, "--coverage", "--report", str(report)]) == 0
    said = capsys.readouterr().out
    assert f"{main_file}: 3 of 3 nodes ran" in said
    assert "parts.yaml: 3 of 4 nodes ran" in said
    told = json.loads(report.read_text())["coverage"]
    assert {point["count"] for point in told if point["file"].endswith("parts.yaml")} == {0, 4}
