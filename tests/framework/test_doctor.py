"""`momantu-bt doctor`: every finding has its cure, cures are carried out, and nothing stops it."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterator
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.cli import doctor as verb
from momantu_bt.cli.doctor import GROUPS
from momantu_bt.diagnosis import Diagnosis, imports, machine, packages, plugins
from momantu_bt.diagnosis.packages import Requirement, judge, release, requirements
from momantu_bt.plugins import Group, PluginError


def run(
    monkeypatch: pytest.MonkeyPatch,
    found: list[Diagnosis],
    *,
    as_json: bool = False,
    fix: bool = False,
) -> int:
    """Exit code of the verb when it finds just this."""
    monkeypatch.setattr(verb, "diagnose", lambda output: iter(found))
    return verb.doctor(as_json=as_json, fix=fix)


WRONG = Diagnosis("rendering", False, "nothing renders", "plug a card in")
RIGHT = Diagnosis("memory", True, "plenty")


def test_nothing_wrong_is_exit_0(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, [RIGHT]) == 0
    assert "Nothing is wrong" in capsys.readouterr().out


def test_a_fault_is_exit_1_with_its_cure(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, [RIGHT, WRONG]) == 1
    said = capsys.readouterr().out
    assert "nothing renders" in said
    assert "plug a card in" in said
    assert "--fix" not in said, "nothing here can be mended by doctor"


def test_json_is_for_programs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, [RIGHT, WRONG], as_json=True) == 1
    report = json.loads(capsys.readouterr().out)
    assert report["ok"] is False
    assert [entry["name"] for entry in report["diagnoses"]] == ["memory", "rendering"]
    assert report["diagnoses"][1]["cure"] == "plug a card in"


def test_fix_mends_only_what_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []
    mendable = Diagnosis("driver", False, "none", "fetch it", lambda: done.append("driver"))
    healthy = Diagnosis("cv2", True, "fine", "", lambda: done.append("cv2"))
    assert run(monkeypatch, [mendable, healthy], fix=True) == 0
    assert done == ["driver"]


@pytest.mark.parametrize("error", [OSError("no network"), RuntimeError("pip failed")])
def test_a_cure_that_does_not_work_is_said(
    error: Exception, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def mend() -> None:
        raise error

    assert run(monkeypatch, [Diagnosis("driver", False, "none", "fetch it", mend)], fix=True) == 1
    said = capsys.readouterr().out
    assert str(error) in said
    assert "fetch it" in said


@pytest.mark.parametrize(
    ("version", "ok"), [((3, 10), False), ((3, 11), True), ((3, 12), True), ((3, 13), False)]
)
def test_python_versions(version: tuple[int, int], ok: bool) -> None:
    found = machine.python_version(version)
    assert found.ok is ok
    assert bool(found.cure) is not ok


@pytest.mark.parametrize(("available", "ok"), [(1e9, False), (8e9, True), (None, True)])
def test_memory(available: float | None, ok: bool) -> None:
    assert machine.memory(available).ok is ok


def test_memory_of_this_machine_is_known() -> None:
    available = machine.available_memory()
    assert available is None or available > 0.0


def test_a_folder_that_does_not_exist_yet_is_judged_by_its_parent(tmp_path: Path) -> None:
    assert machine.writable("output", tmp_path / "a" / "b", "elsewhere").ok


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_read_only_folder_has_a_cure(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    found = machine.writable("output", tmp_path, "name another")
    assert not found.ok
    assert found.cure == "name another"


def test_a_file_in_the_place_of_a_folder_is_not_writable(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    assert not machine.writable("output", tmp_path / "taken", "name another").ok


LINES = [
    "numpy>=2.0",
    "rich<15,>=14.0",
    'sapien>=3.0.3; extra == "worlds"',
    'torch==2.13.0; extra == "worlds"',
    'momantu-bt[skills,worlds]; extra == "all"',
]


def test_requirements_are_read_with_their_extras() -> None:
    assert [(one.name, one.extra) for one in requirements(LINES)] == [
        ("numpy", ""),
        ("rich", ""),
        ("sapien", "worlds"),
        ("torch", "worlds"),
    ]


@pytest.mark.parametrize(
    ("bounds", "version", "allowed"),
    [
        (">=14.0,<15", "14.3.4", True),
        (">=14.0,<15", "15.0", False),
        (">=14.0,<15", "13.9", False),
        ("==2.13.0", "2.13.0+cpu", True),
        ("==2.13.0", "2.14", False),
        ("", "0.1", True),
    ],
)
def test_bounds(bounds: str, version: str, allowed: bool) -> None:
    assert Requirement("x", bounds, "").allows(version) is allowed


@given(st.lists(st.integers(0, 99), min_size=1, max_size=4))
def test_trailing_zeros_and_local_parts_do_not_count(numbers: list[int]) -> None:
    text = ".".join(map(str, numbers))
    assert release(text) == release(text + ".0") == release(text + "+cpu")


def core(*having: tuple[str, str | None], tested: dict[str, str] | None = None) -> Diagnosis:
    wanted = [Requirement("numpy", ">=2.0", ""), Requirement("rich", ">=14,<15", "")]
    return judge("packages", "", wanted, dict(having), tested or {})


def test_what_is_missing_or_too_new_is_named() -> None:
    found = core(("numpy", None), ("rich", "15.1"))
    assert not found.ok
    assert "missing: numpy" in found.detail
    assert "rich 15.1 (wanted >=14,<15)" in found.detail
    assert "pip install" in found.cure


def test_another_than_the_tested_version_is_told_but_no_fault() -> None:
    found = core(("numpy", "2.9"), ("rich", "14.1"), tested={"numpy": "2.4.6", "rich": "14.1.0"})
    assert found.ok
    assert "numpy 2.9 (tested: 2.4.6)" in found.detail
    assert "rich" not in found.detail


def test_an_extra_that_nobody_asked_for_is_no_fault() -> None:
    wanted = [Requirement("sapien", ">=3", "worlds"), Requirement("torch", "==2.13", "worlds")]
    assert judge("w", "worlds", wanted, {"sapien": None, "torch": None}, {}).ok
    half = judge("w", "worlds", wanted, {"sapien": "3.0.3", "torch": None}, {})
    assert not half.ok
    assert "momantu-bt[worlds]" in half.cure


def test_the_tested_versions_are_found() -> None:
    tested = packages.tested_versions()
    assert {"numpy", "py-trees", "sapien"} <= set(tested)


class Loaded:
    """A plug-in whose `diagnose` is told to it."""

    def __init__(self, diagnose: Callable[[], Iterator[Diagnosis]] | None = None) -> None:
        if diagnose is not None:
            self.diagnose = diagnose


def with_plugins(monkeypatch: pytest.MonkeyPatch, found: dict[str, Any]) -> list[Diagnosis]:
    """What is collected from plug-ins of these names; an exception is raised on loading."""

    def load(name: str) -> Any:
        if isinstance(found[name], Exception):
            raise found[name]
        return found[name]

    group: Group[Any] = Group("momantu_bt.skills", "skill")
    entries = {name: EntryPoint(name, f"nowhere_{name}:X", "g") for name in found}
    monkeypatch.setattr(group, "installed", lambda: entries)
    monkeypatch.setattr(group, "load", load)
    return list(plugins.plugins([group]))


def test_a_hook_that_several_plugins_share_is_called_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def diagnose() -> Iterator[Diagnosis]:
        yield WRONG

    found = with_plugins(monkeypatch, {"a": Loaded(diagnose), "b": Loaded(diagnose), "c": Loaded()})
    assert found.count(WRONG) == 1
    assert any(one.ok and one.detail == "a, b, c" for one in found)


def test_a_hook_that_raises_is_a_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    def diagnose() -> Iterator[Diagnosis]:
        yield RIGHT
        raise ValueError("half of it")

    found = with_plugins(monkeypatch, {"a": Loaded(diagnose)})
    assert RIGHT in found
    assert "half of it" in found[-1].detail
    assert not found[-1].ok


def test_a_plugin_that_cannot_be_loaded_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    broken = PluginError("the skill 'a' cannot be loaded: no module 'cuda'")
    found = with_plugins(monkeypatch, {"a": broken, "b": Loaded()})
    wrong = [one for one in found if not one.ok]
    assert len(wrong) == 1
    assert "cuda" in wrong[0].detail
    assert wrong[0].cure


def test_imports_are_tried_where_a_crash_does_no_harm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "crashes_here.py").write_text("import os; os._exit(11)")
    (tmp_path / "breaks_here.py").write_text("raise ImportError('libgomp.so.1: cannot open')")
    (tmp_path / "loads_here.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    names = ["crashes_here", "loads_here", "breaks_here", "is_not_there"]
    errors = imports.import_errors(names)
    assert set(errors) == {"crashes_here", "breaks_here"}
    assert "11" in errors["crashes_here"]


def test_a_missing_system_library_is_named_in_the_cure() -> None:
    reason = "ImportError: libgomp.so.1: cannot open shared object file: No such file"
    assert "libgomp.so.1" in imports.import_cure("pinocchio", reason)
    assert "pinocchio" in imports.import_cure("pinocchio", "SyntaxError: oh")


def test_it_loads_the_plugins_of_every_group() -> None:
    page = (Path(__file__).parents[2] / "docs" / "api.md").read_text(encoding="utf-8")
    table = page[page.index("| group |") : page.index("## Tunables")]
    listed = re.findall(r"^\| `(momantu_bt\.\w+)` \|", table, re.MULTILINE)
    assert [group.name for group in GROUPS] == listed
