"""Write docs/tunables.md: everything that a site can set, from what services and skills declare.

After you change a tunable, run `.venv/bin/python setup/tunables.py`. A test says when the page is
out of date.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from momantu_bt.descriptions.tunables import TUNABLES, Tunables, groups_of, tunables_of

PAGE = Path(__file__).resolve().parent.parent / "docs" / "tunables.md"
HEAD = """# Tunables

Everything that a world file can set of the services and skills that come along, at
`site.services`:

```yaml
site:
  services:
    navigate:
      speed: 0.5 m/s
      controller: {samples: 600, weights: {nearness: 2}}
    localization: {hit_sigma: 8 cm}
```

A number without a unit has the unit of the table. A name that does not exist, a wrong unit and a
value out of range are errors at their line of the file:

```
momantu-bt worlds check my_flat.yaml
```

Tunables of a skill or service of your own: see [the API](api.md#tunables). `setup/tunables.py`
writes this page.
"""


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")


def page() -> str:
    """The page for what is installed of this project."""
    parts = [HEAD]
    for name in TUNABLES:
        if TUNABLES.installed()[name].module.startswith("momantu_"):
            parts += _section(name, TUNABLES.load(name), 2)
    return "\n".join(parts)


def _section(name: str, kind: type[Tunables], level: int) -> Iterator[str]:
    about = (kind.__doc__ or "").split("\n\n")[0].replace("\n", " ")
    yield f"{'#' * level} `{name}`\n\n{' '.join(about.split())}\n"
    yield "| name | default | unit | range | meaning |\n|---|---|---|---|---|"
    for each in tunables_of(kind):
        cells = (f"`{each.name}`", each.default, each.unit, each.range, each.meaning)
        yield f"| {' | '.join(cells)} |"
    yield ""
    for group, inner in groups_of(kind):
        yield from _section(f"{name}.{group}", inner, level + 1)


if __name__ == "__main__":
    main()
