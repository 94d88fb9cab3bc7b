"""Using a driver in this process: environment and preloaded libraries."""

from __future__ import annotations

import os
import warnings

from momantu_bt.shared_library import ensure_shared_library
from momantu_worlds.vulkan.private import ICD_VARIABLE, installed_driver, is_ours, preload
from momantu_worlds.vulkan.probe import Way

SOFTWARE_THREADS_VARIABLE = "LP_NUM_THREADS"
OPENMP_RUNTIME = "libgomp.so.1"


def apply(way: Way) -> None:
    """Make this process render the given way; must come before the first `import sapien`.

    Raises:
        FileNotFoundError: the way needs the private driver and there is none.
        OSError: a library of the private driver cannot be loaded.
    """
    # One rasteriser thread: two runs side by side are faster, and do not slow each other down.
    os.environ.setdefault(SOFTWARE_THREADS_VARIABLE, "1")
    # SAPIEN imports Pinocchio where it is installed, and warns where that lacks its OpenMP runtime.
    ensure_shared_library(OPENMP_RUNTIME, carriers=("torch",))
    # SAPIEN says so on every machine without a system-wide loader, and uses the one it brings.
    warnings.filterwarnings("ignore", message="Failed to find system libvulkan")
    if way is not Way.PRIVATE and is_ours(os.environ.get(ICD_VARIABLE)):
        del os.environ[ICD_VARIABLE]
    if way is Way.SYSTEM:
        return
    driver = installed_driver()
    if driver is None:
        raise FileNotFoundError("the private Vulkan driver is not installed")
    preload(driver.window_libraries)
    if way is Way.PRIVATE:
        preload(driver.driver_libraries)
        os.environ[ICD_VARIABLE] = str(driver.icd)
