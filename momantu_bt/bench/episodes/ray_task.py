"""The task of a Ray worker: one episode in a process of its own."""

from __future__ import annotations

import socket
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import momantu_bt
from momantu_bt.bench.episodes.parcel import Parcel
from momantu_bt.bench.episodes.process import EpisodeProcess
from momantu_bt.bench.planning.made_of import foreign
from momantu_bt.bench.rows.spec import EpisodeSpec


def order(spec: EpisodeSpec, parcel: Parcel) -> dict[str, Any]:
    """All that a worker needs, as plain data."""
    told = {"version": momantu_bt.__version__, "spec": spec.as_dict()}
    return told | {"parcel": asdict(parcel)}


def errand() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """The function that Ray takes to its workers.

    It is a local function, so Ray sends its code and not its name. It can therefore report that
    the worker lacks this package or has another version. It returns `row` and `record` (the files
    of the episode's record by name), or `refused` (why it cannot run there).
    """

    def run(order: dict[str, Any]) -> dict[str, Any]:
        import socket

        try:
            import momantu_bt

            if momantu_bt.__version__ == order["version"]:
                from momantu_bt.bench.episodes.ray_task import carry_out

                return carry_out(order)
            found = f"has momantu-bt {momantu_bt.__version__}"
        except ImportError as error:
            found = f"cannot import momantu-bt ({error})"
        need = order["version"]
        cure = f"install {need} there, with the same extras and plug-ins"
        return {"refused": f"the machine {socket.gethostname()} {found}, not {need}; {cure}"}

    return run


def carry_out(order: Mapping[str, Any]) -> dict[str, Any]:
    """Run the ordered episode on this machine."""
    spec = EpisodeSpec.from_dict(order["spec"])
    if differs := foreign(spec.made_of):
        return {
            "refused": f"the machine {socket.gethostname()} would give other results: "
            f"{'; '.join(differs)}; install the same there"
        }
    with tempfile.TemporaryDirectory(prefix="momantu_bt_ray_") as name:
        files, record = Path(name) / "files", Path(name) / "record"
        files.mkdir()
        parcel = Parcel(**order["parcel"])
        tree = parcel.unpack(files)
        here = replace(spec, tree=str(tree), record=str(record) if spec.record else None)
        with EpisodeProcess(here) as process:
            row = parcel.as_shown(process.wait(), files)
        return {"row": row, "record": _contents(record)}


def _contents(folder: Path) -> dict[str, bytes]:
    if not folder.is_dir():
        return {}
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}
