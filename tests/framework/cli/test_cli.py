"""The command line: exit codes, messages without stack traces, and what it does not import."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from momantu_bt import __version__, plugins
from momantu_bt.cli import VERBS, main
from momantu_bt.cli.verbs import COMMANDS
from momantu_bt.tree.problems import MOST_SHOWN
from momantu_bt.world import WorldError

TREES = Path(__file__).parents[3] / "trees"
HEAVY = ("torch", "sapien", "cv2", "pinocchio", "ompl", "coal", "numba", "scipy", "toppra", "av")
BAD = "momantu_bt: 1\ntrees:\n  Main:\n    - wit: 1 s\n    - wait: 1 m\n"
GOOD = "momantu_bt: 1\ntrees:\n  Main:\n    - wait: 1 s\n      retry: 3\n"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A file with a good tree."""
    path = tmp_path / "good.yaml"
    path.write_text(GOOD, encoding="utf-8")
    return path


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    """A file with two errors."""
    path = tmp_path / "bad.yaml"
    path.write_text(BAD, encoding="utf-8")
    return path


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.strip() == __version__


def test_help_names_every_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert all(f"  {verb} " in shown for verb in VERBS)
    assert main([]) == 2


@pytest.mark.parametrize("verb", ["check", "show", "run", "doctor"])
def test_help_of_a_verb_has_examples_on_lines_of_their_own(
    capsys: pytest.CaptureFixture[str], verb: str
) -> None:
    assert main([verb, "--help"]) == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert any(line.startswith(f"momantu-bt {verb}") for line in lines)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["chek"], "Did you mean 'check'?"),
        (["check"], "name at least one tree file"),
        (["check", "--json", "--sarif", "x.yaml"], "one of --json and --sarif"),
        (["check", "--explain", "unknwon-node"], "did you mean unknown-node?"),
        (["check", "--wrld", "x", "y"], "--wrld"),
        (["check", "nowhere.yaml"], "there is no file nowhere.yaml"),
        (["show", "bring_objct"], "did you mean bring_object?"),
        (["skills", "show", "navgate"], "did you mean 'navigate'?"),
        (["worlds", "four_rooms"], "knows check, "),
        (["worlds", "four_rooms"], " To see one: momantu-bt worlds show four_rooms. See "),
        (["robots", "chek", "x"], "Did you mean 'check'"),
        (["run", "--sede", "3", "x"], "--sede (Possible options: --seed, "),
        (["run", "--sede", "3", "x"], ". See momantu-bt run --help."),
        (["robots", "show"], "Missing argument 'name'. See momantu-bt robots show --help."),
        (["robots", "show", "a", "b"], "(b). See momantu-bt robots show --help."),
    ],
)
def test_wrong_arguments(
    capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    assert main(arguments) == 2
    said = capsys.readouterr()
    assert message in said.err
    assert "Traceback" not in said.err


def test_check_of_a_good_tree(capsys: pytest.CaptureFixture[str], tree: Path) -> None:
    assert main(["check", str(tree)]) == 0
    assert "no errors in 1 tree with 3 nodes" in capsys.readouterr().out


def test_check_reports_all_errors(capsys: pytest.CaptureFixture[str], bad: Path) -> None:
    assert main(["check", str(bad)]) == 2
    said = capsys.readouterr().err
    assert f"{bad}:4:7: error: no node is called 'wit' [unknown-node]" in said
    assert f"{bad}:5:13: error:" in said
    assert "did you mean wait?" in said
    assert said.endswith("2 errors; momantu-bt check --explain unknown-node says more\n")


def test_check_as_json(capsys: pytest.CaptureFixture[str], tree: Path, bad: Path) -> None:
    assert main(["check", "--json", str(tree), str(bad), "nowhere.yaml"]) == 2
    report = json.loads(capsys.readouterr().out)
    assert [each["ok"] for each in report["trees"]] == [True, False, False]
    first = report["trees"][1]["problems"][0]
    assert (first["code"], first["line"], first["column"]) == ("unknown-node", 4, 7)


def test_check_explains_a_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--explain", "unknown-node"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("# unknown-node")
    assert "Wrong:" in said


def test_check_with_a_goal(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "bring_object", "--goal", "can on table_b"]) == 0
    capsys.readouterr()
    assert main(["check", "bring_object", "--goal", "can on tabel_b"]) == 2
    assert "--goal:1:1: error: the world has no surface 'tabel_b'" in capsys.readouterr().err


