"""`run` installs by uv as pip's settings say: their translation alone, then the script itself in a small project without any network."""

from __future__ import annotations

import base64
import datetime
import fcntl
import functools
import hashlib
import http.server
import ipaddress
import os
import shutil
import signal
import ssl
import subprocess
import sys
import threading
import tomllib
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

import pytest

import pip_settings
from pip_settings import SettingError, environment_lines, listed_settings, translate

ROOT = Path(__file__).resolve().parents[1]
# A virtual environment may have no pip; `run` is called with the interpreter behind it, as a visitor does.
INTERPRETER = getattr(sys, "_base_executable", None) or sys.executable
UV = shutil.which("uv", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", ""), str(ROOT / ".uv" / "bin")]))
needs_uv = pytest.mark.skipif(UV is None, reason="no uv here: ./run install, or pip install uv")
SECRET = "s3cret"


# --- the translation alone ---


def translated(settings: Mapping[str, str], environment: Mapping[str, str] | None = None) -> dict[str, str]:
    return translate(settings, environment or {}).variables


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (["global.index-url='https://a/simple'", "install.index-url='https://b/simple'"], {"index-url": "https://b/simple"}),
        (["install.index-url='https://b/simple'", ":env:.index-url='https://c/simple'"], {"index-url": "https://c/simple"}),
        ([":env:.index-url='https://c/simple'", "global.index-url='https://a/simple'"], {"index-url": "https://c/simple"}),
        (["download.no-binary='all'", "global.pre='true'"], {"pre": "true"}),
        (["global.default-timeout='60'", ":env:.timeout='5'"], {"timeout": "5"}),
        (["global.timeout='60'", ":env:.default-timeout='5'"], {"timeout": "5"}),
        (["global.find_links='\\n/a\\n/b'"], {"find-links": "/a\n/b"}),
        (["global.cert='/a.pem'", ":env:.cert=''"], {"cert": "/a.pem"}),
        (["global.Index_URL='https://a/simple'"], {"index-url": "https://a/simple"}),
        (["""global.cert="/it's/here.pem\""""], {"cert": "/it's/here.pem"}),
        (["WARNING: not a setting", ""], {}),
    ],
    ids=["section", "environment", "order", "command", "alias", "other-alias", "newline", "empty", "underscore", "quote", "noise"],
)
def test_settings_count_as_for_pip(lines: list[str], expected: dict[str, str]) -> None:
    assert listed_settings(lines) == expected


def test_without_pip_its_variables_count() -> None:
    environment = {"PIP_INDEX_URL": "https://a/simple", "PIP_FIND_LINKS": "/a\n/b", "PIP_CERT": "", "HOME": "/x"}
    assert listed_settings(environment_lines(environment)) == {"index-url": "https://a/simple", "find-links": "/a\n/b"}


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"index-url": "https://me:pass@a/simple"}, {"UV_DEFAULT_INDEX": "https://me:pass@a/simple"}),
        (
            {"extra-index-url": "https://a/simple\nhttps://b/simple"},
            {"UV_INDEX": "https://a/simple https://b/simple", "UV_INDEX_STRATEGY": "unsafe-best-match"},
        ),
        ({"find-links": "https://a/x,y.html https://b/"}, {"UV_FIND_LINKS": "https://a/x%2Cy.html,https://b/"}),
        ({"trusted-host": "a\nb:8080"}, {"UV_INSECURE_HOST": "a b:8080"}),
        ({"timeout": "2.5"}, {"UV_HTTP_TIMEOUT": "3"}),
        ({"timeout": "0"}, {"UV_HTTP_TIMEOUT": "1"}),
        ({"pre": "yes"}, {"UV_PRERELEASE": "allow"}),
        ({"pre": "0"}, {}),
        ({"constraint": "https://a/limits.txt"}, {"UV_CONSTRAINT": "https://a/limits.txt"}),
        ({"use-feature": "truststore fast-deps"}, {"UV_NATIVE_TLS": "1", "UV_SYSTEM_CERTS": "1"}),
        ({"keyring-provider": "subprocess"}, {"UV_KEYRING_PROVIDER": "subprocess"}),
        ({"keyring-provider": "auto"}, {}),
    ],
    ids=str,
)
def test_settings_have_names_in_uv(settings: dict[str, str], expected: dict[str, str]) -> None:
    assert translated(settings) == expected


