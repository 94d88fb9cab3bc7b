"""Documents to draw: bundled ones, one with every kind of wire, and random ones."""

from collections.abc import Callable

import pytest
from hypothesis import strategies as st

from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.model import Document
from momantu_bt.tree.registry import Registry

EVIL = "\"<&>' \\ ]]> -->|x| #35; `b` %%{init}%% 日本 }{"
"""A text with what means something in one of the languages that pictures are written in."""

LEAVES = st.sampled_from(
    ["{a: }", "{b: {n: 1}}", "{b: {n: 2}}", "{c: {to: $x}}", "{d: {to: $@y}, skip_if: $x}",
     "{a: , name: way}", "{wait: 1 s}", "{a: , retry: 3, timeout: 2 s}", "{a: , disabled: true}",
     "{script: $x := 1}", "{fail: {code: LOST}}"]
)  # fmt: skip


def _around(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    several = st.lists(inner, min_size=1, max_size=4).map(", ".join)
    return st.one_of(
        several.map(lambda kids: f"{{sequence: [{kids}]}}"),
        several.map(lambda kids: f"{{fallback: [{kids}], retry: 2}}"),
        st.tuples(inner, inner).map(lambda two: f"{{if: {two[0]}, then: {two[1]}}}"),
        st.tuples(inner, inner).map(
            lambda two: (
                f"{{recover: {{attempts: 2, try: {two[0]}, "
                f"catch: {{A | B: again, any: {two[1]}}}}}}}"
            )
        ),
    )


NODES = st.recursive(LEAVES, _around, max_leaves=8)


@st.composite
def files(draw: st.DrawFn) -> str:
    """A random file of two trees, the first of which runs the second."""
    first, second, value = draw(NODES), draw(NODES), draw(st.sampled_from(["3", "4 mm"]))
    return (
        f"momantu_bt: 1\nmain: One\nvalues: {{y: {value}}}\n"
        f"trees:\n  One: {{sequence: [{first}, Two]}}\n  Two: {second}\n"
    )


def document_of(text: str) -> Document:
    """A text read and not checked: drawing asks for no more."""
    document, problems = read(text, "t.yaml")
    assert problems.sorted() == []
    return document


@pytest.fixture(scope="session")
def texts() -> st.SearchStrategy[str]:
    """Random files of two trees."""
    return files()


@pytest.fixture(scope="session")
def document() -> Callable[[str], Document]:
    """A text read and not checked: drawing asks for no more."""
    return document_of


@pytest.fixture(scope="session")
def evil() -> str:
    """A text that must be escaped wherever it goes."""
    return EVIL


@pytest.fixture(scope="session")
def registry() -> Registry:
    """Everything installed."""
    return Registry.installed()
