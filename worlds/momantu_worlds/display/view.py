"""A live 3D view of a run in a browser on this machine; needs no Vulkan driver of its own."""

from __future__ import annotations

import io
import socket
from collections.abc import Sequence
from contextlib import redirect_stdout
from typing import TYPE_CHECKING, Any

import numpy as np
import viser

from momantu_bt.geometry import Transform
from momantu_bt.marker import Marker
from momantu_bt.world import Layer, TreeLine, WorldError
from momantu_worlds.display.following import Following
from momantu_worlds.display.markers import UPRIGHT, drawn
from momantu_worlds.display.panel import Panel
from momantu_worlds.display.shapes import ColoredMesh, body_meshes, link_meshes, still_meshes
from momantu_worlds.scenes.geometry.bodies import Body, Episode, Picture

if TYPE_CHECKING:
    from momantu_worlds.sapien.simulator import Simulator

HOST = "127.0.0.1"
"""Only browsers on this machine are served."""
MOVED = 1e-4
"""m or quaternion units; smaller motions are not sent."""


class BrowserView:
    """Implements `View`, `MarkerView` and `TreeView` of `momantu_bt.world`."""

    def __init__(self, simulator: Simulator, episode: Episode, port: int) -> None:
        """See `open_view`."""
        self._simulator, self._port = simulator, port
        with redirect_stdout(io.StringIO()):  # it would announce itself in the terminal
            self._server = viser.ViserServer(host=HOST, port=port, verbose=False)
        self._open = True
        self._server.scene.set_up_direction("+z")
        self._server.scene.world_axes.visible = False
        self._following = Following(self._server, simulator.truth.base())
        self._layers = {
            layer: self._server.scene.add_frame(_folder(layer), show_axes=False) for layer in Layer
        }
        self._panel = Panel(self._server.gui, self._show_layer)
        self._server.scene.add_light_ambient("/light", intensity=0.6)
        still = [body for body in episode.bodies if body.static]
        self._meshes("/still", still_meshes(still))
        for body in still:
            self._pictures(body)
        self._frames: dict[str, Any] = {}
        for body in episode.bodies:
            if not body.static:
                self._frames[body.name] = self._frame(f"/things/{body.name}", body_meshes(body))
        self._links: dict[str, Any] = {}
        for name, link in simulator.model.links.items():
            self._links[name] = self._frame(f"/robot/{name}", link_meshes(link))
        self._sent: dict[str, Transform] = {}
        self._markers: dict[str, Any] = {}
        self._guests: set[str] = set()
        self.update()

    @property
    def url(self) -> str:
        """The address to open in a browser."""
        return f"http://{HOST}:{self._port}"

    @property
    def shown(self) -> tuple[str, ...]:
        """Names of the bodies that may move, come or go, as they are shown now."""
        return tuple(self._frames)

    def update(self) -> None:
        """Show the current world."""
        truth = self._simulator.truth
        with self._server.atomic():
            self._come_and_go()
            for name, frame in self._frames.items():
                self._put(f"body {name}", frame, truth.pose(name))
            for name, frame in self._links.items():
                self._put(f"link {name}", frame, truth.link(name))
            self._following.move(truth.base(), follows=self._panel.follows)
        self._server.flush()

    def draw(
        self, name: str, marker: Marker, map_from_frame: Transform, layer: Layer = Layer.MARKERS
    ) -> None:
        """Show a marker; it replaces an earlier one of that name."""
        self.erase(name)
        handle = drawn(self._server.scene, f"{_folder(layer)}/{name}", marker, map_from_frame)
        if handle is not None:
            self._markers[name] = handle

    def erase(self, name: str) -> None:
        """Show a marker no longer."""
        handle = self._markers.pop(name, None)
        if handle is not None:
            handle.remove()

    @property
    def marked(self) -> tuple[str, ...]:
        """Names of the markers that are shown now."""
        return tuple(self._markers)

    def tell(self, headline: str, lines: Sequence[TreeLine]) -> None:
        """Show what runs, and the tree's lines."""
        self._panel.tell(headline, lines)

    @property
    def told(self) -> str:
        """What runs and the tree as they are shown now, as HTML."""
        return self._panel.text

    def end(self, text: str) -> None:
        """Say how the run ended, and offer to close the view."""
        self._panel.end(text)
        self._server.flush()

    @property
    def dismissed(self) -> bool:
        """Whether a person has closed the view in the browser."""
        return self._panel.dismissed

    def _show_layer(self, layer: Layer, visible: bool) -> None:
        self._layers[layer].visible = visible

    def close(self) -> None:
        """Stop serving; safe to call twice."""
        if self._open:
            self._open = False
            with redirect_stdout(io.StringIO()):
                self._server.stop()

    def _come_and_go(self) -> None:
        """Show bodies that were added to the world, and no longer those that were removed."""
        added = {body.name: body for body in self._simulator.added}
        for name in [name for name in self._guests if name not in added]:
            self._guests.remove(name)
            self._sent.pop(f"body {name}", None)
            self._frames.pop(name).remove()
        for name, body in added.items():
            if name not in self._guests:
                self._guests.add(name)
                self._frames[name] = self._frame(f"/things/{name}", body_meshes(body))

    def _put(self, key: str, frame: Any, pose: Transform) -> None:
        sent = self._sent.get(key)
        if sent is not None and _close(sent, pose):
            return
        self._sent[key] = pose
        frame.position, frame.wxyz = pose.position, pose.quaternion

    def _frame(self, name: str, meshes: list[ColoredMesh]) -> Any:
        frame = self._server.scene.add_frame(name, show_axes=False)
        self._meshes(name, meshes)
        return frame

    def _meshes(self, name: str, meshes: list[ColoredMesh]) -> None:
        for index, mesh in enumerate(meshes):
            self._server.scene.add_mesh_simple(
                f"{name}/{index}", mesh.vertices, mesh.faces, color=mesh.color, flat_shading=True
            )

    def _pictures(self, body: Body) -> None:
        for index, part in enumerate(body.parts):
            if isinstance(part.geometry, Picture):
                pose = body.map_from_body @ part.body_from_part @ UPRIGHT
                self._server.scene.add_image(
                    f"/pictures/{body.name}/{index}",
                    part.geometry.pixels,
                    render_width=part.geometry.size[0],
                    render_height=part.geometry.size[1],
                    position=pose.position,
                    wxyz=pose.quaternion,
                )


def _folder(layer: Layer) -> str:
    """The path in the scene below which a layer's markers are."""
    return f"/layers/{layer.name.lower()}"


def _close(a: Transform, b: Transform) -> bool:
    return bool(
        np.abs(a.position - b.position).max() < MOVED
        and np.abs(a.quaternion - b.quaternion).max() < MOVED
    )


def open_view(simulator: Simulator, episode: Episode, port: int) -> BrowserView:
    """Serve a simulation to browsers on this machine.

    Raises:
        WorldError: something else listens at the port already.
    """
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            raise WorldError(
                f"the view cannot be served at port {port}: {error.strerror}; choose another port"
            ) from error
    return BrowserView(simulator, episode, port)