@pytest.mark.parametrize("proxy", ["me:pass@proxy:3128", "http://me:pass@proxy:3128"])
def test_a_proxy_needs_no_scheme_and_replaces_that_of_the_environment(proxy: str) -> None:
    variables = translated({"proxy": proxy}, {"HTTPS_PROXY": "http://other:1"})
    names = {"HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy", "https_proxy", "all_proxy"}
    assert variables == dict.fromkeys(names, "http://me:pass@proxy:3128")


@pytest.mark.parametrize(
    ("settings", "own"),
    [
        ({"index-url": "https://a/simple"}, "UV_DEFAULT_INDEX"),
        ({"index-url": "https://a/simple"}, "UV_INDEX_URL"),
        ({"extra-index-url": "https://a/simple"}, "UV_INDEX"),
        ({"extra-index-url": "https://a/simple"}, "UV_EXTRA_INDEX_URL"),
        ({"find-links": "https://a/"}, "UV_FIND_LINKS"),
        ({"trusted-host": "a"}, "UV_INSECURE_HOST"),
        ({"timeout": "9"}, "UV_HTTP_TIMEOUT"),
        ({"constraint": "https://a/limits.txt"}, "UV_CONSTRAINT"),
        ({"pre": "1"}, "UV_PRERELEASE"),
        ({"cert": __file__}, "UV_SYSTEM_CERTS"),
    ],
)
def test_a_variable_of_uvs_own_wins(settings: dict[str, str], own: str) -> None:
    assert translated(settings) != {}
    assert translated(settings, {own: "mine"}) == {}


@pytest.mark.parametrize(
    "name", ["quiet", "verbose", "progress-bar", "cache-dir", "retries", "log", "require-virtualenv", "user", "config-file"]
)
def test_settings_that_change_no_package_are_ignored(name: str) -> None:
    assert translate({name: "1"}, {}).records() == []


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"no-binary": "numpy", "quiet": "1"}, ["no-binary"]),
        ({"no-binary": "numpy", "prefer-binary": "true"}, ["no-binary", "prefer-binary"]),
        ({"require-hashes": "0", "pre": "1"}, []),
        ({"no-build-isolation": "false"}, ["no-build-isolation"]),
        ({"use-deprecated": "legacy-resolver"}, ["use-deprecated"]),
        ({"find-links": __file__}, ["find-links"]),
        ({"not-yet-invented": "x"}, ["not-yet-invented"]),
    ],
    ids=str,
)
def test_settings_without_counterpart_are_named(settings: dict[str, str], named: list[str]) -> None:
    result = translate(settings, {})
    assert result.untranslated == named
    assert bool(result.variables) is (not named)


def test_places_that_do_not_exist_are_left_out_and_named(tmp_path: Path) -> None:
    gone, here = tmp_path / "gone", tmp_path / "here"
    here.mkdir()
    settings = {
        "find-links": f"{gone} {here}",
        "extra-index-url": f"{gone.as_uri()} {here.as_uri()}",
        "cert": f"{gone}",
        "client-cert": f"{gone}",
    }
    result = translate(settings, {})
    assert result.variables == {"UV_INDEX": here.as_uri(), "UV_INDEX_STRATEGY": "unsafe-best-match", "UV_FIND_LINKS": here.as_uri()}
    assert [message.split()[2] for message in result.messages] == ["extra-index-url", "find-links", "cert", "client-cert"]
    assert all(f"{gone}, which does not exist" in message for message in result.messages)


def test_a_missing_index_does_not_make_uv_turn_to_the_public_one(tmp_path: Path) -> None:
    result = translate({"index-url": (tmp_path / "gone").as_uri()}, {})
    assert result.variables == {"UV_DEFAULT_INDEX": (tmp_path / "gone").as_uri()}
    assert len(result.messages) == 1


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_certificates_are_a_file_or_a_folder(tmp_path: Path, kind: str) -> None:
    place = tmp_path / "certificates"
    place.mkdir() if kind == "folder" else place.touch()
    assert translated({"cert": str(place)}) == {"SSL_CERT_DIR" if kind == "folder" else "SSL_CERT_FILE": str(place)}


