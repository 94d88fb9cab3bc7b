"""What all tests share: property tests draw the same examples each time and know no deadline."""

import signal

from hypothesis import settings

if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:  # under nohup; tests send this signal
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")
