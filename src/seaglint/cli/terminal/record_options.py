"""Options of a command, derived from the records that it takes: requests of the studies, results and workers.

Each field of a record becomes one option with the help text of the field. Some options name small files (weights, masks) or layouts of raw
files; these are read here. The records ``ResultOptions`` and ``RunOptions`` are shared by commands: destinations of results, and workers.
The functions at the end finish a store, and report a share of the work.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from functools import partial, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, NamedTuple, get_args, get_origin, get_type_hints

import typer
from typer.core import TyperCommand

from seaglint.base.errors import DataError
from seaglint.base.parameters import GROUPS, Parameter, described
from seaglint.cli.terminal.messages import contrasts_of, log
from seaglint.cli.terminal.options import place_given, two_numbers
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.studies.study_requests import WeightsFile, WorkRequest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from seaglint.cluster import Workers


RAW_NAMES = ("rows", "columns", "dtype", "byte_order", "offset", "frame_header")


def weights(path: Path) -> NDArray[np.float64]:
    """Return the numbers of a small CSV or NumPy file."""
    import numpy as np

    from seaglint.store.outputs import read_text

    try:
        if path.suffix == ".npy":
            return np.asarray(np.load(path, allow_pickle=False), dtype=np.float64)
        # Semicolons, commas and blanks all separate numbers.
        text = read_text(path, "give a CSV or .npy file").replace(";", " ").replace(",", " ")
        return np.loadtxt(text.splitlines(), dtype=np.float64, ndmin=2)
    except (OSError, ValueError) as error:
        raise DataError(f"{path}: cannot be read as rows of numbers ({str(error).splitlines()[0]}); give a CSV or .npy file") from error


def _mask(path: Path) -> Any:
    """Return a mask from a file: its reader is imported where one is given."""
    from seaglint.formats.region_files import read_mask

    return read_mask(path)


def _regions(path: Path) -> Any:
    """Return the regions of a file."""
    from seaglint.formats.region_files import read_regions

    return read_regions(path)


def raw_layout(text: str | None) -> Any:
    """Return the layout of a raw file from ``name=value`` pairs; None without a text."""
    if text is None:
        return None
    from seaglint.formats.recording import RawLayout

    table: dict[str, Any] = {}
    for pair in text.split(","):
        name, sign, value = (part.strip() for part in pair.partition("="))
        if not sign:
            raise DataError(f"--raw {text}: give name=value pairs of {', '.join(RAW_NAMES)}, separated by commas")
        table[name] = _typed(value)
    return RawLayout.of(table, "--raw")


def _typed(value: str) -> int | float | str:
    """Return a text as a whole number or as a number, otherwise unchanged."""
    for kind in (int, float):
        try:
            return kind(value)
        except ValueError:
            continue
    return value


class Without(NamedTuple):
    """Fields of a record for which a command has no options; they keep their defaults."""

    names: tuple[str, ...]


class RecordCommand(TyperCommand):
    """Command with its options in groups on the help page."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the arguments, then the options under their headings."""
        sections: dict[str, list[tuple[str, str]]] = {"Arguments": [], **{group: [] for group in GROUPS}, "Other": []}
        for parameter in self.get_params(ctx):
            line = parameter.get_help_record(ctx)
            if line is not None:
                argument = parameter.param_type_name == "argument"
                sections["Arguments" if argument else getattr(parameter, "rich_help_panel", None) or "Other"].append(line)
        for heading, lines in sections.items():
            if lines:
                with formatter.section(heading):
                    formatter.write_dl(lines)


def option_of(name: str) -> str:
    """Return the option that sets a parameter."""
    return f"--{name.replace('_', '-')}"