@pytest.mark.parametrize(
    "settings",
    [
        {"index-url": f"https://me:{SECRET}/x@host/simple"},
        {"extra-index-url": f"https://me:{SECRET}:x@host:y/simple"},
        {"proxy": f"me:{SECRET}@"},
        {"timeout": SECRET},
        {"constraint": "/nowhere/limits.txt"},
    ],
    ids=lambda settings: next(iter(settings)),
)
def test_what_pip_cannot_use_either_is_an_error_without_its_secrets(settings: dict[str, str]) -> None:
    with pytest.raises(SettingError, match=rf"pip's setting {next(iter(settings))} .*; ") as caught:
        translate(settings, {})
    assert SECRET not in str(caught.value)


def test_quiet_pip_still_lists_its_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", INTERPRETER)
    if subprocess.run([INTERPRETER, "-m", "pip", "--version"], capture_output=True, check=False).returncode:
        pytest.skip("the interpreter has no pip")
    monkeypatch.setattr(pip_settings.importlib.util, "find_spec", lambda name: name)
    monkeypatch.setenv("PIP_CONFIG_FILE", os.devnull)
    monkeypatch.setenv("PIP_QUIET", "3")
    monkeypatch.setenv("PIP_INDEX_URL", "https://a/simple")
    assert listed_settings(pip_settings.pip_lines())["index-url"] == "https://a/simple"


# --- the script in a small project ---


BACKEND = '''
"""Builds the small project's editable wheel with nothing but the standard library."""
import tomllib, zipfile

def build_editable(folder, settings=None, metadata=None):
    project = tomllib.load(open("pyproject.toml", "rb"))["project"]
    lines = ["Metadata-Version: 2.1", "Name: seaglint", "Version: 1.0"]
    for extra, requirements in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f"Requires-Dist: {requirement}; extra == '{extra}'" for requirement in requirements]
    files = {
        "METADATA": "\\n".join(lines) + "\\n",
        "WHEEL": "Wheel-Version: 1.0\\nGenerator: test\\nRoot-Is-Purelib: true\\nTag: py3-none-any\\n",
    }
    files["RECORD"] = "".join(f"seaglint-1.0.dist-info/{name},,\\n" for name in [*files, "RECORD"])
    name = "seaglint-1.0-py3-none-any.whl"
    with zipfile.ZipFile(f"{folder}/{name}", "w") as wheel:
        for file, text in files.items():
            wheel.writestr(f"seaglint-1.0.dist-info/{file}", text)
    return name
'''

# `./run tables` starts this after the environment is ready.
TABLES = "from importlib.metadata import version\nprint('sample', version('sample'))\n"


