"""The metadata of a COLLADA file: its up axis, its unit, the names of its nodes.

The library that reads the triangles trusts its input, so files that would never end are rejected
here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

import numpy as np

from momantu_bt.geometry import Array

Z_FROM: Mapping[str, Array] = {
    "X_UP": np.array([(0.0, -1.0, 0.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)]),
    "Y_UP": np.array([(1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)]),
    "Z_UP": np.eye(3),
}
"""Rotations to z up; x stays to the right (COLLADA 1.4.1, table of <up_axis>)."""
MOST_DEPTH = 100
MOST_INSTANCES = 20_000
"""Most geometries in the scene, counted as often as they are used."""


class BadMesh(Exception):
    """A mesh file cannot be used; the message says why."""


@dataclass(slots=True)
class ColladaNotes:
    """up: as in the file; empty if not given. meter: length of one unit.

    names: ids of the geometries that a node, or a geometry, of a name shows.
    """

    up: str = ""
    meter: float = 1.0
    names: dict[str, set[str]] = field(default_factory=dict)


def collada_notes(file: Path) -> ColladaNotes:
    """Read them.

    Raises:
        BadMesh: it is not XML, declares entities, or its scene multiplies beyond bounds.
    """
    reader = _Reader()
    try:
        with file.open("rb") as stream:
            reader.parser.ParseFile(stream)
    except expat.ExpatError as error:
        raise BadMesh(f"line {error.lineno} is not XML: {expat.ErrorString(error.code)}") from None
    reader.count_instances()
    return reader.notes


class _Reader:
    """Follows expat through the file; keeps only the metadata."""

    def __init__(self) -> None:
        self.notes = ColladaNotes()
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._characters
        self.parser.EntityDeclHandler = self._entity
        self._tags: list[str] = []
        self._nodes: list[str] = []
        self._shows: dict[str, list[str]] = {}
        self._uses: dict[str, list[str]] = {}

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        tag = tag.rpartition(":")[2]
        self._tags.append(tag)
        if len(self._tags) > MOST_DEPTH:
            raise BadMesh(f"more than {MOST_DEPTH} elements within each other")
        if tag == "unit" and "meter" in attributes:
            self._unit(attributes["meter"])
        elif tag == "geometry":
            identity = attributes.get("id", "")
            for name in (identity, attributes.get("name", "")):
                self.notes.names.setdefault(name, set()).add(identity)
        elif tag == "node":
            self._node(attributes)
        elif tag in ("instance_geometry", "instance_node", "instance_controller"):
            self._instance(tag, attributes.get("url", "").removeprefix("#"))

    def _node(self, attributes: dict[str, str]) -> None:
        identity = attributes.get("id") or f"node {len(self._shows)}"
        if self._nodes:
            self._uses[self._nodes[-1]].append(identity)
        self._shows.setdefault(identity, [])
        self._uses.setdefault(identity, [])
        self._nodes.append(identity)
        if name := attributes.get("name"):
            self._shows.setdefault(name, self._shows[identity])

    def _instance(self, tag: str, url: str) -> None:
        if self._nodes:
            (self._uses if tag == "instance_node" else self._shows)[self._nodes[-1]].append(url)

    def _unit(self, text: str) -> None:
        try:
            meter = float(text)
        except ValueError:
            meter = 0.0
        if not 1e-6 < meter < 1e6:
            raise BadMesh(f"its unit is {text!r} m; expected a number above 0")
        self.notes.meter = meter

    def _end(self, tag: str) -> None:
        self._tags.pop()
        if tag.rpartition(":")[2] == "node":
            self._nodes.pop()

    def _characters(self, text: str) -> None:
        if self._tags[-1] == "up_axis":
            self.notes.up = (self.notes.up + text).strip()

    def _entity(self, *_: object) -> None:
        raise BadMesh("it declares entities of its own")

    def count_instances(self) -> None:
        """Store the names of nodes; reject scenes that include themselves or are too large."""
        if self.notes.up and self.notes.up not in Z_FROM:
            raise BadMesh(f"its <up_axis> is {self.notes.up!r}; expected X_UP, Y_UP or Z_UP")
        for name, shown in self._shows.items():
            self.notes.names.setdefault(name, set()).update(shown)
        totals: dict[str, int] = {}
        for identity in self._uses:
            self._total(identity, totals)
        if sum(totals.values()) > MOST_INSTANCES:
            raise BadMesh(f"its scene shows more than {MOST_INSTANCES} geometries")

    def _total(self, identity: str, totals: dict[str, int]) -> None:
        """Number of geometries that a node shows, with all nodes it uses; without recursion."""
        waiting, open_nodes = [identity], set[str]()
        while waiting:
            here = waiting[-1]
            inner = [use for use in self._uses.get(here, ()) if use in self._uses]
            missing = [use for use in inner if use not in totals]
            if here in totals:
                waiting.pop()
            elif here in open_nodes and missing:
                raise BadMesh(f"its node {here!r} uses itself")
            elif missing:
                open_nodes.add(here)
                waiting += missing
            else:
                totals[here] = len(self._shows.get(here, ())) + sum(totals[use] for use in inner)
                waiting.pop()
