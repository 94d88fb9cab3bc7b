"""`setup/browser.py`: it fetches a browser only where there is none, whole or not at all."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

import pytest
from momantu_worlds.vulkan.apt import AptError

ROOT = Path(__file__).resolve().parents[2]


class Apt:
    """Packages that unpack to one shell script, or the refusal of apt."""

    refused = False
    script = "#!/bin/sh\necho it-works\n"

    def __init__(self, folder: Path, system: object, backports: bool) -> None:
        pass

    def download(self, packages: Iterable[str], release: str | None) -> list[Path]:
        if self.refused:
            raise AptError("no network")
        return []

    def unpack(self, archives: Iterable[Path], root: Path) -> None:
        program = root / "usr" / "lib" / "chromium" / "chromium-headless-shell"
        program.parent.mkdir(parents=True)
        program.write_text(self.script)
        program.chmod(0o755)


@pytest.fixture
def setup(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script on a machine without a browser, with another apt and another cache folder."""
    spec = importlib.util.spec_from_file_location("browser", ROOT / "setup" / "browser.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setenv("MOMANTU_BT_CACHE", str(tmp_path))
    monkeypatch.delenv("MOMANTU_BROWSER", raising=False)
    monkeypatch.setattr(module, "NAMES", ())
    monkeypatch.setattr(module, "PrivateApt", Apt)
    monkeypatch.setattr(module, "this_system", lambda: None)
    return module


def test_it_is_fetched_once_and_then_found(
    setup: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert setup.find_browser() is None
    setup.main()
    assert setup.find_browser() == str(tmp_path / "browser" / "browser")
    assert "Fetching" in capsys.readouterr().out
    setup.main()
    assert capsys.readouterr().out == ""


def test_a_named_browser_comes_first(setup: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    setup.main()
    monkeypatch.setenv("MOMANTU_BROWSER", "/opt/other")
    assert setup.find_browser() == "/opt/other"


@pytest.mark.parametrize(
    "wrong", [{"refused": True}, {"script": "#!/bin/sh\nexit 1\n"}, {"script": "#!/bin/sh\n"}]
)
def test_where_it_cannot_be_had_it_is_said_and_nothing_is_left(
    setup: ModuleType,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    wrong: dict[str, object],
) -> None:
    for name, value in wrong.items():
        monkeypatch.setattr(Apt, name, value)
    setup.main()
    assert "tests of HTML pages are skipped" in capsys.readouterr().out
    assert setup.find_browser() is None
    assert list(tmp_path.iterdir()) == []
