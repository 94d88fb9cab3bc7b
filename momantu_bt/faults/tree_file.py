"""Read the fault rows of one tree: `my_tree.faults.yaml` beside `my_tree.yaml`; its JSON Schema.

momantu_bt: 1
begins:                        # when a fault begins in this tree, unless @PHASE says otherwise
  gripper.slips: Serve/dock+2 s
rows:                          # what `bench --faults` runs besides
  - camera.dead@Serve/scan:for=inf
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from momantu_bt.descriptions.schema import DIALECT
from momantu_bt.fault import FaultError
from momantu_bt.fault_kind import Where
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.phase import FORMS, START, parse_phase
from momantu_bt.faults.phases import check_phase
from momantu_bt.faults.spec import FORM, FaultSyntaxError, parse_fault
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import errors
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.files.lookup import FAULTS_SUFFIX, SUFFIXES, TreeNotFound, faults_file
from momantu_bt.tree.files.port_values import drop_duplicates
from momantu_bt.tree.files.side_file import top_values
from momantu_bt.tree.files.syntax import compose
from momantu_bt.tree.files.text import read_text
from momantu_bt.tree.language import VERSION
from momantu_bt.tree.model import Document
from momantu_bt.tree.problems import Problems, TreeError
from momantu_bt.tree.substitute.substitution import Substitution


@dataclass(frozen=True, slots=True)
class TreeFaults:
    """The fault rows and phases of one tree.

    begins: phases by the fault's name. rows: faults as they are written, for a bench of all faults.
    """

    begins: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    rows: tuple[str, ...] = ()


def tree_faults(document: Document) -> TreeFaults:
    """The file of faults beside the document's main file; empty if there is none.

    Raises:
        TreeError: the file has errors; the exception holds all of them.
        TreeNotFound: the file cannot be opened.
    """
    source, problems, found = faults_source(document), Problems(), TreeFaults()
    for name, text in source.items():
        try:
            found = _read(compose(text, name), document, problems)
        except YamlSyntaxError as error:
            raise TreeError([error.problem], source) from None
    if errors(problems.sorted()):
        raise TreeError(problems.sorted(), source)
    return found


def faults_source(document: Document) -> Mapping[str, str]:
    """The file of faults beside a document's main file: its text by its name; empty if none.

    Raises:
        TreeNotFound, TreeError: the file cannot be opened, or is not UTF-8.
    """
    path = faults_file(Path(document.file))
    return {str(path): read_text(path, str(path))} if path.is_file() else {}


def tree_beside(path: Path) -> Path:
    """The tree file that a file of faults belongs to.

    Raises:
        TreeNotFound: there is no such tree.
    """
    stem = path.name.removesuffix(FAULTS_SUFFIX)
    beside = [path.with_name(f"{stem}{suffix}") for suffix in SUFFIXES]
    found = next((file for file in beside if file.is_file()), None)
    if found is None:
        raise TreeNotFound(f"{path} tells of faults in {beside[0].name}, which is not beside it")
    return found


def _read(raw: Raw, document: Document, problems: Problems) -> TreeFaults:
    having = top_values(raw, ("begins", "rows"), "a file of faults", problems)
    if having is None:
        return TreeFaults()
    begins = _begins(having.get("begins"), document, problems)
    return TreeFaults(begins, _rows(having.get("rows"), document, problems))


def _begins(raw: Raw | None, document: Document, problems: Problems) -> Mapping[str, str]:
    if raw is None:
        return {}
    if not isinstance(raw, Entries):
        hint = "such as `camera.dead: Serve/scan`"
        problems.error("wrong-value", raw.place, "`begins` is a mapping of faults to phases", hint)
        return {}
    drop_duplicates(raw, problems)
    found = {}
    for key, value in raw.entries:
        kind = kinds().get(key.text)
        if kind is None:
            hint = valid_names(key.text, kinds(), "faults")
            problems.error("unknown-key", key.place, f"no fault is called {key.text!r}", hint)
        elif kind.place is Where.SITE:
            message = f"{key.text} is so from the start on; it takes no phase"
            problems.error("unknown-key", key.place, message, "leave it out")
        elif not isinstance(value, Scalar):
            problems.error("wrong-value", value.place, "expected one phase", f"such as `{START}`")
        elif _is_phase(value.text, value.place, document, problems):
            found[key.text] = value.text
    return MappingProxyType(found)


def _is_phase(text: str, place: Place, document: Document, problems: Problems) -> bool:
    try:
        parse_phase(text)
        check_phase(text, document, Substitution())
    except (ValueError, FaultError) as error:
        problems.error("wrong-value", place, str(error))
        return False
    return True


def _rows(raw: Raw | None, document: Document, problems: Problems) -> tuple[str, ...]:
    if raw is None:
        return ()
    if not isinstance(raw, Items):
        hint = "such as `- camera.dead@12 s:for=inf`"
        problems.error("wrong-value", raw.place, "`rows` is a list of faults", hint)
        return ()
    found = []
    for item in raw.items:
        if not isinstance(item, Scalar):
            problems.error("wrong-value", item.place, "a row is one fault, as `--fault` takes it")
        elif _is_fault(item, document, problems):
            found.append(item.text)
    return tuple(found)


def _is_fault(item: Scalar, document: Document, problems: Problems) -> bool:
    place = item.place
    try:
        fault = parse_fault(item.text)
    except FaultSyntaxError as error:
        length = max(1, error.end - error.begin)
        place = Place(place.file, place.line, place.column + item.quoted + error.begin, length)
        problems.error("wrong-value", place, error.reason)
        return False
    return fault.phase is None or _is_phase(fault.phase, place, document, problems)


def faults_schema() -> dict[str, Any]:
    """The schema of `my_tree.faults.yaml`, with the faults that are installed."""
    phases = {
        name: {"type": "string", "description": f"{kind.doc} It begins at: {FORMS}"}
        for name, kind in kinds().items()
        if kind.place is not Where.SITE
    }
    return {
        "$schema": DIALECT,
        "title": "momantu-bt file of faults beside a tree",
        "type": "object",
        "properties": {
            "momantu_bt": {"const": VERSION, "description": "the version of the language"},
            "begins": {
                "type": "object",
                "description": "when faults begin in this tree",
                "properties": phases,
                "additionalProperties": False,
            },
            "rows": {
                "type": "array",
                "description": "faults that `bench --faults` runs besides",
                "items": {"type": "string", "description": FORM},
            },
        },
        "required": ["momantu_bt"],
        "additionalProperties": False,
    }
