"""Random files of the dialect: good ones are never refused, and what is passed misses no key."""

import random
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest

import momantu_bt
from momantu_bt.engine.node import TreeNode
from momantu_bt.failure import INPUT_MISSING
from momantu_bt.formats.problems import Problem, errors
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files.xml.format import read
from momantu_bt.tree.registry import Registry

KEYS = [f"v{i}" for i in range(6)]
CONTROLS = {
    "Sequence": 4,
    "AsyncSequence": 3,
    "SequenceWithMemory": 3,
    "ReactiveSequence": 3,
    "Fallback": 4,
    "AsyncFallback": 3,
    "ReactiveFallback": 3,
    "IfThenElse": 3,
    "WhileDoElse": 3,
    "Parallel": 3,
    "ParallelAll": 3,
}
"""Controls with the most children that they get here."""
DECORATORS = {
    "Inverter": {},
    "ForceSuccess": {},
    "ForceFailure": {},
    "RetryUntilSuccessful": {"num_attempts": "123"},
    "Repeat": {"num_cycles": "123"},
    "RunOnce": {"then_skip": ("true", "false")},
    "Precondition": {"else": ("SUCCESS", "FAILURE")},
}
LIMITS = {
    "Parallel": ("success_count", "failure_count"),
    "ParallelAll": ("max_failures",),
}
CONDITIONS = ["_failureIf", "_successIf", "_skipIf", "_while"]
SCRIPTS = ["_onSuccess", "_onFailure", "_onHalted", "_post"]


