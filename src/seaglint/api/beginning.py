"""Functions of scenario files and of files at hand: ``sg.init``, ``sg.schema`` and ``sg.info``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.api.result_record import ResultRecord

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def init(output: str | Path, preset: str = "glint", *, camera: str | Path | None = None, overwrite: bool = False) -> Path:
    """Write a commented scenario file.

    Parameters
    ----------
    output : path
        File to write, ``.toml``.
    preset : str
        Scene to begin with; ``seaglint init --presets`` lists them.
    camera : str or path, optional
        Camera of a data sheet's numbers, as ``"pixels=640x512, pitch_um=15, focal_mm=100, ..."``, or a TOML file of the same. What is
        assumed is logged.
    overwrite : bool
        Replace a file that is there.

    Returns
    -------
    Path
        ``output``; :func:`load` reads it.

    Raises
    ------
    SeaglintError
        An unknown preset, a camera that cannot be, or a file that is there.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.load(sg.init(f"{folder}/my.toml", preset="calm")).wind.speed_m_s > 0.0
    True
    """
    import logging

    from seaglint.files.outputs import refuse_existing, require_ending
    from seaglint.scenario.camera import assumed_values, read_camera
    from seaglint.scenario.load import load_scenario
    from seaglint.scenario.text.template import write_template

    path = Path(output)
    require_ending(path, (".toml",), "a scenario is a TOML file")
    refuse_existing(path, overwrite=overwrite)
    chosen = None if camera is None else read_camera(str(camera))
    write_template(path, preset, camera=chosen, overwrite=overwrite)
    for line in () if chosen is None else (*chosen.assumed, *assumed_values(load_scenario(path), chosen)):
        logging.getLogger(__name__).info("camera: %s", line)
    return path


def schema() -> dict[str, Any]:
    """JSON Schema of scenario files.

    Returns
    -------
    dict
        The schema, for editors and validators.

    Examples
    --------
    >>> import seaglint as sg
    >>> "wind" in sg.schema()["properties"]
    True
    """
    from seaglint.scenario.text.template import json_schema

    return dict(json_schema())


def info(path: str | Path, *, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> ResultRecord:
    """Say what a file holds and how it was made.

    Parameters
    ----------
    path : str or path
        Sequence, finished or not, also a URL; mean map; scenario; recording of any format.
    variable : str, optional
        Array of a recording that holds several.
    channel : str, optional
        Colour, or number of a channel, of a recording of several.
    axes : str, optional
        Order of a recording's axes, e.g. ``yxt`` where time is the last.

    Returns
    -------
    ResultRecord
        Values that ``seaglint info --json`` prints; ``plot()`` draws a picture of a sequence or a map.

    Raises
    ------
    SeaglintError
        Nothing is there, or it cannot be read.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.info(sg.init(f"{folder}/my.toml"))["kind"]
    'scenario'
    """
    from seaglint.studies.contents.input_facts import describe_recording, describe_scenario, is_ours
    from seaglint.studies.contents.output_facts import describe

    place = path if isinstance(path, str) and "://" in path else Path(path)
    if is_ours(place):
        values: Mapping[str, Any] = describe(place).as_dict()
        return ResultRecord(values, draw=lambda: _picture(place), title=str(path))
    file = Path(path)
    known = describe_scenario(file) if file.suffix.lower() == ".toml" else describe_recording(file, variable, channel, axes)
    return ResultRecord(known.as_dict(), title=str(path))


def _picture(place: str | Path) -> Figure:
    """Draw a sequence or a map as the preview of its command."""
    from seaglint.files.netcdf import open_netcdf
    from seaglint.files.store.store import open_sequence
    from seaglint.plot.preview import draw

    is_file = isinstance(place, Path) and place.is_file()
    with open_netcdf(place, decode_times=False) if is_file else open_sequence(place, allow_partial=True) as dataset:
        return draw(dataset)
