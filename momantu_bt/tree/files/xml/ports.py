"""The attributes of one node element: ports, conditions, name and notes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from momantu_bt.formats.names import nearest, valid_names
from momantu_bt.formats.places import Place
from momantu_bt.formats.units import UnitError, in_unit
from momantu_bt.formats.xml.elements import Attribute, Element
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import (
    AUTOREMAP,
    EXPLICIT,
    MODIFIERS,
    SUBTREE,
    XML_CONDITIONS,
    NodeSpec,
)
from momantu_bt.tree.files.port_values import KEY
from momantu_bt.tree.files.syntax import OURS
from momantu_bt.tree.files.xml.values import WireError, attribute_value, flow_value
from momantu_bt.tree.model import (
    BROKEN,
    FIRST_INPUT,
    Literal,
    Node,
    PortDeclaration,
    PortValue,
    Reference,
    Scope,
)
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.script import ScriptSyntaxError, parse
from momantu_bt.values.kinds import ScriptText, ValueType
from momantu_bt.values.types import parse_type

PREFIX = "momantu:"
"""Of our own nodes in an ID."""
CATCH = "Catch"

DISABLED, NOTE, DESCRIPTION = "disabled", "note", "_description"
_CONDITIONS = {theirs: ours for ours, theirs in XML_CONDITIONS.items()}
RESERVED = ("ID", "name", DESCRIPTION, AUTOREMAP, *_CONDITIONS)
_BOOLS = {"true": True, "1": True, "false": False, "0": False}

TypeOf = Callable[[str], ValueType]


@dataclass(slots=True)
class PortReader:
    """Reads the attributes of an element into its node."""

    node: Node
    element: Element
    problems: Problems
    spec: NodeSpec | None = None
    _plain: dict[str, str] = field(default_factory=dict)
    """The ports of a built-in node, by the attribute that BehaviorTree.CPP has for them."""

    def of_spec(self, spec: NodeSpec) -> None:
        """Read a built-in node: it has only its own attributes."""
        self.spec = spec
        names = {spec.xml.get(port, port): port for port in spec.ports}
        self._plain = {name: port for name, port in names.items() if name}
        self._read(lambda port: spec.ports[port].type if port in spec.ports else object)
        self._one_time()

    def of_skill(self, ports: Mapping[str, Port] | None) -> None:
        """Read a skill, or an unknown node for None."""
        known = ports or {}
        self._read(lambda port: known[port].type if port in known else object)

    def of_tree(self, ports: Mapping[str, PortDeclaration]) -> None:
        """Read a node that runs a tree."""
        self._read(lambda port: _declared_type(ports[port]) if port in ports else object)

    def _error(self, code: str, place: Place, message: str, hint: str = "") -> None:
        self.problems.error(code, place, message, hint)

    def apart(self, name: str, element: Element) -> None:
        """Read a port whose name cannot be an attribute: `<momantu:Port name="a b">5</…>`."""
        place = element.text_place or element.place
        value = flow_value(element.text.strip(), name, place, self.problems)
        if name in self.node.ports:
            message = f"{name!r} is given twice"
            self._error("duplicate-key", element.place, message, "remove one")
            return
        self.node.ports[name] = Reference(BROKEN) if value is None else value
        self.node.port_places[name] = place
        self.node.port_name_places[name] = place if name == FIRST_INPUT else element.place

    def _read(self, type_of: TypeOf) -> None:
        for attribute in self.element.attributes:
            if attribute.space == OURS:
                self._own(attribute)
                continue
            with self.problems.keeping():
                if attribute.space:
                    message = f"{attribute.name!r} of the namespace {attribute.space!r}"
                    message += " has no meaning"
                    self._error("unknown-port", attribute.name_place, message, "remove it")
                elif attribute.name.startswith("_") or attribute.name in RESERVED:
                    self._reserved(attribute)
                else:
                    self._port(attribute, type_of)

    # not ports

    def _reserved(self, attribute: Attribute) -> None:
        name, value = attribute.name, attribute.value
        if name == "name":
            self.node.name = value or None
        elif name == DESCRIPTION:
            self.node.note = value or None
        elif name in _CONDITIONS:
            self._condition(_CONDITIONS[name], attribute)
        elif name == AUTOREMAP and self.node.target is not None:
            self._keep(name, attribute, self._flag(attribute))
        elif name == "ID" and self.element.name in (SUBTREE, *EXPLICIT):
            return
        else:
            self._report_slip(attribute)

    def _report_slip(self, attribute: Attribute) -> None:
        """Report an attribute that is almost one with a meaning.

        Others that begin with `_` are what editors and other programs keep for themselves.
        """
        known = [*_CONDITIONS, DESCRIPTION]
        known += [AUTOREMAP] if self.node.target is not None else []
        near = nearest(attribute.name, known)
        if near is None and attribute.name != "ID":
            return
        hint = f"did you mean {near}?" if near else "remove it"
        message = f"no attribute is called {attribute.name!r}"
        self._error("unknown-modifier", attribute.name_place, message, hint)

    def _condition(self, name: str, attribute: Attribute) -> None:
        if self._script(attribute):
            self.node.conditions[name] = attribute.value
            self.node.condition_places[name] = attribute.place

    def _script(self, attribute: Attribute) -> bool:
        """Whether it is a script. If it is wrong, report the problem."""
        try:
            parse(attribute.value)
        except ScriptSyntaxError as error:
            place = attribute.place
            if place.length == len(attribute.value) and error.offset < place.length:
                column = place.column + error.offset
                place = Place(place.file, place.line, column, error.length)
            self._error("script", place, error.message, error.hint)
            return False
        return True

    def _flag(self, attribute: Attribute) -> bool:
        found = _BOOLS.get(attribute.value.lower())
        if found is None:
            message = f"{attribute.name!r} is true or false"
            self._error("wrong-value", attribute.place, message, 'write "true" or "false"')
        return bool(found)

    def _own(self, attribute: Attribute) -> None:
        name = attribute.name
        if name == DISABLED:
            self.node.disabled = self._flag(attribute)
        elif name == NOTE:
            self.node.note = attribute.value or None
        elif self.spec is not None and name not in self.spec.ports:
            self._unknown_port(attribute, [DISABLED, NOTE, *self.spec.ports])
        else:
            value = self._ours(name, attribute)
            self._put(name, attribute, Reference(BROKEN) if value is None else value)

    def _ours(self, name: str, attribute: Attribute) -> PortValue | None:
        if self.spec is not None and self.spec.ports[name].type is ScriptText:
            message = f"{name!r} is a script, which stands in the plain attribute"
            self._error("script", attribute.name_place, message, f'write {name}="…"')
            return None
        return flow_value(attribute.value, name, attribute.place, self.problems)

    # ports

    def _port(self, attribute: Attribute, type_of: TypeOf) -> None:
        name = attribute.name
        if self.spec is not None:
            if name not in self._plain:
                self._unknown_port(attribute, list(self._plain))
                return
            name = self._plain[name]
        bare = attribute.value.removeprefix("@")
        if self.spec is not None and name in self.spec.keys and KEY.fullmatch(bare):
            scope = Scope.LOCAL if bare == attribute.value else Scope.ROOT
            self._put(name, attribute, Reference(bare, scope=scope))
            return
        if self.spec is not None and names_key(self.spec, name) and attribute.value[:1] == "{":
            self._keep_places(name, attribute)
            self.node.ports[name] = Reference(BROKEN)
            message = f"{attribute.value} would be the key whose name {attribute.value} holds"
            hint = f'write {attribute.name}="{attribute.value.strip("{}")}" for that key itself'
            self._error("not-a-key", attribute.place, message, hint)
            return
        type_ = type_of(name)
        if type_ is ScriptText:
            self._keep_places(name, attribute)
            if self._script(attribute):
                self.node.ports[name] = Literal(attribute.value)
            return
        try:
            value: PortValue = attribute_value(attribute.value, name, type_)
        except WireError as error:
            hint = f'a part of a value or a text is written momantu:{name}="…"'
            self._error("not-a-key", attribute.place, str(error), hint)
            value = Reference(BROKEN)
        self._put(name, attribute, value)

    def _unknown_port(self, attribute: Attribute, known: list[str]) -> None:
        name, said = attribute.name, self.element.said
        message = f"{said} has no port {name!r}"
        near = nearest(name, known)
        if self.spec is not None and name in self.spec.ports and self.spec.xml.get(name) == "":
            hint = f"write momantu:{name}, which only we have"
        elif self.spec is not None and name in self.spec.ports and name not in known:
            hint = f"did you mean {self.spec.xml[name]}?"
        elif near is None and name in MODIFIERS:
            hint = "decorators are elements around the node, conditions such as _skipIf attributes"
        else:
            hint = valid_names(name, known, "ports") if known else f"{said} has no ports"
        self._error("unknown-port", attribute.name_place, message, hint)
        meant = self._plain.get(near, near) if near is not None else name
        if self.spec is not None and meant in self.spec.ports:  # do not report it as missing too
            self._keep_places(meant, attribute)

    def _put(self, name: str, attribute: Attribute, value: PortValue) -> None:
        if name in self.node.ports:
            message = f"{name!r} is given twice, with and without `momantu:`"
            self._error("duplicate-key", attribute.name_place, message, "remove one")
            return
        self.node.ports[name] = value
        self._keep_places(name, attribute)

    def _keep(self, name: str, attribute: Attribute, value: bool) -> None:
        self.node.ports[name] = Literal(value)
        self._keep_places(name, attribute)

    def _keep_places(self, name: str, attribute: Attribute) -> None:
        self.node.port_places[name] = attribute.place
        self.node.port_name_places[name] = attribute.name_place

    def _one_time(self) -> None:
        """Drop `msec` beside `momantu:duration`. Others read it, so it must say the same."""
        ports, places = self.node.ports, self.node.port_places
        duration, msec = ports.get("duration"), ports.get("msec")
        if not (isinstance(duration, Literal) and isinstance(msec, Literal)):
            return
        seconds, milliseconds = _number(duration.value, "s"), _number(msec.value, None)
        if seconds is None or milliseconds is None:
            return  # the checker reports what is wrong with them
        if round(seconds * 1000.0, 6) != milliseconds:
            message = f"{duration.value} is not {msec.value} ms"
            hint = "momantu:duration is what counts here; correct the other one"
            self._error("wrong-value", places["msec"], message, hint)
        for having in (ports, places, self.node.port_name_places):
            having.pop("msec")


def names_key(spec: NodeSpec, port: str) -> bool:
    """Whether BehaviorTree.CPP reads the attribute as a key's name: `output_key="k"` writes k."""
    return port in spec.keys and (port == spec.removes or port in spec.copies)


def _number(value: object, unit: str | None) -> float | None:
    """A number, or a text that is a number in this unit."""
    if isinstance(value, str) and unit is not None:
        try:
            return in_unit(value, unit)
        except UnitError:
            return None
    return float(value) if isinstance(value, int | float) else None


def _declared_type(declaration: PortDeclaration) -> ValueType:
    try:
        return parse_type(declaration.type_name)
    except KeyError:
        return object