class Maker:
    """Makes one file. careless: keys may be read before they are written, shared or removed."""

    def __init__(self, seed: int, *, careless: bool) -> None:
        self.chance = random.Random(seed)
        self.careless = careless
        self.loops = 0
        self.trees = self.chance.randint(0, 3)

    def pick(self, *choices: str) -> str:
        return self.chance.choice(choices)

    def key(self) -> str:
        return self.chance.choice(KEYS)

    def condition(self) -> str:
        simple = f"{self.key()} {self.pick('<', '>', '==', '<=')} {self.pick('0', '2', self.key())}"
        return self.pick(simple, simple, f"!({simple})", f"({simple}) && ({self.key()} > 1)")

    def script(self) -> str:
        create = ":=" if self.careless and self.chance.random() < 0.4 else "="
        return self.pick(
            f"{self.key()} += 1",
            f"{self.key()} {create} {self.pick('0', '3')}",
            f"{self.key()} = {self.key()} * 2 - 1",
            f"{self.key()} += 1; {self.key()} -= 1",
            f"{self.key()} {create} ({self.condition()}) ? {self.key()} + 1 : 0",
        )

    def attributes(self) -> str:
        found = {}
        while self.chance.random() < 0.25:
            name = self.chance.choice([*CONDITIONS, *SCRIPTS])
            found[name] = self.condition() if name in CONDITIONS else self.script()
        return "".join(f" {name}={quoteattr(text)}" for name, text in found.items())

    def leaf(self, tree: int) -> str:
        kind = self.chance.random()
        given = self.attributes()
        if kind < 0.35:
            return f"<Script code={quoteattr(self.script())}{given}/>"
        if kind < 0.55:
            return f"<ScriptCondition code={quoteattr(self.condition())}{given}/>"
        if kind < 0.65 and self.careless:
            return self.pick(
                f'<UnsetBlackboard key="{self.key()}"/>',
                f'<SetBlackboard output_key="{self.key()}" value="4"/>',
                f'<SetBlackboard output_key="{self.key()}" value="{{{self.key()}}}"/>',
            )
        if kind < 0.75 and tree < self.trees:
            return self.call(tree)
        if kind < 0.85:
            return self.loop()
        return f"<{self.pick('AlwaysSuccess', 'AlwaysFailure')}{given}/>"

    def loop(self) -> str:
        self.loops += 1
        i, end = f"i{self.loops}", self.pick("ForceSuccess", "ForceFailure")
        return (
            f'<Sequence><Script code="{i} := 0"/><{end}>'
            f'<KeepRunningUntilFailure _onHalted="{self.key()} += 1"><Sequence>'
            f'<Script code="{i} += 1; {self.key()} += 1"/>'
            f'<ScriptCondition code="{i} &lt; {self.pick("1", "3")}"/>'
            f"</Sequence></KeepRunningUntilFailure></{end}></Sequence>"
        )

    def call(self, tree: int) -> str:
        target = self.chance.randint(tree + 1, self.trees)
        if self.chance.random() < 0.5:
            return f'<SubTree ID="T{target}" _autoremap="true"/>'
        shared = [key for key in KEYS if not self.careless or self.chance.random() < 0.8]
        values = [f"{{{self.key()}}}" if self.chance.random() < 0.9 else "2" for _ in shared]
        if not self.careless:
            values = [f"{{{self.key()}}}" for _ in shared]
        wires = "".join(f' {k}="{v}"' for k, v in zip(shared, values, strict=True))
        return f'<SubTree ID="T{target}"{wires}/>'

    def node(self, tree: int, depth: int) -> str:
        if depth == 0 or self.chance.random() < 0.25:
            return self.leaf(tree)
        if self.chance.random() < 0.3:
            name = self.chance.choice(list(DECORATORS))
            given = self.attributes()
            given += "".join(
                f' {port}="{self.chance.choice(values)}"'
                for port, values in DECORATORS[name].items()
            )
            if name == "Precondition":
                given += f" if={quoteattr(self.condition())}"
            return f"<{name}{given}>{self.node(tree, depth - 1)}</{name}>"
        name = self.chance.choice(list(CONTROLS))
        least = 2 if name in ("IfThenElse", "WhileDoElse") else 1
        count = self.chance.randint(least, CONTROLS[name])
        given = self.attributes()
        given += "".join(
            f' {port}="{self.chance.randint(1, count)}"' for port in LIMITS.get(name, ())
        )
        inside = "".join(self.node(tree, depth - 1) for _ in range(count))
        return f"<{name}{given}>{inside}</{name}>"

    def file(self) -> str:
        made = [key for key in KEYS if not self.careless or self.chance.random() < 0.7]
        first = "; ".join(f"{key} := 0" for key in made) or "other := 0"
        body = f'<Sequence><Script code="{first}"/>{self.node(0, 3)}</Sequence>'
        trees = [f'<BehaviorTree ID="T0">{body}</BehaviorTree>']
        for tree in range(1, self.trees + 1):
            trees.append(f'<BehaviorTree ID="T{tree}">{self.node(tree, 2)}</BehaviorTree>')
        lines = "\n".join(trees)
        return f'<root BTCPP_format="4" main_tree_to_execute="T0">\n{lines}\n</root>'


def problems(text: str) -> list[Problem]:
    document, found = read(text, "t.xml", Registry())
    return check(document, Registry(), reading=found).problems


@pytest.mark.parametrize("block", range(20))
def test_a_tree_that_begins_with_its_keys_is_never_refused(block: int) -> None:
    for seed in range(block * 20, block * 20 + 20):
        text = Maker(seed, careless=False).file()
        assert errors(problems(text)) == [], text


@pytest.fixture
def missed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What nodes said of keys without a value."""
    found: list[str] = []
    fail = TreeNode._broken

    def noting(self: TreeNode, error: Exception) -> object:
        if getattr(error, "code", "") == INPUT_MISSING or "has no value" in str(error):
            found.append(f"{self.name}: {error}")
        return fail(self, error)  # type: ignore[arg-type]

    monkeypatch.setattr(TreeNode, "_broken", noting)
    return found


def test_a_tree_without_a_word_of_keys_never_misses_one(missed: list[str], tmp_path: Path) -> None:
    quiet = 0
    file = tmp_path / "t.xml"
    for seed in range(600):
        text = Maker(seed, careless=True).file()
        if any(problem.code == "read-before-write" for problem in problems(text)):
            continue
        quiet += 1
        file.write_text(text)
        report = momantu_bt.run(file, world="none", max_time=1.0, registry=Registry())
        assert (missed, report.error) == ([], None), text
    assert quiet > 60
