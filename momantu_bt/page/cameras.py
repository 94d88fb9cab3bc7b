"""The camera's pictures, as data in the page."""

from __future__ import annotations

from typing import Any

from momantu_bt.record.recording import Recording

_CAMERA = "/camera/"


def cameras(recording: Recording) -> list[dict[str, Any]]:
    """Per camera: name, times (s) and images (addresses that hold the picture itself)."""
    found = []
    for topic in recording.topics():
        if not topic.startswith(_CAMERA):
            continue
        times, images = [], []
        for time, message in recording.messages(topic):
            times.append(round(time, 4))
            images.append(f"data:image/{message['format']};base64,{message['data']}")
        found.append({"name": topic.removeprefix(_CAMERA), "times": times, "images": images})
    return found
