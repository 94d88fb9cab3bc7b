"""A failure is a value that keeps its causes."""

import json
from dataclasses import FrozenInstanceError, replace

import pytest

from momantu_bt.failure import CODE, ENGINE_CODES, Failure, FailureValue
from momantu_bt.messages import plain


def test_chain_runs_from_the_outermost_to_the_first_cause() -> None:
    first = FailureValue("SLIPPED", "the can slid out")
    second = FailureValue("NO_TRIES", "gave up", cause=first, tries=3)
    assert [link.code for link in second.chain()] == ["NO_TRIES", "SLIPPED"]


def test_as_dict_is_json() -> None:
    beside = FailureValue("NO_PLAN", "no way", {"tries": 3}, node_type="navigate")
    value = FailureValue("FAILED", "both", node="pick", cause=beside, beside=(beside,))
    told = json.loads(json.dumps(plain(value.as_dict())))
    assert told["cause"]["data"] == {"tries": 3}
    assert told["cause"]["node_type"] == "navigate"
    assert told["beside"][0]["code"] == "NO_PLAN"


@pytest.mark.parametrize("code", ["lower", "", "A-B", "_A", "A__B", "1A", "A B"])
def test_a_code_that_is_no_code_is_refused(code: str) -> None:
    with pytest.raises(ValueError, match="not upper-case words"):
        Failure(code, "what")


def test_a_failure_keeps_its_data() -> None:
    failure = Failure("OBJECT_NOT_FOUND", "no can on table_a", seen=3)
    assert failure.code == "OBJECT_NOT_FOUND"
    assert failure.value.data["seen"] == 3
    assert str(failure) == str(failure.value) == "OBJECT_NOT_FOUND, no can on table_a"


def test_the_engines_codes_are_codes_with_sentences() -> None:
    for code, sentence in ENGINE_CODES.items():
        assert CODE.fullmatch(code)
        assert " " in sentence


def test_a_failure_at_another_node_keeps_all_else() -> None:
    cause = FailureValue("LOST", "no map")
    value = FailureValue("GONE", "it is gone", {"seen": 3}, cause=cause, tries=2, most_tries=5)
    moved = value.at("dock", "tree.yaml:3", "Dock")
    assert moved == replace(value, node="dock", place="tree.yaml:3", node_type="Dock")
    assert (value.node, value.place, value.node_type) == ("", "", "")


def test_a_failure_cannot_be_changed() -> None:
    value = FailureValue("GONE", "it is gone")
    with pytest.raises(FrozenInstanceError):
        value.code = "LOST"  # type: ignore[misc]
    with pytest.raises(TypeError):
        value.data["seen"] = 4  # type: ignore[index]
