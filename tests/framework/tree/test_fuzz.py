"""Inputs that no tree file should be: found good or refused, soon, and in little memory."""

import random
import resource
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from momantu_bt.formats.problems import Problem
from momantu_bt.tree.catalogue import SPELLED
from momantu_bt.tree.check.checker import check as check_document
from momantu_bt.tree.files.xml.format import read as read_xml
from momantu_bt.tree.files.yaml.format import read as read_yaml
from momantu_bt.tree.load import TreeError
from momantu_bt.tree.problems import MOST_PROBLEMS, Problems, TooManyProblems
from momantu_bt.tree.registry import Registry

BENCHMARKS = Path(__file__).resolve().parents[3] / "benchmarks"
INPUTS = 2_000
LONGEST = 10.0
"""Seconds of processor time of one input: a safety bound against inputs that hang, ten times what
`benchmarks/fuzz.py` demands, so that it holds on slow machines too."""
MOST_MEMORY = 200.0
"""Megabytes by which the peak of memory may grow."""
HEAD = "momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n"


@pytest.fixture(scope="module")
def fuzzing() -> Iterator[SimpleNamespace]:
    """What `benchmarks/fuzz.py` makes its inputs with."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(BENCHMARKS))
        from fuzzing.checking import check_file
        from fuzzing.good import good_trees
        from fuzzing.inputs import Inputs
        from fuzzing.words import Words

        yield SimpleNamespace(
            check_file=check_file, good_trees=good_trees, Inputs=Inputs, Words=Words
        )
        for name in [each for each in sys.modules if each.partition(".")[0] == "fuzzing"]:
            del sys.modules[name]


def peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_any_input_is_found_good_or_refused(
    part: int, fuzzing: SimpleNamespace, registry: Registry, tmp_path: Path
) -> None:
    inputs = fuzzing.Inputs(1, fuzzing.good_trees(), fuzzing.Words(registry.skills))
    memory, some = peak(), INPUTS // 4
    for number in range(part * some, (part + 1) * some):
        one = inputs.make(number)
        path = tmp_path / f"input{one.suffix}"
        path.write_bytes(one.data)
        started = time.process_time()
        fuzzing.check_file(path, registry)
        assert time.process_time() - started < LONGEST, number
    assert peak() - memory < MOST_MEMORY


def test_inputs_depend_on_seed_and_number_alone(fuzzing: SimpleNamespace) -> None:
    words, good = fuzzing.Words(["pick"]), fuzzing.good_trees()
    forward = [fuzzing.Inputs(3, good, words).make(number) for number in range(50)]
    inputs = fuzzing.Inputs(3, good, words)
    assert [inputs.make(number) for number in reversed(range(50))] == forward[::-1]
    assert {one.kind for one in map(inputs.make, range(300))} == {
        "bytes",
        "tokens",
        "nodes",
        "bomb",
    }
    assert forward != [fuzzing.Inputs(4, good, words).make(number) for number in range(50)]


def test_good_trees_are_good(fuzzing: SimpleNamespace, tmp_path: Path) -> None:
    """Inputs begin with files that the checker has something to say about, not with soup."""
    for suffix, texts in fuzzing.good_trees().items():
        read = read_xml if suffix == ".xml" else read_yaml
        for text in random.Random(0).sample(texts, 10):
            document, _ = read(text, f"t{suffix}")
            assert document.trees


# bounds


def test_many_problems_end_the_search(registry: Registry) -> None:
    text = HEAD + "".join(f"    - nonesuch{number}\n" for number in range(3 * MOST_PROBLEMS))
    document, found = read_yaml(text, "t.yaml")
    problems = check_document(document, registry, reading=found).problems
    assert len(problems) == MOST_PROBLEMS + 1
    assert [p.code for p in problems if p.code != "unknown-node"] == ["too-large"]
    assert problems[-1].place.line == 4 + MOST_PROBLEMS + 1


def test_many_problems_of_reading_are_one_error(registry: Registry) -> None:
    text = HEAD + "    - {}\n" * (2 * MOST_PROBLEMS)
    with pytest.raises(TreeError) as caught:
        read_yaml(text, "t.yaml")
    assert len(caught.value.problems) == MOST_PROBLEMS + 1
    assert caught.value.source == {"t.yaml": text}
    items = "<Sleep nonesuch='1' msec='1'/>" * (2 * MOST_PROBLEMS)
    text = f'<root BTCPP_format="4"><BehaviorTree ID="M"><Sequence>{items}</Sequence>'
    with pytest.raises(TreeError) as caught:
        read_xml(f"{text}</BehaviorTree></root>", "t.xml")
    assert len(caught.value.problems) == MOST_PROBLEMS + 1


def test_warnings_never_end_the_search() -> None:
    problems = Problems()
    place = read_yaml(f"{HEAD}    - wait: 1 s\n", "t.yaml")[0].trees["Main"].place
    for number in range(2 * MOST_PROBLEMS):
        problems.warning("unused-tree", place, f"number {number}")
    assert len(problems.sorted()) == MOST_PROBLEMS
    with pytest.raises(TooManyProblems):
        problems.error("no-node", place, "an error is not left out in silence")


def test_each_child_that_overlaps_is_reported_once(registry: Registry) -> None:
    text = f"{HEAD}    parallel:\n{'      - relocalize' + chr(10)}" + "      - relocalize\n" * 3
    document, found = read_yaml(text, "t.yaml")
    problems: list[Problem] = check_document(document, registry, reading=found).problems
    assert [(p.code, p.place.line) for p in problems] == [
        ("overlapping-uses", line) for line in (7, 8, 9)
    ]
    assert all("(line 6)" in p.message for p in problems)


def test_what_a_disabled_node_would_use_does_not_overlap(registry: Registry) -> None:
    disabled = "      - sequence: [relocalize]\n        disabled: true\n"
    text = f"{HEAD}    parallel:\n      - relocalize\n{disabled}"
    document, found = read_yaml(text, "t.yaml")
    assert check_document(document, registry, reading=found).problems == []


@pytest.mark.parametrize("keys", [1000, 1001])
def test_keys_of_a_tree_are_bounded(keys: int, registry: Registry) -> None:
    scripts = "".join(f"    - script: $k{number} := 1\n" for number in range(keys))
    document, found = read_yaml(HEAD + scripts, "t.yaml")
    problems = check_document(document, registry, reading=found).problems
    assert ([p.code for p in problems if p.code == "too-large"] == []) is (keys <= 1000)


def test_keys_that_calls_share_are_bounded(registry: Registry) -> None:
    scripts = "".join(f'<Script code="k{number} := 1"/>' for number in range(600))
    calls = '<SubTree ID="Sub" _autoremap="true"/>' * 100
    text = (
        '<root BTCPP_format="4" main_tree_to_execute="Main">'
        f'<BehaviorTree ID="Main"><Sequence>{calls}</Sequence></BehaviorTree>'
        f'<BehaviorTree ID="Sub"><Sequence>{scripts}</Sequence></BehaviorTree></root>'
    )
    document, found = read_xml(text, "t.xml", registry)
    problems = check_document(document, registry, reading=found).problems
    assert [p.code for p in problems] == ["too-large"]


def test_attributes_of_an_element_are_bounded() -> None:
    written = " ".join(f'a{number}="1"' for number in range(501))
    text = f'<root BTCPP_format="4"><BehaviorTree ID="M"><Sleep {written}/></BehaviorTree></root>'
    with pytest.raises(TreeError, match="more than 500 attributes"):
        read_xml(text, "t.xml")


def test_comments_are_bounded() -> None:
    with pytest.raises(TreeError, match="more than 10000 comments"):
        read_yaml(f"{HEAD}    - wait: 1 s\n" + "#\n" * 10_001, "t.yaml")


def test_words_have_every_node(fuzzing: SimpleNamespace) -> None:
    assert set(SPELLED) <= set(fuzzing.Words([]).nodes)