@dataclass
class Project:
    """A folder with the script `run`, a package `seaglint` that requires `sample`, and nothing else."""

    folder: Path
    environment: dict[str, str] = field(default_factory=dict)

    def start(self, **settings: object) -> subprocess.Popen[str]:
        return subprocess.Popen(
            ["bash", "run", "tables"],
            cwd=self.folder,
            env={**self.environment, **{name: str(value) for name, value in settings.items()}},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def run(self, **settings: object) -> tuple[int, str]:
        process = self.start(**settings)
        output, _ = process.communicate(timeout=120)
        return process.returncode, output

    def log(self) -> str:
        return (self.folder / ".venv" / ".install.log").read_text()

    def installs(self, version: str, by: str = "uv", **settings: object) -> str:
        status, output = self.run(**settings)
        assert status == 0, output
        assert f"sample {version}\n" in output
        assert f" s, by {by}\n" in output
        return output


@pytest.fixture
def project(tmp_path: Path) -> Project:
    folder = tmp_path / "project"
    (folder / "tools").mkdir(parents=True)
    (tmp_path / "home").mkdir()
    (tmp_path / "bin").mkdir()
    if UV is not None:
        (tmp_path / "bin" / "uv").symlink_to(UV)
    shutil.copy(ROOT / "run", folder)
    shutil.copy(ROOT / "tools" / "pip_settings.py", folder / "tools")
    (folder / "tools" / "tables.py").write_text(TABLES)
    (folder / "backend.py").write_text(BACKEND)
    extras = dict.fromkeys(tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"], "[]")
    extras["video"] = '["sample"]'
    (folder / "pyproject.toml").write_text(
        '[build-system]\nrequires = []\nbuild-backend = "backend"\nbackend-path = ["."]\n'
        '[project]\nname = "seaglint"\nversion = "1.0"\nrequires-python = ">=3.11"\n'
        "[project.optional-dependencies]\n" + "".join(f"{extra} = {requirements}\n" for extra, requirements in extras.items())
    )
    environment = {
        "PATH": f"{tmp_path / 'bin'}:/usr/local/bin:/usr/bin:/bin",
        "HOME": str(tmp_path / "home"),
        "PYTHON": INTERPRETER,
        "PIP_CONFIG_FILE": os.devnull,  # this machine's settings do not count
        "UV_NO_CONFIG": "1",
        "UV_HTTP_RETRIES": "0",
        "NO_PROXY": "localhost",
    }
    return Project(folder, environment)


def write_wheel(folder: Path, version: str) -> None:
    """Write a wheel of the package `sample`."""
    folder.mkdir(parents=True, exist_ok=True)
    about = f"sample-{version}.dist-info"
    files = {
        "sample.py": "",
        f"{about}/METADATA": f"Metadata-Version: 2.1\nName: sample\nVersion: {version}\n",
        f"{about}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    digests = {name: base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b"=").decode() for name, text in files.items()}
    record = "".join(f"{name},sha256={digests[name]},{len(text)}\n" for name, text in files.items()) + f"{about}/RECORD,,\n"
    with zipfile.ZipFile(folder / f"sample-{version}-py3-none-any.whl", "w") as wheel:
        for name, text in {**files, f"{about}/RECORD": record}.items():
            wheel.writestr(name, text)


def wheels(folder: Path, *versions: str) -> Path:
    """Return a folder of wheels."""
    for version in versions:
        write_wheel(folder, version)
    return folder


def simple_index(folder: Path, *versions: str) -> Path:
    """Return an index of packages in a folder."""
    (folder / "sample").mkdir(parents=True)
    wheels(folder / "sample", *versions)
    names = [f"sample-{version}-py3-none-any.whl" for version in versions]
    (folder / "sample" / "index.html").write_text("".join(f'<a href="{name}">{name}</a>\n' for name in names))
    return folder


@dataclass
class Server:
    """An index of packages on this machine, which may want a user and password and may be a proxy."""

    port: int
    requests: list[str]


class Handler(http.server.SimpleHTTPRequestHandler):
    """Serve a folder; `wanted` is the header of the right user and password, `refusal` the status of a request without it."""

    wanted = ""
    header = "Authorization"
    refusal = 401
    requests: list[str] = []  # noqa: RUF012  replaced in each server's own class

    def do_GET(self) -> None:
        self.requests.append(self.path)
        if self.wanted and self.headers.get(self.header) != self.wanted:
            self.send_response(self.refusal)
            self.send_header("WWW-Authenticate" if self.refusal == 401 else "Proxy-Authenticate", 'Basic realm="packages"')
            self.send_header("Content-Length", "0")
            self.end_headers()
            return
        self.path = urlsplit(self.path).path  # a proxy is called with the whole address
        super().do_GET()

    do_HEAD = do_GET

    def log_message(self, *arguments: object) -> None:
        pass


Serve = Callable[..., Server]


@pytest.fixture
def serve() -> Iterator[Serve]:
    running = []

    def start(
        folder: Path, password: str = "", context: ssl.SSLContext | None = None, kind: type = Handler, **attributes: object
    ) -> Server:
        wanted = "Basic " + base64.b64encode(f"me:{password}".encode()).decode() if password else ""
        requests: list[str] = []
        handler = type("OwnHandler", (kind,), {"wanted": wanted, "requests": requests, **attributes})
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(handler, directory=str(folder)))
        if context is not None:
            server.socket = context.wrap_socket(server.socket, server_side=True)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        running.append(server)
        return Server(server.server_address[1], requests)

    yield start
    for server in running:
        server.shutdown()
        server.server_close()


@needs_uv
def test_wheels_in_folders_and_no_index(project: Project, tmp_path: Path) -> None:
    # Every sign that a shell or uv's list of places could take for its own.
    odd = wheels(tmp_path / "a,b'\"$(touch${IFS}evaluated);%20", "2.0")
    project.installs(
        "2.0",
        PIP_NO_INDEX=1,
        PIP_FIND_LINKS=f"{wheels(tmp_path / 'old', '1.0')}\n{odd}",
        PIP_INDEX_URL=simple_index(tmp_path / "index", "9.0").as_uri(),
    )
    assert not list(project.folder.glob("evaluated"))


@needs_uv
def test_a_constraint_selects_the_older_version(project: Project, tmp_path: Path) -> None:
    (tmp_path / "limits.txt").write_text("sample<2\n")
    links = wheels(tmp_path / "wheels", "1.0", "2.0")
    project.installs("1.0", PIP_NO_INDEX=1, PIP_FIND_LINKS=links, PIP_CONSTRAINT=tmp_path / "limits.txt")


@needs_uv
def test_a_version_before_a_release_is_taken_where_pip_would_take_it(project: Project, tmp_path: Path) -> None:
    project.installs("3.0rc1", PIP_NO_INDEX=1, PIP_FIND_LINKS=wheels(tmp_path / "wheels", "1.0", "3.0rc1"), PIP_PRE="true")


@needs_uv
@pytest.mark.parametrize("best", ["index-url", "extra-index-url", "find-links"])
def test_the_best_version_of_all_indexes_is_taken(project: Project, tmp_path: Path, best: str) -> None:
    version = {place: "2.0" if place == best else "1.0" for place in ("index-url", "extra-index-url", "find-links")}
    project.installs(
        "2.0",
        PIP_INDEX_URL=simple_index(tmp_path / "first", version["index-url"]).as_uri(),
        PIP_EXTRA_INDEX_URL=simple_index(tmp_path / "second", version["extra-index-url"]),
        PIP_FIND_LINKS=wheels(tmp_path / "wheels", version["find-links"]),
    )


@needs_uv
def test_settings_in_a_file_and_places_that_do_not_exist(project: Project, tmp_path: Path) -> None:
    if subprocess.run([INTERPRETER, "-m", "pip", "--version"], capture_output=True, check=False).returncode:
        pytest.skip("the interpreter has no pip")
    links = wheels(tmp_path / "wheels", "2.0")
    (tmp_path / "pip.conf").write_text(
        f"[global]\nno-index = true\ncert = {tmp_path}/gone.pem\nfind-links =\n    {tmp_path}/gone\n    {links}\n[install]\nconstraint =\n"
    )
    output = project.installs("2.0", PIP_CONFIG_FILE=tmp_path / "pip.conf")
    assert f"== pip's setting find-links names {tmp_path}/gone, which does not exist; uv goes without it\n" in output
    assert f"== pip's setting cert names {tmp_path}/gone.pem, which does not exist; uv goes without it\n" in output


@needs_uv
def test_pip_installs_where_a_setting_has_no_counterpart(project: Project, tmp_path: Path) -> None:
    output = project.installs("2.0", by="pip", PIP_NO_INDEX=1, PIP_FIND_LINKS=wheels(tmp_path / "wheels", "2.0"), PIP_NO_BINARY="another")
    assert "== pip installs: uv has no counterpart of pip's setting no-binary\n" in output


@needs_uv
def test_pip_installs_where_uv_fails(project: Project, tmp_path: Path) -> None:
    links = wheels(tmp_path / "wheels", "2.0")
    output = project.installs("2.0", by="pip", PIP_NO_INDEX=1, PIP_FIND_LINKS=links, UV_FIND_LINKS=tmp_path / "gone")
    assert output.count("== uv failed (") == 1
    assert "); pip goes on\n" in output


@dataclass
class Certificates:
    """An authority of certificates, one of a server on this machine and one of a visitor, as files."""

    authority: Path
    server: Path
    visitor: Path


@pytest.fixture(scope="session")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Certificates:
    x509 = pytest.importorskip("cryptography.x509")
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec

    folder = tmp_path_factory.mktemp("certificates")
    authority_key = ec.generate_private_key(ec.SECP256R1())
    authority = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "Authority of the test")])
    start = datetime.datetime.now(datetime.UTC) - datetime.timedelta(days=1)

    def write(name: str, is_authority: bool) -> Path:
        key = authority_key if is_authority else ec.generate_private_key(ec.SECP256R1())
        subject = authority if is_authority else x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, name)])
        builder = x509.CertificateBuilder().subject_name(subject).issuer_name(authority).public_key(key.public_key())
        builder = (
            builder.serial_number(x509.random_serial_number()).not_valid_before(start).not_valid_after(start + datetime.timedelta(days=9))
        )
        builder = builder.add_extension(x509.BasicConstraints(ca=is_authority, path_length=None), critical=True)
        if not is_authority:
            names = [x509.DNSName("localhost"), x509.IPAddress(ipaddress.ip_address("127.0.0.1"))]
            builder = builder.add_extension(x509.SubjectAlternativeName(names), critical=False)
        pem = builder.sign(authority_key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)
        if not is_authority:
            format_ = serialization.PrivateFormat.PKCS8
            pem += key.private_bytes(serialization.Encoding.PEM, format_, serialization.NoEncryption())
        (folder / name).write_bytes(pem)
        return folder / name

    return Certificates(write("authority.pem", True), write("server.pem", False), write("visitor.pem", False))


