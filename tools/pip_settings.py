#!/usr/bin/env python3
"""Translate pip's settings (`pip config list`, `PIP_*`) to those of uv, which reads neither.

`run` calls this with the interpreter that it found, before there is an environment: standard library only. The output is a list of records,
each closed by a NUL byte, which `read -d ''` reads without any evaluation by the shell:

    NAME=VALUE        a variable for uv
    option=--no-index an option for uv, where uv has no variable
    say=TEXT          a message
    pip=SETTINGS      uv has no counterpart of these settings: pip installs
    error=TEXT        neither uv nor pip can install with a setting
    end=              nothing was cut off

Values hold passwords; messages hold none.
"""

from __future__ import annotations

import ast
import importlib.util
import math
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

#: Two names of one setting.
ALIASES = {"default-timeout": "timeout", "pypi-url": "index-url"}

#: Settings that change nothing about what is installed into an environment.
IGNORED = frozenset(
    [
        "break-system-packages",
        "cache-dir",
        "check-build-dependencies",
        "compile",
        "config-file",
        "debug",
        "disable-pip-version-check",
        "exists-action",
        "help",
        "isolated",
        "log",
        "log-file",
        "no-cache-dir",
        "no-clean",
        "no-color",
        "no-compile",
        "no-input",
        "no-python-version-warning",
        "no-warn-conflicts",
        "no-warn-script-location",
        "progress-bar",
        "quiet",
        "report",
        "require-venv",
        "require-virtualenv",
        "resume-retries",
        "retries",
        "root-user-action",
        "src",
        "upgrade-strategy",
        "use-pep517",
        "user",
        "verbose",
        "version",
    ]
)

#: Settings that uv has under a name of its own.
TRANSLATED = frozenset(
    [
        "index-url",
        "extra-index-url",
        "find-links",
        "no-index",
        "cert",
        "client-cert",
        "trusted-host",
        "proxy",
        "timeout",
        "constraint",
        "build-constraint",
        "pre",
        "keyring-provider",
        "use-feature",
        "use-deprecated",
    ]
)

#: Values of `use-feature` and `use-deprecated` that change nothing about what is installed; the trust store has a counterpart.
FEATURES = frozenset(
    {"2020-resolver", "build-constraint", "fast-deps", "in-tree-build", "inprocess-build-deps", "legacy-certs", "truststore"}
)

FALSE = frozenset({"n", "no", "f", "false", "off", "0"})

#: The order in which pip's sections count, the last one first of all. Sections of other commands, as `download`, do not count.
SECTIONS = ("global", "install", ":env:")


class SettingError(Exception):
    """A setting that neither uv nor pip can use."""


@dataclass
class Translation:
    """What uv needs to install as pip would."""

    variables: dict[str, str] = field(default_factory=dict)
    options: list[str] = field(default_factory=list)
    messages: list[str] = field(default_factory=list)
    untranslated: list[str] = field(default_factory=list)

    def records(self) -> list[str]:
        """Return the records of the output, without the closing one."""
        result = [f"say={message}" for message in self.messages]
        if self.untranslated:
            return [*result, f"pip={', '.join(self.untranslated)}"]
        return [*result, *(f"option={option}" for option in self.options), *(f"{name}={value}" for name, value in self.variables.items())]


def listed_settings(lines: Iterable[str]) -> dict[str, str]:
    """Return the settings of `pip install` by name from the lines of `pip config list`; empty values do not count, as for pip."""
    sections: dict[str, dict[str, str]] = {section: {} for section in SECTIONS}
    for line in lines:
        match = re.fullmatch(r"(:env:|[^.=]+)\.([^=]+)=(.*)", line.strip())
        if match is None or match[1] not in sections:
            continue
        try:
            value = str(ast.literal_eval(match[3])).strip()
        except (SyntaxError, ValueError):
            value = match[3].strip()
        if value:
            name = match[2].lower().replace("_", "-").lstrip("-")
            sections[match[1]][ALIASES.get(name, name)] = value
    result: dict[str, str] = {}
    for section in SECTIONS:
        result.update(sections[section])
    return result


def environment_lines(environment: Mapping[str, str]) -> list[str]:
    """Return `PIP_*` as `pip config list` would list it."""
    return [f":env:.{name[4:].lower()}={value!r}" for name, value in environment.items() if name.startswith("PIP_")]


