"""``seaglint detect``: probabilities of detection and false alarm of a detector, on a recording or in rendered scenes.

Four commands, each with the options of its request; ``seaglint detect SOURCE`` takes all options and chooses by the file's ending.
"""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, Final

import typer
from typer.core import TyperGroup

from seaglint.base.errors import DataError
from seaglint.cli.terminal.record_options import ALONE, RecordCommand, ResultOptions, RunOptions, Without, option_of, takes_records
from seaglint.studies.detect.detection_requests import DesignRequest, RangeRequest, RecordingRequest, SceneRequest

BARE: Final = "SOURCE"  #: Name under which the command without a name is registered; nobody types it.


EveryTail = Annotated[bool, typer.Option("--tails", help="print unreliable extrapolated rates too", rich_help_panel="Results")]


class DetectGroup(TyperGroup):
    """Group whose first word may be a file instead of a command: then it is the command without a name, with all options."""

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        # It is reached by a file as the first word, and not by a name.
        self.bare = self.commands.pop(BARE)

    def make_context(self, info_name: str | None, args: list[str], parent: Any = None, **extra: Any) -> Any:
        """Return the context of the group, or of the command without a name."""
        group = not args or args[0] in self.commands or args[0] == "--help"
        if not group:
            self._require_file(args[0])
        make = super().make_context if group else self.bare.make_context
        return make(info_name, args, parent=parent, **extra)

    def _require_file(self, word: str) -> None:
        """Refuse a first word that can only be a misspelt command: one without an ending or a folder, where no file has its name."""
        if re.fullmatch(r"\w[\w-]*", word) and not Path(word).exists():
            raise DataError(f"{word}: is no file, and none of the commands {', '.join(self.commands)}; give one of them, or a file's name")

    def shell_complete(self, ctx: Any, incomplete: str) -> list[Any]:
        """Return the commands, and the options of the command without a name."""
        return [*super().shell_complete(ctx, incomplete), *(self.bare.shell_complete(ctx, incomplete) if incomplete else ())]


detect = typer.Typer(
    cls=DetectGroup,
    rich_markup_mode=None,
    no_args_is_help=True,
    help="Probabilities of detection and false alarm of a detector.\n\n"
    "Objects are injected into a recording or into rendered scenes; errors of place are given as well. "
    "'seaglint detect SOURCE' takes the options of all four and chooses by the file: SCENARIO.toml, "
    "with --design or --range, or a recording. A file with the name of a command is written as ./range.",
)


@detect.command("recording", cls=RecordCommand)
@takes_records(order="frame_rate pixel_mrad")
def recording(
    request: RecordingRequest,
    results: ResultOptions,
    run: Annotated[RunOptions, Without((*ALONE, "threads", "resume"))],
    every_tail: EveryTail = False,
) -> None:
    """Detection on a recording without objects."""
    from seaglint.cli.detect_runs import detect_recording

    detect_recording(request, results, run, every_tail=every_tail)


@detect.command("scene", cls=RecordCommand)
@takes_records(order="workers dask dask_slurm")
def scene(request: SceneRequest, results: ResultOptions, run: Annotated[RunOptions, Without(("threads",))]) -> None:
    """Detection in independent rendered seas of a scenario."""
    from seaglint.cli.detect_runs import detect_scene

    detect_scene(request, results, run)


@detect.command("design", cls=RecordCommand)
@takes_records(order="workers dask dask_slurm")
def design(request: DesignRequest, results: ResultOptions, run: Annotated[RunOptions, Without(("threads",))]) -> None:
    """Contrast that an object needs, and loss against white noise.

    For P_d 0.9 at one false alarm per hour and field, unless others are given.
    """
    from seaglint.cli.detect_runs import detect_scene

    detect_scene(request, results, run)


@detect.command("range", cls=RecordCommand)
@takes_records(order="workers dask dask_slurm")
def detection_range(
    request: RangeRequest, results: Annotated[ResultOptions, Without(("report",))], run: Annotated[RunOptions, Without(("threads",))]
) -> None:
    """Range up to which an object of a scenario is detected."""
    from seaglint.cli.detect_runs import detect_range

    detect_range(request, results, run)


@detect.command(BARE, cls=RecordCommand, hidden=True)
@takes_records(order="frame_rate pixel_mrad workers dask dask_slurm")
def detect_source(
    recorded: RecordingRequest,
    rendered: DesignRequest,
    far: RangeRequest,
    results: ResultOptions,
    run: Annotated[RunOptions, Without(("threads",))],
    as_design: Annotated[
        bool,
        typer.Option(
            "--design",
            help="contrast for P_d 0.9 at one false alarm per hour and field, and the loss against white noise",
            rich_help_panel="Design",
        ),
    ] = False,
    find_range: Annotated[
        bool, typer.Option("--range", help="range up to which an object of the scenario is detected", rich_help_panel="Range")
    ] = False,
    every_tail: EveryTail = False,
) -> None:
    """Probabilities of detection and false alarm of a detector.

    INPUT is a recording without objects, or SCENARIO.toml. Each kind has a command with its own options alone: seaglint detect --help.
    """
    if Path(recorded.source).suffix.lower() == ".toml":
        wrong = given(recorded, besides=(rendered, far))
        if wrong:
            raise DataError(f"{', '.join(wrong)}: says something of a recording, which a scenario says itself; leave it out")
        if find_range:
            from seaglint.cli.detect_runs import detect_range

            detect_range(far, results, run)
            return
        from seaglint.cli.detect_runs import detect_scene

        designed = as_design or any(value is not None for value in (far.p_fa, far.alarms_per_hour, far.p_d))
        # Without figures for a designer the request is one for scenes, with the same fields.
        own = {field.name: getattr(rendered, field.name) for field in fields(SceneRequest)}
        detect_scene(rendered if designed else SceneRequest(**own), results, run)
        return
    flags = (("--resume", run.resume), ("--design", as_design), ("--range", find_range))
    wrong = [*given(rendered, far, besides=(recorded,)), *(option for option, on in flags if on)]
    if wrong:
        raise DataError(f"{', '.join(wrong)}: for scenarios, and {recorded.source} is a recording; give SCENARIO.toml, or leave it out")
    from seaglint.cli.detect_runs import detect_recording

    run.done_here("a recording is judged")
    detect_recording(recorded, results, run, every_tail=every_tail)


def given(*requests: Any, besides: tuple[Any, ...]) -> list[str]:
    """Return the options that were set of some requests and that others do not have."""
    known = {field.name for other in besides for field in fields(other)}
    own = {field.name: (field.default, getattr(request, field.name)) for request in requests for field in fields(request)}
    return [option_of(name) for name, (default, value) in own.items() if name not in known and value != default]