def tls(certificates: Certificates, visitor: bool = False) -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificates.server)
    if visitor:
        context.verify_mode = ssl.CERT_REQUIRED
        context.load_verify_locations(certificates.authority)
    return context


@needs_uv
def test_certificates_of_an_organisation_and_of_a_visitor(
    project: Project, tmp_path: Path, serve: Serve, certificates: Certificates
) -> None:
    server = serve(simple_index(tmp_path / "index", "2.0"), context=tls(certificates, visitor=True))
    address = f"https://localhost:{server.port}"
    project.installs("2.0", PIP_INDEX_URL=address, PIP_CERT=certificates.authority, PIP_CLIENT_CERT=certificates.visitor)


@needs_uv
def test_without_the_certificate_a_line_says_what_to_do_and_the_same_command_goes_on(
    project: Project, tmp_path: Path, serve: Serve, certificates: Certificates
) -> None:
    server = serve(simple_index(tmp_path / "index", "2.0"), context=tls(certificates))
    address = f"https://localhost:{server.port}"
    status, output = project.run(PIP_INDEX_URL=address, PIP_RETRIES=0)
    assert status == 2
    assert (
        "the certificate of the index is not trusted; name the file of your organisation's certificates: pip config set global.cert FILE"
        in output
    )
    assert len(output.splitlines()) == 4, output  # making, installing, uv failed, packages cannot be installed
    output = project.installs("2.0", PIP_INDEX_URL=address, PIP_TRUSTED_HOST=f"localhost:{server.port}")
    assert "making .venv" not in output


