"""The same drive in another process is the same to the last bit."""

import hashlib
import subprocess
import sys
from pathlib import Path

SCRIPT = """
import hashlib, sys
import numpy as np
from momantu_skills.navigation.map.fields import clearance
from momantu_skills.navigation.localize.particle_filter import likelihood_field
from momantu_skills.navigation.plan.planner import _slowness
from momantu_skills.navigation.config import PlannerConfig

padding = [bytearray(int(n)) for n in np.random.default_rng(int(sys.argv[1])).integers(1, 999, 50)]
blocked = np.random.default_rng(0).random((141, 133)) < 0.01
field = clearance(blocked, 0.05)
parts = field, likelihood_field(field, 0.05, 0.15), _slowness(field, 0.31, 0.12, PlannerConfig())
print(hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest())
"""


def test_fields_do_not_depend_on_where_memory_lies(tmp_path: Path) -> None:
    script = tmp_path / "fields.py"
    script.write_text(SCRIPT)
    words = {
        subprocess.run(
            [sys.executable, str(script), str(k)], capture_output=True, text=True, check=True
        ).stdout.strip()
        for k in range(3)
    }
    assert len(words) == 1
    assert len(words.pop()) == 2 * hashlib.sha256().digest_size
