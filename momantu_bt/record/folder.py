"""The folder of one recorded run."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.formats.files import OutputError

LOG = "run.mcap"
REPORT = "report.json"


def prepare_folder(folder: Path) -> None:
    """Make the folder of a record, with an empty log so that no other run takes it.

    Raises:
        OutputError: the folder cannot be made or written, or holds a record already.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / LOG).open("x").close()
    except FileExistsError:
        problem = "holds a record already" if folder.is_dir() else "is a file"
        raise OutputError(f"{folder} {problem}; choose another folder") from None
    except OSError as error:
        raise OutputError(f"{folder} cannot be written: {error.strerror or error}") from None
