"""Scripts in YAML values, such as those of `skip_if` and `condition`."""

from __future__ import annotations

from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.values import Entries, Raw, Scalar
from momantu_bt.formats.yaml.writer import scalar
from momantu_bt.tree.files.yaml.words import BTCPP
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.script import ScriptSyntaxError, assigned, canonical, parse, yaml_spelling


def read_script(value: Raw, problems: Problems, *, asked: bool) -> str | None:
    """A script in BehaviorTree.CPP's spelling; None if a problem was reported.

    asked: whether it is a condition.
    """
    if isinstance(value, Entries) and [key.text for key, _ in value.entries] == [BTCPP]:
        return _kept(value.entries[0][1], problems)
    if not isinstance(value, Scalar) or value.value is None:
        hint = "such as $n > 2; a script with `: ` or `{` must be quoted whole"
        problems.error("script", value.place, "a script is expected here", hint)
        return None
    try:
        script = canonical(value.text)
        slip = assigned(value.text, dollar=True) if asked else None
    except ScriptSyntaxError as error:
        problems.error("script", _within(value, error), error.message, error.hint)
        return None
    if slip is None:
        return script
    place = _place(value, *slip)
    message = f"`{value.text[slip[0] : sum(slip)]}` assigns; a condition compares"
    problems.error("assigns", place, message, "did you mean `==`?")
    return None


def as_condition(value: Raw) -> Raw | None:
    """`if: $n > 2` as the node `condition: $n > 2`; None if the value is a node itself."""
    if not isinstance(value, Scalar):
        return None
    if isinstance(value.value, str) and "$" not in value.value:
        return None
    key = Scalar("condition", "condition", False, value.place)
    return Entries([(key, value)], value.place)


def _kept(value: Raw, problems: Problems) -> str | None:
    """A script that is in BehaviorTree.CPP's spelling already; it is kept as it is."""
    text = value.text if isinstance(value, Scalar) else ""
    try:
        return parse(text).text
    except ScriptSyntaxError as error:
        place = _within(value, error) if isinstance(value, Scalar) else value.place
        problems.error("script", place, error.message, error.hint)
        return None


def _within(value: Scalar, error: ScriptSyntaxError) -> Place:
    return _place(value, error.offset, error.length)


def _place(value: Scalar, offset: int, length: int) -> Place:
    """The place of a part of a script."""
    place = value.place
    quotes = 1 if value.quoted else 0
    if place.length != len(value.text) + 2 * quotes:
        return place  # with several lines or escapes, an offset in the text is not one in the file
    if offset + quotes >= place.length:
        return place
    return Place(place.file, place.line, place.column + offset + quotes, length)


def script_spelling(text: str, *, asked: bool) -> str | None:
    """A canonical script in our spelling, with words if possible, or else with signs.

    asked: whether it is a condition. None if neither reads back as the same script, as with
    `a && b || c`, or as a condition `n = 3`.
    """
    if asked and _assigns(text):
        return None
    for words in (True, False):
        try:
            spelled = yaml_spelling(text, words=words)
            if canonical(spelled) == text:
                return spelled
        except ScriptSyntaxError:
            continue
    return None


def _assigns(text: str) -> bool:
    try:
        return assigned(text, dollar=False) is not None
    except ScriptSyntaxError:
        return False


def script_text(text: str, *, asked: bool, flow: bool = False) -> str:
    """A canonical script as a YAML value. `{btcpp: …}` holds one that our spelling cannot say.

    asked: whether it is a condition.
    """
    spelled = script_spelling(text, asked=asked)
    if spelled is not None:
        return scalar(spelled, flow=flow, typed=False)
    return f"{{{BTCPP}: {scalar(text, flow=True, typed=False)}}}"
