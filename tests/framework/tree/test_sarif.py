"""SARIF: what its specification requires of a log, and that nothing of a problem is lost."""

from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, Severity
from momantu_bt.tree.show.problem_pages import codes
from momantu_bt.tree.show.sarif import sarif

PLACES = st.builds(
    Place,
    st.sampled_from(["tree.yaml", "a folder/tree.yaml", "/trees/tree.yaml"]),
    st.integers(1, 10_000),
    st.integers(1, 500),
    st.integers(1, 80),
)
PROBLEMS = st.lists(
    st.builds(
        Problem,
        st.sampled_from(sorted(codes())),
        st.text(min_size=1),
        PLACES,
        st.text(),
        st.sampled_from(Severity),
    ),
    max_size=8,
)


@given(PROBLEMS)
def test_each_problem_is_one_result_with_its_rule_and_place(problems: list[Problem]) -> None:
    log = sarif(problems)
    run = log["runs"][0]
    rules = run["tool"]["driver"]["rules"]
    assert log["version"] == "2.1.0"
    assert len(run["results"]) == len(problems)
    for problem, result in zip(problems, run["results"], strict=True):
        rule = rules[result["ruleIndex"]]
        assert rule["id"] == result["ruleId"] == problem.code
        assert rule["shortDescription"]["text"] == codes()[problem.code]
        assert result["message"]["text"].startswith(problem.message)
        assert problem.hint in result["message"]["text"]
        place = result["locations"][0]["physicalLocation"]
        assert place["region"]["startLine"] == problem.place.line
        assert place["region"]["startColumn"] == problem.place.column
        assert place["region"]["endColumn"] > problem.place.column


@given(PROBLEMS)
def test_rules_are_those_that_are_used_once_each(problems: list[Problem]) -> None:
    names = [rule["id"] for rule in sarif(problems)["runs"][0]["tool"]["driver"]["rules"]]
    assert names == sorted({problem.code for problem in problems})


def test_levels_and_paths() -> None:
    place = Place("a folder/tree.yaml", 3, 7, 4)
    kinds = [Problem("syntax", "bad", place, severity=severity) for severity in Severity]
    results = sarif(kinds)["runs"][0]["results"]
    assert [result["level"] for result in results] == ["error", "warning", "note"]
    location = results[0]["locations"][0]["physicalLocation"]
    assert location["artifactLocation"]["uri"] == "a%20folder/tree.yaml"
    absolute = sarif([Problem("syntax", "bad", Place("/a b.yaml", 1, 1))])["runs"][0]["results"][0]
    uri = absolute["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert uri == "file:///a%20b.yaml"


def test_a_file_that_cannot_be_opened_is_a_notification() -> None:
    invocation = sarif([], ["there is no file x.yaml"])["runs"][0]["invocations"][0]
    assert not invocation["executionSuccessful"]
    assert (
        invocation["toolExecutionNotifications"][0]["message"]["text"] == "there is no file x.yaml"
    )
    assert sarif([])["runs"][0]["invocations"][0]["executionSuccessful"]
