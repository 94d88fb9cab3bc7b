"""Numerical libraries have one thread each, from the command line and from Python."""

import os
import subprocess
import sys

import pytest

from momantu_bt.threads import VARIABLES


@pytest.mark.parametrize(
    "first",
    [
        "import momantu_bt; momantu_bt.run",
        "import momantu_bt; momantu_bt.open_session",
        "import momantu_bt.cli",
    ],
)
def test_they_are_told_before_numpy_is_loaded(first):
    bare = {name: value for name, value in os.environ.items() if name not in VARIABLES}
    told = f"import os; print(*(os.environ[name] for name in {VARIABLES}))"
    asked = [sys.executable, "-c", f"{first}; {told}"]
    assert subprocess.check_output(asked, env=bare, text=True).split() == ["1"] * len(VARIABLES)
    own = {**bare, VARIABLES[0]: "2"}
    assert subprocess.check_output(asked, env=own, text=True).split()[0] == "2"
