"""A skill's description: for the terminal, for programs and as a page of the docs."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping
from typing import Any

from momantu_bt.skill import MISSING, Port, Skill
from momantu_bt.tree.catalogue.spec import NodeSpec
from momantu_bt.tree.show.skill_example import xml_example, yaml_example
from momantu_bt.values.types import label

_HEADINGS = (("in", "Inputs"), ("out", "Outputs"))


def as_text(name: str, skill: type[Skill]) -> str:
    """For the terminal."""
    lines = [f"{name}: {_doc(skill)}", *port_lines(skill)]
    lines += ["", f"Uses      {', '.join(sorted(skill.uses)) or 'no actuator'}"]
    if skill.senses:
        lines += [f"Senses    {', '.join(sorted(skill.senses))}"]
    lines += [f"Needs     {', '.join(skill.needs) or 'no service'}"]
    if skill.calls:
        lines += [f"Calls     {', '.join(_called(skill))}"]
    if skill.failures:
        lines += ["", "Fails with"]
        lines += [f"  {code}: {sentence}" for code, sentence in skill.failures.items()]
    for heading, example in _examples(name, skill):
        lines += ["", heading, *(f"  {line}" for line in example.splitlines())]
    return "\n".join(lines)


def as_data(name: str, skill: type[Skill]) -> dict[str, Any]:
    """For programs, as JSON."""
    return {
        "name": name,
        "doc": _doc(skill),
        "ports": [port_data(port) for port in skill.ports.values()],
        "one_of": [list(group) for group in skill.one_of],
        "uses": sorted(skill.uses),
        "senses": sorted(skill.senses),
        "needs": list(skill.needs),
        "calls": _called(skill),
        "failures": dict(skill.failures),
        "examples": {heading.lower(): example for heading, example in _examples(name, skill)},
    }


def as_markdown(name: str, skill: type[Skill]) -> str:
    """A page of the docs."""
    parts = [f"# {name}", _doc(skill)]
    for heading, example in _examples(name, skill):
        parts.append(f"```{heading.lower()}\n{example}\n```")
    parts += port_tables(skill)
    if skill.failures:
        parts.append("## Failure codes")
        codes = [[f"`{code}`", sentence] for code, sentence in skill.failures.items()]
        parts.append(_table(["Code", "Meaning"], codes))
    uses = ", ".join(f"`{use}`" for use in sorted(skill.uses)) or "no actuator"
    needs = ", ".join(f"`{need}`" for need in skill.needs)
    parts.append(f"It commands {uses}" + (f" and needs the service {needs}." if needs else "."))
    if skill.senses:
        parts.append(f"The robot needs a {' and a '.join(sorted(skill.senses))}.")
    if skill.calls:
        parts.append(f"It calls the skills {', '.join(f'`{name}`' for name in _called(skill))}.")
    return "\n\n".join(parts) + "\n"


def _called(skill: type[Skill]) -> list[str]:
    """Names of the skills that it calls."""
    return [each if isinstance(each, str) else each.__name__ for each in skill.calls]


def port_lines(owner: type[Skill] | NodeSpec) -> Iterator[str]:
    """The ports of a skill or a node, for the terminal."""
    for heading, ports in _by_direction(owner):
        yield from ("", heading)
        yield from (f"  {port.name}: {kind(port)}{_default(port)}. {port.doc}" for port in ports)
    yield from (f"  exactly one of {', '.join(group)}" for group in owner.one_of)


def port_tables(owner: type[Skill] | NodeSpec) -> Iterator[str]:
    """The same as paragraphs of Markdown."""
    for heading, ports in _by_direction(owner):
        rows = [_row(port) for port in ports]
        columns = ["Port", "Type", *(["Default"] if heading == "Inputs" else []), "Meaning"]
        yield f"## {heading}"
        yield _table(columns, rows)
    yield from (f"Exactly one of `{'`, `'.join(group)}` is given." for group in owner.one_of)


def pages(skills: Mapping[str, type[Skill]]) -> dict[str, str]:
    """The file names and texts of a folder with one page a skill and an index."""
    found = {f"{name}.md": as_markdown(name, skill) for name, skill in skills.items()}
    rows = [
        [f"[{name}]({name}.md)", _doc(skill).partition("\n")[0]] for name, skill in skills.items()
    ]
    intro = "Each page says what `momantu-bt skills show NAME` says, and is made from the skill."
    found["index.md"] = f"# Skills\n\n{intro}\n\n{_table(['Skill', 'What it does'], rows)}\n"
    return found


def kind(port: Port) -> str:
    """A port's type, what it names, its unit and its range, in words."""
    words = label(port.type) + (" (ignored)" if port.ignored else "")
    if port.names is not None and "." in port.names:
        words += f", a plug-in of `{port.names}`"
    elif port.names is not None:
        words += f", a {port.names.replace('_', ' ')}"
    if port.unit is not None:
        words += f" in {port.unit}"
    return f"{words}, {port.bounds}" if port.bounds else words


def _doc(skill: type[Skill]) -> str:
    return inspect.getdoc(skill) or ""


def _by_direction(owner: type[Skill] | NodeSpec) -> Iterator[tuple[str, list[Port]]]:
    for direction, heading in _HEADINGS:
        ports = [port for port in owner.ports.values() if port.direction == direction]
        if ports:
            yield heading, ports


def _examples(name: str, skill: type[Skill]) -> Iterator[tuple[str, str]]:
    yield "YAML", yaml_example(name, skill)
    yield "XML", xml_example(name, skill)


def _default(port: Port) -> str:
    if port.direction == "out":
        return ""
    if port.default is MISSING:
        return ", required"
    return "" if port.default is None else f", else {port.default}"


def _row(port: Port) -> list[str]:
    cells = [f"`{port.name}`", kind(port).replace("|", "\\|")]
    if port.direction == "in":
        default = "" if port.default is None else f"`{port.default}`"
        cells.append("required" if port.default is MISSING else default)
    return [*cells, port.doc + (" (read again on each tick)" if port.live else "")]


def _table(columns: list[str], rows: list[list[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def port_data(port: Port) -> dict[str, Any]:
    """A port for programs."""
    return {
        "name": port.name,
        "direction": port.direction,
        "type": label(port.type),
        "unit": port.unit,
        "names": port.names,
        "least": port.least,
        "most": port.most,
        "required": port.required,
        "default": None if port.default is MISSING else str(port.default),
        "doc": port.doc,
    }
