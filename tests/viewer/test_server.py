"""What the server answers, and what it does not."""

from __future__ import annotations

import gc
import json
import os
import socket
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from seaglint.base.errors import BackendError, DataError

pytest.importorskip("starlette", reason="the viewer's extra is not installed")
httpx = pytest.importorskip("httpx", reason="httpx is not installed")

from seaglint.viewer import server  # noqa: E402
from seaglint.viewer.jobs import Jobs, PageJob, StoppedError  # noqa: E402
from seaglint.viewer.library import Library  # noqa: E402
from seaglint.viewer.server import MOST_ADDRESS, MOST_BODY, Guard  # noqa: E402

from .conftest import COLUMNS, ROWS, radiance  # noqa: E402

HOST = "127.0.0.1:8420"


async def _ask(app, method: str, path: str, **more):
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url=f"http://{HOST}") as client:
        return await client.request(method, path, **more)


def ask(app, path: str, method: str = "GET", **more):
    import asyncio

    return asyncio.run(_ask(app, method, path, **more))


@pytest.fixture(scope="module")
def app(store):
    return server.make_app(Library([store]))


def test_frame_is_a_byte_a_pixel_with_its_scale(app):
    found = ask(app, "/api/frame/0/3?layer=radiance&scaling=linear&low=0&high=10")
    levels = np.frombuffer(found.content, np.uint8).reshape(ROWS, COLUMNS)
    expected = np.clip(1 + np.floor(254 * radiance(3) / 10 + 0.5), 1, 255)
    assert np.abs(levels - expected).max() <= 1  # rounding of single precision
    scale = json.loads(found.headers["seaglint-scale"])
    assert scale == {"shares": [0.0, 0.25, 0.5, 0.75, 1.0], "values": [0.0, 2.5, 5.0, 7.5, 10.0], "unit": "W m⁻² sr⁻¹"}


def test_frame_that_the_browser_has_is_not_sent_again(app):
    path = "/api/frame/0/3?layer=radiance"
    etag = ask(app, path).headers["etag"]
    again = ask(app, path, headers={"if-none-match": etag})
    assert (again.status_code, again.content) == (304, b"")
    assert ask(app, "/api/frame/0/4?layer=radiance", headers={"if-none-match": etag}).status_code == 200


def test_exports_are_the_stores_values(app):
    import io

    import tifffile
    from PIL import Image

    assert np.array_equal(np.load(io.BytesIO(ask(app, "/api/export/frame/0/2/npy?layer=radiance").content)), radiance(2))
    assert np.array_equal(tifffile.imread(io.BytesIO(ask(app, "/api/export/frame/0/2/tif?layer=radiance").content)), radiance(2))
    found = ask(app, "/api/export/frame/0/2/png?layer=radiance&scaling=linear&low=0&high=10&colours=black-hot")
    picture = np.asarray(Image.open(io.BytesIO(found.content)).convert("L"))
    levels = np.frombuffer(ask(app, "/api/frame/0/2?layer=radiance&scaling=linear&low=0&high=10").content, np.uint8)
    assert np.array_equal(picture.ravel(), 255 - levels)
    assert found.headers["content-disposition"] == 'attachment; filename="run-radiance-00002.png"'


def test_clip_has_the_frames_asked_for(app, tmp_path):
    av = pytest.importorskip("av", reason="PyAV is not installed")
    (tmp_path / "clip.mp4").write_bytes(ask(app, "/api/export/clip/0?first=2&last=6&layer=radiance").content)
    with av.open(str(tmp_path / "clip.mp4")) as film:
        assert sum(1 for _ in film.decode(video=0)) == 5


def test_boxes_are_the_truths(app):
    assert ask(app, "/api/truth/0/3").json()["boxes"] == [
        {"name": "boat", "left": 13.0, "top": 20.0, "width": 8.0, "height": 4.0, "range_m": 1200.0}
    ]


