"""Which services a run starts: those that its skills need and those that its tree reads."""

from __future__ import annotations

from collections.abc import Mapping

from momantu_bt.descriptions.tunables import TUNABLES, configured
from momantu_bt.engine.skills.services import in_order
from momantu_bt.errors import MomantuError
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place
from momantu_bt.plugins import installed_names
from momantu_bt.robot import RobotDescription
from momantu_bt.running.prepare import Prepared
from momantu_bt.service import Service
from momantu_bt.skill import Skill
from momantu_bt.tree.check.named_world import world_of
from momantu_bt.tree.check.root_keys import services_read
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.substitute.substitution import reached
from momantu_bt.world import Site


class LaunchError(MomantuError):
    """The run cannot begin as requested; nothing was started."""


def check_sensors(needed: Mapping[str, type[Service]], description: RobotDescription) -> None:
    """Check that a robot has the sensors that services need.

    Raises:
        LaunchError: it lacks one.
    """
    having = {sensor.kind for sensor in description.sensors.values()}
    for name, service in needed.items():
        for kind in service.senses:
            if kind not in having:
                raise LaunchError(
                    f"the service {name!r} needs a {kind}, and {description.name} has none; its "
                    f"sensors: {', '.join(description.sensors) or 'none'}"
                )


def check_parameters(needed: Mapping[str, type[Service]], site: Site) -> None:
    """Check what a site sets of services, for sites that no world file describes.

    Raises:
        LaunchError: it sets what a service does not declare, or a wrong value.
        PluginError: the tunables of a service are broken.
    """
    for name in needed:
        given = site.services.get(name, {})
        said = f"the site {site.name} sets the service {name!r}"
        if not isinstance(given, Mapping):
            raise LaunchError(f"{said} to {given!r}; expected a mapping of tunables to values")
        if name in TUNABLES:
            try:
                configured(TUNABLES.load(name), given, name)
            except ValueError as error:
                raise LaunchError(f"{said} wrongly: {error}") from None
        elif given and name in installed_names("momantu_bt.services"):
            raise LaunchError(f"{said}, which declares no tunables: {', '.join(given)}")


def services_of(prepared: Prepared, kinds: Mapping[str, type[Skill]]) -> dict[str, type[Service]]:
    """The services that skills need or the tree reads and, before each, those that it needs.

    Raises:
        LaunchError: one is not installed, or the tree reads one and has no world to run it in.
        ServiceCycleError: services need each other in a circle.
        PluginError: one is broken.
    """
    services = prepared.registry.services
    askers = {name: kind.needs for name, kind in kinds.items()}
    askers |= {f"the service {name}": (name,) for name in _services_read(prepared)}
    for asker, needs in askers.items():
        try:
            in_order(needs, services.__getitem__)
        except KeyError as error:
            service = error.args[0]
            hint = valid_names(service, sorted(services), "installed services")
            message = f"{asker} needs the service {service!r}, which is not installed; {hint}"
            raise LaunchError(message) from None
    return in_order([need for needs in askers.values() for need in needs], services.__getitem__)


def _services_read(prepared: Prepared) -> dict[str, Place]:
    """The services that the tree reads, each with the first place; none of those replaced.

    Raises:
        LaunchError: the tree reads a service and has no world, or a robot, to run it in.
    """
    document, replacing = prepared.document, prepared.substitution
    context = Context(document, prepared.registry, Problems())
    nodes = reached(document, replacing.results)
    read = services_read(context, ((node, bool(replacing.of(node))) for node in nodes))
    found = {name: place for name, place in read.items() if name not in replacing.values}
    if found and world_of(document, prepared.options.world_name) is None:
        name, place = next(iter(found.items()))
        raise LaunchError(
            f"{place}: the tree reads $@{name}, which a service publishes, and services run in a "
            f"world; worlds: {', '.join(prepared.registry.worlds) or 'none'}; give one with "
            "--world, or the value with --substitute"
        )
    return found
