"""`COMPONENT.MODE[@PHASE][:name=value,name=value]` as a Fault, and back."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from types import MappingProxyType

from momantu_bt.fault import Fault, FaultError, FaultParameter
from momantu_bt.fault_kind import FOR, FaultKind
from momantu_bt.faults.kinds.catalogue import kinds
from momantu_bt.faults.phase import parse_phase
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import underlined
from momantu_bt.skill import Port
from momantu_bt.values.convert import convert
from momantu_bt.values.types import label
from momantu_bt.values.words import ConversionError

FORM = "COMPONENT.MODE[@PHASE][:name=value,name=value]"
_FOREVER = ("inf", "for good")
_SIGN = re.compile(r"[@:]")


class FaultSyntaxError(FaultError):
    """A text is not a fault; the message shows it with a caret under what is wrong.

    begin, end: the wrong part of the text. reason: why it is wrong, and what would be valid.
    """

    def __init__(self, text: str, begin: int, end: int, reason: str) -> None:
        stretch = text[begin:end]
        begin += len(stretch) - len(stretch.lstrip())
        length = len(stretch.strip())
        shown, carets = underlined(text, begin, length)
        super().__init__(f"a fault is not right\n  {shown}\n  {carets} {reason}")
        self.begin, self.end, self.reason = begin, begin + length, reason


def parse_fault(text: str) -> Fault:
    """Read a written fault, and fill in its defaults.

    Raises:
        FaultSyntaxError: this is not a fault; the message shows what is wrong and what is valid.
    """
    sign = _SIGN.search(text)
    end = len(text) if sign is None else sign.start()
    kind = _kind(text, end)
    phase, rest = None, end
    if text[end : end + 1] == "@":
        rest = text.find(":", end)
        rest = len(text) if rest < 0 else rest
        phase = text[end + 1 : rest].strip()
        try:
            parse_phase(phase)
        except ValueError as error:
            raise FaultSyntaxError(text, end + 1, rest, str(error)) from None
    given = _parameters(text, rest + 1, kind) if rest < len(text) else {}
    parameters = MappingProxyType({**kind.defaults, **given})
    return Fault(kind.component, kind.mode, phase, parameters)


def format_fault(fault: Fault) -> str:
    """The shortest text that means the fault; its numbers are in SI units."""
    kind = kinds()[fault.name]
    changed = [
        f"{name}={_written(value)}"
        for name, value in fault.parameters.items()
        if value != kind.defaults.get(name)
    ]
    phase = "" if fault.phase is None else f"@{fault.phase}"
    return fault.name + phase + (":" + ",".join(changed) if changed else "")


def _written(value: FaultParameter) -> str:
    return repr(value) if isinstance(value, float) else str(value)


def _kind(text: str, end: int) -> FaultKind:
    name = text[:end].strip()
    having = kinds()
    found = having.get(name)
    if found is not None:
        return found
    component, dot, mode = name.partition(".")
    modes = [kind.mode for kind in having.values() if kind.component == component]
    if not modes:
        known = list(dict.fromkeys(kind.component for kind in having.values()))
        hint = valid_names(component, known, "components")
        if component in (kind.mode for kind in having.values()) and not dot:
            whole = [name for name in having if name.endswith(f".{component}")]
            hint = f"did you mean {' or '.join(whole)}?"
        raise FaultSyntaxError(
            text, 0, len(component), f"no component is called {component!r}; {hint}"
        )
    if not dot:
        message = f"expected {FORM}; modes of {component}: {', '.join(modes)}"
        raise FaultSyntaxError(text, end, end + 1, message)
    hint = valid_names(mode, modes, f"modes of {component}")
    raise FaultSyntaxError(
        text, len(component) + 1, end, f"{component} has no mode {mode!r}; {hint}"
    )


def _parameters(text: str, begin: int, kind: FaultKind) -> Mapping[str, FaultParameter]:
    ports = {port.name: port for port in kind.parameters}
    found: dict[str, FaultParameter] = {}
    for piece in text[begin:].split(","):
        end = begin + len(piece)
        written, equals, value = piece.partition("=")
        name = written.strip()
        if name not in ports:
            hint = valid_names(name, ports, "parameters") if ports else "it takes none"
            message = f"{kind.name} has no parameter {name!r}; {hint}"
            raise FaultSyntaxError(text, begin, begin + len(written), message)
        if not equals:
            raise FaultSyntaxError(
                text, begin, end, f"expected {name}=VALUE, {_expected(ports[name])}"
            )
        if name in found:
            raise FaultSyntaxError(text, begin, end, f"{name} is given twice")
        try:
            found[name] = _value(value.strip(), ports[name])
        except ConversionError as error:
            raise FaultSyntaxError(
                text, begin + len(written) + 1, end, f"{name}: {error}"
            ) from None
        begin = end + 1
    return found


def _value(text: str, port: Port) -> FaultParameter:
    if port.name == FOR and text in _FOREVER:
        return math.inf
    value: FaultParameter = convert(text, port)
    return value


def _expected(port: Port) -> str:
    unit = "" if port.unit is None else f" in {port.unit}"
    return (
        f"a {label(port.type)}{unit}"
        + (f", {port.bounds}" if port.bounded else "")
        + f": {port.doc}"
    )
