"""`momantu-bt bench --merge`: folders of results from several machines as one."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import typer

from momantu_bt.bench.planning.merge import Merged, merge
from momantu_bt.bench.planning.plan import PLAN, RECORDS, record_name
from momantu_bt.bench.reports.report import report as as_report
from momantu_bt.bench.reports.report import write_report
from momantu_bt.bench.reports.tables import summary_text
from momantu_bt.bench.rows.spec import Row
from momantu_bt.bench.rows.store import Store
from momantu_bt.bench.statistics.summary import Summary
from momantu_bt.errors import ExitCode, InputError
from momantu_bt.formats.files import check_writable


def merge_folders(words: Sequence[str], out: Path | None, report: Path | None) -> ExitCode:
    """Merge folders into another one, and print the results of all.

    Exit code 0: every episode that any of them was to run has a row; 1: some are missing, or
    differ between two folders.
    """
    if out is None:
        raise InputError("--merge needs --out, a folder for all of it")
    if report is not None:
        check_writable(report)
    folders = list(dict.fromkeys(Path(word) for word in words))
    before = [out] if (out / PLAN).exists() and out not in folders else []
    merged = merge([*before, *folders])
    with Store(out) as store:
        merged.wanted.write(out)
        for key, row in merged.rows.items():
            if key not in store.rows:
                _copy_record(row, folders, out)
                store.add(row)
    _say(merged, report)
    missing = merged.wanted.missing(merged.rows)
    if missing:
        typer.echo(f"missing: {'; '.join(missing)}", err=True)
    return ExitCode.FAILURE if missing else ExitCode.SUCCESS


def _copy_record(row: Row, folders: Sequence[Path], out: Path) -> None:

    name = record_name(row["seed"], row["fault"], row["key"])
    for folder in folders:
        if (folder / RECORDS / name).is_dir():
            shutil.copytree(folder / RECORDS / name, out / RECORDS / name, dirs_exist_ok=True)
            return


def _say(merged: Merged, report: Path | None) -> None:

    rows = list(merged.rows.values())
    if rows:
        typer.echo(summary_text(rows[0]["tree"], Summary.of(rows)))
    if merged.doubles:
        typer.echo(f"{merged.doubles} episodes were in two folders, with equal results")
    if merged.others:
        typer.echo(f"{merged.others} rows of other files or options are left out", err=True)
    for conflict in merged.conflicts:
        typer.echo(f"conflict, in no row: {conflict}", err=True)
    if report is not None:
        write_report(report, as_report(rows, {}))
        typer.echo(f"report: {report}")
