"""Scripts against a second opinion: random expressions with their value by Python's own rules."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.problems import Problem
from momantu_bt.tree.script import ScriptError, ScriptSyntaxError, canonical, parse, yaml_spelling

Check = Callable[[str], list[Problem]]


@dataclass
class Board:
    """Keys for tests."""

    keys: dict[str, Any]

    def has(self, key: str) -> bool:
        """Whether there is such a key."""
        return key in self.keys

    def get(self, key: str) -> Any:
        """Read a key."""
        return self.keys[key]

    def set(self, key: str, value: Any) -> None:
        """Write a key."""
        self.keys[key] = value


KEYS = {"a": 3, "b": 0.5, "c": -2, "@d": 7}
Pair = tuple[str, Any]
"""A canonical script and its value."""


def value(text: str, **keys: Any) -> Any:
    """What a canonical script gives on these keys."""
    return parse(text).run(Board(keys))


def _applied(operator: str, of: Callable[[Any, Any], Any]) -> Callable[[tuple[Pair, Pair]], Pair]:
    return lambda pairs: (
        f"({pairs[0][0]}) {operator} ({pairs[1][0]})",
        of(pairs[0][1], pairs[1][1]),
    )


_LEAVES: st.SearchStrategy[Pair] = st.one_of(
    st.sampled_from(sorted(KEYS.items())),
    st.integers(0, 20).map(lambda n: (str(n), n)),
    st.sampled_from([0.25, 1.5, 1e3]).map(lambda x: (repr(x), x)),
)


def _numbers(inner: st.SearchStrategy[Pair]) -> st.SearchStrategy[Pair]:
    two = st.tuples(inner, inner)
    return st.one_of(
        two.map(_applied("+", lambda a, b: a + b)),
        two.map(_applied("-", lambda a, b: a - b)),
        two.map(_applied("*", lambda a, b: a * b)),
        two.filter(lambda t: t[1][1] != 0).map(_applied("/", lambda a, b: a / b)),
        inner.map(lambda pair: (f"-({pair[0]})", -pair[1])),
    )


NUMBERS = st.recursive(_LEAVES, _numbers, max_leaves=6)
# far enough apart or the same, so that the tolerance of `==` decides nothing here
APART = st.tuples(NUMBERS, NUMBERS).filter(
    lambda t: t[0][1] == t[1][1] or abs(t[0][1] - t[1][1]) > 1e-3
)
COMPARED = st.one_of(
    APART.map(_applied("<", lambda a, b: a < b)),
    APART.map(_applied(">=", lambda a, b: a >= b)),
    APART.map(_applied("==", lambda a, b: a == b)),
    APART.map(_applied("!=", lambda a, b: a != b)),
)
TRUTHS = st.recursive(
    COMPARED,
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(_applied("&&", lambda a, b: a and b)),
        st.tuples(inner, inner).map(_applied("||", lambda a, b: a or b)),
        inner.map(lambda pair: (f"!({pair[0]})", not pair[1])),
    ),
    max_leaves=5,
)


@given(NUMBERS)
def test_arithmetic_is_pythons(pair: Pair) -> None:
    assert value(pair[0], **KEYS) == pytest.approx(pair[1], rel=1e-12, abs=1e-12)


@given(TRUTHS, NUMBERS, NUMBERS)
def test_logic_and_choice_are_pythons(condition: Pair, yes: Pair, no: Pair) -> None:
    assert value(condition[0], **KEYS) is bool(condition[1])
    chosen = value(f"{condition[0]} ? ({yes[0]}) : ({no[0]})", **KEYS)
    assert chosen == pytest.approx(yes[1] if condition[1] else no[1], rel=1e-12, abs=1e-12)


@given(TRUTHS, st.sampled_from(["", " ", "  "]))
def test_both_spellings_mean_the_same(pair: Pair, gap: str) -> None:
    tight = pair[0].replace(" && ", f"{gap}&&{gap}").replace(" || ", f"{gap}||{gap}")
    ours = yaml_spelling(tight)
    assert not {"&&", "||", "!("} & {ours[i : i + 2] for i in range(len(ours))}
    assert value(canonical(ours), **KEYS) is bool(pair[1])


@given(st.lists(st.tuples(st.sampled_from("+-*/&|^"), st.integers(1, 9)), min_size=1, max_size=6))
def test_ranks_of_one_group_are_pythons(rest: list[tuple[str, int]]) -> None:
    sums = "7" + "".join(f" {o} {n}" for o, n in rest if o in "+-*/")
    bits = "7" + "".join(f" {o} {n}" for o, n in rest if o == "&" or o == "|")
    # their ^ ranks with |, Python's above it: asked apart
    flips = "7" + "".join(f" {o} {n}" for o, n in rest if o == "&" or o == "^")
    for text in (sums, bits, flips):
        assert value(text) == pytest.approx(eval(text))  # digits and operators alone


@pytest.mark.parametrize(
    ("script", "shown"),
    [
        ("a&&b", "$a and $b"),
        ("1||@b", "1 or $@b"),
        ("(a)&&!b", "($a) and not $b"),
        ("a&& !(b||c)", "$a and not ($b or $c)"),
        ("!a", "not $a"),
        ("a != b", "$a != $b"),
        ("n := 'a&&b'", "$n := 'a&&b'"),
    ],
)
def test_words_stand_apart(script: str, shown: str) -> None:
    assert yaml_spelling(script) == shown
    parse(canonical(shown))


_HUGE = "1" + "0" * 400


@pytest.mark.parametrize(
    "text",
    [
        f"{_HUGE} / 3",
        f"{_HUGE} * 1.5",
        f"{_HUGE} - 0.5",
        "n /= 1 - 1",
        "~inf",
        "inf & 1",
        "1 | nan",
    ],
)
def test_numbers_out_of_bounds_are_script_errors(text: str) -> None:
    with pytest.raises(ScriptError):
        value(text, n=int(_HUGE), inf=float("inf"), nan=float("nan"))


def test_comparisons_of_numbers_out_of_bounds() -> None:
    assert value(f"{_HUGE} == 1.5") is False
    assert value(f"{_HUGE} != 1.5") is True
    assert value(f"{_HUGE} == {_HUGE}") is True
    assert value("a == a", a=float("inf")) is True
    assert value("a == b", a=float("inf"), b=float("-inf")) is False


@pytest.mark.parametrize("word", ["$true", "$false"])
def test_true_and_false_are_no_variables(word: str, check: Check) -> None:
    with pytest.raises(ScriptSyntaxError) as caught:
        canonical(f"$a or {word}")
    assert (caught.value.offset, caught.value.length) == (6, len(word))
    found = check(f"momantu_bt: 1\ntrees:\n  A: {{condition: {word}}}\n")
    assert [(p.code, p.place.column, p.hint) for p in found] == [
        ("script", 18, f"write {word[1:]}")
    ]


@pytest.mark.parametrize(
    ("text", "needs"),
    [
        ("a + b", ["a", "b"]),
        ("a := 1; b := a", []),
        ("a := a + 1", ["a"]),
        ("a = 1", ["a"]),
        ("a += 1", ["a"]),
        ("a := 0; a += 1; a", []),
        ("c ? (a := 1) : 2; a", ["c", "a"]),
        ("c ? (a := 1) : (a := 2); a", ["c"]),
        ("a.x + @b", ["a", "@b"]),
        ("(a := 1) + a", []),
    ],
)
def test_what_a_script_needs(text: str, needs: list[str]) -> None:
    script = parse(text)
    assert [variable.key for variable in script.needs] == needs


@given(
    st.lists(
        st.tuples(
            st.sampled_from("ab"), st.sampled_from([":=", "=", "+="]), st.sampled_from("abc1")
        ),
        min_size=1,
        max_size=5,
    ),
    st.sets(st.sampled_from("abc")),
)
def test_a_script_runs_exactly_when_it_has_what_it_needs(
    statements: list[tuple[str, str, str]], having: set[str]
) -> None:
    script = parse("; ".join(" ".join(statement) for statement in statements))
    needs = {variable.key for variable in script.needs}
    try:
        script.run(Board(dict.fromkeys(having, 1)))
    except ScriptError:
        assert not needs <= having
    else:
        assert needs <= having


@pytest.mark.parametrize(
    ("script", "problems"),
    [
        ("$a := $a + 1", ["nothing writes $a before it is read here"]),
        ("$a += 1", ["nothing writes $a before it is read here"]),
        ("$a = 1", ["nothing writes $a before it is read here"]),
        ("$a := 1; $a += $n", []),
        ("$n += 1", []),
    ],
)
def test_a_key_that_a_script_changes_must_be_there(
    script: str, problems: list[str], check: Check
) -> None:
    found = check(f"momantu_bt: 1\nvalues: {{n: 1}}\ntrees: {{A: {{script: '{script}'}}}}\n")
    assert [problem.message for problem in found] == problems
    assert all("`:=` makes a new one" in problem.hint for problem in found)


@pytest.mark.parametrize(
    ("written", "column"),
    [
        ("$n > 1 and m", 23),
        ("'$n > 1 and m'", 24),
        ('"$n == \\"x\\" and m"', 12),
        ("|\n        $n > 1 and m", 12),
        ("$n > 1\n        and m", 12),
    ],
)
def test_the_place_of_a_mistake_lies_in_the_line_of_the_script(
    written: str, column: int, check: Check
) -> None:
    text = f"momantu_bt: 1\nvalues: {{n: 1}}\ntrees:\n  A:\n    wait: 1\n    while: {written}\n"
    (problem,) = check(text)
    assert problem.code == "script"
    assert (problem.place.line, problem.place.column) == (6, column)
    end = problem.place.column - 1 + problem.place.length
    assert end <= len(text.splitlines()[5])
