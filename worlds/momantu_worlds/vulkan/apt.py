"""A private apt state: downloads from the machine's package sources without root.

The machine's own settings say where its packages come from, how it reaches them and which keys it
trusts. Lists, cache and state are in a scratch folder; the system is only read.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

APT_SECONDS = 900.0
"""Longest time of one apt command; a slower mirror is useless."""

_KEYRINGS = "/usr/share/keyrings"
_STATUS = "/var/lib/dpkg/status"
_TOOLS = ("apt-get", "apt-config", "dpkg-deb", "ldd")


class AptError(RuntimeError):
    """Packages cannot be had this way; the message says what was tried and what apt said."""


@dataclass(frozen=True, slots=True)
class System:
    """name: `debian`, `ubuntu` …; codename of the release, such as `bookworm`."""

    name: str
    codename: str


def this_system() -> System:
    """The distribution this machine runs.

    Raises:
        AptError: it does not get its packages with apt.
    """
    missing = [tool for tool in _TOOLS if shutil.which(tool) is None]
    if missing:
        raise AptError(f"this machine has no {' and no '.join(missing)}")
    release: dict[str, str] = {}
    for line in Path("/etc/os-release").read_text(encoding="utf-8").splitlines():
        key, _, value = line.partition("=")
        release[key] = value.strip("\"'")
    if not release.get("VERSION_CODENAME"):
        raise AptError("/etc/os-release names no VERSION_CODENAME")
    return System(release.get("ID", ""), release["VERSION_CODENAME"])


class PrivateApt:
    """apt with lists, cache and state of its own under `folder`, an empty scratch folder."""

    def __init__(self, folder: Path, system: System, backports: bool) -> None:
        """Read the machine's sources and settings.

        Args:
            folder: absolute path of an existing scratch folder.
            system: what to keep of the sources: the release's own.
            backports: add the release's backports, which a plain Debian does not list.

        Raises:
            AptError: the machine names no source of its own release.
        """
        self._folder = folder
        self._downloads = folder / "cache" / "archives"
        (folder / "state" / "lists" / "partial").mkdir(parents=True)
        (self._downloads / "partial").mkdir(parents=True)
        shutil.copyfile(_STATUS, folder / "status")
        sources = "\n".join(_source_lines(system, backports)) + "\n"
        (folder / "sources.list").write_text(sources, encoding="utf-8")
        (folder / "apt.conf").write_text(self._settings(), encoding="utf-8")

    def download(self, packages: Iterable[str], release: str | None) -> list[Path]:
        """Fetch packages and what they need beyond what the machine has; nothing is installed.

        Args:
            packages: names.
            release: prefer this suite's versions, such as `bookworm-backports`; None: the usual.

        Raises:
            AptError: apt refuses; the message has apt's words.
        """
        self._run("update")
        target = [] if release is None else ["-t", release]
        self._run(*target, "--download-only", "--reinstall", "--yes", "install", *packages)
        return sorted(self._downloads.glob("*.deb"))

    def unpack(self, archives: Iterable[Path], root: Path) -> None:
        """Lay packages out under `root` as they would lie under `/`."""
        for archive in archives:
            _output(["dpkg-deb", "-x", str(archive), str(root)])

    def _run(self, *arguments: str) -> str:
        environment = dict(os.environ, APT_CONFIG=str(self._folder / "apt.conf"), LC_ALL="C")
        environment["DEBIAN_FRONTEND"] = "noninteractive"
        return _output(["apt-get", *arguments], environment)

    def _settings(self) -> str:
        """Our folders before the machine's own `Acquire` lines (proxies, certificates)."""
        folder = self._folder
        own = {
            "Dir::State": folder / "state",
            "Dir::State::lists": folder / "state" / "lists",
            "Dir::State::status": folder / "status",
            "Dir::Cache": folder / "cache",
            "Dir::Etc::sourcelist": folder / "sources.list",
            "Dir::Etc::sourceparts": "/dev/null",
            "Dir::Etc::parts": "/dev/null",
            "Dir::Etc::main": "/dev/null",
            "Dir::Etc::preferences": "/dev/null",
            "Dir::Etc::preferencesparts": "/dev/null",
            # The sandbox user of a root's apt could not write in a private folder.
            "APT::Sandbox::User": "",
            "APT::Install-Recommends": "false",
            "Debug::NoLocking": "true",
        }
        lines = [f'{key} "{value}";' for key, value in own.items()]
        dumped = _output(["apt-config", "dump"]).splitlines()
        kept = [line for line in dumped if line.startswith("Acquire::") and '""' not in line]
        return "\n".join([*lines, *kept]) + "\n"


def _source_lines(system: System, backports: bool) -> list[str]:
    """One-line sources of the release itself; third parties' (and their keys) are left out."""
    suites = [system.codename, *(f"{system.codename}-{part}" for part in ("updates", "security"))]
    components: dict[tuple[str, str], list[str]] = {}
    form = "--format=$(REPO_URI)|$(RELEASE)|$(COMPONENT)"
    targets = _output(
        ["apt-get", "indextargets", "--no-release-info", form, "Created-By: Packages"]
    )
    for line in targets.splitlines():
        uri, _, rest = line.partition("|")
        suite, _, component = rest.partition("|")
        having = components.setdefault((uri, suite), []) if suite in suites else []
        if component and component not in having:
            having.append(component)
    own = [uri for uri, suite in components if suite == system.codename]
    if not own:
        raise AptError(f"apt on this machine lists no packages of {system.codename}")
    if backports:
        components[own[0], f"{system.codename}-backports"] = ["main"]
    keyring = Path(_KEYRINGS, f"{system.name}-archive-keyring.gpg")
    options = f" [signed-by={keyring}]" if keyring.is_file() else ""
    return [
        f"deb{options} {uri} {suite} {' '.join(names)}"
        for (uri, suite), names in components.items()
    ]


def _output(command: list[str], environment: dict[str, str] | None = None) -> str:
    try:
        done = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=APT_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise AptError(f"`{' '.join(command[:2])}` did not work: {error}") from error
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if line.strip()]
        raise AptError(f"`{' '.join(command[:2])}` failed: {' / '.join(said[-3:]) or 'no reason'}")
    return done.stdout
