"""Server of the viewer: an address and its pages; no data leave the machine."""

from __future__ import annotations

import errno
import gc
import os
import shutil
import socket
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from seaglint.base.errors import DataError
from seaglint.base.optional import missing
from seaglint.viewer.safety import MOST_BODY, Application, Guard, is_loopback, new_token

if TYPE_CHECKING:
    from seaglint.viewer.library import Library

PORT: Final = 8420  #: First port that the viewer tries.

_TRIED: Final = 50  # ports after it


@dataclass(frozen=True)
class Page:
    """Page made of NiceGUI's elements."""

    path: str  #: Path of the page: ``"/workbench"``.
    title: str  #: Title of the browser's tab, and of the link to it.
    build: Callable[[], None]  #: Fills the page; called for every browser that opens it.
    routes: tuple[Any, ...] = ()  #: Starlette routes that the page needs beside it, under ``/api/``.


def workbench(scenario: str | Path | None = None) -> Page:
    """Return the workbench page, which changes a scenario of a file or a preset and shows its pictures."""
    from seaglint.viewer.workbench import page

    return Page("/workbench", "Scenario workbench", lambda: page(scenario))


def require_installed() -> None:
    """Check that NiceGUI is installed.

    Raises
    ------
    BackendError
        NiceGUI or what it stands on is not installed.
    """
    from importlib.util import find_spec

    if any(find_spec(name) is None for name in ("nicegui", "starlette", "uvicorn")):
        raise missing("the viewer", "nicegui")


def make_app(library: Library, pages: Sequence[Page] = (), *, host: str = "127.0.0.1", token: str | None = None) -> Application:
    """Return the ASGI application: sequences at ``/``, the pages at their paths, behind the :class:`~seaglint.viewer.safety.Guard`."""
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
        ui.page(page.path, title=f"{page.title} - seaglint", dark=True)(page.build)
    app = FastAPI(routes=addresses, openapi_url=None, docs_url=None, redoc_url=None)
    ui.run_with(app, title="seaglint", dark=True, show_welcome_message=False, reconnect_timeout=10.0)
    return app


def bind(host: str, port: int | None) -> socket.socket:
    """Return a socket that listens at ``port``, or at the first free one from :data:`PORT` on where none is given.

    Raises
    ------
    DataError
        The port is taken (the text names a free one) or may not be used, or the address is not of this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    candidates = range(PORT, PORT + _TRIED) if port is None else (port,)
    for number in candidates:
        made = socket.socket(family, socket.SOCK_STREAM)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            made.bind((host, number))
            made.listen(128)
        except OSError as error:
            made.close()
            if error.errno == errno.EADDRINUSE:
                continue
            if error.errno in (errno.EACCES, errno.EPERM):
                raise DataError(f"port = {number}: may not be used by this account; give one above 1023") from None
            raise DataError(f"host = {host}: cannot be listened at ({error.strerror or error}); give an address of this machine") from None
        return made
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
        Files that may be looked at.
    pages : sequence of Page
        Other pages; the first one opens where the library is empty.
    host, port : str, int
        Address to listen at; beyond the own machine a token becomes part of it.
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
                # Only here does the server hear Ctrl-C: before, Python may lose it in a callback of an import.
                await super().startup(sockets=sockets)
                if not self.started or self.should_exit:
                    return
                # The program puts off the search for unused circles of objects until many are made; a viewer leaves some with each answer.
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
            return  # the ordinary end
        if server.failure is not None:
            raise server.failure


def address(host: str, port: int, token: str | None, path: str = "") -> str:
    """Return the address to open, with the token where there is one.

    >>> address("0.0.0.0", 8420, None).startswith("http://0.0.0.0")
    False
    """
    name = host
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

        try:
            opened = webbrowser.open(where)
        except (webbrowser.Error, OSError):
            opened = False
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
