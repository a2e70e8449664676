"""Tables and figures of the documentation: how they are made, and whether the code has changed since.

    ./run tables --list [NAME ...]    what is older than its code
    ./run tables --check [NAME ...]   a few numbers of each of these computed again, or of those named whatever their age
    ./run tables [NAME ...]           make those named anew, or all (hours)
    ./run tables --stamp NAME ...     put down that these are as the code of now makes them, where a script's output was copied by hand

``tools/tables.toml`` says for each table which command makes it, which files it fills and which rooms of the source its numbers hang on;
``docs/data/made.toml`` keeps the digest of these rooms at the time, the commit and the date. The digest takes statements of Python by what
they do: comments, docstrings, imports, and the file and order that statements stand in do not change it, so that files can be moved, split
and merged. Any other file of a room is taken by its bytes. Tables of times hang on the machine and have no digest.
"""

from __future__ import annotations

import argparse
import ast
import datetime
import hashlib
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from data_folders import name_folders
from seaglint.base.kernel_cache import syntax_text

ROOT = Path(__file__).resolve().parents[1]
SOURCE = Path("src") / "seaglint"
MADE = ROOT / "docs" / "data" / "made.toml"
IMPORTS = (ast.Import, ast.ImportFrom)
NUMBER = re.compile(r"[-+]?\d+(?:\.(?P<decimals>\d+))?(?:[eE](?P<exponent>[-+]?\d+))?")
SPARE = 0.6
"""Units of the last printed digit that a number may be off [1]: half of one by rounding, the rest for other processors' arithmetic."""
ERRORS = 4.0
"""Standard errors, of the printed and the new number together, that numbers with an error may be apart [1]."""


@dataclass(frozen=True)
class Table:
    """A table or figure: what makes it, what is made, and what it hangs on."""

    name: str
    command: str
    makes: tuple[str, ...]
    rooms: tuple[str, ...] = ()
    cost: str = ""
    sample: str = ""
    stdout: str = ""
    by_hand: bool = False
    times: bool = False

    def digest(self, root: Path = ROOT) -> str:
        """Digest of the sources that the table judges."""
        return digest(files(self.rooms, root))


def tables() -> dict[str, Table]:
    """All tables of ``tools/tables.toml``; one with ``each`` stands for one table a file."""
    registry = tomllib.loads((ROOT / "tools" / "tables.toml").read_text(encoding="utf-8"))
    groups: dict[str, list[str]] = registry["rooms"]

    def rooms(names: Iterable[str]) -> Iterator[str]:
        for name in names:
            yield from rooms(groups[name]) if name in groups else (name,)

    result = {}
    for name, entry in registry["tables"].items():
        pattern = entry.pop("each", None)
        for one in sorted(path.stem for path in ROOT.glob(pattern)) if pattern else [""]:
            filled: dict[str, Any] = {
                key: tuple(text.format(one=one) for text in value) if isinstance(value, list) else value for key, value in entry.items()
            }
            filled["command"] = entry["command"].format(one=one)
            filled["rooms"] = tuple(dict.fromkeys(rooms(filled.get("rooms", ()))))
            full = f"{name}/{one}" if one else name
            result[full] = Table(name=full, **filled)
    return result


def files(rooms: Iterable[str], root: Path = ROOT) -> list[Path]:
    """Files of rooms: folders or files below the package or, failing that, below the repository."""
    result: set[Path] = set()
    for room in rooms:
        path = next((root / base / room for base in (SOURCE, ".") if (root / base / room).exists()), None)
        if path is None:
            raise SystemExit(f"tables: neither {SOURCE / room} nor {room} is there; say in tools/tables.toml where it has moved")
        found = path.rglob("*") if path.is_dir() else [path]
        result |= {file for file in found if file.is_file() and "__pycache__" not in file.parts and not file.name.startswith(".")}
    return sorted(result)


def digest(paths: Iterable[Path]) -> str:
    """Digest of what some files do, whatever their names."""
    return hashlib.sha256("\n".join(sorted(part for path in paths for part in parts(path))).encode()).hexdigest()[:16]


@cache
def parts(path: Path) -> tuple[str, ...]:
    """Digests of a module's statements, or of any other file."""
    texts = [text.encode() for text in statements(path.read_text(encoding="utf-8"))] if path.suffix == ".py" else [path.read_bytes()]
    return tuple(hashlib.sha256(text).hexdigest() for text in texts)


def statements(source: str) -> list[str]:
    """Top-level statements of a module as text, without imports, docstrings and the list of public names."""
    found = (syntax_text(node, IMPORTS) for node in ast.parse(source).body if not isinstance(node, ast.If) or not only_imports(node))
    return [text for text in found if text and not text.startswith("Assign(targets=[Name(id='__all__'")]


def only_imports(node: ast.If) -> bool:
    """Whether a branch is there for imports alone, as ``if TYPE_CHECKING`` is."""
    return all(isinstance(one, ast.Import | ast.ImportFrom) for one in (*node.body, *node.orelse))


def made() -> dict[str, dict[str, str]]:
    """What is known of the tables as they stand: digest, commit and date."""
    return tomllib.loads(MADE.read_text(encoding="utf-8")) if MADE.exists() else {}


def write_made(entries: dict[str, dict[str, str]]) -> None:
    """Write what is known, a line a table."""
    lines = ["# Written by tools/tables.py: the digest of the code that made each table, the commit and the date."]
    for name, entry in sorted(entries.items()):
        lines.append(f'"{name}" = {{ ' + ", ".join(f'{key} = "{value}"' for key, value in entry.items()) + " }")
    MADE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def stamp(table: Table) -> dict[str, str]:
    """What is put down of a table that is as the code of now makes it."""
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=ROOT, check=False).stdout.strip()
    entry = {"commit": commit or "unknown", "date": f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}"}
    return entry | ({} if table.times else {"digest": table.digest()})


