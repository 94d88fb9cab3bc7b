import importlib
import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from momantu_bt.lazy import lazily, putting_off


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A package `slow_tools` with modules that note in `sys` when they run."""
    folder = tmp_path / "slow_tools"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "saw.py").write_text(
        "import sys\nsys.sawn = getattr(sys, 'sawn', 0) + 1\n"
        "from slow_tools import blade\nTEETH = 24\n"
    )
    (folder / "blade.py").write_text("import sys\nsys.blades = True\n")
    (folder / "broken.py").write_text("raise RuntimeError('no blade')\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "sawn", 0, raising=False)
    monkeypatch.setattr(sys, "blades", False, raising=False)
    yield folder
    for name in [name for name in sys.modules if name.startswith("slow_tools")]:
        del sys.modules[name]


def test_a_module_runs_once_and_when_it_is_first_used(package: Path) -> None:
    with lazily():
        from slow_tools import saw
    assert sys.sawn == 0  # type: ignore[attr-defined]
    assert saw.__name__ == "slow_tools.saw"
    assert saw.__file__ == str(package / "saw.py")
    assert sys.sawn == 0  # type: ignore[attr-defined]
    assert saw.TEETH == 24
    assert saw.TEETH + len(saw.__dict__) > 24
    assert sys.sawn == 1  # type: ignore[attr-defined]


def test_what_a_lazy_module_imports_is_loaded_with_it(package: Path) -> None:
    with lazily():
        from slow_tools import saw

        assert saw.TEETH == 24
        assert sys.blades is True  # type: ignore[attr-defined]


def test_everybody_gets_the_same_module(package: Path) -> None:
    with lazily():
        from slow_tools import saw
    again = importlib.import_module("slow_tools.saw")
    assert again is saw
    assert again.TEETH == 24


def test_a_library_that_is_not_installed_is_told_at_its_first_use() -> None:
    with lazily():
        import no_such_library  # type: ignore[import-not-found]
        import no_such_library.part
        from no_such_library import other
    for use in (
        lambda: no_such_library.saw,
        lambda: no_such_library.part.saw,
        lambda: other.saw,
    ):
        with pytest.raises(ModuleNotFoundError, match="no_such_library"):
            use()
    assert importlib.util.find_spec("no_such_library") is None
    assert not any(name.startswith("no_such_library") for name in sys.modules)


def test_a_module_that_needs_a_library_that_is_not_installed_says_so(package: Path) -> None:
    (package / "needy.py").write_text("import no_such_library\n")
    with lazily():
        from slow_tools import needy

        with pytest.raises(ModuleNotFoundError, match="no_such_library"):
            _ = needy.ANYTHING


def test_a_module_that_an_installed_library_lacks_is_told_at_once(package: Path) -> None:
    with pytest.raises(ModuleNotFoundError, match="axe"), lazily():
        import slow_tools.axe  # type: ignore[import-not-found]  # noqa: F401
    with pytest.raises(ImportError, match="axe"), lazily():
        from slow_tools import axe  # type: ignore[attr-defined]  # noqa: F401


def test_an_error_inside_is_raised_at_each_use(package: Path) -> None:
    with lazily():
        from slow_tools import broken
    for _ in range(2):
        with pytest.raises(RuntimeError, match="no blade"):
            _ = broken.ANYTHING


def test_imports_after_the_block_are_as_usual(package: Path) -> None:
    finders = list(sys.meta_path)
    with lazily():
        pass
    assert sys.meta_path == finders
    importlib.import_module("slow_tools.saw")
    assert sys.sawn == 1  # type: ignore[attr-defined]


def test_a_named_module_is_put_off_whoever_imports_it(package: Path) -> None:
    with putting_off("slow_tools.blade"):
        from slow_tools import saw
    assert saw.TEETH == 24
    assert sys.blades is False  # type: ignore[attr-defined]
    assert saw.blade.sys is sys
    assert sys.blades is True  # type: ignore[attr-defined]


def test_it_is_put_off_also_below_a_module_that_runs_late(package: Path) -> None:
    with putting_off("slow_tools.blade"), lazily():
        from slow_tools import saw

        assert saw.TEETH == 24
        assert sys.blades is False  # type: ignore[attr-defined]


def test_after_the_block_nothing_is_put_off(package: Path) -> None:
    with putting_off("slow_tools.blade"):
        pass
    assert importlib.import_module("slow_tools.saw").TEETH == 24
    assert sys.blades is True  # type: ignore[attr-defined]


def test_a_missing_module_may_be_named(package: Path) -> None:
    with putting_off("slow_tools.none"), pytest.raises(ModuleNotFoundError, match="none"):
        importlib.import_module("slow_tools.none")


def test_a_package_that_is_put_off_runs_after_the_modules_in_it(package: Path) -> None:
    (package / "__init__.py").write_text("import sys\nsys.unpacked = True\nNAME = 'tools'\n")
    sys.unpacked = False  # type: ignore[attr-defined]
    with putting_off("slow_tools", "slow_tools.blade"):
        import slow_tools
        import slow_tools.blade as blade

        importlib.import_module("slow_tools.saw")
    assert sys.unpacked is sys.blades is False  # type: ignore[attr-defined]
    assert blade.sys is sys
    assert sys.blades is True  # type: ignore[attr-defined]
    assert slow_tools.NAME == "tools"
    assert slow_tools.blade is blade
    assert sys.unpacked is True  # type: ignore[attr-defined]
