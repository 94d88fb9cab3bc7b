"""Unpack a software Vulkan driver into the user's cache folder: without root, in about 5 s.

Run it with `python -m momantu_worlds.vulkan.install`; `momantu-bt doctor --fix` and `make setup`
do. It needs apt (Debian, Ubuntu and their kin) and 25-60 MB from the machine's own package mirror.
"""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from momantu_bt.formats.cache import cache_folder
from momantu_worlds.vulkan.apt import AptError, PrivateApt, System, this_system
from momantu_worlds.vulkan.choice import (
    Choice,
    VulkanMissingError,
    choose,
    machine_state,
    remembered,
)
from momantu_worlds.vulkan.places import driver_folder
from momantu_worlds.vulkan.private import MANIFEST

WINDOW_PACKAGE = "libx11-6"
_WINDOW_LIBRARY = "libX11.so.6"
_RUNTIME = ("libc.so", "libm.so", "libdl.so", "libpthread.so", "librt.so", "ld-linux", "libstdc++")
"""Never unpacked: a process has one C and C++ runtime, the machine's."""
_RUNTIME_ALSO = ("libgcc_s.so", "libresolv.so")


@dataclass(frozen=True, slots=True)
class Recipe:
    """Where a software driver comes from: package, its library, and releases that need backports.

    backports: codenames whose own version of the package is too old for SAPIEN.
    """

    name: str
    package: str
    library: str
    backports: tuple[str, ...] = ()


RECIPES = (
    # Debian 12's own Mesa 22.3 lacks VK_KHR_external_semaphore_fd, which SAPIEN asks for.
    Recipe("Mesa lavapipe", "mesa-vulkan-drivers", "libvulkan_lvp.so", ("bookworm",)),
    # Chromium brings SwiftShader along: smaller, and 2.5 times slower.
    Recipe("SwiftShader", "chromium-common", "libvk_swiftshader.so"),
)


def install(say: Callable[[str], None] = print) -> Choice:
    """Make sure that something renders; install the private driver only where nothing does.

    Raises:
        VulkanMissingError: no recipe helped; the message says why each did not.
    """
    with _one_at_a_time():
        state = machine_state()
        known = remembered(state)
        if known is not None:
            return known
        try:
            return choose(state)
        except VulkanMissingError as error:
            reasons = [str(error).partition(". ")[0]]
        say(
            "SAPIEN finds no Vulkan driver here: fetching a software driver for this user (no root)"
        )
        for recipe in RECIPES:
            try:
                _unpack(recipe, this_system())
                return choose(machine_state())
            except (AptError, OSError, VulkanMissingError) as error:
                reasons.append(f"{recipe.name}: {str(error).partition('. ')[0]}")
                say(f"  {reasons[-1]}")
    raise VulkanMissingError(
        f"no Vulkan driver could be set up ({'; '.join(reasons)}). Install one with your system's "
        f"packages: Mesa 24.3 or newer (`mesa-vulkan-drivers`) and {WINDOW_PACKAGE}"
    )


def _unpack(recipe: Recipe, system: System) -> None:
    """Download a recipe's packages and put the libraries it needs into the driver folder."""
    backports = system.codename in recipe.backports
    release = f"{system.codename}-backports" if backports else None
    with tempfile.TemporaryDirectory(dir=cache_folder(), prefix="vulkan-setup-") as name:
        scratch = Path(name)
        apt = PrivateApt(scratch, system, backports)
        archives = apt.download([recipe.package, WINDOW_PACKAGE], release)
        root = scratch / "root"
        apt.unpack(archives, root)
        found = {path.name: path for path in root.rglob("*.so*") if path.is_file()}
        for library in (recipe.library, _WINDOW_LIBRARY):
            if library not in found:
                raise AptError(f"{library} is in none of the packages that apt chose")
        window = _needed(found[_WINDOW_LIBRARY], root)
        driver = [path for path in _needed(found[recipe.library], root) if path not in window]
        fresh = scratch / "driver"
        packages = [archive.stem for archive in archives]
        _lay_out(fresh, window, driver, found[recipe.library].name, packages)
        shutil.rmtree(driver_folder(), ignore_errors=True)
        fresh.rename(driver_folder())


def _needed(library: Path, root: Path) -> list[Path]:
    """`library` and what it needs of what lies under `root`, runtimes excepted, by `ldd`."""
    folders = sorted({str(path.parent) for path in root.rglob("*.so*")})
    environment = dict(os.environ, LD_LIBRARY_PATH=":".join(folders))
    listed = subprocess.run(
        ["ldd", str(library)], env=environment, capture_output=True, text=True, check=False
    )
    needed = [library]
    for line in listed.stdout.splitlines():
        name, arrow, rest = line.strip().partition(" => ")
        path = Path(rest.partition(" (")[0])
        runtime = name.startswith((*_RUNTIME, *_RUNTIME_ALSO))
        if arrow and path.is_relative_to(root) and not runtime:
            needed.append(path)
    return needed


def _lay_out(
    folder: Path, window: list[Path], driver: list[Path], library: str, packages: list[str]
) -> None:
    """Fill `folder`: the libraries, the ICD file (with its final, absolute path), the manifest."""
    (folder / "lib").mkdir(parents=True)
    for path in (*window, *driver):
        shutil.copyfile(path.resolve(), folder / "lib" / path.name)
    description = {
        "file_format_version": "1.0.0",
        "ICD": {"library_path": str(driver_folder() / "lib" / library), "api_version": "1.3.0"},
    }
    manifest = {
        "icd": "icd.json",
        "window_libraries": [f"lib/{path.name}" for path in window],
        "driver_libraries": [f"lib/{path.name}" for path in driver],
        "packages": packages,
    }
    (folder / "icd.json").write_text(json.dumps(description, indent=1), encoding="utf-8")
    (folder / MANIFEST).write_text(json.dumps(manifest, indent=1), encoding="utf-8")


@contextmanager
def _one_at_a_time() -> Iterator[None]:
    """Hold the cache folder's lock: two set-ups at once would delete each other's work.

    Raises:
        VulkanMissingError: the cache folder cannot be written.
    """
    try:
        cache_folder().mkdir(parents=True, exist_ok=True)
        # The lock may be there already, in a folder that has become read-only since.
        with tempfile.TemporaryFile(dir=cache_folder()):
            lock = (cache_folder() / "vulkan.lock").open("w")
    except OSError as error:
        raise VulkanMissingError(
            f"the cache folder {cache_folder()} cannot be written ({error.strerror}); "
            "name another one in MOMANTU_BT_CACHE"
        ) from error
    with lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


if __name__ == "__main__":
    try:
        chosen = install()
    except VulkanMissingError as problem:
        sys.exit(f"momantu-bt: {problem}")
    if "--quiet" not in sys.argv[1:]:
        print(f"Vulkan: {chosen.device} ({chosen.way.value})")
