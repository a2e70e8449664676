"""Server of the viewer: pages, access control and limits of requests. No data leave the machine.

A page of another site in the user's browser can send requests to this machine. With a host name that its owner directs to this machine (DNS
rebinding), the browser even treats both as one site. The outermost layer of the server therefore refuses requests unless ``Host`` is a name
with which the server was started, and ``Origin``, if a browser sends one, is the same host. Other machines need a token as well.
"""

from __future__ import annotations

import errno
import gc
import hmac
import os
import secrets
import shutil
import socket
import sys
import tempfile
import threading
from collections.abc import Awaitable, Callable, Iterator, MutableMapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import parse_qs, quote, urlsplit

from seaglint.base.errors import DataError
from seaglint.base.optional import missing

if TYPE_CHECKING:
    from seaglint.viewer.library import Library


Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Scope, Receive, Send], Awaitable[None]]

LOOPBACK: Final = frozenset({"127.0.0.1", "localhost", "::1"})  #: Names of the local machine that every browser knows.

MOST_BODY: Final = 1_000_000  #: Largest size of a request's body or of a websocket's message [bytes].

MOST_ADDRESS: Final = 4096  #: Largest size of a request's path and query [bytes].

# NiceGUI's pages contain their scripts, and build functions from text. Nothing may be loaded from other hosts, whatever a page contains.
_POLICY: Final = "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; frame-ancestors 'none'; form-action 'self'"
# The viewer's own pages load their scripts from files: text that gets into a page cannot run.
_STRICT: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
_HEADERS: Final = (
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"referrer-policy", b"no-referrer"),
)


def is_loopback(host: str) -> bool:
    """Return true for an address of the local machine.

    >>> is_loopback("localhost"), is_loopback("127.0.0.2"), is_loopback("0.0.0.0")
    (True, True, False)
    """
    if host in LOOPBACK:
        return True
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False


def new_token() -> str:
    """Return a random token, fit for an address."""
    return secrets.token_urlsafe(24)