@needs_uv
def test_an_index_that_asks_for_a_password(project: Project, tmp_path: Path, serve: Serve) -> None:
    server = serve(simple_index(tmp_path / "index", "2.0"), password=SECRET)
    status, output = project.run(PIP_INDEX_URL=f"http://me:not{SECRET}@localhost:{server.port}")
    assert status == 2
    last = output.splitlines()[-1]
    assert f"the index localhost:{server.port} asks for a user and password; write them into its address in pip's settings" in last
    assert "the same command goes on from here" in last
    assert f"not{SECRET}" not in output + project.log()
    output = project.installs("2.0", PIP_INDEX_URL=f"http://me:{SECRET}@localhost:{server.port}", PIP_EXTRA_INDEX_URL="file:///nowhere")
    assert SECRET not in output


@needs_uv
def test_a_refused_extra_index_leaks_nothing(project: Project, tmp_path: Path, serve: Serve) -> None:
    server = serve(simple_index(tmp_path / "index", "2.0"), password=SECRET, refusal=403)
    first = simple_index(tmp_path / "empty").as_uri()
    status, output = project.run(PIP_INDEX_URL=first, PIP_EXTRA_INDEX_URL=f"http://me:not{SECRET}@localhost:{server.port}/")
    assert status == 2
    assert f"the index localhost:{server.port} refuses (403); check its address, user and password in pip's settings" in output
    assert f"not{SECRET}" not in output + project.log()


