from __future__ import annotations

from pathlib import Path

import pytest

from momantu_bt.formats.cache import CACHE_VARIABLE, cache_folder


def test_the_cache_folder_follows_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, "/somewhere")
    assert cache_folder() == Path("/somewhere")
    monkeypatch.delenv(CACHE_VARIABLE)
    monkeypatch.setenv("XDG_CACHE_HOME", "/base")
    assert cache_folder() == Path("/base/momantu-bt")
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", "/home/somebody")
    assert cache_folder() == Path("/home/somebody/.cache/momantu-bt")


def test_a_relative_name_is_one_folder_wherever_the_process_goes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(CACHE_VARIABLE, "kept")
    assert cache_folder() == tmp_path / "kept"
    monkeypatch.setenv(CACHE_VARIABLE, "~/kept")
    assert cache_folder() == Path.home() / "kept"
