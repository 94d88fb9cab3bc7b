"""The wheel: trees and worlds travel with it, and it checks trees without anything heavy."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HEAVY = ("sapien", "torch", "pinocchio", "coal", "ompl", "cv2", "numba", "scipy", "mani_skill")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The project's wheel, built as pip builds it."""
    folder = tmp_path_factory.mktemp("wheel")
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*pip, "--wheel-dir", str(folder), str(ROOT)], check=True)
    return next(folder.glob("momantu_bt-*.whl"))


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual environment outside the checkout with the wheel in it.

    Of the packages installed here it sees the light ones alone: links to what the core needs.
    """
    venv = tmp_path_factory.mktemp("venv")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(venv)], check=True)
    site = next(venv.glob("lib/python*/site-packages"))
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    here = Path(pytest.__file__).parent.parent
    for entry in light(here):
        (site / entry.name).symlink_to(entry)
    return venv / "bin" / "python"


def light(here: Path) -> Iterator[Path]:
    """Everything in a site-packages folder but heavy libraries, this project, and path files."""
    for entry in sorted(here.iterdir()):
        name = entry.name.lower()
        if name.endswith(".pth") or name.startswith(("_momantu", "momantu", "__editable__")):
            continue
        if not name.startswith((*HEAVY, "cmeel", "opencv", "pin-", "eigenpy")):
            yield entry


def momantu(python: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a verb as its user does, from a folder that is not the checkout."""
    program = "import sys; from momantu_bt.cli import main; sys.exit(main())"
    environment = {name: text for name, text in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.run(
        [str(python), "-c", program, *arguments],
        cwd=folder,
        env=dict(environment, NO_COLOR="1"),
        capture_output=True,
        text=True,
        check=False,
    )


def test_every_file_that_is_not_code_travels(wheel: Path) -> None:
    having = set(zipfile.ZipFile(wheel).namelist())
    listed = subprocess.run(
        [
            "git",
            "ls-files",
            "momantu_bt",
            "skills/momantu_skills",
            "worlds/momantu_worlds",
            "trees",
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    wanted = {
        name.removeprefix("skills/")
        .removeprefix("worlds/")
        .replace("trees/", "momantu_bt/trees/", 1)
        if name.startswith("trees/")
        else name.removeprefix("skills/").removeprefix("worlds/")
        for name in listed
        if (ROOT / name).is_file()
    }
    assert wanted - having == set()
    assert "momantu_bt/constraints.txt" in having, "doctor compares with the tested versions"


def test_nothing_else_travels(wheel: Path) -> None:
    tops = {name.partition("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == {
        "momantu_bt",
        "momantu_skills",
        "momantu_worlds",
    }


def test_it_says_that_it_is_typed(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    for package in ("momantu_bt", "momantu_skills", "momantu_worlds"):
        assert f"{package}/py.typed" in names


@pytest.mark.parametrize("tree", ["bring_object", "bring_object_plain", "examples/patrol"])
def test_bundled_trees_are_found_by_name(tree: str, python: Path, tmp_path: Path) -> None:
    done = momantu(python, tmp_path, "check", tree)
    assert done.returncode == 0, done.stdout + done.stderr


def test_what_a_light_install_cannot_check_is_said(python: Path, tmp_path: Path) -> None:
    done = momantu(python, tmp_path, "check", "bring_object")
    assert "poses and actuators of 'fetch' are not checked" in done.stdout + done.stderr


def test_a_bundled_tree_is_shown(python: Path, tmp_path: Path) -> None:
    done = momantu(python, tmp_path, "show", "bring_object")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "pick" in done.stdout


def test_bundled_worlds_travel(python: Path, tmp_path: Path) -> None:
    done = momantu(python, tmp_path, "worlds", "show", "four_rooms")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "table_a" in done.stdout


@pytest.mark.parametrize("verb", [["check", "bring_object"], ["show", "bring_object"], ["skills"]])
def test_light_verbs_load_nothing_heavy(verb: list[str], tmp_path: Path) -> None:
    program = (
        "import sys; from momantu_bt.cli import main; code = main(sys.argv[1:]); "
        f"loaded = [name for name in {HEAVY!r} if name in sys.modules]; "
        "print(loaded, file=sys.stderr); sys.exit(code or len(loaded))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, *verb],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_doctor_takes_a_light_install_for_what_it_is(python: Path, tmp_path: Path) -> None:
    done = momantu(python, tmp_path, "doctor", "--json")
    assert '"packages"' in done.stdout, done.stderr
    assert "Traceback" not in done.stderr