@needs_uv
def test_a_proxy_with_a_password(project: Project, tmp_path: Path, serve: Serve) -> None:
    proxy = serve(simple_index(tmp_path / "index", "2.0"), password=SECRET, header="Proxy-Authorization", refusal=407)
    settings = {"PIP_INDEX_URL": "http://packages.invalid/", "PIP_RETRIES": 0}
    status, output = project.run(**settings, PIP_PROXY=f"me:not{SECRET}@127.0.0.1:{proxy.port}")
    assert status == 2
    assert f"not{SECRET}" not in output + project.log()
    output = project.installs("2.0", **settings, PIP_PROXY=f"me:{SECRET}@127.0.0.1:{proxy.port}")
    assert SECRET not in output
    assert "http://packages.invalid/sample/" in proxy.requests


@needs_uv
def test_without_a_network_a_line_says_so_and_the_same_command_goes_on(project: Project, tmp_path: Path) -> None:
    status, output = project.run(PIP_INDEX_URL=f"http://me:{SECRET}@127.0.0.1:9/simple", PIP_RETRIES=0)
    assert status == 2
    assert "run: packages cannot be installed (the index of packages cannot be reached; check the network" in output.splitlines()[-1]
    assert SECRET not in output + project.log()
    assert "making .venv" not in project.installs("2.0", PIP_INDEX_URL=simple_index(tmp_path / "index", "2.0").as_uri())


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        ({"PIP_INDEX_URL": f"https://me:{SECRET}/x@localhost/simple"}, "run: pip's setting index-url is no address"),
        (
            {"PIP_CONSTRAINT": "/nowhere/limits.txt"},
            "run: pip's setting constraint names /nowhere/limits.txt, which does not exist; correct it",
        ),
    ],
    ids=["address", "constraint"],
)
def test_settings_that_nobody_can_use_end_in_one_line(project: Project, settings: dict[str, str], line: str) -> None:
    status, output = project.run(**settings)
    assert status == 2
    assert output.splitlines()[-1].startswith(line)
    assert SECRET not in output


@pytest.mark.parametrize(
    ("text", "masked"),
    [
        (f"https://me:{SECRET}@host/simple", "https://****@host/simple"),
        (f"(http://{SECRET}@host/simple, x)", "(http://****@host/simple, x)"),
        (f"https://me:{SECRET}@{SECRET}/x@host", "https://****@host"),
        (f"proxy 'me:{SECRET}@host:3128'", "proxy '****@host:3128'"),
        ("file:///places/me@work/wheels", "file:///places/me@work/wheels"),
        ("seaglint @ file:///places/x", "seaglint @ file:///places/x"),
    ],
    ids=["user", "token", "slash", "proxy", "file", "requirement"],
)
def test_addresses_are_masked(text: str, masked: str) -> None:
    script = (ROOT / "run").read_text()
    function = script[script.index("mask() {") :].split("\n}\n")[0] + "\n}\nmask"
    process = subprocess.run(["bash", "-c", function], input=text, capture_output=True, text=True, check=True)
    assert process.stdout == masked


@needs_uv
def test_two_at_once_make_the_environment_once(project: Project, tmp_path: Path) -> None:
    settings = {"PIP_NO_INDEX": 1, "PIP_FIND_LINKS": wheels(tmp_path / "wheels", "2.0")}
    processes = [project.start(**settings) for _ in range(2)]
    outputs = [process.communicate(timeout=120)[0] for process in processes]
    assert [process.returncode for process in processes] == [0, 0], outputs
    assert all("sample 2.0\n" in output for output in outputs)
    assert sum("== making .venv" in output for output in outputs) == 1
    assert sum("== environment ready" in output for output in outputs) == 1


