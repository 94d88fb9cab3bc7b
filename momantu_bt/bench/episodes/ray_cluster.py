"""Connect to a Ray cluster: a private one on this machine, or a running one."""

from __future__ import annotations

import logging
import os
import secrets
import shutil
import signal
import socket
import tempfile
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from typing import Any

from momantu_bt.bench.episodes.engine import EngineError

AUTO = "auto"
"""The address of the cluster that `ray start` began on this machine."""
_LOOPBACK = {"RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0"}
"""Ray's own setting for machines with firewalls: it listens on the loopback interface alone."""
_NOT_NICE = {"RAY_worker_niceness": "0"}
"""Without it, workers and their episodes would run at a lower priority than all other programs."""
_NO_STATISTICS = {"RAY_USAGE_STATS_ENABLED": "0"}
_STORE = 256 * 1024**2
"""Bytes of Ray's object store on this machine: rows and the records of a few episodes."""
_REACHABLE = 5.0
"""Seconds within which a cluster must answer."""
_SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def cluster(address: str | None, jobs: int) -> Iterator[Any]:
    """A connection to Ray; at the end it disconnects, and ends what it has started.

    address: None starts a private cluster on this machine alone, with `jobs` workers; `"auto"` or
    HOST:PORT connects to a running one.

    Raises:
        EngineError: Ray is not installed, or there is no such cluster.
    """
    if address is not None:
        _check(address)
    own = {} if address is not None else {**_LOOPBACK, **_NOT_NICE, **_secret()}
    with _folder() as folder, _environment({**_NO_STATISTICS, **own}):
        ray = _import()
        try:
            with _handlers_kept():
                if address is None:
                    _start(ray, jobs, folder)
                else:
                    _connect(ray, address)
            yield ray
        finally:
            ray.shutdown()


def _import() -> Any:
    try:
        return import_module("ray")
    except ImportError as error:
        raise EngineError(
            f"--engine ray needs Ray ({error}); pip install 'momantu-bt[ray]'"
        ) from None


def _start(ray: Any, jobs: int, folder: str) -> None:
    try:
        ray.init(
            "local",
            num_cpus=jobs,
            num_gpus=0,
            include_dashboard=False,
            log_to_driver=False,
            logging_level=logging.ERROR,
            object_store_memory=_STORE,
            _temp_dir=folder,
        )
    except Exception as error:
        raise EngineError(f"Ray cannot start on this machine: {_first_line(error)}") from error


def _connect(ray: Any, address: str) -> None:
    try:
        ray.init(address, log_to_driver=False, logging_level=logging.ERROR)
    except ConnectionError as error:
        raise EngineError(
            f"no Ray cluster at {address} ({_first_line(error)}); `ray start --head` begins one; "
            "one that wants a token needs RAY_AUTH_MODE=token here too"
        ) from error
    except Exception as error:
        raise EngineError(f"the Ray cluster at {address}: {_first_line(error)}") from error


def _check(address: str) -> None:
    """Whether something listens at an address: Ray itself would try for minutes."""
    if address == AUTO:
        return
    host, _, port = address.rpartition(":")
    if not host or not port.isdecimal():
        raise EngineError(f"--ray-address {address} is not an address; write auto or HOST:PORT")
    try:
        socket.create_connection((host.strip("[]"), int(port)), _REACHABLE).close()
    except (OSError, OverflowError) as error:
        raise EngineError(
            f"no Ray cluster at {address} ({error}); `ray start --head` there begins one"
        ) from None


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]


@cache
def _secret() -> Mapping[str, str]:
    """Other users of this machine reach the loopback interface too, and have no token.

    One for the whole process, since Ray reads it once.
    """
    return {"RAY_AUTH_MODE": "token", "RAY_AUTH_TOKEN": secrets.token_hex(32)}


@contextmanager
def _folder() -> Iterator[str]:
    """The folder of Ray's sockets and logs. Socket names must be short: not below TMPDIR."""
    folder = tempfile.mkdtemp(prefix="momantu_ray_", dir="/tmp")
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def _environment(settings: Mapping[str, str]) -> Iterator[None]:
    """Set environment variables for a while; processes started then keep them."""
    before = {name: os.environ.get(name) for name in settings}
    os.environ.update(settings)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@contextmanager
def _handlers_kept() -> Iterator[None]:
    """Restore the handler of SIGTERM, which Ray replaces when it connects."""
    before = {number: signal.getsignal(number) for number in _SIGNALS}
    try:
        yield
    finally:
        if threading.current_thread() is threading.main_thread():
            for number, handler in before.items():
                signal.signal(number, handler)
