"""Namespaces: one prefix for every name of a part, wherever the part uses it."""

from __future__ import annotations

from collections.abc import Iterator

from lxml import etree


def add_namespace(root: etree._Element, namespace: str) -> None:
    """Rename every link, joint and material of a URDF in place."""
    for element, attribute in _names(root):
        element.set(attribute, f"{namespace}_{element.get(attribute)}")


def _names(root: etree._Element) -> Iterator[tuple[etree._Element, str]]:
    """Every place where a URDF defines or uses a name: (element, attribute)."""
    for tag in ("link", "joint", "material"):
        for element in root.findall(tag):
            yield element, "name"
    for joint in root.findall("joint"):
        for tag, attribute in (("parent", "link"), ("child", "link"), ("mimic", "joint")):
            for element in joint.findall(tag):
                yield element, attribute
    for material in root.findall("link/visual/material"):
        if material.get("name"):
            yield material, "name"
