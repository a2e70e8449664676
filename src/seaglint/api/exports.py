"""Functions that write results for other programs: ``sg.export``, ``sg.export_sea`` and ``sg.labels``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from seaglint.api.inputs_and_results import arguments_of, path_of, scenario_of
from seaglint.base.parameters import documented
from seaglint.studies.study_requests import ExportRequest

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.api.inputs_and_results import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.formats.export.stack import Exported


@documented(ExportRequest, videos="videos")
def export(
    run: xr.Dataset | str | Path,
    output: str | Path,
    *,
    variable: str | None = None,
    frames: range | None = None,
    dtype: Literal["uint16", "float32"] | None = None,
    limits: tuple[float, float] | None = None,
    colours: Literal["white-hot", "black-hot", "perceptual"] | None = None,
    rate: float | None = None,
    scale: Literal["auto", "linear", "log"] | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Exported:
    """Write frames of a run for another program.

    Parameters
    ----------
    run : xarray.Dataset or path
        Result of :func:`render` or a part of it, or a finished store.
    output : path
        ``.nc``, ``.h5``, ``.tif``, ``.fits``, ``.npy``, ``.raw`` (the last two with a JSON header beside them), ``.mp4`` or ``.gif``.
    {request}
    progress : callable, optional
        Called with (frames done, frames in all).

    Returns
    -------
    Exported
        Files, shape and type of the numbers, scale and offset of counts.

    Raises
    ------
    SeaglintError
        A format, variable, frames or settings that cannot be, an unfinished run, a file that is there already, no room.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> camera = {"pixels": [8, 4], "frames": 3}
    >>> scene = sg.load({"sensor": camera, "sea": {"resolve_waves": False}})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = sg.render(scene, f"{folder}/run.zarr")
    ...     sg.export(run, f"{folder}/run.tif", dtype="uint16", limits=(0.0, 2.0)).shape
    (3, 4, 8)
    """
    from seaglint.plot.run_export import export_run
    from seaglint.store.sequence_store import open_sequence

    dataset = open_sequence(run) if isinstance(run, str | Path) else run
    return export_run(**arguments_of(export_run, locals()))


def export_sea(
    scenario: SceneInput,
    output: str | Path | None = None,
    *,
    time: float = 0.0,
    extent: tuple[float, float] | None = None,
    spacing: float | None = None,
    centre: tuple[float, float] = (0.0, 0.0),
    lattices: bool = True,
    overwrite: bool = False,
) -> xr.Dataset:
    """Write heights, slopes and roughness of the sea at one time.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        See :func:`load`.
    output : path, optional
        File to write too: ``.ply`` a triangle mesh, ``.nc`` NetCDF.
    time : float
        Time from the start of the sequence [s].
    extent : (float, float), optional
        Size of the patch to the east and north [m]; 256 x 256, less where waves are very short.
    spacing : float, optional
        Distance of its points [m]; a quarter of the shortest wave.
    centre : (float, float)
        Middle of the patch to the east and north of the sensor's foot [m].
    lattices : bool
        With the periodic tiles beside the patch.
    overwrite : bool
        Replace a file that is there.

    Returns
    -------
    xarray.Dataset
        ``height`` [m], ``slope_east`` and ``slope_north`` [1] over ``y, x``, and the covariance of slopes that no wave resolves.

    Raises
    ------
    SeaglintError
        A scenario without resolved waves, a patch that does not fit the memory, an output that cannot be written.

    Examples
    --------
    >>> import seaglint as sg
    >>> sea = sg.export_sea({"seed": 1}, extent=(16.0, 8.0), spacing=1.0, lattices=False)
    >>> sea.height.shape
    (9, 17)
    """
    from seaglint.store.outputs import refuse_existing
    from seaglint.studies.sequence.sea_export import export_sea as exported
    from seaglint.studies.sequence.sea_export import require_sea_name, write_sea

    if output is not None:
        refuse_existing(require_sea_name(Path(output)), overwrite=overwrite)
    sea = exported(scenario_of(scenario), time, centre=centre, extent=extent, spacing=spacing)
    if output is not None:
        write_sea(sea, Path(output), lattices=lattices, overwrite=overwrite)
    return sea.dataset(lattices=lattices)


def labels(run: str | Path, output: str | Path | None = None, *, masks: str = "response", overwrite: bool = False) -> xr.Dataset:
    """Write places, masks and contrasts of objects, by frame.

    Parameters
    ----------
    run : path
        Finished sequence of :func:`render` with objects.
    output : path, optional
        File to write too: ``.json`` (COCO, with masks) or ``.csv``.
    masks : str
        Kind of masks: ``"response"``, of an object after the optics (geometric without a detector), or ``"geometric"``, pixels that it
        touches at the aperture.
    overwrite : bool
        Replace a file that is there.

    Returns
    -------
    xarray.Dataset
        The numbers of each object over ``frame`` and ``object``, and ``classes``, the names of the objects. :func:`frames` gives masks.

    Raises
    ------
    SeaglintError
        No finished sequence, one without objects, or an output that cannot be written.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> camera = {"pixels": [48, 24], "fov_deg": [4, 2], "elevation_deg": -4, "frames": 1}
    >>> boat = {"name": "boat", "preset": "small-boat", "north_m": -400}
    >>> scene = {"sensor": camera, "sea": {"resolve_waves": False}, "objects": [boat]}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     run = sg.render(scene, f"{folder}/run.zarr")
    ...     truth = sg.labels(f"{folder}/run.zarr", f"{folder}/labels.json")
    >>> truth.classes.values, round(float(truth.range_m[0, 0]))
    (array(['boat'], dtype='<U4'), 401)
    """
    from seaglint.formats.object_labels import Labels, label_dataset, report_never_seen, require_labels_name, write_labels
    from seaglint.store.outputs import refuse_existing

    run = path_of(run, "run")
    if output is not None:
        refuse_existing(require_labels_name(output), overwrite=overwrite, inputs=[run])
    truth = Labels.of(run, masks)
    report_never_seen(truth)
    if output is not None:
        write_labels(truth, output, overwrite=overwrite)
    return label_dataset(truth)