def test_the_second_waits_with_a_line_and_not_for_one_that_died(project: Project, tmp_path: Path) -> None:
    owner = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "import fcntl, sys; f = open('.run.lock', 'w'); fcntl.flock(f, fcntl.LOCK_EX); print('held', flush=True); input()",
        ],
        cwd=project.folder,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert owner.stdout is not None
    assert owner.stdout.readline() == "held\n"
    process = project.start(PIP_NO_INDEX=1, PIP_FIND_LINKS=wheels(tmp_path / "wheels", "2.0"))
    assert process.stdout is not None
    assert process.stdout.readline() == "== another ./run makes the environment; waiting\n"
    assert not (project.folder / ".venv").exists()
    owner.send_signal(signal.SIGKILL)
    owner.wait()
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 0, output
    assert "sample 2.0\n" in output
    with (project.folder / ".run.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # released


@needs_uv
def test_an_installation_that_was_cut_off_is_made_anew(project: Project, tmp_path: Path, serve: Serve) -> None:
    reached, go_on = threading.Event(), threading.Event()

    class Slow(Handler):
        def do_GET(self) -> None:
            reached.set()
            go_on.wait(60)
            super().do_GET()

    links = wheels(tmp_path / "wheels", "2.0")
    project.installs("2.0", PIP_NO_INDEX=1, PIP_FIND_LINKS=links)
    pyproject = project.folder / "pyproject.toml"
    pyproject.write_text(pyproject.read_text() + "# changed\n")
    (project.folder / ".venv" / "half").touch()
    process = project.start(PIP_INDEX_URL=f"http://localhost:{serve(tmp_path, kind=Slow).port}")
    assert reached.wait(60)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    go_on.set()
    project.installs("2.0", PIP_NO_INDEX=1, PIP_FIND_LINKS=links)
    assert not (project.folder / ".venv" / "half").exists()


def in_small_disk(project: Project, folder: Path, size: str, command: str, **settings: object) -> tuple[int, str]:
    """Run a shell command where `folder` is a disk of its own of this size, without rights of an administrator."""
    mount = f'mount -t tmpfs -o size={size} tmpfs "{folder}"'
    unshare = ["unshare", "--user", "--map-root-user", "--mount", "bash", "-c"]
    if shutil.which("unshare") is None or subprocess.run([*unshare, mount], capture_output=True, check=False).returncode:
        pytest.skip("no small disk can be made here (unshare, mount)")
    process = subprocess.run(
        [*unshare, f"{mount} && cd '{project.folder}' && {command}"],
        env={**project.environment, **{name: str(value) for name, value in settings.items()}},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
        check=False,
    )
    return process.returncode, process.stdout


@needs_uv
def test_a_home_folder_without_room(project: Project, tmp_path: Path) -> None:
    settings = {"PIP_NO_INDEX": 1, "PIP_FIND_LINKS": wheels(tmp_path / "wheels", "2.0")}
    status, output = in_small_disk(project, tmp_path / "home", "4k", "head -c 4096 /dev/zero >$HOME/all; bash run tables", **settings)
    assert status == 0, output
    assert "sample 2.0\n" in output
    assert "by uv\n" in output
    assert not (project.folder / ".venv" / ".uv-cache").exists()


@needs_uv
def test_a_disk_without_room_and_the_same_command_goes_on(project: Project, tmp_path: Path) -> None:
    settings = {"PIP_NO_INDEX": 1, "PIP_FIND_LINKS": wheels(tmp_path / "wheels", "2.0")}
    disk = tmp_path / "disk"  # not the project's own folder or .venv: a mount cannot be removed
    disk.mkdir()
    fill = f"cp -r . '{disk}' && cd '{disk}' && head -c 990000 /dev/zero >all; bash run tables; echo status $?"
    command = f"{fill}; rm all; mount -o remount,size=200m '{disk}'; bash run tables"
    status, output = in_small_disk(project, disk, "1m", command, **settings)
    assert status == 0, output
    first, second = output.split("status 2\n")
    assert "no room left on the disk" in first.splitlines()[-1]
    assert "sample 2.0\n" in second
