"""The page at the view's address while the run is prepared: it says what is being prepared.

It gives way to the view as soon as that serves the same address.
"""

from __future__ import annotations

import json
import threading
import time
from html import escape
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from momantu_bt.world import WorldError

HOST = "127.0.0.1"
"""Only browsers on this machine are served."""
STATUS = "/preparing"
"""The path that tells the page what is being prepared; the view does not know it."""
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>momantu-bt: preparing</title>
<style>
body { background: #f4f4f2; color: #222; font: 16px/1.5 sans-serif; margin: 12vh auto;
       max-width: 40rem; padding: 0 1rem }
h1 { font-size: 1.3rem } pre { color: #667; font-size: .85rem; overflow-x: auto }
</style></head><body>
<h1>TITLE</h1><p id="stage">preparing the run</p><pre>LINES</pre>
<script>
async function look() {
  try {
    const answer = await fetch("STATUS", { cache: "no-store" });
    const { stage, seconds } = JSON.parse(await answer.text());
    document.getElementById("stage").textContent = `${stage} … ${seconds} s`;
  } catch (error) {
    if (error instanceof SyntaxError) { location.reload(); return; }
  }
  setTimeout(look, 500);
}
look();
</script></body></html>
"""


class WaitingPage:
    """Serves the page from now on, in a thread. title, lines: the run and its tree.

    Raises:
        WorldError: something else listens at the port already.
    """

    def __init__(self, port: int, title: str, lines: str) -> None:
        self._stage, self._since = "preparing the run", time.perf_counter()
        page = _PAGE.replace("TITLE", escape(title)).replace("LINES", escape(lines))
        page = page.replace("STATUS", STATUS)
        waiting = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                is_status = self.path.partition("?")[0] == STATUS
                text = waiting.status() if is_status else page
                self.send_response(200)
                kind = "application/json" if is_status else "text/html; charset=utf-8"
                self.send_header("Content-Type", kind)
                self.send_header("Cache-Control", "no-store")
                self.end_headers()
                self.wfile.write(text.encode())

            def log_message(self, format: str, *args: object) -> None:
                """Say nothing in the terminal."""

        try:
            self._server: ThreadingHTTPServer | None = ThreadingHTTPServer((HOST, port), Handler)
        except (OSError, OverflowError) as error:
            why = getattr(error, "strerror", None) or error
            raise WorldError(
                f"the view cannot be served at port {port}: {why}; choose another port"
            ) from error
        self.url = f"http://{HOST}:{port}"
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(0.05,), name="waiting page", daemon=True
        )
        self._thread.start()

    def stage(self, text: str) -> None:
        """Say what is being prepared now."""
        self._stage, self._since = text, time.perf_counter()

    def status(self) -> str:
        """What is being prepared, and for how long, as JSON."""
        return json.dumps({"stage": self._stage, "seconds": int(time.perf_counter() - self._since)})

    def close(self) -> None:
        """Free the port; safe to call twice."""
        server, self._server = self._server, None
        if server is not None:
            server.shutdown()
            server.server_close()
            self._thread.join()
