"""What services publish: `/service/<name>`, when it has changed."""

from __future__ import annotations

from collections.abc import Callable

from momantu_bt.engine.executor import Executor
from momantu_bt.record.channels.channel import Due, stamp_of
from momantu_bt.record.codec import dumps, to_json
from momantu_bt.record.mcap.file import McapFile
from momantu_bt.record.mcap.schemas import SERVICE
from momantu_bt.service import Service

RATE = 5.0
"""Hz of the world's clock at which services are asked."""


class Published:
    """Reads each service that publishes. A service that raises is not read again."""

    def __init__(self, remark: Callable[[str], None]) -> None:
        self._remark = remark
        self._due = Due(RATE)
        self._last: dict[str, str] = {}
        self._silent: set[str] = set()

    def write(self, run: Executor, file: McapFile) -> None:
        """Write the values that have changed since they were last written."""
        if run.settling or not self._due(run.context.now):
            return
        for name, service in run.services.running.items():
            if not service.publishes or name in self._silent:
                continue
            text = self._text(name, service)
            if text is not None and self._last.get(name) != text:
                self._last[name] = text
                channel = file.channel(f"/service/{name}", f"momantu.service.{name}", SERVICE)
                file.add(channel, stamp_of(run.context.now), text)

    def _text(self, name: str, service: Service) -> str | None:
        try:
            values = {str(key): to_json(value) for key, value in service.published().items()}
        except Exception as error:
            self._silent.add(name)
            self._remark(f"the record goes on without what {name} publishes: {error!r}")
            return None
        return dumps(values)