def pip_lines() -> list[str]:
    """Return the lines of `pip config list` of this interpreter; where it has no pip only `PIP_*` counts."""
    if importlib.util.find_spec("pip") is None:
        return environment_lines(os.environ)
    process = subprocess.run(
        [sys.executable, "-m", "pip", "config", "list"],
        env={**os.environ, "PIP_QUIET": "0", "PIP_VERBOSE": "0"},  # a quiet pip lists nothing
        capture_output=True,
        text=True,
        check=False,
    )
    if process.returncode:
        raise SettingError(f"pip's settings cannot be read; this says why: {sys.executable} -m pip config list")
    return process.stdout.splitlines()


def local_path(place: str) -> Path | None:
    """Return the path of a place on this machine; None for one that is reached over a network."""
    if place.lower().startswith("file:"):
        return Path(url2pathname(urlsplit(place).path))
    return None if "://" in place else Path(place).expanduser().absolute()


def checked_address(setting: str, address: str) -> str:
    """Return an address whose parts are readable: pip and uv quote the others, password included."""
    try:
        readable = urlsplit(address).hostname is not None and (urlsplit(address).port or 1) > 0
    except ValueError:
        readable = False
    if not readable:
        raise SettingError(
            f"pip's setting {setting} is no address, as https://USER:PASSWORD@HOST/PATH is; "
            "write @ : / in a user or password as %40 %3A %2F (pip config list shows it)"
        )
    return address


def missing(setting: str, path: Path, consequence: str) -> str:
    """Return the message on a place that does not exist."""
    return f"pip's setting {setting} names {path}, which does not exist; {consequence}"


def translate(settings: Mapping[str, str], environment: Mapping[str, str]) -> Translation:
    """Return pip's settings in uv's names; variables of uv's own in the environment win."""
    result = Translation()
    result.untranslated = untranslated(settings)
    if result.untranslated:
        return result
    translate_indexes(settings, environment, result)
    translate_links(settings, environment, result)
    translate_network(settings, environment, result)
    translate_certificates(settings, environment, result)
    for setting, name in (("constraint", "UV_CONSTRAINT"), ("build-constraint", "UV_BUILD_CONSTRAINT")):
        if setting in settings and name not in environment:
            result.variables[name] = " ".join(constraint(setting, place) for place in settings[setting].split())
    if settings.get("keyring-provider") == "subprocess" and "UV_KEYRING_PROVIDER" not in environment:
        result.variables["UV_KEYRING_PROVIDER"] = "subprocess"
    if is_on(settings, "pre") and "UV_PRERELEASE" not in environment:
        result.variables["UV_PRERELEASE"] = "allow"
    return result


def is_on(settings: Mapping[str, str], setting: str) -> bool:
    """Return whether a switch is set, as pip reads it."""
    return settings.get(setting, "no").lower() not in FALSE


def untranslated(settings: Mapping[str, str]) -> list[str]:
    """Return the names of settings without counterpart."""
    result = []
    for name, value in settings.items():
        if name in IGNORED:
            continue
        if name in ("use-feature", "use-deprecated"):
            known = set(value.split()) <= FEATURES
        elif name == "find-links":
            paths = [local_path(place) for place in value.split()]
            known = not any(path is not None and path.is_file() and path.suffix.lower() not in (".htm", ".html") for path in paths)
        else:
            # A switch that is off says nothing; pip reads that of build isolation both ways.
            known = name in TRANSLATED or (value.lower() in FALSE and name != "no-build-isolation")
        if not known:
            result.append(name)
    return result


def translate_indexes(settings: Mapping[str, str], environment: Mapping[str, str], result: Translation) -> None:
    """Translate index-url, extra-index-url and no-index."""
    if is_on(settings, "no-index"):
        result.options.append("--no-index")
        return
    if "index-url" in settings and not {"UV_DEFAULT_INDEX", "UV_INDEX_URL"} & environment.keys():
        place = settings["index-url"]
        path = local_path(place)
        if path is not None and not path.exists():
            # uv takes it for an empty index; without it, uv would turn to the public index.
            result.messages.append(missing("index-url", path, "no packages come from it"))
        result.variables["UV_DEFAULT_INDEX"] = index("index-url", place)
    if "extra-index-url" in settings and not {"UV_INDEX", "UV_EXTRA_INDEX_URL"} & environment.keys():
        places = existing("extra-index-url", settings["extra-index-url"].split(), result)
        if places:
            result.variables["UV_INDEX"] = " ".join(index("extra-index-url", place) for place in places)
            if "UV_INDEX_STRATEGY" not in environment:
                result.variables["UV_INDEX_STRATEGY"] = "unsafe-best-match"  # pip takes the best version of all indexes


