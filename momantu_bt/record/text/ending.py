"""Say in one line how a run ended."""

from __future__ import annotations

from pathlib import PurePath

from momantu_bt.engine.ending import ERROR, FAILURE, INTERRUPTED
from momantu_bt.record.report import Report
from momantu_bt.record.text.failure import failure_line


def ending_text(report: Report) -> str:
    """`bring_object succeeded after 83.2 s …`, or why it did not; the referee's word beside it."""
    name = PurePath(report.tree).stem
    times = f"after {report.sim_time_s:.1f} s simulated, {report.real_time_factor:.1f} x real time"
    if report.status == ERROR:
        last = (report.error or "").strip().rpartition("\n")[2]
        return f"{name}: internal error {times}: {last}"
    if report.status == INTERRUPTED:
        return f"{name} was interrupted{_by(report)} {times}; everything stands still"
    if report.status == FAILURE:
        chain = "" if report.failure is None else failure_line(report.failure)
        return f"{name} failed: {chain}; {times}{_referee(report)}"
    return f"{name} succeeded {times}{_referee(report)}"


def _by(report: Report) -> str:
    """The signal, unless it was Ctrl-C."""
    if report.interrupted_by == "SIGHUP":
        return " by SIGHUP, as the terminal has closed,"
    ctrl_c = report.interrupted_by in (None, "SIGINT")
    return "" if ctrl_c else f" by {report.interrupted_by}"


def _referee(report: Report) -> str:
    if report.success is None:
        return ""
    if report.success:
        return "; the referee agrees" if report.status != FAILURE else "; the referee sees success"
    reason = ", ".join(report.unmet) or "no reason given"
    return f"; the referee denies success: {reason}{_demanded(report)}"


def _demanded(report: Report) -> str:
    """What was demanded, where that is written, and how to do without."""
    wanted = ", ".join(demand.demand for demand in report.demands)
    places = ", ".join(dict.fromkeys(d.place for d in report.demands if d.place))
    if not wanted:
        return "; --no-referee leaves it to the tree"
    return f"; demanded: {wanted}{places and f' ({places})'}; --no-referee leaves it to the tree"
