"""Scripts: both spellings, the grammar's ranks, evaluation, and errors with their place."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.geometry import Pose2D
from momantu_bt.tree.script import (
    ScriptError,
    ScriptSyntaxError,
    canonical,
    parse,
    truth,
    yaml_spelling,
)
from momantu_bt.tree.script.parser import MAX_DEPTH
from momantu_bt.tree.script.tokens import MAX_LENGTH


class Keys(dict[str, Any]):
    """A board for tests."""

    def has(self, key: str) -> bool:
        """Whether there is such a key."""
        return key in self

    def set(self, key: str, value: Any) -> None:
        """Write a key."""
        self[key] = value

    def get(self, key: str, default: Any = None) -> Any:
        """Read a key."""
        return self[key]


def value(text: str, **keys: Any) -> Any:
    """What a canonical script gives on these keys."""
    return parse(text).run(Keys(keys))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 + 2 * 3", 7),
        ("(1 + 2) * 3", 9),
        ("8 - 2 - 1", 5),
        ("7 / 2", 3.5),
        ("-n + 1", -2),
        ("+3 - -2", 5),
        ("0x10 + 1", 17),
        ("1.5e1", 15.0),
        ("6 & 3 | 8", 10),
        ("~0", -1),
        ("5 ^ 1", 4),
        ("'a' .. \"b\"", "ab"),
        ("'a' + 'b'", "ab"),
        ("1 < 2 < 3", True),
        ("1 < 3 < 2", False),
        ("0.1 + 0.2 == 0.3", True),
        ("'a' < 'b'", True),
        ("!false && true", True),
        ("!n == 0", True),
        # the ranks of operators are those of BehaviorTree.CPP 4.10, which gave these values
        ("true || true && false", True),
        ("false && true || true", True),
        ("1 + 2 & 3", 3),
        ("1 | 2 + 4", 7),
        ("6 & 3 == 2", True),
        ("1 + 2 .. 'a'", "3a"),
        ("- -2", 2),
        ("!!n", True),
        ("~2.5", -3),
        ("true ? 1 : 0 ? 2 : 3", 1),
        ("0 ? 1 : 0 ? 2 : 3", 3),
        ("a := b := 3; a + b", 6),
        ("a := 1;; a", 1),
        # a number and a text
        ("'a' .. 1", "a1"),
        ("1 .. 'a'", "1a"),
        ("'a' .. 0.5 .. true", "a0.5true"),
        ("'5' == 5", True),
        ("5 != '5.0'", False),
        ("'1.50' < 1.6", True),
        ("'true' == true", True),
        ("n > 2 ? 'yes' : 'no'", "yes"),
        ("n := 4; n + 1", 5),
        ("m := 1; m += 2; m *= 4; m -= 2; m /= 5; m", 2),
        ("pose.x * 2", 3.0),
    ],
)
def test_value(text: str, expected: Any) -> None:
    assert value(text, n=3, pose=Pose2D(1.5, 0.0)) == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("missing + 1", "has no value"),
        ("new = 1", "`:=` creates it"),
        ("new += 1", "does not exist"),
        ("'a' - 'b'", "does not work on texts"),
        ("'a' == 1", "compares alike with alike"),
        ("n + 'a'", "needs a number"),
        ("-'a'", "needs a number"),
        ("1 / (n - 3)", "division by zero"),
        ("1.5 & 1", "whole numbers"),
        ("pose.z", "no part 'z'; parts: x, y, yaw"),
        ("pose.__class__", "no part '__class__'"),
        ("1 .. 2", "a text on one side"),
        ("'a' .. pose", "joins texts and numbers"),
        ("'5m' == 5", "compares alike with alike"),
        ("pose == 'a'", "compares alike with alike"),
        ("pose + 1", "needs a number"),
        ("pose ? 1 : 2", "needs a number"),
        # both sides are evaluated, as in BehaviorTree.CPP
        ("true || missing", "has no value"),
    ],
)
def test_an_evaluation_that_fails(text: str, message: str) -> None:
    with pytest.raises(ScriptError, match=message):
        value(text, n=3, pose=Pose2D(1.5, 0.0))


@pytest.mark.parametrize(
    ("text", "offset"),
    [
        ("", 0),
        ("n >", 3),
        ("n > )", 4),
        ("(n > 1", 6),
        ("1 := 2", 0),
        ("n.x := 2", 0),
        ("n := 1 m := 2", 7),
        ("n # 2", 2),
        ("'open", 0),
        ("n ? 1", 5),
        ("a b", 2),
        ("3 m", 2),
        ("3m", 0),
        ("$n", 0),
    ],
)
def test_a_script_that_cannot_be_read(text: str, offset: int) -> None:
    with pytest.raises(ScriptSyntaxError) as caught:
        parse(text)
    assert caught.value.offset == offset


def test_scripts_are_bounded() -> None:
    with pytest.raises(ScriptSyntaxError, match="levels deep"):
        parse("(" * (MAX_DEPTH + 1) + "1" + ")" * (MAX_DEPTH + 1))
    for repeated in ("!", "a := ", "1 ? 2 : "):
        with pytest.raises(ScriptSyntaxError, match="levels deep"):
            parse(repeated * (MAX_DEPTH + 1) + "1")
    with pytest.raises(ScriptSyntaxError, match="characters"):
        parse("1" * (MAX_LENGTH + 1))
    assert value("+".join(["1"] * (MAX_LENGTH // 2))) == MAX_LENGTH // 2


def test_reads_and_writes() -> None:
    script = parse("a := b + @c; d += a.x")
    assert [v.key for v in script.reads] == ["b", "@c", "d", "a"]
    assert [v.key for v in script.writes] == ["a", "d"]


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        ("not $at_a", "!at_a"),
        ("$a and not ($b or $c)", "a && !(b || c)"),
        ("$failure.code == 'SLIPPED'", "failure.code == 'SLIPPED'"),
        ("$@count > 2", "@count > 2"),
        ("$a == 'x and $y'", "a == 'x and $y'"),
        ("$n := true", "n := true"),
    ],
)
def test_the_two_spellings(ours: str, theirs: str) -> None:
    assert canonical(ours) == theirs
    assert yaml_spelling(theirs) == ours


_OPERANDS = st.sampled_from(["a", "b", "@c", "pose.x", "1", "2.5", "true", "'t'"])


@given(
    st.recursive(
        _OPERANDS,
        lambda inner: st.one_of(
            st.tuples(inner, st.sampled_from(["+", "*", "==", "<", "&&"]), inner).map(
                lambda t: f"({t[0]}) {t[1]} ({t[2]})"
            ),
            inner.map(lambda x: f"!({x})"),
        ),
        max_leaves=12,
    )
)
def test_respelling_there_and_back_changes_nothing(text: str) -> None:
    parse(text)
    assert canonical(yaml_spelling(text)) == text


@given(st.text(alphabet="ab$@.1 +-*/&|!<>=?:;()'\"", max_size=30))
def test_any_text_is_read_or_refused(text: str) -> None:
    for reader in (parse, canonical):
        refused = None
        try:
            reader(text)
        except ScriptSyntaxError as error:
            refused = error
        assert refused is None or 0 <= refused.offset <= len(text)


@pytest.mark.parametrize(
    ("given_value", "expected"), [(0, False), (2, True), (0.0, False), ("", False), ("x", True)]
)
def test_truth(given_value: Any, expected: bool) -> None:
    assert truth(given_value) is expected
