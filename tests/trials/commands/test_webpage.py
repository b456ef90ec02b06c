"""The page of `herd play --web` leads a browser to this machine alone."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator
from html.parser import HTMLParser
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from trials.commands import playback
from trials.commands.webpage import policy, served

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-headless-shell", "google-chrome"))), None)
PAGE = """<!doctype html><html><head>
<link rel="preconnect" href="https://{other}" />
<LINK href='//{other}/font.css' rel=stylesheet>
<link rel="icon" href="favicon.ico" />
<script src="http://{other}/a.js"></script>
<script src="own.js"></script>
</head><body><p id=told>waiting</p><img src="http://{other}/b.png"><script>
navigator.sendBeacon("http://{other}/c");
fetch("http://{other}/d").then(() => "reached", () => "refused")
    .then((word) => {{ document.getElementById("told").textContent = word; }});
</script></body></html>"""


class Viewer(BaseHTTPRequestHandler):
    """Stands in for the viewer's own server."""

    other = "example.com"

    def do_GET(self) -> None:
        files = {"/": ("text/html", PAGE.format(other=self.other)), "/own.wasm": ("application/wasm", "\0asm")}
        found = files.get(self.path.partition("?")[0])
        self.send_response(200 if found else 404)
        if found:
            self.send_header("Content-Type", found[0])
        self.end_headers()
        self.wfile.write(found[1].encode() if found else b"")

    def log_message(self, format: str, *args: object) -> None:
        pass


@pytest.fixture
def page() -> Iterator[str]:
    """The address of the page of a made-up viewer, as it is handed on."""
    viewer = ThreadingHTTPServer(("127.0.0.1", 0), Viewer)
    threading.Thread(target=viewer.serve_forever, daemon=True).start()
    (port,) = playback._free_ports(1)
    with served("127.0.0.1", port, viewer.server_port, 9):
        yield f"http://127.0.0.1:{port}/"
    viewer.shutdown()
    viewer.server_close()


def foreign(html: str) -> list[str]:
    """The addresses of other hosts that the tags of a page have a browser look up."""
    found: list[str] = []

    class Tags(HTMLParser):
        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            if tag in ("link", "script"):
                found.extend(value or "" for name, value in attrs if name in ("href", "src"))

    Tags().feed(html)
    return [address for address in found if re.match("(https?:)?//", address)]


def test_every_answer_has_a_policy_that_names_the_loopback_address_alone(page: str) -> None:
    for path, kind in (("", "text/html"), ("own.wasm?x=1", "application/wasm")):
        with urllib.request.urlopen(page + path) as answer:
            assert answer.headers["Content-Type"] == kind
            assert answer.headers["Content-Security-Policy"] == policy("127.0.0.1", 9)
    with pytest.raises(urllib.error.HTTPError) as told:
        urllib.request.urlopen(f"{page}nowhere")
    assert told.value.code == 404
    assert set(re.findall(r"//([^:;\s]+)", policy("127.0.0.1", 9))) == {"127.0.0.1"}
    assert "default-src 'self'" in policy("127.0.0.1", 9)
    assert "*" not in policy("127.0.0.1", 9)


def test_tags_that_name_other_hosts_are_left_out(page: str) -> None:
    html = urllib.request.urlopen(page).read().decode()
    assert len(foreign(PAGE)) == 3
    assert foreign(html) == []
    assert "favicon.ico" in html
    assert "own.js" in html


def test_reruns_own_page_is_left_without_other_hosts(tmp_path: Path) -> None:
    import rerun as rr

    recording = rr.RecordingStream("test", recording_id="test")
    recording.save(tmp_path / "0001.rrd")
    recording.log("one", rr.Scalars(1.0))
    recording.disconnect()
    port, viewer_port, web_port = playback._free_ports(3)
    process = playback._started(playback.viewer_command(tmp_path / "0001.rrd", port, viewer_port))
    try:
        with served("127.0.0.1", web_port, viewer_port, port):
            playback._await(process, viewer_port)
            html = urllib.request.urlopen(f"http://127.0.0.1:{web_port}/").read().decode()
            own = urllib.request.urlopen(f"http://127.0.0.1:{viewer_port}/").read().decode()
    finally:
        playback._end(process)
    assert "<canvas" in html
    assert foreign(own)  # else nothing would need to be left out
    assert foreign(html) == []


@pytest.mark.skipif(BROWSER is None, reason="no browser on this machine")
def test_a_browser_contacts_no_other_host(page: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another address of this machine stands in for the internet: nobody may connect to it, not even ahead of time."""
    with socket.create_server(("127.0.0.2", 0)) as other:
        monkeypatch.setattr(Viewer, "other", f"127.0.0.2:{other.getsockname()[1]}")
        done = subprocess.run(
            [str(BROWSER), "--headless", "--no-sandbox", "--dump-dom", "--virtual-time-budget=5000", page],
            capture_output=True,
            text=True,
            timeout=120,
        )
        other.setblocking(False)
        with pytest.raises(BlockingIOError):  # nobody waits to be accepted
            other.accept()
    assert "refused" in done.stdout, done.stderr
