"""docs/tunables.md lists every tunable as it is declared, and its example is right."""

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest
from ruamel.yaml import YAML

from momantu_bt.descriptions.tunables import TUNABLES, configured, groups_of, tunables_of

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("tunables", ROOT / "setup" / "tunables.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_that_of_the_declarations(generator: ModuleType) -> None:
    page = generator.PAGE.read_text(encoding="utf-8")
    assert page == generator.page(), "run `.venv/bin/python setup/tunables.py`"


@pytest.mark.parametrize("name", sorted(TUNABLES))
def test_every_tunable_says_what_it_means(name: str) -> None:
    kinds = [TUNABLES.load(name)]
    for kind in kinds:
        kinds += [inner for _, inner in groups_of(kind)]
        silent = [each.name for each in tunables_of(kind) if not each.meaning]
        assert silent == []


def test_the_pages_example_can_be_set(generator: ModuleType) -> None:
    example = re.search(r"```yaml\n(.*?)```", generator.page(), flags=re.S)
    assert example is not None
    services = YAML(typ="safe").load(example[1])["site"]["services"]
    for name, parameters in services.items():
        configured(TUNABLES.load(name), parameters, name)