def takes_records(*, order: str = "") -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return a decorator that gives a command an option for each field of the records among its parameters.

    Fields of one name in several records are one option, with the help of the first record, and its value goes to all of them. A help page
    lists the names in ``order`` first.
    """
    return partial(_with_options, first=order.split())


def _with_options(command: Callable[..., None], first: Sequence[str]) -> Callable[..., None]:
    """Return a command with an option for each field of its records."""
    hints = get_type_hints(command, include_extras=True)
    hints.pop("return", None)
    records: dict[str, type] = {}
    parameters: dict[str, inspect.Parameter] = {}
    readers: dict[str, Callable[[Any], Any]] = {}
    renamed: dict[str, str] = {}
    for name, hint in hints.items():
        record = get_args(hint)[0] if get_origin(hint) is Annotated else hint
        if not is_dataclass(record):
            default = inspect.signature(command).parameters[name].default
            # Where a field of an earlier record has the same name, its option stays.
            parameters.setdefault(name, inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint))
            continue
        records[name] = record  # type: ignore[assignment]
        left_out = next((extra.names for extra in get_args(hint)[1:] if isinstance(extra, Without)), ())
        types, texts = get_type_hints(record, include_extras=True), described(record)  # type: ignore[arg-type]
        for field in fields(record):
            if field.name not in left_out and field.name not in parameters:
                text = texts.get(field.name)
                parameters[field.name], readers[field.name] = _option(field, types[field.name], text)
                if text is not None and text.option:
                    renamed[field.name] = text.option

    @wraps(command)
    def called(**given: Any) -> None:
        read = {name: readers[name](value) if name in readers else value for name, value in given.items()}
        built = {
            name: record(**{field.name: read[field.name] for field in fields(record) if field.name in read})
            for name, record in records.items()
        }
        command(**built, **{name: read[name] for name in hints if name not in records})

    # The names in ``order`` come first; the others keep the order of the records.
    listed = {name: parameters[name] for name in first} | parameters
    called.__annotations__ = {name: parameter.annotation for name, parameter in listed.items()} | {"return": None}
    # Stable: a signature must have parameters without default first, and otherwise keeps its order.
    ordered = sorted(listed.values(), key=lambda parameter: parameter.default is not inspect.Parameter.empty)
    called.__signature__ = inspect.Signature(ordered, return_annotation=None)  # type: ignore[attr-defined]
    # Errors name parameters; the program replaces them by these options.
    called.renamed = renamed  # type: ignore[attr-defined]
    return called


def _option(field: Field[Any], hint: Any, text: Parameter | None) -> tuple[inspect.Parameter, Callable[[Any], Any]]:
    """Return the parameter of a command for a field of a record, and the function that reads its text."""
    default: Any = inspect.Parameter.empty if field.default is MISSING else field.default
    if text is None:  # the field is declared as an option of Typer
        return inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint), lambda value: value
    kind = get_args(hint)[0]
    option = text.option or option_of(field.name)
    help_text = re.sub(r"`(\w+)`", lambda match: option_of(match[1]), text.help) + SPELLED.get(text.form, "")
    more: dict[str, Any] = {"metavar": text.metavar} if text.metavar else {}
    if field.default is MISSING:
        info: Any = typer.Argument(help=help_text, **more)
    else:
        limit: dict[str, Any] = {} if text.least is None else {"min": text.least}
        info = typer.Option(option, help=help_text, rich_help_panel=text.group or None, **limit, **more)
    reader: Callable[[Any, str], Any] = READERS.get(text.form, lambda value, _: value)
    if text.form == "switch":
        kind, default = Literal["auto", "always", "never"], next(word for word, value in SWITCH.items() if value is default)
    elif text.form == "name":
        kind = str
    elif get_origin(kind) is tuple and get_args(kind)[1:] == (...,) and text.form in ("", "names"):
        item: Any = str if text.form else get_args(kind)[0]
        # Typer repeats the option of a list; without one the value is None, which becomes an empty tuple.
        several: Any = list[item] | None
        parameter = inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[several, info])
        return parameter, lambda value: tuple(value or ())
    elif text.form:
        # All other forms are texts, which their reader turns into numbers.
        kind = Path | None if text.form in ("weights", "mask", "regions") else str | None
        default = None if default is None else WRITTEN.get(text.form, _commas)(default)
    parameter = inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, info])
    return parameter, lambda value: None if value is None else reader(value, option)


def _commas(values: Sequence[float]) -> str:
    return ",".join(f"{value:g}" for value in values)


def _shares(text: str, option: str) -> tuple[float, float]:
    """Return the ends of a part of the height from FIRST:LAST [1]."""
    first, colon, last = text.partition(":")
    try:
        if not colon:
            raise ValueError
        return float(first or 0.0), float(last or 1.0)
    except ValueError:
        raise DataError(f"{option} {text}: give FIRST:LAST as shares of the height from the top, e.g. 0.45: or 0.2:0.8") from None


def _size(text: str, option: str) -> tuple[int, int]:
    """Return columns and rows from COLUMNSxROWS."""
    parts = text.lower().split("x")
    if len(parts) != 2 or not all(part.strip().isdecimal() and int(part) > 0 for part in parts):
        raise DataError(f"{option} {text}: give columns and rows above 0 as COLUMNSxROWS, e.g. 512x512")
    return int(parts[0]), int(parts[1])


SWITCH: Final[Mapping[str, bool | None]] = {"auto": None, "always": True, "never": False}  #: Values of the words of a switch.

#: Readers of texts by the form of a parameter; each takes text and option. Frames are read later, where their number is known.
READERS: Final[Mapping[str, Callable[[Any, str], Any]]] = {
    "numbers": contrasts_of,
    "pair": two_numbers(",", "X,Y in pixels a frame, to the right and down, e.g. 0.5,0"),
    "size": _size,
    "limits": two_numbers(":", "NEAR:FAR in metres, e.g. 500:40000"),
    "shares": _shares,
    "weights": lambda path, _: WeightsFile(path, weights(path)),
    "mask": lambda path, _: WeightsFile(path, partial(_mask, path)),
    "regions": lambda path, _: WeightsFile(path, partial(_regions, path)),
    "raw": lambda text, _: raw_layout(text),
    "switch": lambda text, _: SWITCH[text],
}

#: Ends of help texts by the form of a parameter: how a value is written on the command line.
SPELLED: Final[Mapping[str, str]] = {
    "frames": ": 37, 37:38 (end not included), 10:",
    "every": ", by number: 37, 37:38 (end not included), 0:100:2",
    "shares": ", as shares from the top: 0.45: or 0.2:0.8",
}

#: Texts of defaults by the form of a parameter; other forms are numbers with commas between them.
WRITTEN: Final[Mapping[str, Callable[[Any], str]]] = {
    "shares": lambda ends: ":" if ends == (0.0, 1.0) else f"{ends[0]:g}:{ends[1]:g}",
    "size": lambda sides: f"{sides[0]}x{sides[1]}",
}


def chosen(
    workers: int | None, dask: str | None, dask_slurm: Path | None, *, threads: int | None = None
) -> AbstractContextManager[Workers | None]:
    """Provide the requested workers; None where this process works alone. ``threads`` is the number for each local process.

    Raises
    ------
    DataError
        More than one kind of workers is requested, or threads for Dask workers.
    SeaglintError
        ``seaglint.cluster.dask`` refuses the cluster.
    """
    given = [name for name, value in (("--workers", workers), ("--dask", dask), ("--dask-slurm", dask_slurm)) if value is not None]
    if len(given) > 1:
        raise DataError(f"{' and '.join(given)}: work is shared out in one way; give one of them")
    if threads is not None and (dask is not None or dask_slurm is not None):
        raise DataError(f"--threads {threads}: is of this machine, and Dask's workers have their own; start them with --nthreads {threads}")
    if workers is not None:
        from seaglint.cluster.local import LocalProcesses

        return LocalProcesses(workers, threads=threads, report=log)
    if dask is not None:
        from seaglint.cluster.dask import connected

        return connected(dask, log)
    if dask_slurm is not None:
        from seaglint.cluster.dask import queued

        return queued(dask_slurm, log)
    return nullcontext()


@dataclass(frozen=True)
class ResultOptions:
    """Destinations of results: text or JSON on stdout, files with one stem, a report."""

    as_json: Annotated[bool, typer.Option("--json", help="print JSON", rich_help_panel="Results")] = False
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="RESULT",
            help="writes RESULT.json, RESULT.csv (or .parquet), and beside them characteristics (RESULT_roc.csv) and pictures",
            rich_help_panel="Results",
        ),
    ] = None
    report: Annotated[Path | None, typer.Option("--report", metavar="F.html", help="report with pictures", rich_help_panel="Results")] = (
        None
    )


@dataclass(frozen=True)
class RunOptions(WorkRequest):
    """Settings of a run: workers, continuation, and progress."""

    dask: Annotated[
        str | None,
        typer.Option("--dask", metavar="tcp://HOST:PORT", help="scheduler of a Dask cluster that does the work", rich_help_panel="Run"),
    ] = None
    dask_slurm: Annotated[
        Path | None,
        typer.Option(
            "--dask-slurm",
            metavar="CLUSTER.toml",
            help="batch queue that provides workers, with the settings in this file",
            rich_help_panel="Run",
        ),
    ] = None
    resume: Annotated[bool, Parameter("continue with the parts stored beside RESULT", "Run")] = False
    show: Annotated[
        ProgressMode, typer.Option("--progress", help="bar on a terminal, log lines elsewhere, or nothing", rich_help_panel="Run")
    ] = ProgressMode.AUTO

    def chosen(self) -> AbstractContextManager[Workers | None]:
        """Provide the requested workers; see ``seaglint.cli.terminal.record_options.chosen``."""
        return chosen(self.workers, self.dask, self.dask_slurm, threads=self.threads)

    def done_here(self, what: str) -> None:
        """Report that requested workers are not used, since the work cannot be divided."""
        if self.workers is not None or self.dask is not None or self.dask_slurm is not None:
            log(f"{what} in one piece, by this process alone")


ALONE = ("workers", "dask", "dask_slurm")  #: Fields of ``RunOptions`` that share work; left out by commands that work alone.


def require_one_way(*, shard: str | None, overwrite: bool) -> None:
    """Refuse ``--finish`` together with options that make or replace frames.

    Raises
    ------
    DataError
        One of these options is given.
    """
    for name, given in (("--shard", shard is not None), ("--overwrite", overwrite)):
        if given:
            raise DataError(f"--finish checks and names an existing store, and {name} makes frames; give one of the two")


def finish_store(scenario: str, output: str | None, sensor: str | None) -> Path | str:
    """Check a store, give it its final name and return its place; without an output, ``scenario`` is the store.

    Raises
    ------
    SeaglintError
        See ``seaglint.store.sequence_store.finish_sequence``.
    """
    from seaglint.scenario.load import load_scenario
    from seaglint.store.sequence_store import finish_sequence, open_sequence

    if output is None and scenario.lower().endswith(".toml"):
        raise DataError(f"--finish: which store of {scenario}? Name it with -o run.zarr, or alone: seaglint render --finish run.zarr")
    store = place_given(scenario if output is None else output)
    expected = None if output is None else load_scenario(Path(scenario), sensor=sensor).model_dump_json(exclude_none=True)
    if not finish_sequence(store, expected):
        log(f"{store}: is finished already")
        return store
    with open_sequence(store) as dataset:
        log(f"{store}: {dataset.sizes['time']} frames, all complete and with correct checksums")
    return store


def report_share(store: Path | str, share: object) -> None:
    """Report the progress of the whole sequence when a share of it is done."""
    from seaglint.store.location import place_of
    from seaglint.store.sequence_store import open_sequence

    place = place_of(store)
    if place.taken():
        log(f"{store}: is finished already; share {share} has nothing to do")
        return
    with open_sequence(place.work, allow_partial=True) as dataset:
        done = dataset["frame_done"].to_numpy()
    message = f"{place.work}: share {share} is done; {int(done.sum())} of {done.size} frames are there"
    log(f"{message}; next: seaglint render --finish {store}" if done.all() else message)
