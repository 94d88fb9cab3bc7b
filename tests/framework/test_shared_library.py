"""Shared libraries: the machine's where there is one, else a carrier's, and never an error."""

from __future__ import annotations

import ctypes
from pathlib import Path
from types import SimpleNamespace

import pytest

from momantu_bt import shared_library


@pytest.fixture
def loading(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """Which paths are asked for; those in `there` load. The carrier lies in /site/carrier."""
    state = SimpleNamespace(asked=[], there=set())

    def load(path: str) -> object:
        state.asked.append(path)
        if path not in state.there:
            raise OSError(f"{path}: cannot open shared object file")
        return object()

    found = SimpleNamespace(submodule_search_locations=["/site/carrier"])
    monkeypatch.setattr(shared_library, "_loaded", {})
    monkeypatch.setattr(ctypes, "CDLL", load)
    monkeypatch.setattr(shared_library.importlib.util, "find_spec", lambda name: found)
    return state


NAME = "libfoo.so.1"
CARRIED = str(Path("/site/carrier/lib") / NAME)


def ensure() -> None:
    shared_library.ensure_shared_library(NAME, carriers=("carrier",))


def test_the_machines_own_comes_first(loading: SimpleNamespace) -> None:
    loading.there = {NAME, CARRIED}
    ensure()
    ensure()
    assert loading.asked == [NAME], "and it is loaded once"


def test_a_carriers_serves_where_the_machine_has_none(loading: SimpleNamespace) -> None:
    loading.there = {CARRIED}
    ensure()
    assert loading.asked == [NAME, CARRIED]


def test_without_either_the_import_itself_says_so(loading: SimpleNamespace) -> None:
    ensure()
    assert CARRIED in loading.asked
