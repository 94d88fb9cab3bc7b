"""Sub-verbs of other packages: found by name, imported when asked for, harmless when broken."""

import sys
from collections.abc import Callable
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from momantu_bt import plugins
from momantu_bt.cli import main
from momantu_bt.cli.verbs import COMMANDS
from momantu_bt.plugins import PluginError

Out = pytest.CaptureFixture[str]
Bring = Callable[[str, str], None]

GREET = '''
"""Greets."""
import typer


def greet(name: str, loud: bool = typer.Option(False, "--loud")) -> int:
    """Say hello to somebody.

    Examples:
      momantu-bt worlds greet Ada
    """
    typer.echo(f"hello {name}".upper() if loud else f"hello {name}")
    return 1


group = typer.Typer(help="Several.")
group.command("one")(lambda: typer.echo("one"))
group.command("two")(lambda: typer.echo("two"))
'''


@pytest.fixture
def bring(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Bring:
    """`bring("worlds greet", text)`: an entry point to `greet` of a module with that text."""
    having: list[EntryPoint] = []
    modules = []
    find = plugins.entry_points
    monkeypatch.setattr(
        plugins,
        "entry_points",
        lambda group: having if group == COMMANDS.name else find(group=group),
    )
    monkeypatch.syspath_prepend(tmp_path)
    folder = tmp_path / "package_of_a_test" / "inner"
    folder.mkdir(parents=True)

    def write(name: str, text: str, attribute: str = "greet") -> None:
        modules.append(f"package_of_a_test.inner.m{len(modules)}")
        (folder / f"m{len(modules) - 1}.py").write_text(text, encoding="utf-8")
        having.append(EntryPoint(name, f"{modules[-1]}:{attribute}", COMMANDS.name))

    yield write
    for name in [name for name in sys.modules if name.startswith("package_of_a_test")]:
        del sys.modules[name]


@pytest.mark.parametrize("verb", ["worlds", "robots"])
def test_a_sub_verb_is_listed_helped_and_run_again_and_again(
    bring: Bring, capsys: Out, verb: str
) -> None:
    bring(f"{verb} greet", GREET)
    for _ in range(2):
        assert main([verb, "--help"]) == 0
        assert "Say hello to somebody." in capsys.readouterr().out
        assert main([verb, "greet", "Ada", "--loud"]) == 1
        assert capsys.readouterr().out == "HELLO ADA\n"
    assert main([verb, "greet", "--help"]) == 0
    assert "  momantu-bt worlds greet Ada\n" in capsys.readouterr().out


def test_the_verb_without_sub_verb_and_its_own_go_on(bring: Bring, capsys: Out) -> None:
    bring("worlds greet", GREET)
    bring("worlds list", GREET)
    assert main(["worlds"]) == 0
    listed = capsys.readouterr().out
    assert "four_rooms" in listed
    assert main(["worlds", "list"]) == 0
    assert capsys.readouterr().out == listed


def test_another_verbs_sub_verb_is_not_there(bring: Bring, capsys: Out) -> None:
    bring("worlds greet", GREET)
    assert main(["robots", "greet", "Ada"]) == 2
    assert main(["worlds", "greed"]) == 2
    assert main(["--help"]) == 0
    assert "greet" not in capsys.readouterr().out


def test_a_group_as_sub_verb(bring: Bring, capsys: Out) -> None:
    bring("worlds several", GREET, "group")
    assert main(["worlds", "several", "two"]) == 0
    assert capsys.readouterr().out == "two\n"


def test_help_imports_none_of_them_and_a_broken_one_is_told(bring: Bring, capsys: Out) -> None:
    bring("worlds broken", "raise RuntimeError('no GPU')\n" + GREET)
    bring("worlds unread", "def greet(:\n")
    bring("worlds greet", GREET)
    assert main(["worlds", "--help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    about = {line.split()[0]: " ".join(line.split()[1:]) for line in lines if line.strip()}
    assert about["broken"] == about["greet"] == "Say hello to somebody."
    assert about["unread"] == "From a plug-in."
    assert not [name for name in sys.modules if name.startswith("package_of_a_test.inner")]
    assert main(["worlds", "broken"]) == 2
    said = capsys.readouterr().err
    assert "the verb 'worlds broken'" in said
    assert "no GPU" in said
    assert main(["worlds", "greet", "Ada"]) == 1


@pytest.mark.parametrize(
    ("name", "attribute", "words"),
    [
        ("worlds greet twice", "greet", "not a verb"),
        ("worlds  greet", "greet", "not a verb"),
        ("run greet", "greet", "'run' takes no sub-verbs"),
        ("worlds greet", "__doc__", "neither a function"),
    ],
)
def test_what_can_be_no_sub_verb(bring: Bring, name: str, attribute: str, words: str) -> None:
    bring(name, GREET, attribute)
    with pytest.raises(PluginError, match=words):
        COMMANDS.load(name)


WHOLE = '''
"""Paints."""
import typer

paint = typer.Typer(invoke_without_command=True)


@paint.callback()
def make(context: typer.Context, blue: bool = typer.Option(False, "--blue")) -> int:
    """Paint a wall.

    Examples:
      momantu-bt paint --blue
      momantu-bt paint wash
    """
    if context.invoked_subcommand is None:
        typer.echo("blue" if blue else "white")
    return 1
'''


def test_a_verb_of_another_package_does_something_itself_and_takes_sub_verbs(
    bring: Bring, capsys: Out
) -> None:
    bring("paint", WHOLE, "paint")
    bring("paint greet", GREET)
    assert main(["--help"]) == 0
    assert "Paint a wall." in capsys.readouterr().out
    assert main(["paint", "--blue"]) == 1
    assert capsys.readouterr().out == "blue\n"
    assert main(["paint", "greet", "Ada"]) == 1
    assert capsys.readouterr().out == "hello Ada\n"
    assert main(["paint", "--help"]) == 0
    said = capsys.readouterr().out
    assert "paint --blue\n" in said
    assert "Say hello to somebody." in said
