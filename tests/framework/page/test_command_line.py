"""`momantu-bt replay RUN --html FILE`, of a run that was really made."""

import json

import pytest

from momantu_bt.cli import main

TREE = """
momantu_bt: 1
main: Main
trees:
  Main:
    - Try: {what: the door}
  Try:
    inputs: {what: text}
    fallback:
      - sequence: [{wait: 0.2 s}, {fail: {code: BLOCKED, message: "${what} is shut"}}]
      - fail: {code: LOST}
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    (folder / "tree.yaml").write_text(TREE, encoding="utf-8")
    assert main(["run", str(folder / "tree.yaml"), "--record", str(folder / "run")]) == 1
    return folder / "run"


def test_a_page_is_written(run, tmp_path, capsys):
    page = tmp_path / "run.html"
    assert main(["replay", str(run), "--html", str(page)]) == 0
    assert capsys.readouterr().out == f"{page}: open it in a browser\n"
    text = page.read_text(encoding="utf-8")
    data = json.loads(text.partition('id="record">')[2].partition("</script>")[0])
    assert data["about"]["ended"] == "FAILURE"
    assert "Try what the door" in data["labels"]["texts"]
    codes = [failure["links"][0]["code"] for failure in data["failures"]]
    assert codes == ["LOST"]
    links = [(link["role"], link["code"]) for link in data["failures"][0]["links"]]
    assert ("after ", "BLOCKED") in links
    assert [lane["name"] for lane in data["lanes"]] == ["wait", "failures"]


def test_a_page_that_cannot_be_written_is_said(run, tmp_path, capsys):
    assert main(["replay", str(run), "--html", str(tmp_path / "none" / "run.html")]) == 2
    assert "cannot be written" in capsys.readouterr().err
