"""Finding something to render with: probed once, remembered, never in the way of what works."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from momantu_worlds.vulkan import apt, choice, install, places, private
from momantu_worlds.vulkan.choice import Choice, VulkanMissingError
from momantu_worlds.vulkan.probe import ProbeResult, Way
from momantu_worlds.vulkan.use import apply

from momantu_bt.formats.cache import CACHE_VARIABLE


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache folder, and no driver named by the environment."""
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.delenv(private.ICD_VARIABLE, raising=False)
    monkeypatch.setenv("LP_NUM_THREADS", "1")
    return tmp_path / "cache"


@pytest.fixture
def library(tmp_path: Path) -> Path:
    """A real shared library to unpack and load: the C library's mathematics.

    A second copy of an extension module may end the process.
    """
    mapped = Path("/proc/self/maps").read_text().splitlines()
    return next(Path(line.split()[-1]) for line in mapped if line.endswith("/libm.so.6"))


def lay_out(library: Path, cache: Path) -> private.PrivateDriver:
    cache.mkdir(exist_ok=True)
    install._lay_out(places.driver_folder(), [library], [], library.name, ["mesa_1"])
    driver = private.installed_driver()
    assert driver is not None
    return driver


def probing(monkeypatch: pytest.MonkeyPatch, works: Way | None) -> list[Way]:
    """Replace the probe by one that finds a device one way alone; the list fills with its calls."""
    calls: list[Way] = []

    def probe(way: Way) -> ProbeResult:
        calls.append(way)
        return ProbeResult("GPU: a card", "") if way is works else ProbeResult("", "no card")

    monkeypatch.setattr(choice, "probe", probe)
    return calls


def test_a_machine_that_renders_is_probed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = probing(monkeypatch, Way.SYSTEM)
    state = choice.machine_state()
    assert choice.remembered(state) is None
    made = choice.choose(state)
    assert choice.remembered(choice.machine_state()) == made == Choice(Way.SYSTEM, "GPU: a card")
    assert calls == [Way.SYSTEM]


def test_another_machine_state_is_not_the_remembered_one(monkeypatch: pytest.MonkeyPatch) -> None:
    probing(monkeypatch, Way.SYSTEM)
    choice.choose(choice.machine_state())
    monkeypatch.setenv("VK_DRIVER_FILES", "/another/driver.json")
    assert choice.remembered(choice.machine_state()) is None


def test_nothing_that_renders_is_an_error_with_a_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    probing(monkeypatch, None)
    with pytest.raises(VulkanMissingError, match="no card.*doctor --fix"):
        choice.choose(choice.machine_state())


def test_the_private_driver_comes_last(
    monkeypatch: pytest.MonkeyPatch, library: Path, cache: Path
) -> None:
    lay_out(library, cache)
    calls = probing(monkeypatch, Way.PRIVATE)
    assert choice.choose(choice.machine_state()).way is Way.PRIVATE
    assert calls == [Way.SYSTEM, Way.SYSTEM_DRIVER, Way.PRIVATE]


def test_choices_that_are_not_json_are_made_again(
    monkeypatch: pytest.MonkeyPatch, cache: Path
) -> None:
    cache.mkdir()
    places.choices_file().write_text("{", encoding="utf-8")
    probing(monkeypatch, Way.SYSTEM)
    state = choice.machine_state()
    assert choice.remembered(state) is None
    choice.choose(state)
    assert choice.remembered(state) is not None


def test_a_cache_that_cannot_be_written_costs_only_the_memory(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "taken").write_text("")
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "taken"))
    probing(monkeypatch, Way.SYSTEM)
    state = choice.machine_state()
    assert choice.choose(state).way is Way.SYSTEM
    assert choice.remembered(state) is None
    with pytest.raises(VulkanMissingError, match="MOMANTU_BT_CACHE"):
        install.install(say=lambda text: None)


def test_few_choices_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    probing(monkeypatch, Way.SYSTEM)
    for number in range(20):
        choice.choose(f"state {number}")
    assert len(json.loads(places.choices_file().read_text())) < 20
    assert choice.remembered("state 19") is not None


def test_an_unpacked_driver_is_found_whole(library: Path, cache: Path) -> None:
    driver = lay_out(library, cache)
    description = json.loads(driver.icd.read_text())
    assert Path(description["ICD"]["library_path"]).is_file(), "the final place, absolute"
    driver.window_libraries[0].unlink()
    assert private.installed_driver() is None, "half a driver is none"


