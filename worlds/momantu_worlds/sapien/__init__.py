"""Episodes in SAPIEN: physics, drives, sensors and ground truth.

Importing any module of this package first looks for a Vulkan driver, which SAPIEN needs before it
is imported itself. Without one the import raises WorldError, so that no run starts without
rendering.
"""

import warnings

from momantu_worlds.vulkan import ensure_vulkan

ensure_vulkan()

with warnings.catch_warnings():
    # it brings a loader of its own where the system has none, which is not a reason to warn
    warnings.filterwarnings("ignore", message="Failed to find system libvulkan")
    import sapien as _sapien  # noqa: F401
