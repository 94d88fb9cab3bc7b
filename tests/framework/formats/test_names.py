"""What was probably meant by an unknown name."""

import re

from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.names import nearest, valid_names

NAMES = st.lists(st.text("abcdefgh_", min_size=3, max_size=12), unique=True, max_size=100)


@given(st.lists(st.from_regex(r"[a-z]{1,4}(_[a-z]{1,4})?", fullmatch=True), min_size=1))
def test_a_known_name_is_its_own_nearest(names: list[str]) -> None:
    for name in names:
        assert nearest(name, names) == name
        assert nearest(name.upper().replace("_", "-"), names) == name
        assert valid_names(name, names, "names") == f"did you mean {name}?"


@given(NAMES, st.text("abcdefgh_", min_size=3, max_size=12))
def test_an_unknown_name_is_answered_with_names_there_are(known: list[str], name: str) -> None:
    said = valid_names(name, [*known, *known], "names")
    if not known:
        assert said == "there are no names"
    elif said.startswith("did you mean"):
        assert set(re.findall(r"[a-h_]{3,}", said.removeprefix("did you mean"))) <= set(known)
    else:
        listed = said.removeprefix("names: ").split(", ")
        assert [each for each in listed if each != "…"] == known[:60]
        assert ("…" in listed) == (len(known) > 60)
    if name in known:
        assert said == f"did you mean {name}?"


def test_names_that_are_equally_near_are_all_offered() -> None:
    arms = [f"arm_link_{n}" for n in range(3)]
    assert valid_names("arm_link_9", [*arms, "wheel"], "links") == (
        "did you mean arm_link_2, arm_link_1 or arm_link_0?"
    )
    assert valid_names("pik", ["pick", "place"], "nodes") == "did you mean pick?"
    assert nearest("zzz", ["pick"]) is None
