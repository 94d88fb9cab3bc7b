"""The OpenMP runtime: the machine's where there is one, else torch's, and never an error."""

from __future__ import annotations

import ctypes
from pathlib import Path
from types import SimpleNamespace

import pytest

from momantu_bt import openmp


@pytest.fixture
def loading(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """Which paths are asked for; those in `there` can be loaded. torch lies in /site/torch."""
    state = SimpleNamespace(asked=[], there=set())

    def load(path: str) -> object:
        state.asked.append(path)
        if path not in state.there:
            raise OSError(f"{path}: cannot open shared object file")
        return object()

    found = SimpleNamespace(submodule_search_locations=["/site/torch"])
    monkeypatch.setattr(openmp, "_loaded", [])
    monkeypatch.setattr(ctypes, "CDLL", load)
    monkeypatch.setattr(openmp.importlib.util, "find_spec", lambda name: found)
    return state


TORCHS = str(Path("/site/torch/lib") / openmp.RUNTIME)


def test_the_machines_own_comes_first(loading: SimpleNamespace) -> None:
    loading.there = {openmp.RUNTIME, TORCHS}
    openmp.ensure_openmp()
    openmp.ensure_openmp()
    assert loading.asked == [openmp.RUNTIME], "and it is loaded once"


def test_torchs_serves_where_the_machine_has_none(loading: SimpleNamespace) -> None:
    loading.there = {TORCHS}
    openmp.ensure_openmp()
    assert loading.asked == [openmp.RUNTIME, TORCHS]


def test_without_either_the_import_itself_says_so(loading: SimpleNamespace) -> None:
    openmp.ensure_openmp()
    assert TORCHS in loading.asked
