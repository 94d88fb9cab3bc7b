"""Episodes in SAPIEN: physics, drives, sensors and ground truth.

Importing any module of this package first looks for a Vulkan driver, which SAPIEN needs before it
is imported itself. Without one the import raises WorldError, so that no run starts without
rendering.
"""

import warnings

from momantu_bt.lazy import putting_off
from momantu_worlds.vulkan import ensure_vulkan

ensure_vulkan()

_NEVER_USED = (
    "numpy.f2py",
    "numpy.testing",
    "requests",
    "scipy.spatial.transform",
    "trimesh",
)
"""What SAPIEN and SciPy import too, for their tests, downloads and other ways to load a mesh."""

with warnings.catch_warnings(), putting_off(*_NEVER_USED):
    # it brings a loader of its own where the system has none, which is not a reason to warn
    warnings.filterwarnings("ignore", message="Failed to find system libvulkan")
    import sapien as _sapien  # noqa: F401
    import sapien.wrapper.urdf_loader as _loader  # noqa: F401
    import scipy.spatial as _spatial  # noqa: F401
