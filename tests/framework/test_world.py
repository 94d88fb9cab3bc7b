"""Random numbers depend on what names them and on nothing else."""

import subprocess
import sys

from momantu_bt.geometry import Pose2D
from momantu_bt.world import Site, seeded


def test_each_name_has_its_own_stream() -> None:
    draws = {
        seeded(*key).random() for key in [(1, "a"), (1, "b"), (2, "a"), (1, "a", 0), (1, "a", 0.5)]
    }
    assert len(draws) == 5


def test_parts_do_not_run_together() -> None:
    assert seeded(1, "1").random() != seeded("1", 1).random()
    assert seeded("ab", "c").random() != seeded("a", "bc").random()


def test_another_process_draws_the_same() -> None:
    code = "from momantu_bt.world import seeded; print(seeded(7, 'laser', 0.25).random().hex())"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == seeded(7, "laser", 0.25).random().hex()


def test_a_site_names_its_places_and_surfaces() -> None:
    assert Site("s", places={"home": Pose2D(0, 0)}).known_places() == ("home",)