@pytest.mark.parametrize(
    ("path", "told"),
    [
        ("/api/frame/0/99", "frame 99: run.zarr has 12, from 0"),
        ("/api/frame/7/0", "source 7: the list has 1 files"),
        ("/api/frame/0/0?layer=../secret", "has no layer '../secret'"),
        ("/api/frame/0/0?scaling=magic", "allowed are linear, percentile, plateau"),
        ("/api/frame/0/0?low=3&high=1", "the smaller first"),
        ("/api/frame/0/0?low=nan&high=1", "give a finite number"),
        ("/api/probe/0/0?row=1.5&column=2", "give a whole number"),
        ("/api/probe/0/0?column=2", "row: is missing"),
        ("/api/export/frame/0/0/exe", "saved as .png, .npy, .tif"),
        ("/api/job/77", "start it again"),
    ],
)
def test_what_cannot_be_is_told(app, path, told):
    found = ask(app, path)
    assert found.status_code == 409
    assert told in found.json()["error"]


@pytest.mark.parametrize(
    "path",
    [
        "/static/../server.py",
        "/static/..%2fserver.py",
        "/static/%2e%2e/%2e%2e/cli/app.py",
        "/api/frame/../../etc/passwd",
        "/%2Fetc/passwd",
        "/api/source/-1",
        "/api/source/0%00",
        "/api/frame/0/0/extra",
        "/run.zarr/zarr.json",
        "/.env",
    ],
)
def test_nothing_is_served_by_path(app, path):
    found = ask(app, path)
    assert found.status_code == 404
    assert b"import" not in found.content


def test_the_icon_that_browsers_ask_for_is_there(app):
    found = ask(app, "/favicon.ico")
    assert (found.status_code, found.headers["content-type"]) == (200, "image/svg+xml")


def test_folder_offers_what_lies_in_it_and_no_link_out(store, tmp_path):
    inside = tmp_path / "data"
    inside.mkdir()
    np.save(inside / "own.npy", radiance(0))
    np.save(tmp_path / "secret.npy", radiance(1))
    (inside / "link.npy").symlink_to(tmp_path / "secret.npy")
    (inside / "notes.txt").write_text("x")
    library = Library([], folder=inside)
    assert [entry["name"] for entry in library.listed()] == ["own.npy"]
    # A file that was listed and is replaced by a link out of the folder is not opened.
    (inside / "own.npy").unlink()
    (inside / "own.npy").symlink_to(tmp_path / "secret.npy")
    with pytest.raises(DataError, match="leads out of the folders"):
        library.source(0)


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"host": "evil.example"}, 403),
        ({"host": "127.0.0.1.evil.example:8420"}, 403),
        ({"host": "192.168.1.5:8420"}, 403),
        ({"host": ""}, 403),
        ({"origin": "http://evil.example"}, 403),
        ({"origin": "http://127.0.0.1:9999"}, 403),
        ({"origin": "null"}, 403),
        ({"sec-fetch-site": "cross-site", "sec-fetch-mode": "no-cors"}, 403),
        ({"content-length": str(MOST_BODY + 1)}, 413),
        ({"content-length": "-5"}, 400),
        ({"origin": f"http://{HOST}"}, 200),
        ({"host": "localhost:8420"}, 200),
        ({"host": "[::1]:8420"}, 200),
        ({"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate"}, 200),
    ],
)
def test_requests_of_other_sites_are_refused(app, headers, status):
    assert ask(app, "/api/session", headers=headers).status_code == status


def test_long_addresses_are_refused(app):
    assert ask(app, "/api/session?x=" + "a" * MOST_ADDRESS).status_code == 414


def test_pages_may_ask_nothing_of_others(app):
    policy = ask(app, "/").headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "http" not in policy
    assert "unsafe-eval" not in policy


def test_body_without_a_length_ends_where_it_is_too_large():
    import asyncio

    taken = []

    async def inner(scope, receive, send):
        while (message := await receive())["type"] == "http.request":
            taken.append(len(message["body"]))

    async def receive():
        return {"type": "http.request", "body": b"x" * 300_000, "more_body": True}

    async def send(message):
        pass

    scope = {"type": "http", "path": "/", "headers": [(b"host", HOST.encode())], "server": ("127.0.0.1", 8420)}
    asyncio.run(Guard(inner)(scope, receive, send))
    assert sum(taken) <= MOST_BODY


