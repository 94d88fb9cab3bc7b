"""Plug-ins that misbehave at import: they are named, and no output is spoilt."""

from __future__ import annotations

import json
import sys
import time

import pytest

from momantu_bt import importing
from momantu_bt.cli import doctor
from momantu_bt.diagnosis import imports, plugins

SKILL = '''
from momantu_bt.skill import Run, Skill

class Noisy(Skill):
    """Makes noise."""

    def run(self, robot) -> Run:
        print("noise in run")
        yield "noisy"
'''
BREAKS = {
    "prints": 'import os\nprint("hello")\nos.system("echo from a child")\n',
    "exits": "import sys\nsys.exit(0)\n",
    "generator_exit": "raise GeneratorExit\n",
    "odd": "class Odd(BaseException): pass\nraise Odd('odd')\n",
}


@pytest.fixture
def installed(tmp_path, install):
    def make(name, text):
        entries = f"[momantu_bt.skills]\n{name} = {name}_module:Noisy\n"
        return install(tmp_path, name, entries, {f"{name}_module.py": text + SKILL})

    return make


@pytest.mark.parametrize("how", BREAKS)
def test_the_json_of_a_verb_is_pure_and_names_a_broken_plug_in(installed, how):
    package = installed(how, BREAKS[how])
    done = package.command("skills --json")
    (about,) = (each for each in json.loads(done.stdout) if each["name"] == how)
    assert about["ok"] is (how == "prints")
    if how == "prints":
        assert "hello" in done.stderr
    else:
        assert f"the skill '{how}'" in about["about"]
        assert "cannot be loaded" in about["about"]


@pytest.mark.parametrize("line", ["skills test prints --json", "check tree.yaml --json"])
def test_what_a_plug_in_prints_does_not_get_into_json(installed, line):
    package = installed("prints", BREAKS["prints"])
    (package.folder / "tree.yaml").write_text("momantu_bt: 1\ntrees: {Main: [prints]}\n")
    done = package.command(line)
    json.loads(done.stdout)
    assert "hello" in done.stderr


def test_an_import_that_hangs_is_named(installed, monkeypatch, capsys):
    monkeypatch.setattr(importing, "SLOW", 0.01)
    with importing.importing("no_such_module", lambda: "the skill 'slow' (a:b of c)"):
        print("noise")
        time.sleep(0.2)
    said = capsys.readouterr()
    assert said.out == ""
    assert "still importing the skill 'slow' (a:b of c)" in said.err
    assert "noise" in said.err


def test_imports_in_another_process_name_what_hangs_and_what_ends_it(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    texts = {
        "hangs": "import time\ntime.sleep(600)\n",
        "leaves": "import os\nos._exit(0)\n",
        "exits": "import sys\nsys.exit(0)\n",
        "talks": "print('GOOD nothing', end='')\n",
        "threads": "import threading as t, time\nt.Thread(target=time.sleep, args=(99,)).start()",
    }
    for name, text in texts.items():
        (tmp_path / f"{name}.py").write_text(text)
    assert imports.fatal_imports(texts, seconds=4.0) == {
        "hangs": "importing it took more than 4 s",
        "leaves": "importing it ended Python with 0",
    }


def test_doctor_gives_up_on_a_plug_in_that_hangs(installed, monkeypatch):
    hung = lambda modules, seconds: dict.fromkeys(modules, "hung")  # noqa: E731
    monkeypatch.setattr(plugins, "fatal_imports", hung)
    groups = doctor.GROUPS[:1]
    first = next(iter(groups[0].installed().values()))
    monkeypatch.setattr(plugins, "_is_ours", lambda entry: entry.module != first.module)
    monkeypatch.delitem(sys.modules, first.module, raising=False)
    found = [each for each in plugins.plugins(groups) if not each.ok]
    there = [each for each in groups[0].installed().values() if each.module == first.module]
    assert [each.detail for each in found] == [
        f"{each.value} cannot be imported: hung" for each in there
    ]