class Guard:
    """Middleware that refuses requests that do not come from the viewer's own pages.

    Parameters
    ----------
    app : callable
        ASGI application behind it.
    host : str
        Address that the server is bound to.
    token : str or None
        Secret that the first request must have in its query (``?token=``) and later requests in a cookie; None for the local machine.
    """

    def __init__(self, app: Application, *, host: str = "127.0.0.1", token: str | None = None) -> None:
        self.app, self.token = app, token
        self._everywhere = host in ("0.0.0.0", "::", "")
        self._names = {*LOOPBACK, host.lower()}
        # Other machines use the names of this machine; a server at the loopback device is reached by LOOPBACK alone.
        if self._everywhere or not is_loopback(host):
            self._names |= {socket.gethostname().lower(), socket.getfqdn().lower()}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse a request, or pass it to the application."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        refused = self._refusal(scope)
        if refused is not None:
            await _refuse(scope, receive, send, *refused)
            return
        if self.token is not None and not self._known(scope):
            await self._greet(scope, receive, send)
            return
        if scope["type"] == "websocket":
            await self.app(scope, _bounded_messages(receive, send), send)
        else:
            await self._answer(scope, receive, send)

    def _refusal(self, scope: Scope) -> tuple[int, str] | None:
        """Return status and reason of a refusal; None for an allowed request."""
        headers = _headers(scope)
        host = headers.get("host", "")
        if not self._is_ours(host):
            return 403, "this host name is not the viewer's; open the address that 'seaglint view' printed"
        # Browsers state the origin of requests that a script or a form sends; programs may omit it.
        origin = headers.get("origin")
        if origin is not None and not _same_place(origin, host):
            return 403, "requests of other sites are refused"
        # A link on another site may open the viewer; its scripts, images and forms must not send requests.
        if headers.get("sec-fetch-site") in ("cross-site", "same-site") and headers.get("sec-fetch-mode") != "navigate":
            return 403, "requests of other sites are refused"
        if len(scope.get("raw_path") or b"") + len(scope.get("query_string") or b"") > MOST_ADDRESS:
            return 414, f"the address is longer than {MOST_ADDRESS} bytes"
        length = headers.get("content-length", "0")
        if not (length.isascii() and length.isdigit()):
            return 400, "Content-Length is no number"
        # Cut before the conversion: Python refuses texts of very many digits.
        if int(length[:20]) > MOST_BODY:
            return 413, f"the message is larger than {MOST_BODY} bytes"
        return None

    def _is_ours(self, host: str) -> bool:
        try:
            name = (urlsplit("//" + host).hostname or "").lower()
        except ValueError:
            return False
        if name in self._names or is_loopback(name):
            return True
        if not self._everywhere:
            return False
        try:
            ip_address(name)  # an address is not a name that its owner could direct elsewhere
        except ValueError:
            return False
        return True

    def _cookie(self, scope: Scope) -> str:
        server = scope.get("server") or ("", 0)
        return f"seaglint-{server[1]}"  # cookies are shared by the ports of a host

    def _known(self, scope: Scope) -> bool:
        try:
            cookie = SimpleCookie(_headers(scope).get("cookie", "")).get(self._cookie(scope))
        except CookieError:
            return False
        # Compared in constant time, so that answering times do not reveal how much of the token is right.
        return cookie is not None and hmac.compare_digest(cookie.value.encode(), (self.token or "").encode())

    async def _greet(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Move the token from the address into a cookie, so that neither history nor links contain it."""
        query = parse_qs(bytes(scope.get("query_string") or b"").decode("ascii", "replace"))
        given = query.get("token", [""])[-1]
        if scope["type"] != "http" or not hmac.compare_digest(given.encode(), (self.token or "").encode()):
            await _refuse(scope, receive, send, 401, "the token is missing or wrong; open the whole address that 'seaglint view' printed")
            return
        cookie = f"{self._cookie(scope)}={self.token}; Path=/; HttpOnly; SameSite=Strict"
        # One slash: two would be an address of another host.
        place = quote("/" + str(scope["path"]).lstrip("/\\"))
        await send(
            {"type": "http.response.start", "status": 303, "headers": [(b"location", place.encode()), (b"set-cookie", cookie.encode())]}
        )
        await send({"type": "http.response.body", "body": b""})

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with a bounded body, and with headers that keep the answer within this site."""
        path = str(scope["path"])
        # All other paths are NiceGUI's, which does not work under the strict policy.
        own = path in ("/", "/favicon.ico") or path.startswith(("/static/", "/api/"))
        policy = (b"content-security-policy", (_STRICT if own else _POLICY).encode())

        async def sealed(message: Message) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": [*message.get("headers", []), *_HEADERS, policy]}
            await send(message)

        await self.app(scope, _bounded_body(receive), sealed)


def _headers(scope: Scope) -> dict[str, str]:
    return {bytes(name).decode("latin-1").lower(): bytes(value).decode("latin-1") for name, value in scope["headers"]}


def _same_place(origin: str, host: str) -> bool:
    """Return true where an ``Origin`` header names the host of the request."""
    try:
        parts = urlsplit(origin)
    except ValueError:
        return False
    return parts.scheme in ("http", "https") and parts.netloc.lower() == host.lower()


async def _refuse(scope: Scope, receive: Receive, send: Send, status: int, reason: str) -> None:
    if scope["type"] == "websocket":
        await receive()  # the handshake; closing before accepting it is the refusal
        await send({"type": "websocket.close", "code": 1008})
        return
    body = (reason + "\n").encode()
    headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode()), (b"connection", b"close")]
    await send({"type": "http.response.start", "status": status, "headers": [*headers, *_HEADERS]})
    await send({"type": "http.response.body", "body": body})


def _bounded_body(receive: Receive) -> Receive:
    """Return a receiver that ends a body without a length where it becomes too large."""
    taken = 0

    async def bounded() -> Message:
        nonlocal taken
        message = await receive()
        # A chunked body states no length: it is counted while it arrives.
        taken += len(message.get("body") or b"")
        return {"type": "http.disconnect"} if taken > MOST_BODY else message

    return bounded


