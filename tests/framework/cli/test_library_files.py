"""Files that are libraries: several trees and no main one, or models alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from momantu_bt.cli import main

Out = pytest.CaptureFixture[str]
ROOT = '<root BTCPP_format="4">{}</root>'
TREES = ROOT.format(
    "".join(f'<BehaviorTree ID="{name}"><AlwaysSuccess/></BehaviorTree>' for name in ("A", "B"))
)
MODELS = ROOT.format('<TreeNodesModel><Action ID="Dig"/></TreeNodesModel>')


@pytest.mark.parametrize(("text", "code"), [(TREES, "no-main"), (MODELS, "no-trees")])
def test_they_are_checked_and_shown_but_not_run(
    tmp_path: Path, capsys: Out, text: str, code: str
) -> None:
    file = tmp_path / "library.xml"
    file.write_text(text)
    assert main(["check", str(file)]) == 2
    assert f"[{code}]" in capsys.readouterr().err
    assert main(["check", str(file), "--undeclared", "warn"]) == 0
    assert f"warning: the file {'does not say' if code == 'no-main' else 'has no tree'}" in (
        capsys.readouterr().err
    )
    assert main(["show", str(file)]) == 0
    assert ("A" if code == "no-main" else "1 model, no tree") in capsys.readouterr().out
    assert main(["run", str(file), "--world", "none"]) == 2


@pytest.mark.parametrize("kind", ["--svg", "--dot", "--mermaid"])
def test_models_are_no_picture(tmp_path: Path, capsys: Out, kind: str) -> None:
    file = tmp_path / "models.xml"
    file.write_text(MODELS)
    assert main(["show", str(file), kind]) == 2
    assert "models alone, and no tree to draw" in capsys.readouterr().err
