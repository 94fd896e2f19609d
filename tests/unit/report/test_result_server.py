"""Who is answered by the server of results, and who is refused."""

import http.client
import threading

import pytest

from clerestory.report.result_server import Resource, ResultServer


@pytest.fixture(scope="module")
def server():
    made = []

    def content():
        made.append(1)
        return b"values"

    with ResultServer({"": Resource("text/html", content)}) as found:
        found.made = made
        thread = threading.Thread(target=found.serve_forever, daemon=True)
        thread.start()
        yield found
        found.shutdown()


def ask(server, path, *, method="GET", **headers):
    connection = http.client.HTTPConnection(*server.server_address, timeout=10)
    connection.request(
        method, path, headers={k.replace("_", "-"): v for k, v in headers.items()}
    )
    answer = connection.getresponse()
    found = answer.status, answer.read(), answer.headers
    connection.close()
    return found


def test_the_token_opens_the_page(server):
    status, content, headers = ask(server, f"/{server.token}/")
    assert (status, content) == (200, b"values")
    assert headers["Cache-Control"] == "no-store"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert "Access-Control-Allow-Origin" not in headers


def test_content_is_made_once(server):
    for _ in range(2):
        ask(server, f"/{server.token}/")
    assert server.made == [1]


@pytest.mark.parametrize("path", ["/", "/x/", "/{}x/", "//", "/../{}/", "/%C3%A9/"])
def test_other_tokens_are_refused(server, path):
    assert ask(server, path.format(server.token))[0] == 403


@pytest.mark.parametrize(
    "path",
    [
        "../../etc/passwd",
        "part/../../results.nc",
        "%2e%2e/%2e%2e/etc/passwd",
        "/etc/passwd",
        "results.nc",
        "part/",
    ],
)
def test_no_path_leads_to_a_file(server, path):
    assert ask(server, f"/{server.token}/{path}")[0] == 404


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1", "localhost:1", ""])
def test_other_hosts_are_refused(server, host):
    """A site whose name was made to lead to this computer (DNS rebinding)."""
    assert ask(server, f"/{server.token}/", Host=host)[0] == 403


def test_pages_of_other_sites_are_refused(server):
    path = f"/{server.token}/"
    assert ask(server, path, Sec_Fetch_Site="cross-site")[0] == 403
    assert ask(server, path, Sec_Fetch_Site="same-origin")[0] == 200


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH", "OPTIONS"])
def test_nothing_can_be_sent(server, method):
    assert ask(server, f"/{server.token}/", method=method)[0] == 501


def test_only_the_loopback_address_answers(server):
    """127.0.0.2 is this computer as well, and would answer for any other address."""
    assert server.server_address[0] == "127.0.0.1"
    connection = http.client.HTTPConnection("127.0.0.2", server.server_port, timeout=5)
    with pytest.raises(OSError):
        connection.request("GET", f"/{server.token}/")


def test_tokens_differ_and_are_long(server):
    with ResultServer({}) as other:
        assert other.token != server.token
        assert len(other.token) >= 40
