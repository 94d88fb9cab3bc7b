"""Comments of YAML files belong to a part of the model, and are written there again."""

import random
import re
from pathlib import Path

import pytest

from momantu_bt.formats.text import Beside
from momantu_bt.tree.files.lookup import bundled
from momantu_bt.tree.files.syntax import compose_with_comments
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.files.yaml.writer import write
from momantu_bt.tree.model import Document

BUNDLED = sorted(bundled().values())

TEXT = """\
# 1 the file
momantu_bt: 1  # 2 version
main: Main
# 3 about values
values:
  # 4 above
  from: a  # 5 beside
  text: |  # 6 of a block
    no # comment
  # 7 quoted below
  other: 'no # comment'
trees:
  # 8 the tree
  Main:  # 9 beside the tree
    inputs:
      at: text  # 10 an input
      # 11 another
      to: {type: text, default: b}
    sequence:  # 12 the sequence
      # 13 the node
      - pick:  # 14 its line
          object: $at  # 15 a port
          # 16 the other port
          side: 2
          # 17 - commented: out
        name: x  # 18 the name
        retry: 3  # 19 three
        # 20 above the limit
        timeout: 2 s
      - recover:
          try:  # 21 what to do
            - succeed
            # 22 - last: one
          catch:
            # 23 a handler
            A | B: {wait: 1 s}  # 24 beside it
            any:  # 25 the rest
              # 26 in a list
              - succeed
      # 27 - commented: out
  # 28 the next tree
  Other:
    - if: $n > 1  # 29 asked
      # 30 then
      then: succeed
      else: {wait: {
        duration: 2}}  # 31 after braces
# 32 the end
"""


def _texts(text: str) -> list[str]:
    return [remark.text for remark in compose_with_comments(text, "t.yaml")[1]]


def _everywhere(document: Document) -> dict[str, list[str]]:
    """Comments by the name of what they belong to."""
    found = {"header": [*document.header_comments], "end": [*document.comments]}
    found |= {f"value {name}": [*texts] for name, texts in document.value_comments.items()}
    for tree in document.trees.values():
        found[tree.name] = [*tree.comments]
        found |= {f"{tree.name}.{p.name}": [*p.comments] for p in tree.ports.values()}
        for index, node in enumerate(tree.root.walk()):
            name = f"{tree.name} {index} {node.type}"
            found[name] = [*node.comments]
            found |= {f"{name}.{port}": [*texts] for port, texts in node.port_comments.items()}
            found[f"{name} end"] = [*node.end_comments]
            for handler in node.handlers:
                found[f"{name} {handler.codes}"] = [*handler.comments]
    return {name: texts for name, texts in found.items() if texts}


def test_each_comment_belongs_to_what_it_stands_at() -> None:
    document, problems = read(TEXT, "t.yaml")
    assert problems.sorted() == []
    found = {
        name: [int(re.match(r"\d+", text)[0]) for text in texts]  # type: ignore[index]
        for name, texts in _everywhere(document).items()
    }
    assert found == {
        "header": [1, 2],
        "end": [32],
        "value from": [3, 4, 5],
        "value text": [6],
        "value other": [7],
        "Main": [8, 9],
        "Main.at": [10],
        "Main.to": [11],
        "Main 0 Sequence": [12],
        "Main 0 Sequence end": [27],
        "Main 1 Timeout": [13],
        "Main 1 Timeout end": [20],
        "Main 2 RetryUntilSuccessful end": [19],
        "Main 3 pick": [14],
        "Main 3 pick.object": [15],
        "Main 3 pick.side": [16],
        "Main 3 pick end": [17, 18],
        "Main 5 Sequence end": [22],
        "Main 6 AlwaysSuccess": [21],
        "Main 4 Recover ('A', 'B')": [23, 24],
        "Main 4 Recover ('any',)": [25],
        "Main 9 AlwaysSuccess": [26],
        "Other": [28],
        "Other 1 IfThenElse": [29],
        "Other 3 AlwaysSuccess": [30],
        "Other 4 Sleep.duration": [31],
    }
    beside = {text for texts in _everywhere(document).values() for text in texts}
    marked = {int(text.split()[0]) for text in beside if isinstance(text, Beside)}
    assert {5, 9, 10, 12, 14, 15, 24, 25, 29} <= marked
    assert not marked & {1, 3, 4, 8, 11, 13, 16, 17, 20, 22, 23, 26, 27, 28, 30, 32}


def test_comments_are_written_where_they_were_and_in_their_order() -> None:
    document, _ = read(TEXT, "t.yaml")
    written = write(document)
    assert _texts(written) == _texts(TEXT)
    again, _ = read(written, "t.yaml")
    assert write(again) == written
    assert "timeout: 2 s  # 20" in written
    assert "\n  # 28 the next tree\n  Other:" in written


@pytest.mark.parametrize("path", BUNDLED, ids=lambda path: path.stem)
def test_a_bundled_tree_keeps_every_comment(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    document, _ = read(text, str(path))
    written = write(document)
    assert _texts(written) == _texts(text)
    assert _everywhere(read(written, str(path))[0]) == _everywhere(document)


@pytest.mark.parametrize("path", BUNDLED, ids=lambda path: path.stem)
def test_a_comment_at_any_line_survives(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    for index in sorted(random.Random(path.stem).sample(range(len(lines)), min(12, len(lines)))):
        line = lines[index]
        if not line.strip() or "#" in line or line.endswith("|"):
            continue
        indent = " " * (len(line) - len(line.lstrip()))
        for new in (f"{line}  # here", f"{indent}# here\n{line}"):
            text = "\n".join([*lines[:index], new, *lines[index + 1 :]]) + "\n"
            document, problems = read(text, str(path))
            assert problems.sorted() == []
            assert _texts(write(document)) == _texts(text), f"{path}:{index + 1}: {new}"


@pytest.mark.parametrize("line", ["      cycles: 3  # here", "      # here\n      cycles: 3"])
def test_a_comment_in_a_node_that_becomes_a_modifier_survives(line: str) -> None:
    text = f"momantu_bt: 1\ntrees:\n  A:\n    repeat:\n{line}\n      child: {{wait: 1 s}}\n"
    document, problems = read(text, "t.yaml")
    assert problems.sorted() == []
    assert "repeat: 3  # here" in write(document)
