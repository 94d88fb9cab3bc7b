"""A copy of a robot of two parts: a cart, and an arm with two fingers from a xacro file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

CARTER = Path(__file__).parents[2] / "robots" / "carter"
FILES = {"robot": "robot.yaml", "cart": "cart.urdf", "arm": "arm.urdf.xacro"}


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MOMANTU_BT_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def carter(tmp_path: Path) -> Callable[..., Path]:
    """Writes the robot's folder, texts of its files changed: `carter(robot=(old, new))`."""

    def write(**changes: tuple[str, str]) -> Path:
        folder = tmp_path / "carter"
        folder.mkdir(exist_ok=True)
        for key, file in FILES.items():
            old, new = changes.pop(key, ("", ""))
            text = (CARTER / file).read_text(encoding="utf-8")
            assert old in text
            (folder / file).write_text(text.replace(old, new, 1), encoding="utf-8")
        assert not changes
        return folder / "robot.yaml"

    return write
