"""Web server of the interactive page of a run, for the browser of the same computer.

The server listens on the loopback address alone and only answers reading requests. All
addresses contain a random token. They are keys of a table, never names of files. The
header Host must name the server, which stops pages of other sites (DNS rebinding).
"""

import hmac
import secrets
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

from clerestory.report.content_from_results import from_results
from clerestory.report.explore_data import OPERATED, ExploreData
from clerestory.report.explore_page import explore_page
from clerestory.report.explore_pictures import served_frames
from clerestory.study.results import Results

LOOPBACK = "127.0.0.1"

# Sensors of the page: in the browser, a year of their hours takes 0.3 GB
_MOST_SENSORS = 20_000

_HTML, _BYTES, _JPEG = "text/html; charset=utf-8", "application/gzip", "image/jpeg"
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


@dataclass(frozen=True, eq=False)
class Resource:
    """Answer to an address: media type, and function that makes the content once."""

    media_type: str
    make: Callable[[], bytes]
    _kept: list[bytes] = field(default_factory=list)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def content(self) -> bytes:
        """Return the content."""
        with self._lock:
            if not self._kept:
                self._kept.append(self.make())
            return self._kept[0]


def resources_of(
    results: Results, *, pictures: str | Path | None = None
) -> dict[str, Resource]:
    """Return the page of a run (address "") and all values and pictures beside it."""
    content = from_results(results, pictures=pictures, most_sensors=_MOST_SENSORS)
    data = ExploreData(content)
    parts = {OPERATED: data.illuminance_part}
    parts |= dict((*data.glare_parts(), *data.state_parts()))
    frames, images = served_frames(content)
    names = dict.fromkeys(parts)
    page = explore_page(data, parts=names, pictures=frames)
    found = {"": Resource(_HTML, page.encode)}
    found |= {f"part/{name}": Resource(_BYTES, make) for name, make in parts.items()}
    return found | {name: Resource(_JPEG, make) for name, make in images.items()}


class ResultServer(ThreadingHTTPServer):
    """Server of resources by address, on the loopback address.

    `port` 0 selects a free port. Use it in a `with` block, which closes the port.
    """

    daemon_threads = True
    # Another program cannot listen on the same port
    allow_reuse_address = False

    def __init__(self, resources: Mapping[str, Resource], *, port: int = 0) -> None:
        super().__init__((LOOPBACK, port), _Handler)
        self.resources = resources
        self.token = secrets.token_urlsafe(32)

    @property
    def names(self) -> set[str]:
        """Names of the server in the header Host."""
        return {f"{host}:{self.server_port}" for host in (LOOPBACK, "localhost")}

    @property
    def address(self) -> str:
        """Address of the page, with the token."""
        return f"http://{LOOPBACK}:{self.server_port}/{self.token}/"

    def find(self, path: str) -> Resource | HTTPStatus:
        """Return the resource of a path, or the status if the path has none."""
        token, _, name = path.removeprefix("/").partition("/")
        if not hmac.compare_digest(token.encode(), self.token.encode()):
            return HTTPStatus.FORBIDDEN
        return self.resources.get(name, HTTPStatus.NOT_FOUND)


class _Handler(BaseHTTPRequestHandler):
    server: ResultServer
    protocol_version = "HTTP/1.1"
    # Seconds after which an idle connection is closed
    timeout = 60

    def do_GET(self) -> None:
        self._answer(body=True)

    def do_HEAD(self) -> None:
        self._answer(body=False)

    def _answer(self, *, body: bool) -> None:
        found = HTTPStatus.FORBIDDEN if self._foreign() else self._resource()
        if isinstance(found, HTTPStatus):
            self.send_error(found)
            return
        content = found.content()
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", found.media_type)
        self.send_header("Content-Length", str(len(content)))
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        self.end_headers()
        if body:
            self.wfile.write(content)

    def _foreign(self) -> bool:
        # Whether the request was made by a page of another site
        site = self.headers.get("Sec-Fetch-Site", "none")
        own = self.headers.get("Host", "") in self.server.names
        return not own or site not in ("none", "same-origin")

    def _resource(self) -> Resource | HTTPStatus:
        return self.server.find(urlsplit(self.path).path)

    def version_string(self) -> str:
        return "Clerestory"

    def log_message(self, *_words: object) -> None:
        # Addresses contain the token: nothing is logged
        pass
