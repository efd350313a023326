"""The page of the web viewer, handed on with a rule that keeps it on this machine.

Rerun's own page asks hosts of its makers for fonts, examples and versions, and sends usage data, whatever is set in the
environment. A content security policy tells the browser to let none of that out.
"""

from __future__ import annotations

import contextlib
import http.client
import http.server
import threading
from collections.abc import Iterator
from typing import Any

__all__ = ["guarded"]

_POLICY = (
    "default-src 'self'; connect-src 'self' http://127.0.0.1:* data: blob:; font-src 'self' data:; "
    "img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; worker-src 'self' blob:; "
    "script-src 'self' 'unsafe-inline' 'unsafe-eval' 'wasm-unsafe-eval'"
)
_HANDED_ON = ("Content-Type", "Content-Encoding")


@contextlib.contextmanager
def guarded(port: int) -> Iterator[int]:
    """Serve what a server on a port of this machine serves, with the policy; give the port. Ends with the context.

    Parameters
    ----------
    port : int
        Port of Rerun's own page on 127.0.0.1.
    """

    class Page(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            inner = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
            try:
                inner.request("GET", self.path)
                answer = inner.getresponse()
                body = answer.read()
            except OSError as error:
                self.send_error(502, f"the viewer's server does not answer: {error.strerror or error}")
                return
            finally:
                inner.close()
            self.send_response(answer.status)
            for name in _HANDED_ON:
                value = answer.getheader(name)
                if value is not None:
                    self.send_header(name, value)
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Content-Security-Policy", _POLICY)
            self.end_headers()
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                self.wfile.write(body)

        def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - its name in the base class
            """Say nothing about requests."""

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Page) as server:
        server.daemon_threads = True
        # Looks often whether it is to end: a signal ends a viewer within a second.
        thread = threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True)
        thread.start()
        try:
            yield server.server_address[1]
        finally:
            server.shutdown()
            thread.join()
