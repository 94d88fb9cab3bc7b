"""The error of a calibration that its data do not allow."""

from __future__ import annotations

from momantu_bt.errors import InputError


class CalibrationError(InputError):
    """The data cannot give a calibration; the message says why and what to do."""