@pytest.mark.parametrize(("origin", "accepted"), [(f"http://{HOST}", True), ("http://evil.example", False)])
def test_websockets_of_other_sites_are_refused_and_large_messages_end_them(origin, accepted):
    import asyncio

    seen, sent = [], []
    waiting = [{"type": "websocket.connect"}, {"type": "websocket.receive", "text": "x" * (MOST_BODY + 1)}]

    async def inner(scope, receive, send):
        seen.extend([await receive(), await receive()])

    async def receive():
        return waiting.pop(0)

    async def send(message):
        sent.append(message)

    headers = [(b"host", HOST.encode()), (b"origin", origin.encode())]
    asyncio.run(Guard(inner)({"type": "websocket", "path": "/x", "headers": headers, "server": ("127.0.0.1", 8420)}, receive, send))
    assert [m["type"] for m in seen] == (["websocket.connect", "websocket.disconnect"] if accepted else [])
    assert [m["code"] for m in sent] == [1009 if accepted else 1008]


def test_beyond_the_own_machine_a_token_is_asked_for(store):
    app = server.make_app(Library([store]), host="0.0.0.0", token="right")
    assert ask(app, "/").status_code == 401
    assert ask(app, "/?token=wrong").status_code == 401
    assert ask(app, "/api/session", headers={"cookie": "seaglint-None=wrong"}).status_code == 401
    greeted = ask(app, "/?token=right")
    assert (greeted.status_code, greeted.headers["location"]) == (303, "/")
    cookie = greeted.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    assert ask(app, "/api/session", headers={"cookie": cookie.split(";")[0]}).status_code == 200
    assert ask(app, "/%2Fevil.example/?token=right").headers["location"] == "/evil.example/"
    assert ask(app, "/", headers={"host": "192.168.1.5:8420"}).status_code == 401  # a number may be how the machine is reached
    assert ask(app, "/", headers={"host": "evil.example:8420"}).status_code == 403


def test_fifty_clients_at_once(store):
    app = server.make_app(Library([store]))
    with ThreadPoolExecutor(50) as clients:
        found = list(clients.map(lambda n: ask(app, f"/api/frame/0/{n % 12}?layer=radiance&scaling=linear&low=0&high=10"), range(50)))
    first = {n: np.frombuffer(found[n].content, np.uint8) for n in range(12)}
    assert all(np.array_equal(np.frombuffer(answer.content, np.uint8), first[n % 12]) for n, answer in enumerate(found))


def test_jobs_that_nobody_waits_for_end():
    job = PageJob(requested=time.monotonic() - 60.0)
    with pytest.raises(StoppedError):
        job.progress(1, 2)
    jobs = Jobs()
    number = jobs.start(lambda progress: {"done": progress(1, 2)})
    assert jobs.get(number).finished.wait(600.0)
    assert jobs.get(number).result == {"done": None}


def test_taken_port_names_a_free_one():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(DataError, match=rf"port = {port}: is taken.*port = \d+ is free"):
            server.bind("127.0.0.1", port)
    with pytest.raises(DataError, match="give an address of this machine"):
        server.bind("203.0.113.7", None)


