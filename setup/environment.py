"""Make .venv ready for momantu-bt: what `make setup` runs, with any Python 3.11 or 3.12.

Only the standard library is used here. A second run with nothing to do ends in a fraction of a
second: a stamp in .venv remembers what was installed from which versions of the project's files.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from types import ModuleType

from progress import Progress, StepFailed, Steps

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
VENV_PYTHON = VENV / "bin" / "python"
STAMP = VENV / "momantu-bt.stamp"
LOG = ROOT / "build" / "setup.log"
STEPS = [
    "virtual environment",
    "build tools",
    "packages",
    "OpenCV without a display",
    "compiling kernels",
]
CONSTRAINTS = ROOT / "constraints.txt"

OLDEST, NEWEST = (3, 11), (3, 12)
"""mani-skill's dependency mplib has no wheel for Python 3.13."""
BUILD_TOOLS = ("hatchling", "editables")
"""What builds this project; installed first, so that nothing is built against another version."""
HEADLESS = "opencv-python-headless"
REASONS = """\
Setting up momantu-bt in .venv (nothing outside the project and your cache folder is changed):
  sapien, mani-skill (with torch)   the physics world and the files of the Fetch robot
  pin, coal, ompl, toppra           kinematics, collision checks, planning and timing of motions
  opencv, pyapriltags, numba        perception and navigation
  py-trees, typer, rich, pydantic   trees, the command line and what it prints
  pytest, ruff, mypy, import-linter tests and checks
Versions are those of constraints.txt; about 3 GB, a minute or more, only this first time."""


class SetupError(Exception):
    """Set-up cannot go on; the message says why and what to do."""


def main() -> None:
    """Install what is missing, then make sure that something renders."""
    wanted = _wanted()
    if not _stamp_says(wanted):
        _check_python()
        print(REASONS, flush=True)
        steps = Steps(STEPS, LOG, sys.stdout)
        try:
            _make_venv(steps)
            _install_packages(steps)
            steps.run([str(VENV_PYTHON), "-m", "momantu_skills.warm_up"])
        except StepFailed as problem:
            raise SetupError(
                f"a step failed:\n{problem}\nMend that, then run `make setup` again"
            ) from None
        STAMP.write_text(wanted, encoding="utf-8")
    if _call([str(VENV_PYTHON), "-m", "momantu_worlds.vulkan.install", "--quiet"]) != 0:
        raise SetupError("everything except rendering is installed; see the line above")


def _wanted() -> str:
    """A digest of what decides the contents of .venv; equal digest, nothing to do."""
    digest = hashlib.sha256(str(ROOT).encode())
    for file in (ROOT / "pyproject.toml", CONSTRAINTS, Path(__file__)):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def _stamp_says(wanted: str) -> bool:
    """The last set-up ended well with the same files, and its Python still runs."""
    try:
        return STAMP.read_text(encoding="utf-8") == wanted and VENV_PYTHON.exists()
    except OSError:
        return False


def _check_python() -> None:
    here = sys.version_info[:2]
    if not OLDEST <= here <= NEWEST:
        raise SetupError(
            f"Python {here[0]}.{here[1]} is not supported (3.11 and 3.12 are); install one of them "
            "and run `make setup PYTHON=python3.11`"
        )
    if sys.platform != "linux":
        raise SetupError(f"only Linux is supported (sapien and ompl), not {sys.platform}")


def _make_venv(steps: Steps) -> None:
    """Create .venv with a pip of its own, also where Debian's python3-venv is not installed."""
    asking = [str(VENV_PYTHON), "-m", "pip", "--version"]
    if VENV_PYTHON.exists() and _call(asking, quiet=True) == 0:
        steps.run()
        return
    ensurepip = importlib.util.find_spec("ensurepip") is not None
    without = [] if ensurepip and _ensurepip_works() else ["--without-pip"]
    try:
        steps.run([sys.executable, "-m", "venv", "--clear", *without, str(VENV)])
    except StepFailed as problem:
        raise SetupError(
            "this Python cannot make virtual environments; install `python3-venv` with your "
            f"system's packages, then run `make setup` again\n{problem}"
        ) from None
    if without:
        _bring_pip()


def _ensurepip_works() -> bool:
    """Debian cuts the wheels out of ensurepip and leaves the module that says so."""
    return _call([sys.executable, "-m", "ensurepip", "--version"], quiet=True) == 0


def _bring_pip() -> None:
    """Put pip into .venv from Debian's own wheel of it, fetched without root.

    Raises:
        SetupError: it cannot be had.
    """
    apt = _module("momantu_bt_apt", ROOT / "worlds" / "momantu_worlds" / "vulkan" / "apt.py")
    try:
        with tempfile.TemporaryDirectory() as name:
            scratch = Path(name)
            private = apt.PrivateApt(scratch, apt.this_system(), backports=False)
            private.unpack(private.download(["python3-pip-whl"], None), scratch / "root")
            wheel = next((scratch / "root").rglob("pip-*.whl"))
            command = [str(VENV_PYTHON), str(wheel / "pip"), "install", "--no-index", str(wheel)]
            failed = _call(command, quiet=True) != 0
    except (apt.AptError, OSError, StopIteration) as error:
        raise SetupError(
            f"pip is missing ({error}); install `python3-venv`, then run `make setup` again"
        ) from error
    if failed:
        raise SetupError(
            "pip could not be installed into .venv; install `python3-venv`, then run "
            "`make setup` again"
        )


def _install_packages(steps: Steps) -> None:
    """The project, editable, with everything it uses, in tested versions."""
    pip = [str(VENV_PYTHON), "-m", "pip", "--disable-pip-version-check", "--no-color", "install"]
    constrained = [*pip, "--progress-bar", "off", "--constraint", str(CONSTRAINTS)]
    steps.run([*constrained, *BUILD_TOOLS])
    project = ["--no-build-isolation", "--editable", f"{ROOT}[all,dev]"]
    steps.run([*constrained, *project], progress=Progress(_site_packages(), _pins()))
    # Both builds of OpenCV fill one folder; the one for screens, which sapien asks for, cannot be
    # loaded on a machine without X, so the headless one is laid over it.
    pinned = f"{HEADLESS}=={_pinned(HEADLESS)}"
    steps.run([*pip, "--no-deps", "--force-reinstall", pinned])


def _site_packages() -> Path:
    """Where .venv keeps its packages."""
    return next(VENV.glob("lib/python3*/site-packages"), VENV)


def _pins() -> int:
    return sum("==" in line for line in CONSTRAINTS.read_text(encoding="utf-8").splitlines())


def _pinned(package: str) -> str:
    for line in CONSTRAINTS.read_text(encoding="utf-8").splitlines():
        name, _, version = line.partition("==")
        if name == package:
            return version
    raise SetupError(f"constraints.txt does not name {package}")


def _module(name: str, file: Path) -> ModuleType:
    """One file of the project as a module, before the project is installed."""
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise SetupError(f"{file} cannot be read")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def _call(command: list[str], quiet: bool = False) -> int:
    output = subprocess.DEVNULL if quiet else None
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(command, stdout=output, stderr=output, env=environment, check=False)
    return done.returncode


if __name__ == "__main__":
    try:
        main()
    except SetupError as problem:
        sys.exit(f"make setup: {problem}")
    except KeyboardInterrupt:
        sys.exit("make setup: interrupted; run it again to continue")
