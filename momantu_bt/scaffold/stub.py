"""A package of skills to be filled in: one for each leaf that a tree file uses and nobody has."""

from __future__ import annotations

import importlib.util
import keyword
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

from momantu_bt.formats.text import NOT_TEXT
from momantu_bt.scaffold import CannotCreate, class_name, make_package, module_name, toml_key
from momantu_bt.scaffold.uses import StubLeaf, StubPort, missing_leaves, ports_of
from momantu_bt.skill import Skill
from momantu_bt.tree.load import read_file
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.skill_objection import bad_skill_name

_HERE = Path(__file__).parent


@dataclass(frozen=True, slots=True)
class Stub:
    """What was written. folder: of the package. names: of its skills. left_out: why, by name."""

    folder: Path
    names: tuple[str, ...]
    left_out: dict[str, str]


def stub(tree: Path, into: Path, include: Sequence[Path] = ()) -> Stub:
    """Make a package with a skill for each leaf that a tree file uses and nothing here has.

    Raises:
        TreeNotFound, TreeError: the file cannot be read.
        CannotCreate: there is nothing to write, or the folder cannot be made.
    """
    registry = Registry.installed()
    document, _ = read_file(tree, registry, include)
    leaves, with_children = missing_leaves(document, registry)
    why = "it has children: write a node of your own (docs/writing_a_node.md)"
    left_out = dict.fromkeys(with_children, why)
    wanted = []
    for leaf in leaves:
        wrong = bad_skill_name(leaf.name)
        if wrong is None:
            wanted.append(leaf)
        else:
            left_out[leaf.name] = wrong
    if not wanted:
        said = "; ".join(f"{name}: {why}" for name, why in left_out.items())
        raise CannotCreate(said or f"every leaf of {tree} is installed")
    name = module_name(tree.stem).strip("_")
    package = f"{name}_skills"
    if importlib.util.find_spec(package) is not None:
        raise CannotCreate(f"a Python package called {package!r} is there already")
    folder = make_package(into / package.replace("_", "-"), _files(package, tree.name, wanted))
    return Stub(folder, tuple(leaf.name for leaf in wanted), left_out)


def _files(package: str, tree: str, leaves: Sequence[StubLeaf]) -> dict[str, str]:
    """The texts of the package by their paths in it."""
    modules = _modules(leaves)
    kinds = {leaf.name: class_name(leaf.name) for leaf in leaves}
    entries = [
        f'{toml_key(leaf.name)} = "{package}.{modules[leaf.name]}:{kinds[leaf.name]}"'
        for leaf in leaves
    ]
    files = {leaf.name: f"src/{package}/{modules[leaf.name]}.py" for leaf in leaves}
    skills = [f'    "{leaf.name}",' for leaf in leaves]
    words = {
        "package": package,
        "distribution": package.replace("_", "-"),
        "tree": tree,
        "entries": "\n".join(entries),
        "names": "\n".join(skills),
        "listed": "\n".join(f"- `{name}`: `{path}`" for name, path in files.items()),
    }
    found = {
        "pyproject.toml": _filled("stub_pyproject.toml", words),
        "README.md": _filled("stub_readme.md", words),
        f"src/{package}/__init__.py": f'"""Skills for the leaves of {tree}."""\n',
        "tests/test_stubs.py": _filled("stub_test.py", words),
    }
    found |= {files[leaf.name]: _module(leaf, kinds[leaf.name]) for leaf in leaves}
    return found


def _modules(leaves: Sequence[StubLeaf]) -> dict[str, str]:
    """A module for each leaf; names that fold to the same module get a number."""
    found: dict[str, str] = {}
    for leaf in leaves:
        wanted = module = module_name(leaf.name)
        number = 2
        while module in found.values():
            module, number = f"{wanted}_{number}", number + 1
        found[leaf.name] = module
    return found


def _module(leaf: StubLeaf, kind: str) -> str:
    ports = ports_of(leaf)
    plain = [port for port in ports if _is_attribute(port.name)]
    further = [port for port in ports if not _is_attribute(port.name)]
    lines = [_port(port) for port in plain]
    after = [_port_apart(kind, port) for port in further]
    imports = ["Failure", *(["In"] if _has(plain, "in") else [])]
    imports += [*(["Out"] if _has(plain, "out") else []), "Robot", "Run", "Skill"]
    where = ", ".join(leaf.lines[:5]) + (", …" if len(leaf.lines) > 5 else "")
    words = {
        "name": leaf.name,
        "kind": kind,
        "imports": ", ".join(imports),
        "ports": "".join(f"    {line}\n" for line in lines),
        "apart": "".join(f"\n{line}\n" for line in after),
        "more": "from momantu_bt.skill import MISSING, Port\n" if further else "",
        "where": where,
    }
    return _filled("stub_skill.py", words)


def _has(ports: Sequence[StubPort], direction: str) -> bool:
    return any(port.direction == direction for port in ports)


def _is_attribute(name: str) -> bool:
    """Whether a port can be declared as an attribute of the class."""
    taken = hasattr(Skill, name) or name in ("clock", "random", "frames", "site", "port_values")
    taken = taken or name in ("services", "robot", "self") or name.startswith("__")
    return name.isidentifier() and not keyword.iskeyword(name) and not taken


def _port(port: StubPort) -> str:
    if port.direction == "out":
        return f"{port.name}: {port.type} = Out(doc={_text(port.doc)})"
    default = "" if port.default is None else f"{port.default}, "
    return f"{port.name}: {port.type} = In({default}doc={_text(port.doc)})"


def _port_apart(kind: str, port: StubPort) -> str:
    """A port whose name cannot be an attribute: `self.port_values["class"]` is its value."""
    default = "MISSING" if port.default is None else port.default
    made = f"Port({port.name!r}, {port.direction!r}, {port.type}, {_text(port.doc)}, {default})"
    return f"{kind}.ports = {{**{kind}.ports, {port.name!r}: {made}}}"


def _text(text: str) -> str:
    return repr(NOT_TEXT.sub(" ", text)[:200] or "a port")


def _filled(template: str, words: dict[str, str]) -> str:
    return Template((_HERE / f"{template}.txt").read_text(encoding="utf-8")).substitute(words)
