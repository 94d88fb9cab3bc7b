"""Fetch a headless Chromium for the tests of HTML pages, if there is no browser: for `make test`.

It comes from the machine's own package mirror, without root, into the user's cache folder, once.
If that is impossible (no apt, no network), the script says so and exits with 0: those tests are
skipped then.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from momantu_worlds.vulkan.apt import AptError, PrivateApt, this_system

from momantu_bt.formats.cache import cache_folder

VARIABLE = "MOMANTU_BROWSER"
"""The environment variable that names another browser."""
NAMES = ("chromium-headless-shell", "chromium", "google-chrome", "google-chrome-stable")
PACKAGES = ("chromium-headless-shell", "fonts-dejavu-core")
FOLDER = "browser"
LAUNCHER = """\
#!/bin/sh
root=$(cd "$(dirname "$0")" && pwd)/root
LD_LIBRARY_PATH=$(find "$root" -name '*.so*' -printf '%h\\n' | sort -u | paste -sd:)
export LD_LIBRARY_PATH FONTCONFIG_FILE="$root/../fonts.conf"
exec "$root/usr/lib/chromium/chromium-headless-shell" "$@"
"""
"""Starts the unpacked browser with the libraries and fonts that came with it."""
FONTS = """\
<?xml version="1.0"?>
<fontconfig>
<dir prefix="relative">root/usr/share/fonts</dir>
<cachedir prefix="xdg">fontconfig</cachedir>
</fontconfig>
"""
"""A bare system has no fonts, and without any a browser ends at the first text."""
PROBE_SECONDS = 60.0


def main() -> None:
    """Fetch a browser, unless there is one."""
    if find_browser() is not None:
        return
    print("Fetching a headless browser for the tests of HTML pages (100 MB, no root)", flush=True)
    try:
        fetch(cache_folder() / FOLDER)
    except (AptError, OSError, subprocess.SubprocessError) as error:
        print(f"  no browser could be fetched ({error}); the tests of HTML pages are skipped")


def find_browser() -> str | None:
    """The command of a browser: `$MOMANTU_BROWSER`, one on PATH, or the one fetched before."""
    brought = cache_folder() / FOLDER / FOLDER
    found = [os.environ.get(VARIABLE), *map(shutil.which, NAMES)]
    found.append(str(brought) if brought.is_file() else None)
    return next(filter(None, found), None)


def fetch(folder: Path) -> None:
    """Unpack it into a folder, which appears whole or not at all.

    Raises:
        AptError: apt cannot get it.
        OSError, SubprocessError: it cannot be written or does not start.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix="browser-setup-") as name:
        scratch = Path(name)
        apt = PrivateApt(scratch, this_system(), backports=False)
        fresh = scratch / FOLDER
        fresh.mkdir()
        apt.unpack(apt.download(PACKAGES, None), fresh / "root")
        launcher = fresh / FOLDER
        launcher.write_text(LAUNCHER, encoding="ascii")
        launcher.chmod(0o755)
        (fresh / "fonts.conf").write_text(FONTS, encoding="ascii")
        probe(launcher)
        fresh.rename(folder)


def probe(launcher: Path) -> None:
    """Let the browser read a page; SubprocessError when it cannot."""
    command = [
        str(launcher),
        "--no-sandbox",
        "--disable-gpu",
        "--dump-dom",
        "data:text/html,it-works",
    ]
    said = subprocess.run(
        command, capture_output=True, text=True, timeout=PROBE_SECONDS, check=True
    ).stdout
    if "it-works" not in said:
        raise subprocess.SubprocessError("the browser was fetched, but shows no page")


if __name__ == "__main__":
    main()
