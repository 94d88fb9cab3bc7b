"""A robot's mesh files in SAPIEN: those that cannot be read are told, with their links."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from momantu_bt.formats.urdf import read_urdf
from momantu_bt.world import WorldError

CURE = (
    "write it anew as STL, OBJ, DAE or GLB, or take it out of the robot's URDF; `momantu-bt robots "
    "check` says what else is wrong"
)


def built(builder: Any) -> Any:
    """The articulation of a builder whose base stands still.

    Raises:
        WorldError: the file of a collision mesh cannot be read.
    """
    articulation = builder.build(fix_root_link=True)
    for link in builder.link_builders:
        shapes = articulation.find_link_by_name(link.name).get_collision_shapes()
        meshes = [record.filename for record in link.collision_records if record.filename]
        if meshes and len(shapes) < len(link.collision_records):
            raise _unreadable("collision", meshes[0], link.name)
    return articulation


@contextmanager
def drawn(urdf: Path) -> Iterator[None]:
    """Say which visual mesh cannot be read: SAPIEN reads them for the first picture.

    Raises:
        WorldError: it is one of the robot's.
    """
    try:
        yield
    except RuntimeError as error:
        for link in read_urdf(urdf).root.findall("link"):
            for mesh in link.findall("visual/geometry/mesh"):
                if Path(mesh.get("filename", "")).name in str(error):
                    file, name = mesh.get("filename", ""), link.get("name", "")
                    raise _unreadable("visual", file, name) from None
        raise


def _unreadable(role: str, file: str, link: str) -> WorldError:
    return WorldError(
        f"the {role} mesh {file} of the link {link!r} cannot be read as a mesh; {CURE}"
    )