def test_missing_extra_is_one_line(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(BackendError, match=r"pip install 'nicegui>=3\.0'"):
        server.require_installed()


def test_without_display_the_address_is_told(monkeypatch, capsys):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    server._open_browser("http://127.0.0.1:1/")
    assert "open the address in one" in capsys.readouterr().err


@pytest.mark.validation
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="no /proc to read the memory from")
def test_memory_is_flat_over_10_000_frames(tmp_path):
    import asyncio

    gc.collect()  # ends what a command in this process may have put off
    stored = np.lib.format.open_memmap(tmp_path / "long.npy", "w+", np.float32, (10_000, 128, 160))  # holes: no disk is filled
    stored[::500] = 1.0
    del stored
    app = server.make_app(Library([tmp_path / "long.npy"]))

    def resident() -> int:
        return next(int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmRSS"))

    async def watch() -> list[int]:
        told = []
        async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url=f"http://{HOST}") as client:
            for index in range(10_000):
                assert (await client.get(f"/api/frame/0/{index}?scaling=plateau")).status_code == 200
                if index % 1000 == 999:
                    told.append(resident())
        return told

    told = asyncio.run(watch())
    assert told[-1] - told[1] < 16_000  # kB; the frames read meanwhile are 650 MB


@pytest.mark.validation
def test_command_serves_until_it_is_told_to_end(store, tmp_path):
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "seaglint.cli.app", "view", str(store), "--no-browser", "--port", str(port)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=tmp_path, env=environment) as running:
        assert running.stdout is not None
        assert running.stdout.readline().strip() == f"http://127.0.0.1:{port}/"
        assert httpx.get(f"http://127.0.0.1:{port}/api/session", trust_env=False).json()["given"] == 1
        with socket.create_connection(("127.0.0.1", port)) as rude:
            rude.sendall(b"\x00\xff nonsense\r\n\r\n")
            assert b"200" not in rude.recv(1000)
        assert httpx.get(f"http://127.0.0.1:{port}/", trust_env=False).status_code == 200
        running.send_signal(2)
        assert running.wait(600) == 0
    assert list(Path(tmp_path).iterdir()) == []


def serve_apart(store: Path, folder: Path, announce: str, *, browser: str = "None", first: str = "") -> subprocess.CompletedProcess[str]:
    """Serve in a process of its own, whose Ctrl-C ends no other; what is given is Python."""
    program = f"""
import gc, os, signal, sys, threading, httpx
from seaglint.viewer import server
from seaglint.viewer.library import Library

answered = threading.Event()
press_ctrl_c = lambda: os.kill(os.getpid(), signal.SIGINT)

def visit(where):
    print(httpx.get(where + "api/session", trust_env=False).status_code)
    answered.set()
    press_ctrl_c()

server._open_browser = {browser}
{first}
server.serve(Library([sys.argv[1]]), browser=server._open_browser is not None, announce=lambda where: {announce})
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", program, str(store)]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment, timeout=600, check=False)


def test_ctrl_c_at_the_moment_of_the_address_ends_the_viewer(store, tmp_path):
    ended = serve_apart(store, tmp_path, "(print(where), press_ctrl_c())")
    assert (ended.returncode, ended.stdout[:17], ended.stderr) == (0, "http://127.0.0.1:", "")


def test_a_viewer_searches_for_unused_memory_again(store, tmp_path):
    later = "__import__('seaglint.cli.terminal.program', fromlist=['start']).collect_later()"
    ended = serve_apart(
        store, tmp_path, "(print(gc.get_threshold() == before), press_ctrl_c())", first=f"before = gc.get_threshold(); {later}"
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "True\n", "")


def test_a_browser_that_stays_open_does_not_keep_the_viewer_from_answering(store, tmp_path):
    """Some browsers return only when they are closed."""
    visitor = "threading.Thread(target=visit, args=(where,)).start()"
    ended = serve_apart(store, tmp_path, visitor, browser="lambda where: (print('opened', flush=True), answered.wait(600))")
    assert (ended.returncode, sorted(ended.stdout.split()), ended.stderr) == (0, ["200", "opened"], "")


def test_an_address_that_cannot_be_printed_ends_the_viewer_with_that_error_alone(store, tmp_path):
    ended = serve_apart(store, tmp_path, "(_ for _ in ()).throw(BrokenPipeError(32, 'Broken pipe'))")
    assert ended.returncode == 1
    assert ended.stderr.splitlines()[-1] == "BrokenPipeError: [Errno 32] Broken pipe"
    assert ended.stderr.count("Traceback") == 1