def test_run_accepts_what_stands_elsewhere_in_trees_that_it_does_not_reach(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    tree = tmp_path / "tree.yaml"
    text = "momantu_bt: 1\nmain: A\ntrees:\n  A: [{wait: 0.1 s}]\n  B: [{Kick: {power: 3}}]\n"
    tree.write_text(text)
    run = ["run", "-q", str(tree), "--world", "none"]
    assert main(run) == 2
    assert "no node is called 'Kick'" in capsys.readouterr().err
    assert main([*run, "--undeclared", "warn"]) == 0
    tree.write_text(text.replace("0.1 s}", "0.1 s}, B"))
    capsys.readouterr()
    assert main([*run, "--undeclared", "warn"]) == 2
    assert "nothing here has the node 'Kick'" in capsys.readouterr().err


NEEDS_GOAL = """<root BTCPP_format="4"><BehaviorTree ID="Go">
  <GoalReached goal="{goal}"/>
</BehaviorTree></root>
"""


@pytest.mark.parametrize(
    ("given", "code", "said"),
    [
        ([], 2, "give it a value: --set goal=…"),
        (["--set", "goal=1;2;0"], 0, "no errors in 1 tree"),
        (["--values", "goals.yaml"], 0, "no errors in 1 tree"),
        (["--set", "gaol=1;2;0"], 2, "--set:1:1: error: the tree has no value 'gaol'"),
        (["--set", "goal"], 2, "--set goal: expected key=value"),
        (["--values", "nowhere.yaml"], 2, "nowhere.yaml"),
    ],
)
def test_check_with_values_from_outside(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    given: list[str],
    code: int,
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("go.xml").write_text(NEEDS_GOAL, encoding="utf-8")
    Path("goals.yaml").write_text("goal: {x: 1, y: 2, yaw: 0}\n", encoding="utf-8")
    assert main(["check", "go.xml", *given]) == code
    out, err = capsys.readouterr()
    assert said in out + err


def test_check_in_sarif(bad: Path, tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--sarif", str(bad), str(tree), "nowhere.yaml"]) == 2
    captured = capsys.readouterr()
    run = json.loads(captured.out)["runs"][0]
    assert [result["ruleId"] for result in run["results"]] == ["unknown-node", "wrong-value"]
    assert (
        "nowhere.yaml" in run["invocations"][0]["toolExecutionNotifications"][0]["message"]["text"]
    )
    assert captured.err == ""


def test_very_many_errors_are_counted(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "many.yaml"
    path.write_text("momantu_bt: 1\ntrees:\n  Main:\n" + "    - wit\n" * 60, encoding="utf-8")
    assert main(["check", str(path)]) == 2
    said = capsys.readouterr().err
    assert said.count("[unknown-node]") == MOST_SHOWN
    assert "and 10 more" in said
    assert "\n60 errors;" in said


def test_show(capsys: pytest.CaptureFixture[str], tree: Path, bad: Path) -> None:
    assert main(["show", str(tree)]) == 0
    assert "wait 1 s  (3 tries)" in capsys.readouterr().out
    assert main(["show", str(bad)]) == 2


@pytest.mark.parametrize("kind", ["skills", "worlds", "robots"])
def test_listings(capsys: pytest.CaptureFixture[str], kind: str) -> None:
    assert main([kind, "--json"]) == 0
    names = [each["name"] for each in json.loads(capsys.readouterr().out)]
    assert main([kind]) == main([kind, "list"]) == 0
    for name in names:
        assert main([kind, "show", name, "--json"]) == 0
        assert main([kind, "show", name]) == 0


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (WorldError("no Vulkan driver"), 3),
        (plugins.PluginError("two plug-ins are called 'a'"), 2),
        (KeyboardInterrupt(), 130),
        (ZeroDivisionError("oh"), 4),
        (BrokenPipeError(), 1),
    ],
)
def test_what_a_verb_raises_becomes_an_exit_code(
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    tree: Path,
    error: BaseException,
    code: int,
) -> None:
    def load(*arguments: object, **options: object) -> None:
        raise error

    monkeypatch.setattr("momantu_bt.cli.trees.check.load", load)
    monkeypatch.setattr("os.dup2", lambda *descriptors: None)
    monkeypatch.delenv("MOMANTU_BT_TRACEBACK", raising=False)
    assert main(["check", str(tree)]) == code
    assert "Traceback" not in capfd.readouterr().err


def test_a_verb_of_a_plug_in(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from importlib.metadata import EntryPoint

    entry = EntryPoint("paths", "os.path:basename", COMMANDS.name)
    monkeypatch.setattr(COMMANDS, "installed", lambda: {"paths": entry})
    assert main(["--help"]) == 0
    assert "paths" in capsys.readouterr().out


TREE = str(TREES / "bring_object.yaml")
NEVER = (*HEAVY, "trimesh", "networkx", "matplotlib", "requests", "viser", "py_trees", "PIL.Image")
"""What no verb may load that runs no world."""


@pytest.mark.parametrize(
    ("arguments", "never"),
    [
        (["--help"], (*NEVER, "numpy", "pydantic", "ruamel.yaml", "lxml")),
        (["check", TREE], (*NEVER, "rich.console", "http.server", "momantu_bt.engine.executor")),
        (["show", TREE], (*NEVER, "rich.console", "http.server", "momantu_bt.engine.executor")),
        (["run", "good.yaml", "-q"], (*NEVER, "rich.console", "http.server", "ssl")),
    ],
    ids=lambda given: given[0] if isinstance(given, list) else "",
)
def test_a_verb_loads_nothing_that_it_does_not_need(
    tree: Path, arguments: list[str], never: tuple[str, ...]
) -> None:
    program = (
        "import sys; from momantu_bt.cli import main\n"
        f"code = main({arguments!r})\n"
        "ran = {name for name, module in sys.modules.items() if type(module) is type(sys)}\n"
        f"print(sorted(ran.intersection({never!r})), code)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=tree.parent
    )
    assert done.stdout.splitlines()[-1] == "[] 0", done.stderr


@pytest.mark.parametrize("name", ["bring_object", "bring_object_plain"])
def test_the_bundled_trees_have_neither_errors_nor_warnings(
    capsys: pytest.CaptureFixture[str], name: str
) -> None:
    assert main(["check", name]) == 0
    assert capsys.readouterr().err == ""