def existing(setting: str, places: list[str], result: Translation) -> list[str]:
    """Return the places that exist as far as this machine can tell, with a message on each other: uv would fail where pip goes on."""
    kept = []
    for place in places:
        path = local_path(place)
        if path is None or path.exists():
            kept.append(place)
        else:
            result.messages.append(missing(setting, path, "uv goes without it"))
    return kept


def index(setting: str, place: str) -> str:
    """Return an index as an address."""
    path = local_path(place)
    return checked_address(setting, place) if path is None else path.as_uri()


def translate_links(settings: Mapping[str, str], environment: Mapping[str, str], result: Translation) -> None:
    """Translate find-links; uv separates them by commas."""
    if "find-links" in settings and "UV_FIND_LINKS" not in environment:
        places = existing("find-links", settings["find-links"].split(), result)
        if places:
            result.variables["UV_FIND_LINKS"] = ",".join(index("find-links", place).replace(",", "%2C") for place in places)


def constraint(setting: str, place: str) -> str:
    """Return a file of constraints as an address. A missing one stops pip too: without it other versions would be installed."""
    path = local_path(place)
    if path is None:
        return checked_address(setting, place)
    if not path.exists():
        raise SettingError(missing(setting, path, f"correct it: pip config list, PIP_{setting.upper().replace('-', '_')}"))
    return path.as_uri()


def translate_network(settings: Mapping[str, str], environment: Mapping[str, str], result: Translation) -> None:
    """Translate proxy, trusted-host and timeout. As for pip, its own proxy counts more than one of the environment."""
    if "proxy" in settings:
        proxy = settings["proxy"]
        proxy = checked_address("proxy", proxy if "://" in proxy else f"http://{proxy}")
        for name in ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY"):
            result.variables |= {name: proxy, name.lower(): proxy}
    if "trusted-host" in settings and "UV_INSECURE_HOST" not in environment:
        result.variables["UV_INSECURE_HOST"] = " ".join(settings["trusted-host"].split())
    if "timeout" in settings and not {"UV_HTTP_TIMEOUT", "UV_REQUEST_TIMEOUT"} & environment.keys():
        try:
            seconds = math.ceil(float(settings["timeout"]))
        except (OverflowError, ValueError):
            raise SettingError("pip's setting timeout is no number of seconds; correct it: pip config list, PIP_DEFAULT_TIMEOUT") from None
        result.variables["UV_HTTP_TIMEOUT"] = str(max(1, seconds))


def translate_certificates(settings: Mapping[str, str], environment: Mapping[str, str], result: Translation) -> None:
    """Translate cert, client-cert and the system's trust store. As for pip, its own file counts more than one of the environment."""
    uv_has_own = {"UV_NATIVE_TLS", "UV_SYSTEM_CERTS"} & environment.keys()
    if "truststore" in settings.get("use-feature", "").split() and not uv_has_own:
        result.variables |= {"UV_NATIVE_TLS": "1", "UV_SYSTEM_CERTS": "1"}  # names before and since uv 0.11
    if "cert" in settings and not uv_has_own:
        for place in existing("cert", [settings["cert"]], result):
            path = Path(place).expanduser().absolute()
            result.variables["SSL_CERT_DIR" if path.is_dir() else "SSL_CERT_FILE"] = str(path)
    if "client-cert" in settings:
        for place in existing("client-cert", [settings["client-cert"]], result):
            result.variables["SSL_CLIENT_CERT"] = str(Path(place).expanduser().absolute())


def main() -> None:
    """Print the records."""
    try:
        records = translate(listed_settings(pip_lines()), os.environ).records()
    except SettingError as error:
        records = [f"error={error}"]
    sys.stdout.buffer.write(b"".join(os.fsencode(record) + b"\0" for record in [*records, "end="]))


if __name__ == "__main__":
    main()
