"""World files written for a test."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

Write = Callable[..., Path]
BARE = {"momantu_world": 1, "name": "test_world", "start": {"at": [1.0, 1.0, 0.0]}}


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """`write(key=…)` writes a world file with these parts beside the least that one has."""

    def write(**parts: object) -> Path:
        path = tmp_path / "world.yaml"
        path.write_text(json.dumps({**BARE, **parts}, indent=1), encoding="utf-8")
        return path

    return write