def _bounded_messages(receive: Receive, send: Send) -> Receive:
    """Return a receiver that ends a websocket when a message is too large."""

    async def bounded() -> Message:
        message = await receive()
        if message["type"] == "websocket.receive" and len(message.get("bytes") or message.get("text") or "") > MOST_BODY:
            await send({"type": "websocket.close", "code": 1009})
            return {"type": "websocket.disconnect", "code": 1009}
        return message

    return bounded


PORT: Final = 8420  #: First port that the viewer tries.

_TRIED: Final = 50  #: Number of ports that are tried.


@dataclass(frozen=True)
class Page:
    """Page made of NiceGUI's elements."""

    path: str  #: Path of the page: ``"/workbench"``.
    title: str  #: Title of the browser's tab, and of the link to it.
    build: Callable[[], None]  #: Fills the page; called for every browser that opens it.
    routes: tuple[Any, ...] = ()  #: Further Starlette routes of the page, under ``/api/``.


def workbench(scenario: str | Path | None = None) -> Page:
    """Return the workbench page, which changes a scenario of a file or a preset and shows its pictures."""
    from seaglint.viewer.workbench import page

    return Page("/workbench", "Scenario workbench", lambda: page(scenario))


def require_installed() -> None:
    """Check that NiceGUI is installed.

    Raises
    ------
    BackendError
        NiceGUI, or a library on which it depends, is not installed.
    """
    from importlib.util import find_spec

    if any(find_spec(name) is None for name in ("nicegui", "starlette", "uvicorn")):
        raise missing("the viewer", "nicegui")


def make_app(library: Library, pages: Sequence[Page] = (), *, host: str = "127.0.0.1", token: str | None = None) -> Application:
    """Return the ASGI application: sequences at ``/``, the pages at their paths, behind the ``Guard``."""
    from seaglint.viewer.routes import routes

    links = [{"path": page.path, "title": page.title} for page in pages]
    addresses = [*routes(library, links), *(route for page in pages for route in page.routes)]
    inner: Any
    if pages:
        inner = _with_pages(addresses, pages)
    else:
        from starlette.applications import Starlette

        inner = Starlette(routes=addresses)
    return Guard(inner, host=host, token=token)


def _with_pages(addresses: list[Any], pages: Sequence[Page]) -> Any:
    """Return an application with NiceGUI behind the viewer's own routes; NiceGUI is imported here only, since it takes a second."""
    from fastapi import FastAPI
    from nicegui import ui

    for page in pages:
        ui.page(page.path, title=f"{page.title} - seaglint", dark=None)(page.build)  # None: as the system prefers
    app = FastAPI(routes=addresses, openapi_url=None, docs_url=None, redoc_url=None)
    ui.run_with(app, title="seaglint", dark=None, show_welcome_message=False, reconnect_timeout=10.0)
    return app


