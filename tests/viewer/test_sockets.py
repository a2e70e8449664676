"""Fifty clients over real connections at once, most of them with something that is not to be served."""

from __future__ import annotations

import asyncio
import socket
import threading
import time

import pytest

uvicorn = pytest.importorskip("uvicorn", reason="the viewer's extra is not installed")

from seaglint.viewer.library import Library  # noqa: E402
from seaglint.viewer.server import MOST_BODY, make_app  # noqa: E402

from .conftest import COLUMNS, ROWS  # noqa: E402

GOOD = "/api/frame/0/3?scaling=linear&low=0&high=10"
HANDSHAKE = ("Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==")


@pytest.fixture(scope="module")
def port(store):
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        listening.listen(128)
        running = uvicorn.Server(uvicorn.Config(make_app(Library([store])), log_level="critical", lifespan="off"))
        thread = threading.Thread(target=running.run, kwargs={"sockets": [listening]}, daemon=True)
        thread.start()
        until = time.monotonic() + 600.0
        while not running.started and time.monotonic() < until:
            time.sleep(0.02)
        yield listening.getsockname()[1]
        running.should_exit = True
        thread.join(10.0)


def said(port: int, path: str = GOOD, *more: str, host: str | None = None, method: str = "GET") -> bytes:
    end = () if "Connection: Upgrade" in more else ("Connection: close",)
    lines = (f"{method} {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}", *more, *end, "", "")
    return "\r\n".join(lines).encode()


async def answered(port: int, request: bytes) -> bytes:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(request)
    try:
        return await asyncio.wait_for(reader.read(-1), 600.0)
    except ConnectionError:
        return b""
    finally:
        writer.close()


def test_nothing_is_served_that_should_not_be(port):
    allowed, missing, refused, bad = (200,), (404,), (403,), (400, 0)
    kinds = [
        (said(port), allowed),
        (said(port, 4 * "/.." + "/etc/passwd"), missing),
        (said(port, "/static/..%2f..%2fsafety.py"), missing),
        (said(port, "/static/%2e%2e/server.py"), missing),
        (said(port, "/api/frame/..%2f..%2fetc%2fpasswd/0"), missing),
        (said(port, host="evil.example"), refused),
        (said(port, GOOD, "Origin: http://evil.example"), refused),
        (said(port, GOOD, "Origin: null"), refused),
        (said(port, "/_nicegui_ws/socket.io/?EIO=4&transport=websocket", *HANDSHAKE, "Origin: http://evil.example"), refused),
        (said(port, "/api/analysis/0/0", f"Content-Length: {MOST_BODY + 1}", method="POST"), (413,)),
        (said(port, "/api/session?" + "a" * 8000), (414,)),
        (b"GET \x00\xff garbage\r\n\r\n", bad),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(200) + b"\r\n\r\n", bad),
    ]
    wanted = [kinds[n % len(kinds)] for n in range(52)]

    async def all_at_once() -> list[bytes]:
        return await asyncio.gather(*(answered(port, request) for request, _ in wanted))

    for (request, statuses), answer in zip(wanted, asyncio.run(all_at_once()), strict=True):
        status = int(answer.split(b" ", 2)[1]) if answer.startswith(b"HTTP/1.") else 0
        assert status in statuses, (request[:120], answer[:200])
        assert b"root:" not in answer
        assert b"import" not in answer
        assert (len(answer.partition(b"\r\n\r\n")[2]) == ROWS * COLUMNS) == (status == 200)
    assert asyncio.run(answered(port, said(port))).startswith(b"HTTP/1.1 200")
