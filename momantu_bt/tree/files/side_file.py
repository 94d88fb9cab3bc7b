"""Files beside a tree, such as substitutions and faults: the version, and the keys at the top."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.yaml.values import Entries, Raw, Scalar
from momantu_bt.tree.files.port_values import drop_duplicates
from momantu_bt.tree.language import VERSION
from momantu_bt.tree.problems import Problems

VERSION_KEY = "momantu_bt"


def top_values(
    raw: Raw, keys: Sequence[str], what: str, problems: Problems
) -> Mapping[str, Raw] | None:
    """Values by the keys at the top of a file; None if the file is not a mapping.

    Problems with the version and with the keys are reported.

    Args:
        raw: the composed file.
        keys: the keys that can be at its top, beside the version.
        what: the file in a few words, such as "a file of faults".
        problems: takes the mistakes.
    """
    if not isinstance(raw, Entries):
        hint = f"begin with `{VERSION_KEY}: {VERSION}`, then `{keys[0]}:`"
        problems.error("not-a-tree", raw.place, f"{what} is a mapping", hint)
        return None
    drop_duplicates(raw, problems)
    valid = (VERSION_KEY, *keys)
    for key, _ in raw.entries:
        if key.text not in valid:
            hint = valid_names(key.text, valid, f"keys of {what}")
            problems.error("unknown-key", key.place, f"{what} has no {key.text!r}", hint)
    having = {key.text: value for key, value in raw.entries}
    _check_version(having.get(VERSION_KEY), raw.place, problems)
    return having


def _check_version(raw: Raw | None, place: Place, problems: Problems) -> None:
    hint = f"write `{VERSION_KEY}: {VERSION}`"
    if raw is None:
        place = Place(place.file, place.line, 1)
        problems.error("no-version", place, "the file does not say its language", hint)
    elif not isinstance(raw, Scalar) or raw.text != str(VERSION):
        problems.error("wrong-version", raw.place, "this version is not known", hint)
