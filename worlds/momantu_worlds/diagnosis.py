"""Checks of `momantu-bt doctor` for worlds: rendering, libraries, and Fetch's files."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path

from momantu_bt.diagnosis import Diagnosis
from momantu_bt.diagnosis.imports import import_cure, import_errors
from momantu_worlds.vulkan import VulkanMissingError, ensure_vulkan
from momantu_worlds.vulkan.choice import CURE
from momantu_worlds.vulkan.install import install

LIBRARIES = ("av", "trimesh", "embreex", "viser")
FETCH_FILES = ("fetch.urdf", "fetch.srdf")


def diagnose() -> Iterator[Diagnosis]:
    """Diagnoses of what worlds need; libraries of the extra that are not installed are left out."""
    present = [name for name in LIBRARIES if importlib.util.find_spec(name) is not None]
    errors = import_errors(present)
    for name, reason in errors.items():
        yield Diagnosis(name, False, f"cannot be imported: {reason}", import_cure(name, reason))
    if present and not errors:
        yield Diagnosis("libraries for worlds", True, f"{', '.join(present)} can be imported")
    if importlib.util.find_spec("mani_skill") is not None:
        yield _fetch()
    if importlib.util.find_spec("sapien") is not None:
        yield _vulkan()


def _vulkan() -> Diagnosis:
    """SAPIEN finds something to render with: a GPU, or a software driver."""
    try:
        choice = ensure_vulkan()
    except (VulkanMissingError, OSError) as error:
        reason = str(error).partition(". ")[0]
        return Diagnosis("Vulkan", False, reason, CURE, lambda: install().device)
    kind = "software" if "llvmpipe" in choice.device or "SwiftShader" in choice.device else "GPU"
    whose = {"system": "the machine's driver", "system_driver": "the machine's driver, our libX11"}
    origin = whose.get(choice.way.value, "the driver in your cache folder")
    return Diagnosis("Vulkan", True, f"{kind} rendering, {choice.device} ({origin})")


def _fetch() -> Diagnosis:
    """The robot's files lie in the folder of mani_skill; nothing of it is imported."""
    spec = importlib.util.find_spec("mani_skill")
    root = Path((spec.submodule_search_locations or [""])[0]) if spec is not None else Path()
    folder = root / "assets" / "robots" / "fetch"
    missing = [name for name in FETCH_FILES if not (folder / name).is_file()]
    if missing:
        detail = f"{', '.join(missing)} not found in {folder}"
        return Diagnosis("Fetch", False, detail, "`pip install --force-reinstall mani-skill`")
    return Diagnosis("Fetch", True, f"its description lies in {folder}")
