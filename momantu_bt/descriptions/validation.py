"""Validation errors of a description file, in words that say what would be right."""

from __future__ import annotations

from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from momantu_bt.descriptions.reading import DescriptionError, KeyProblem, Reading
from momantu_bt.descriptions.wording import said
from momantu_bt.formats.names import nearest
from momantu_bt.formats.places import KeyPath

Model = TypeVar("Model", bound=BaseModel)


def checked(reading: Reading, model: type[Model], error: type[DescriptionError]) -> Model:
    """Validate the values of a file with a pydantic model.

    Raises:
        DescriptionError: values do not fit the model; it lists all problems; of the class `error`.
    """
    try:
        return model.model_validate(reading.plain)
    except ValidationError as trouble:
        found = _Located(reading, model, error.what).problems(trouble)
        raise error(reading.path, reading.text, found) from None


def problems_at(reading: Reading, keys: KeyPath, model: type[BaseModel]) -> list[KeyProblem]:
    """The validation errors of a model for the part of a file at some keys."""
    try:
        model.model_validate(reading.value(keys))
    except ValidationError as trouble:
        return _Located(reading, model, str(keys[-1]), keys).problems(trouble)
    return []


class _Located:
    """Turns pydantic's findings into problems at their places."""

    def __init__(
        self, reading: Reading, model: type[BaseModel], what: str, keys: KeyPath = ()
    ) -> None:
        """keys: they lead to the part of the file that the model validated."""
        self._reading, self._what, self._keys = reading, what, keys
        self._plain = reading.value(keys)
        self._schema: dict[str, Any] = model.model_json_schema()

    def problems(self, error: ValidationError) -> list[KeyProblem]:
        """All problems, without those that only follow from a misspelt key or an inner problem."""
        findings = [(self._place(finding["loc"]), dict(finding)) for finding in error.errors()]
        misspelt = {
            (*place[:-1], self._nearest(str(place[-1]), place[:-1]))
            for place, finding in findings
            if finding["type"] == "extra_forbidden"
        }
        within = {place[:i] for place, _ in findings for i in range(len(place))}
        told = {
            self._problem(place, finding): None
            for place, finding in findings
            if not (finding["type"] == "missing" and place in misspelt)
            and not (finding["type"] == "too_short" and place in within)
        }
        return list(told)

    def _place(self, location: tuple[str | int, ...]) -> KeyPath:
        """The keys of a finding in the file; pydantic also gives names of a union's members."""
        place: list[str | int] = []
        here: Any = self._plain
        for i, part in enumerate(location):
            inside = isinstance(here, dict) and part in here
            inside |= isinstance(here, list) and isinstance(part, int) and part < len(here)
            if inside:
                here = here[part]
                place.append(part)
            elif i == len(location) - 1 and isinstance(here, dict):
                place.append(part)
        return tuple(place)

    def _problem(self, place: KeyPath, finding: dict[str, Any]) -> KeyProblem:
        kind, name = finding["type"], str(place[-1]) if place else ""
        if kind == "extra_forbidden":
            return self._at(place, self._unknown_key(name, place), key=True)
        if kind == "missing" and isinstance(finding["loc"][-1], int):
            values = len(self._value(place))
            message = f"expected more values, found {values}"
            wanted = self._schema_at(place).get("minItems")
            if wanted is not None:
                message = f"expected {wanted} values, found {values}"
            return self._at(place, f"{self._dotted(place)}: {message}")
        if kind == "missing":
            message = f"{self._dotted(place[:-1])} needs a key {name!r}"
            return self._at(place, message, at=place[:-1])
        if kind in ("union_tag_invalid", "union_tag_not_found"):
            return self._unknown_kind(place, finding)
        message = said(finding, self._known_keys(place))
        return self._at(place, f"{self._dotted(place)}: {message}")

    def _at(
        self, place: KeyPath, message: str, *, key: bool = False, at: KeyPath | None = None
    ) -> KeyProblem:
        """A problem of the value at `place` in the part; `at`: show it at another place."""
        whole = (*self._keys, *place)
        where = self._reading.at((*self._keys, *(place if at is None else at)), key=key)
        return KeyProblem("", message, where, keys=whole)

    def _value(self, place: KeyPath) -> Any:
        return self._reading.value((*self._keys, *place))

    def _unknown_kind(self, place: KeyPath, finding: dict[str, Any]) -> KeyProblem:
        """The valid kinds, for a value whose kind is missing or unknown."""
        key = str(finding["ctx"]["discriminator"]).strip("'")
        union = _inner(self._schema_at(place[:-1]), place[-1])
        members = (union, *union.get("anyOf", ()))  # an optional value is a union with None
        mappings = (member.get("discriminator", {}).get("mapping", {}) for member in members)
        kinds = ", ".join(kind for mapping in mappings for kind in mapping)
        given = _item(self._value(place), key)
        if given is None:
            place_of, words = place, f"{self._dotted(place)} needs a key {key!r}"
        else:
            place_of, words = (*place, key), f"{given!r} is not possible here"
        return self._at(place, f"{words}; possible: {kinds}", at=place_of)

    def _dotted(self, place: KeyPath) -> str:
        whole = (*self._keys, *place)
        return ".".join(str(part) for part in whole) or f"the {self._what}"

    def _unknown_key(self, name: str, place: KeyPath) -> str:
        """The valid keys, for an unknown key."""
        near = self._nearest(name, place[:-1])
        hint = f"did you mean {near!r}? Keys" if near else "keys"
        known = ", ".join(self._known_keys(place[:-1]))
        return f"unknown key {name!r} in {self._dotted(place[:-1])}; {hint}: {known}"

    def _nearest(self, name: str, place: KeyPath) -> str:
        return nearest(name, self._known_keys(place)) or ""

    def _known_keys(self, place: KeyPath) -> list[str]:
        return list(self._schema_at(place).get("properties", {}))

    def _schema_at(self, place: KeyPath) -> dict[str, Any]:
        here, data = self._resolved(self._schema, self._plain), self._plain
        for part in place:
            data = _item(data, part)
            here = self._resolved(_inner(here, part), data)
        return here

    def _resolved(self, schema: dict[str, Any], data: Any) -> dict[str, Any]:
        """Resolve a schema: follow references, and choose the meant member of a union."""
        if "$ref" in schema:
            found: dict[str, Any] = self._schema["$defs"][schema["$ref"].rsplit("/", 1)[-1]]
            return found
        members = schema.get("anyOf") or schema.get("oneOf") or ()
        mapping = schema.get("discriminator", {})
        if mapping and isinstance(data, dict):
            chosen = mapping.get("mapping", {}).get(data.get(mapping["propertyName"]))
            members = [{"$ref": chosen}] if chosen is not None else ()
        objects = [self._resolved(m, data) for m in members]
        fitting = (m for m in objects if "properties" in m or "prefixItems" in m)
        return next(fitting, schema)


def _inner(schema: dict[str, Any], part: str | int) -> dict[str, Any]:
    """The schema of the value under a key or an index."""
    candidates = [schema.get("properties", {}).get(part)]
    candidates += schema.get("patternProperties", {}).values()
    candidates += [schema.get("additionalProperties"), schema.get("items")]
    return next((each for each in candidates if isinstance(each, dict)), {})


def _item(data: Any, part: str | int) -> Any:
    if isinstance(data, dict):
        return data.get(part)
    return data[part] if isinstance(data, list) and isinstance(part, int) else None