def bind(host: str, port: int | None) -> socket.socket:
    """Return a socket that listens at ``port``, or at the first free one from ``PORT`` on by default.

    Raises
    ------
    DataError
        The port is taken (the text names a free one) or may not be used, or the address is not of this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    candidates = range(PORT, PORT + _TRIED) if port is None else (port,)
    for number in candidates:
        listening = socket.socket(family, socket.SOCK_STREAM)
        # A viewer that is started again gets its port at once, without waiting for old connections to expire.
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((host, number))
            listening.listen(128)
        except OSError as error:
            listening.close()
            # Only a port that is taken is worth trying the next one.
            if error.errno == errno.EADDRINUSE:
                continue
            if error.errno in (errno.EACCES, errno.EPERM):
                raise DataError(f"port = {number}: may not be used by this account; give one above 1023") from None
            raise DataError(f"host = {host}: cannot be listened at ({error.strerror or error}); give an address of this machine") from None
        return listening
    # Port 0 lets the system choose a free one, which the error names.
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.bind((host, 0))
        free = probe.getsockname()[1]
    raise DataError(f"port = {candidates[0]}: is taken, by another viewer perhaps; port = {free} is free")


def serve(
    library: Library,
    pages: Sequence[Page] = (),
    *,
    host: str = "127.0.0.1",
    port: int | None = None,
    browser: bool = True,
    announce: Callable[[str], None] = print,
) -> None:
    """Serve until Ctrl-C.

    Parameters
    ----------
    library : Library
        Files that may be displayed.
    pages : sequence of Page
        Other pages; the first page opens where the library is empty.
    host, port : str, int
        Address to listen at; for other machines than this one a token becomes part of the address.
    browser : bool
        Open the address in a browser, where there is a display.
    announce : callable
        Called with the address, one line.

    Raises
    ------
    DataError
        The address cannot be listened at.
    """
    import uvicorn

    token = None if is_loopback(host) else new_token()
    with bind(host, port) as listening, _storage_apart():
        app = make_app(library, pages, host=host, token=token)
        config = uvicorn.Config(
            app,
            log_level="error",
            access_log=False,
            ws_max_size=MOST_BODY,
            ws_max_queue=8,
            h11_max_incomplete_event_size=16_384,
            timeout_graceful_shutdown=1,
            server_header=False,
            lifespan="on",
        )
        where = address(host, listening.getsockname()[1], token, "" if len(library) or not pages else pages[0].path)

        class Server(uvicorn.Server):
            failure: OSError | None = None

            async def startup(self, sockets: list[socket.socket] | None = None) -> None:
                # Ctrl-C reaches the server only from here on: earlier, Python may lose it in a callback of an import.
                await super().startup(sockets=sockets)
                if not self.started or self.should_exit:
                    return
                # The program postpones the search for unused cycles of objects until many exist; a viewer leaves some with every answer.
                gc.collect()
                try:
                    announce(where)
                except OSError as error:  # a closed pipe
                    self.failure, self.should_exit = error, True
                    return
                if browser:
                    # Some browsers return only when they are closed; the server must answer meanwhile.
                    threading.Thread(target=_open_browser, args=(where,), daemon=True).start()

        server = Server(config)
        try:
            server.run(sockets=[listening])
        except KeyboardInterrupt:
            return  # the usual end
        if server.failure is not None:
            raise server.failure


def address(host: str, port: int, token: str | None, path: str = "") -> str:
    """Return the address to open, with the token if one is required.

    >>> address("0.0.0.0", 8420, None).startswith("http://0.0.0.0")
    False
    """
    name = host
    # These listen at all addresses, but a browser cannot open them.
    if host in ("0.0.0.0", "::", ""):
        name = socket.gethostname()
    if ":" in name:
        name = f"[{name}]"
    return f"http://{name}:{port}{path or '/'}" + ("" if token is None else f"?token={token}")


def _open_browser(where: str) -> None:
    """Open the address where there is a display: without one, text browsers would take the terminal."""
    shown = sys.platform in ("darwin", "win32") or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"))
    opened = False
    if shown:
        import webbrowser

        with suppress(webbrowser.Error, OSError):
            opened = webbrowser.open(where)
    if not opened:
        print("seaglint: no browser could be opened here; open the address in one", file=sys.stderr, flush=True)


@contextmanager
def _storage_apart() -> Iterator[None]:
    """Provide NiceGUI with a temporary folder for its files, so that the user's working folder stays clean."""
    before = os.environ.get("NICEGUI_STORAGE_PATH")
    folder = tempfile.mkdtemp(prefix="seaglint-view-")
    os.environ["NICEGUI_STORAGE_PATH"] = folder
    try:
        yield
    finally:
        if before is None:
            del os.environ["NICEGUI_STORAGE_PATH"]
        else:
            os.environ["NICEGUI_STORAGE_PATH"] = before
        shutil.rmtree(folder, ignore_errors=True)
