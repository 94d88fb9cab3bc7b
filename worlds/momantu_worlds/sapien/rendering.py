"""Making SAPIEN render: the driver, our shaders, and a clear word where neither works."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from momantu_bt.world import WorldError

SHADERS = Path(__file__).parent / "shaders" / "lambert"


def prepare_rendering() -> None:
    """Find a Vulkan driver before SAPIEN is imported; rasterise on one thread unless told else.

    One software-rendering thread leaves the other cores to other episodes.
    """
    os.environ.setdefault("LP_NUM_THREADS", "1")
    from momantu_bt.vulkan import ensure_vulkan

    ensure_vulkan()


def render_system() -> Any:
    """A render system with our shaders: one pass, Lambert, no shadows.

    Raises:
        WorldError: SAPIEN finds no rendering device.
    """
    import sapien

    sapien.render.set_log_level("error")
    sapien.render.set_camera_shader_dir(str(SHADERS))
    sapien.render.set_picture_format("Color", "r8g8b8a8unorm")
    try:
        return sapien.render.RenderSystem()
    except RuntimeError as error:
        raise WorldError(
            f"SAPIEN cannot render: {error}. It needs a Vulkan driver, in software at least; "
            "`make setup` brings one without touching the system, and `momantu-bt doctor` tells "
            "what is missing"
        ) from None