def test_taking_the_private_driver_into_use(
    library: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    driver = lay_out(library, cache)
    apply(Way.PRIVATE)
    assert os.environ[private.ICD_VARIABLE] == str(driver.icd)
    state = choice.machine_state()
    monkeypatch.delenv(private.ICD_VARIABLE)
    assert choice.machine_state() == state, "a child process remembers what its parent chose"


def test_the_machines_driver_is_not_hidden_by_ours(
    library: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    driver = lay_out(library, cache)
    monkeypatch.setenv(private.ICD_VARIABLE, str(driver.icd))
    apply(Way.SYSTEM)
    assert private.ICD_VARIABLE not in os.environ
    monkeypatch.setenv(private.ICD_VARIABLE, "/the/users/own.json")
    apply(Way.SYSTEM)
    assert os.environ[private.ICD_VARIABLE] == "/the/users/own.json"


def test_the_private_way_without_a_private_driver() -> None:
    with pytest.raises(FileNotFoundError, match="not installed"):
        apply(Way.PRIVATE)


def test_a_library_that_cannot_be_loaded_is_said(tmp_path: Path) -> None:
    broken = tmp_path / "libbroken.so"
    broken.write_text("not a library")
    with pytest.raises(OSError, match=r"libbroken\.so"):
        private.preload((broken,))


def test_a_second_recipe_is_tried_after_the_first(
    monkeypatch: pytest.MonkeyPatch, library: Path, cache: Path
) -> None:
    calls = probing(monkeypatch, Way.PRIVATE)

    def unpack(recipe: install.Recipe, system: apt.System) -> None:
        if recipe is install.RECIPES[0]:
            raise apt.AptError("no such package")
        lay_out(library, cache)

    said: list[str] = []
    monkeypatch.setattr(install, "_unpack", unpack)
    monkeypatch.setattr(install, "this_system", lambda: apt.System("debian", "bookworm"))
    assert install.install(said.append).way is Way.PRIVATE
    assert any("no such package" in line for line in said)
    calls.clear()
    assert install.install(said.append).way is Way.PRIVATE
    assert calls == [], "a second set-up has nothing to do"


def test_a_working_driver_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    probing(monkeypatch, Way.SYSTEM)
    monkeypatch.setattr(install, "_unpack", lambda *_: pytest.fail("nothing is to be unpacked"))
    assert install.install(lambda text: None).way is Way.SYSTEM


def test_when_no_recipe_helps_every_reason_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    def unpack(recipe: install.Recipe, system: apt.System) -> None:
        raise apt.AptError(f"{recipe.package} is unknown")

    probing(monkeypatch, None)
    monkeypatch.setattr(install, "_unpack", unpack)
    monkeypatch.setattr(install, "this_system", lambda: apt.System("debian", "bookworm"))
    with pytest.raises(VulkanMissingError) as caught:
        install.install(lambda text: None)
    for recipe in install.RECIPES:
        assert recipe.package in str(caught.value)


TARGETS = """\
mirror:/debian/|bookworm|main
mirror:/debian/|bookworm|main
mirror:/debian/|bookworm-updates|main
mirror:/debian-security/|bookworm-security|main
other:/docker/|bookworm|stable
other:/node/|nodistro|main
"""


def sources(monkeypatch: pytest.MonkeyPatch, targets: str, backports: bool) -> list[str]:
    monkeypatch.setattr(apt, "_output", lambda command: targets)
    return apt._source_lines(apt.System("no-such-system", "bookworm"), backports)


def test_sources_are_the_machines_own(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = sources(monkeypatch, TARGETS, backports=False)
    assert "deb mirror:/debian/ bookworm main" in lines
    assert "deb mirror:/debian-security/ bookworm-security main" in lines
    assert not any("node" in line for line in lines)
    assert len(lines) == len(set(lines))


def test_backports_come_from_where_the_release_comes_from(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = sources(monkeypatch, TARGETS, backports=True)
    assert "deb mirror:/debian/ bookworm-backports main" in lines


def test_a_machine_without_sources_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(apt.AptError, match="bookworm"):
        sources(monkeypatch, "", backports=True)


def test_a_system_without_apt_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(apt.AptError, match="apt-get"):
        apt.this_system()


def test_a_command_that_fails_is_quoted() -> None:
    with pytest.raises(apt.AptError, match="cannot access"):
        apt._output(["ls", "/no/such/folder"], dict(os.environ, LC_ALL="C"))


def test_the_package_needs_nothing_heavy() -> None:
    program = (
        "import sys, momantu_worlds.vulkan.install; "
        "print([m for m in ('sapien', 'torch', 'cv2', 'rich') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
