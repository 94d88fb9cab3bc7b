"""Plug-ins are found by name, and what is wrong with one is said with its name."""

from importlib.metadata import EntryPoint

import pytest

from momantu_bt import plugins
from momantu_bt.plugins import SKILLS, PluginError, installed, load


@pytest.fixture
def entries(monkeypatch: pytest.MonkeyPatch) -> list[EntryPoint]:
    having: list[EntryPoint] = []
    monkeypatch.setattr(plugins, "entry_points", lambda group: having)
    return having


def entry(name: str, value: str) -> EntryPoint:
    return EntryPoint(name, value, SKILLS)


def test_names_come_in_order(entries: list[EntryPoint]) -> None:
    entries += [entry("b", "m:B"), entry("a", "m:A")]
    assert list(installed(SKILLS)) == ["a", "b"]


def test_two_of_one_name_are_both_named(entries: list[EntryPoint]) -> None:
    entries += [entry("a", "one:A"), entry("a", "two:A")]
    with pytest.raises(PluginError, match=r"one:A .* two:A"):
        installed(SKILLS)


def test_the_same_one_twice_is_one(entries: list[EntryPoint]) -> None:
    entries += [entry("a", "one:A"), entry("a", "one:A")]
    assert list(installed(SKILLS)) == ["a"]


def test_an_unknown_name_is_answered_with_the_nearest(entries: list[EntryPoint]) -> None:
    entries.append(entry("navigate", "m:N"))
    with pytest.raises(PluginError, match="did you mean 'navigate'"):
        load(SKILLS, "navigat")


def test_a_broken_plugin_is_named_with_the_reason(entries: list[EntryPoint]) -> None:
    entries.append(entry("a", "no_such_module_anywhere:A"))
    with pytest.raises(PluginError, match=r"'a' .*no_such_module_anywhere.* cannot be loaded"):
        load(SKILLS, "a")


def test_a_good_one_is_loaded(entries: list[EntryPoint]) -> None:
    entries.append(entry("a", "momantu_bt.skill:Skill"))
    assert load(SKILLS, "a").__name__ == "Skill"
