"""The two models that nearly every world includes, for where Gazebo is not installed."""

from __future__ import annotations

from pathlib import Path

from momantu_worlds.sdf.read.document import Element, parse_document

_SUN = b"""<sdf version='1.6'>
  <light name='sun' type='directional'>
    <diffuse>0.8 0.8 0.8 1</diffuse>
    <direction>-0.4 0.2 -0.9</direction>
  </light>
</sdf>"""
_GROUND = b"""<sdf version='1.6'>
  <model name='ground_plane'>
    <static>true</static>
    <link name='link'>
      <collision name='collision'>
        <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>
      </collision>
    </link>
  </model>
</sdf>"""
_TEXTS = {"sun": _SUN, "ground_plane": _GROUND}


def standard_model(uri: str) -> Element | None:
    """The root of a model that is known by its name, whatever server it is named on; or None."""
    words = uri.lower().replace("%20", "_").replace(" ", "_").split("/")
    name = next((word for word in words if word in _TEXTS), None)
    return None if name is None else parse_document(_TEXTS[name], Path(f"<{name}>"))
