"""The web viewer's page, served so that the browser asks nobody but this machine.

Rerun's page brings all that it needs with it, but asks hosts of the internet for fonts and for newer releases, and
tells one of them that it was opened. It is handed on here without the tags that name other hosts, and with a
Content-Security-Policy, by which the browser itself refuses every request that leaves the loopback address, whatever
the program in the page asks for.
"""

from __future__ import annotations

import re
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

HANDED_ON = ("Content-Type", "ETag", "Last-Modified")
"""Headers of the viewer's answers that the browser needs."""
FOREIGN = re.compile(
    rb"""<link\b[^>]*\bhref\s*=\s*["'](?:https?:)?//[^>]*>"""
    rb"""|<script\b[^>]*\bsrc\s*=\s*["'](?:https?:)?//[^>]*>(?:\s*</script>)?""",
    re.IGNORECASE,
)
"""Tags of a page that make a browser look up other hosts, some of them before any policy is asked."""
DARK = b"""<script>
const asked = window.matchMedia.bind(window);
window.matchMedia = (query) => asked(query.includes("prefers-color-scheme: dark") ? "all" : query);
</script>"""
"""Makes the viewer dark whatever the browser prefers: the plans are, and names stand out in that theme alone."""
ANSWER_S = 30.0
"""How long the viewer's own server may take for one file."""


def policy(host: str, data_port: int) -> str:
    """The Content-Security-Policy of a page that takes its recording from a port of `host` and all else from itself."""
    return "; ".join(
        (
            "default-src 'self'",
            "script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob:",
            "worker-src 'self' blob:",
            "style-src 'self' 'unsafe-inline'",
            "img-src 'self' data: blob:",
            "font-src 'self' data:",
            f"connect-src 'self' http://{host}:{data_port} ws://{host}:{data_port} data: blob:",
            "form-action 'none'",
            "frame-src 'none'",
            "object-src 'none'",
        )
    )


@contextmanager
def served(host: str, port: int, viewer_port: int, data_port: int) -> Iterator[None]:
    """Serves at `port` of `host` what the viewer's own server has at `viewer_port`, with the policy, until the end."""
    headers = {
        "Content-Security-Policy": policy(host, data_port),
        "Referrer-Policy": "no-referrer",
        "X-DNS-Prefetch-Control": "off",
        "X-Content-Type-Options": "nosniff",
    }

    class Handler(BaseHTTPRequestHandler):
        """Hands each request on and adds the headers to its answer."""

        def do_GET(self) -> None:
            """Answers with what the viewer's server answers."""
            try:
                request = urllib.request.Request(
                    f"http://{host}:{viewer_port}{self.path}",
                    headers={"Accept-Encoding": "identity"},
                )
                with _direct.open(request, timeout=ANSWER_S) as answer:
                    self._send(answer.status, dict(answer.headers), answer.read())
            except urllib.error.HTTPError as error:
                self._send(error.code, {}, b"")
            except (OSError, ValueError):  # the viewer has ended, or the browser has gone
                self.close_connection = True

        def _send(self, status: int, given: dict[str, str], body: bytes) -> None:
            known = {name.lower(): value for name, value in given.items()}
            if known.get("content-type", "").startswith("text/html"):
                body = FOREIGN.sub(b"", body).replace(b"<head>", b"<head>" + DARK, 1)
            self.send_response(status)
            for name in HANDED_ON:
                if name.lower() in known:
                    self.send_header(name, known[name.lower()])
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            """Says nothing: the terminal has the page's address alone."""

    server = ThreadingHTTPServer((host, port), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield
    finally:
        server.shutdown()
        server.server_close()


_direct = urllib.request.build_opener(urllib.request.ProxyHandler({}))
"""Asks this machine itself, whatever proxy the environment names."""
