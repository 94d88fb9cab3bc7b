"""Running the command line as a person does, in a process of its own."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

LIMIT = 600.0
"""Seconds of wall time after which a run counts as hung."""


@dataclass(frozen=True)
class Ran:
    """What a finished command left: exit code, what it said, and its report if it wrote one."""

    code: int
    said: str
    report: dict[str, Any] | None


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., Ran]:
    """`run("bring_object", "--seed", "3")`; the report goes to a folder of the test's own."""

    def call(*arguments: str | Path, report: str = "report.json") -> Ran:
        path = tmp_path / report
        command = [sys.executable, "-m", "momantu_bt", "run", *map(str, arguments)]
        done = subprocess.run(
            [*command, "--report", str(path)],
            capture_output=True, text=True, timeout=LIMIT, check=False, cwd=tmp_path,
            env={**os.environ, "OMP_NUM_THREADS": "1", "LP_NUM_THREADS": "1"},
        )  # fmt: skip
        told = json.loads(path.read_text()) if path.exists() else None
        return Ran(done.returncode, done.stdout + done.stderr, told)

    return call