def stale(table: Table, known: dict[str, dict[str, str]]) -> bool:
    """Whether the sources have changed since the table was made."""
    return not table.times and known.get(table.name, {}).get("digest") != table.digest()


def block(place: str) -> tuple[Path, re.Match[str]]:
    """Page and text between the markers of ``page.md#name``."""
    page, name = place.split("#")
    path = ROOT / page
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    pattern = rf"(?<=^{re.escape(begin)}\n).*?(?=^{re.escape(end)}$)"
    found = re.search(pattern, path.read_text("utf-8"), re.DOTALL | re.MULTILINE)
    if found is None:
        raise SystemExit(f"tables: {page} lacks the lines '{begin}' and '{end}'; put them around the table")
    return path, found


def make(table: Table) -> bool:
    """Run the command of a table, with this interpreter first in the path and an empty folder named by FOLDER; whether it was made."""
    print(f"\n== {table.name}: {table.command}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        paths = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(
            table.command,
            shell=True,
            check=False,
            cwd=ROOT,
            env=os.environ | {"PATH": paths, "FOLDER": folder},
            stdout=subprocess.PIPE if table.stdout else None,
            text=True,
        )
    if done.returncode:
        print(f"{table.name}: not made, the command ended with status {done.returncode}")
        return False
    if table.stdout:
        path, found = block(table.stdout)
        page = path.read_text(encoding="utf-8")
        path.write_text(f"{page[: found.start()]}\n{done.stdout.strip()}\n\n{page[found.end() :]}", encoding="utf-8")
    if table.by_hand:
        print(f"copy what changed into {', '.join(table.makes)}, then: ./run tables --stamp {table.name}")
    else:
        write_made(made() | {table.name: stamp(table)})
    return True


def apart(printed: str, new: str) -> str:
    """What of a line as printed the new one has left: a number beyond its digits or its error, or other words; empty where nothing has.

    ``1.23 ± 0.02`` on both sides are numbers with standard errors.
    """
    olds, news = list(NUMBER.finditer(printed)), list(NUMBER.finditer(new))
    if NUMBER.sub("#", printed) != NUMBER.sub("#", new):
        return f"printed '{printed}', now '{new}'"
    number = 0
    while number < len(olds):
        old, now, allowed = olds[number], news[number], SPARE * unit(olds[number])
        if re.match(r" ± \d", printed[old.end() :]):
            number += 1
            error = sum(float(one.group()) ** 2 + unit(one) ** 2 / 12.0 for one in (olds[number], news[number])) ** 0.5
            allowed = max(allowed, ERRORS * error)
        if not abs(float(now.group()) - float(old.group())) <= allowed:
            return f"printed {old.group()}, now {now.group()} (allowed {allowed:.2g}) in '{printed}'"
        number += 1
    return ""


def unit(number: re.Match[str]) -> float:
    """Unit of a printed number's last digit [1]."""
    return float(10.0 ** (int(number["exponent"] or 0) - len(number["decimals"] or "")))


def check(table: Table) -> bool:
    """Compute a few numbers of a table again; whether they are as printed."""
    import table_samples

    start, count, bad = sum(os.times()[:4]), 0, []
    try:
        for printed, new in getattr(table_samples, table.sample)():
            count += 1
            bad += [found for found in [apart(printed, new)] if found]
    except table_samples.NotHereError as reason:
        print(f"{table.name}: skipped, {reason}")
        return True
    verdict = f"{len(bad)} of {count} lines are not as printed" if bad else f"{count} lines as printed"
    print(f"{table.name}: {verdict} ({sum(os.times()[:4]) - start:.1f} s)", *bad, sep="\n    ", flush=True)
    return not bad


def listed(table: Table, known: dict[str, dict[str, str]]) -> str:
    """A line on a table that is older than its code."""
    entry = known.get(table.name)
    when = f"made {entry['date']} at {entry['commit']}" if entry else "never stamped"
    return f"  {table.name:30} {when:30} {'sampled' if table.sample else '':8} {table.cost:18} {table.command}"


def main(arguments: list[str] | None = None) -> int:
    """Make, list or check; 1 where a table was not made or a sample is not as printed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_mutually_exclusive_group()
    for flag in ("--list", "--check", "--stamp"):
        what.add_argument(flag, action="store_true")
    parser.add_argument("names", nargs="*", metavar="NAME")
    options = parser.parse_args(arguments)
    name_folders()
    every, known = tables(), made()
    if unknown := set(options.names) - set(every):
        parser.error(f"no table {', '.join(sorted(unknown))}; there are {', '.join(every)}")
    if options.stamp and not options.names:
        parser.error("name the tables to stamp")
    chosen = [every[name] for name in options.names or every]
    if options.list or options.check:
        old = [table for table in chosen if stale(table, known)]
    if options.list:
        print(f"{len(old)} of {len(chosen)} tables and figures are older than their code" + (":" if old else ""))
        print(*(listed(table, known) for table in old), sep="\n", end="\n" if old else "")
    elif options.check:
        sampled = [table for table in (chosen if options.names else old) if table.sample]
        print(f"{len(old)} of {len(chosen)} tables and figures are older than their code, {len(sampled)} samples to compute")
        return int(not all(list(map(check, sampled))))
    elif options.stamp:
        write_made(made() | {table.name: stamp(table) for table in chosen})
    else:
        return int(not all(list(map(make, chosen))))
    return 0


if __name__ == "__main__":
    sys.path.append(str(ROOT / "docs" / "figures"))
    sys.exit(main())
