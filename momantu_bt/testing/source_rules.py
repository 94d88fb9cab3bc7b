"""Find undeclared ports, undeclared codes and missing docs in a skill's source."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from momantu_bt.failure import ENGINE_CODES
from momantu_bt.formats.problems import Problem
from momantu_bt.skill import Skill
from momantu_bt.testing.source import Module, methods, reached
from momantu_bt.tree.skill_objection import skill_objection

NOT_WRITTEN = "NOT_WRITTEN"
"""The code with which a skill of `skills stub` fails until it is filled in."""
_GIVEN = {"port_values", "services", "clock", "random", "frames", "site", "host"}
"""Attributes that the engine sets."""


def documented(skill: type[Skill]) -> Iterator[Problem]:
    """The rules for loading a plug-in, and the presence of explanations."""
    wrong = skill_objection("a_skill", skill)
    if wrong is not None:
        yield Problem("docs", wrong)
    for code, sentence in skill.failures.items():
        if " " not in sentence.strip():
            yield Problem("docs", f"{code}: {sentence!r} does not explain it; write a sentence")


def ports(skill: type[Skill]) -> Iterator[Problem]:
    """Attributes used as if they were ports, inputs written, outputs that are never given."""
    known = {*dir(skill), *_GIVEN}
    uses = list(_attributes(skill))
    written = {node.attr for _, node in uses if isinstance(node.ctx, ast.Store)}
    for module, node in uses:
        name, place = node.attr, module.place(node)
        port = skill.ports.get(name)
        if isinstance(node.ctx, ast.Load):
            if name not in known and name not in written:
                yield Problem("undeclared-port", f"reads self.{name}, which is not a port", place)
        elif port is not None and port.direction == "in":
            yield Problem("input-written", f"writes its input {name!r}", place)
        elif port is None and name not in known and not name.startswith("_"):
            message = (
                f"writes self.{name}, which is not a port: declare it with Out(doc=…), or call it "
                f"self._{name}"
            )
            yield Problem("undeclared-port", message, place)
    yield from _unused(skill)


def codes(skill: type[Skill]) -> Iterator[Problem]:
    """Failures that its class raises by a code which neither it nor the engine declares."""
    for module, method in methods(skill):
        for node in ast.walk(method):
            code = _raised_code(node)
            if code is not None and code not in skill.failures and code not in ENGINE_CODES:
                message = f"raises {code}, which `failures` does not declare"
                yield Problem("undeclared-code", message, module.place(node))


def calls(skill: type[Skill]) -> Iterator[Problem]:
    """Skills that it calls by a name which `calls` does not have, or without `yield from`."""
    for module, method in methods(skill):
        for node in ast.walk(method):
            if isinstance(node, ast.Expr | ast.Assign) and _is_call(node.value):
                message = "`self.call(…)` alone does nothing: write `yield from self.call(…)`"
                yield Problem("call-not-run", message, module.place(node))
            if not (isinstance(node, ast.Call) and _is_call(node) and node.args):
                continue
            name = getattr(node.args[0], "value", None)
            if isinstance(name, str) and name not in skill.calls:
                message = f"calls {name!r}, which `calls` does not declare"
                yield Problem("undeclared-call", message, module.place(node))


def _is_call(node: ast.AST) -> bool:
    """Whether it is `self.call(…)`."""
    called = getattr(node, "func", None)
    return getattr(called, "attr", "") == "call" and (
        getattr(getattr(called, "value", None), "id", "") == "self"
    )


def _raised_code(node: ast.AST) -> str | None:
    """The code of `Failure("CODE", …)`."""
    if not isinstance(node, ast.Call) or not node.args:
        return None
    called, first = node.func, node.args[0]
    name = called.id if isinstance(called, ast.Name) else getattr(called, "attr", None)
    if name != "Failure" or not isinstance(first, ast.Constant):
        return None
    return str(first.value)


def _attributes(skill: type[Skill]) -> Iterator[tuple[Module, ast.Attribute]]:
    """Every `self.name` in the methods of the skill and of what it inherits from."""
    for module, method in methods(skill):
        if not method.args.args or _is_static(method):
            continue
        own = method.args.args[0].arg
        for node in ast.walk(method):
            if (
                isinstance(node, ast.Attribute)
                and isinstance(node.value, ast.Name)
                and node.value.id == own
            ):
                yield module, node


def _is_static(method: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    names = {getattr(each, "id", "") for each in method.decorator_list}
    return bool(names & {"staticmethod", "classmethod"})


def _unused(skill: type[Skill]) -> Iterator[Problem]:
    """Outputs that no line gives, inputs that no line reads, in all that the skill reaches."""
    if NOT_WRITTEN in skill.failures:
        said = "it is a stub: fill in its run(), and take the code out of `failures`"
        yield Problem("not-written", f"{NOT_WRITTEN} is among its codes; {said}")
        return
    given, read = set[str](), set[str]()
    for module in reached(skill):
        for node in ast.walk(module.tree):
            if isinstance(node, ast.Attribute):
                (read if isinstance(node.ctx, ast.Load) else given).add(node.attr)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                # getattr and setattr take names
                read.add(node.value)
                given.add(node.value)
    if not read:
        return
    for port in skill.ports.values():
        if port.direction == "out" and port.name not in given:
            yield Problem("output-never-given", f"no line gives the output {port.name!r}")
        elif port.direction == "in" and not port.ignored and port.name not in read:
            yield Problem("input-never-read", f"no line reads the input {port.name!r}")
