"""The services of a run: which ones, in which order, and when each is due."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeAlias

from momantu_bt.engine.raised import raised_at
from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.errors import PLUGIN_ERRORS, ExitCode, MomantuError
from momantu_bt.failure import Failure
from momantu_bt.frames import FrameBuffer
from momantu_bt.robot import Robot
from momantu_bt.service import Service, ServiceContext
from momantu_bt.skill import Clock
from momantu_bt.world import Site, seeded

ServiceFinder: TypeAlias = Callable[[str], type[Service]]


class ServiceCycleError(MomantuError):
    """Services need each other in a circle; the message shows it."""


class ServiceError(MomantuError):
    """A service raised an exception, which ends the run; the message says which and at what line.

    The exception is its `__cause__`.
    """

    exit_code = ExitCode.INTERNAL


def in_order(names: Iterable[str], service_of: ServiceFinder) -> dict[str, type[Service]]:
    """The named services and those that they need, each after its needs.

    Raises:
        ServiceCycleError: they need each other in a circle.
    """
    found: dict[str, type[Service]] = {}

    def visit(name: str, path: tuple[str, ...]) -> None:
        if name in path:
            raise ServiceCycleError(" needs ".join((*path[path.index(name) :], name)))
        if name in found:
            return
        kind = service_of(name)
        for need in kind.needs:
            visit(need, (*path, name))
        found[name] = kind

    for name in names:
        visit(name, ())
    return _replaced(found)


def _replaced(found: Mapping[str, type[Service]]) -> dict[str, type[Service]]:
    """The same, with the class of the replacing service under each name that it replaces.

    It comes before the first service that it replaces, and so before those that need that one.
    """
    taker = {old: name for name, kind in found.items() for old in kind.replaces}
    kinds: dict[str, type[Service]] = {}
    for name, kind in found.items():
        if name in taker:
            kinds.setdefault(taker[name], found[taker[name]])
            kinds[name] = found[taker[name]]
        else:
            kinds.setdefault(name, kind)
    return kinds


def each_once(
    kinds: Mapping[str, type[Service]], make: Callable[[str, type[Service]], Service]
) -> dict[str, Service]:
    """The services of `in_order`, made; one that replaces others has all their names."""
    services: dict[str, Service] = {}
    for name, kind in kinds.items():
        same = next((s for other, s in services.items() if name in kinds[other].replaces), None)
        services[name] = same or make(name, kind)
    return services


class Services:
    """The running services by name, in their order. They see the robot but cannot command it.

    One that replaces others has their names too; it starts and is updated under its own, the first.
    """

    def __init__(self, running: Mapping[str, Service], actuators: Actuators | None) -> None:
        self.running = dict(running)
        self._robots: dict[str, Robot] = {}
        self._due: dict[str, float] = {}
        self._started: set[str] = set()
        self._actuators = actuators
        if actuators is not None:
            self._robots = {name: actuators.lease(name, ()) for name in running}

    def add(self, name: str, service: Service) -> None:
        """Add a service that `start` will start."""
        assert self._actuators is not None
        self._robots[name] = self._actuators.lease(name, ())
        self.running[name] = service

    def start(
        self,
        site: Site,
        frames: FrameBuffer,
        clock: Clock,
        seed: int,
        other: Callable[[str], Any] | None = None,
    ) -> None:
        """Start each that is not started yet, its needs first. other: how they find each other."""
        for name, service in self._own():
            if name in self._started:
                continue
            self._started.add(name)
            context = ServiceContext(
                site=site,
                description=self._robots[name].description,
                frames=frames,
                clock=clock,
                random=seeded(seed, name),
                parameters=site.services.get(name, {}),
                other=other or self.running.__getitem__,
            )
            with _told(name, service, "start"):
                service.start(context)

    def update(self, now: float) -> None:
        """Update those whose time has come; the first time, all."""
        for name, service in self._own():
            due = self._due.get(name, now)
            if now >= due - CLOCK_SLACK:
                self._due[name] = max(due + 1.0 / service.rate, now)
                with _told(name, service, "update"):
                    service.update(self._robots[name], now)

    def _own(self) -> Iterator[tuple[str, Service]]:
        """Each service once, with its own name."""
        seen = set[int]()
        for name, service in self.running.items():
            if id(service) not in seen:
                seen.add(id(service))
                yield name, service

    def published(self, name: str) -> Mapping[str, Any]:
        """The current values of a service's keys."""
        with _told(name, self.running[name], "published"):
            return self.running[name].published()


@contextmanager
def _told(name: str, service: Service, method: str) -> Iterator[None]:
    """Raise an exception of a service as ServiceError, which says where it happened.

    What a service publishes may be a Failure: the node that reads it then fails.
    """
    try:
        yield
    except PLUGIN_ERRORS as error:
        if method == "published" and isinstance(error, Failure):
            raise
        kind = type(service)
        place = raised_at(error, kind.__module__)
        said = f"the service {name!r} ended the run: {kind.__name__}.{method} raised "
        said += f"{type(error).__name__}: {error}" + (f", at {place}" if place else "")
        raise ServiceError(said) from error
