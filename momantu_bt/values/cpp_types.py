"""Our names for the C++ types that models of BehaviorTree.CPP give to ports."""

from __future__ import annotations

import re

from momantu_bt.values.kinds import ValueType
from momantu_bt.values.types import parse_type

_NAMES = {
    "std::string": "text",
    "BT::StringView": "text",
    "double": "number",
    "float": "number",
    "BT::AnyTypeAllowed": "any",
    "BT::Any": "any",
}
_INT = re.compile(r"(unsigned )?(int|short|char|long|long long|unsigned)|u?int\d+_t|size_t")
_LIST = re.compile(r"std::(?:vector|deque|list)<([^<>,]+)(?:,.*)?>")


def our_type(name: str) -> str:
    """Our name of a type; `any` for a C++ type that we do not have."""
    name = name.strip()
    listed = _LIST.fullmatch(name)
    if listed is not None:
        inner = our_type(listed[1])
        return "any" if inner == "any" else f"list of {inner}"
    if name in _NAMES:
        return _NAMES[name]
    if _INT.fullmatch(name):
        return "int"
    return name if name and not re.search(r"[:<>]", name) else "any"


def model_type(name: str) -> ValueType:
    """The type that a model's name of a type means; `object` if we do not have the type."""
    try:
        return parse_type(our_type(name))
    except KeyError:
        return object
