"""The file of `run --report`: from the first tick on it never tells of another run.

If the process is killed, the file says so: it is written before the first tick as the report of a
run that did not end.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from momantu_bt.cli.shared.notices import notice
from momantu_bt.engine.ending import ERROR, Ending
from momantu_bt.engine.executor import Executor
from momantu_bt.formats.files import OutputError, check_writable, is_special
from momantu_bt.record.report import Report
from momantu_bt.running.reporting import report_of

CUT_OFF = "the process ended in the middle of the run: killed, or ended by code of a plug-in\n"


class ReportFile:
    """A report's file. path: as the user wrote it; a skill that changes the folder changes nothing.

    Raises:
        OutputError: it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        check_writable(path)
        self.path = path
        self._target = path.absolute()
        self._begun = False

    def begin(self, run: Executor) -> None:
        """Write the report of a run that is cut off; only where a later one replaces it."""
        if is_special(self._target):
            return
        cut_off = Ending(ERROR, None, None, 0.0, 0.0, 0, CUT_OFF)
        with suppress(OutputError):  # `write` will tell
            report_of(run.built.root.model.place.file, run, cut_off, 0.0).write(self._target)
            self._begun = True

    def withdraw(self) -> None:
        """Remove the file of a run that could not begin."""
        if self._begun:
            self._target.unlink(missing_ok=True)

    def write(self, report: Report) -> Report:
        """Write the final report. A file that cannot be written is told, and is `lost`."""
        try:
            report.write(self._target)
        except OutputError as error:
            why = str(error).replace(str(self._target), str(self.path))
            notice(f"there is no report: {why}")
            return replace(report, lost=(*report.lost, str(self.path)))
        return report
