"""A texture in the perspective of a scenario: a sequence that stands in for a rendered one."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import DataError
from seaglint.base.threads import single_threaded_algebra
from seaglint.files.provenance import provenance, stored_band
from seaglint.files.store.layout import Layout
from seaglint.files.store.store import check_output, write_sequence
from seaglint.files.texture_file import StoredTexture
from seaglint.scenario.model import Scenario
from seaglint.studies.mean.mean_map import mean as mean_map
from seaglint.studies.prepare import prepare
from seaglint.studies.prepare.memory import require_room
from seaglint.studies.texture.texture_requests import PlaceRequest
from seaglint.studies.texture.texture_sequences import BYTES_PER_PIXEL, latent_model
from seaglint.textures.placement import Footprints, PeriodicField, fluctuation
from seaglint.textures.synthesis import latent

SAME_RATE: Final = 0.01  #: Relative difference of frame rates that is none.


def place(
    stored: StoredTexture,
    scenario: Scenario,
    output: str | Path,
    request: PlaceRequest,
    *,
    progress: Progress | None = None,
) -> Path | str:
    """Lay a texture on the sea of a scenario and store what its sensor sees.

    Parameters
    ----------
    stored : StoredTexture
        Of a Gauss-Markov field.
    scenario : Scenario
        Whose mean map gives mean, horizon and contrast; a standing, upright sensor.
    output : path
        Store to make.
    request : PlaceRequest
        Frames, size and cell of the field, contrast and seed.
    progress : callable, optional
        Called with (frames written, frames in all).

    Raises
    ------
    SeaglintError
        A texture without a Gaussian field, or without time for several frames; a turned or moving sensor; a store that exists.
    """
    check_output(output, overwrite=request.overwrite)
    field, texture = latent_model(stored)
    sensor = scenario.sensor
    numbers = request.frames if request.frames is not None else range(sensor.frames)
    if sensor.frames > 1 and len(numbers) > 1 and field.reach[0] == 0:
        raise DataError(
            f"{len(numbers)} frames: the texture is that of one picture and has no time; choose frame 0 alone, or fit it to a sequence"
        )
    rate = stored.frame_rate
    if rate is not None and field.reach[0] > 0 and abs(rate / sensor.frame_rate_hz - 1.0) > SAME_RATE:
        raise DataError(
            f"sensor.frame_rate_hz = {sensor.frame_rate_hz:g} and the texture's data had {rate:g} Hz, whose frames it counts; "
            f"set sensor.frame_rate_hz = {rate:g}, or fit a sequence of {sensor.frame_rate_hz:g} Hz"
        )
    with single_threaded_algebra():
        camera = prepare.camera(scenario)
        means = mean_map(scenario)
        seed = scenario.seed if request.seed is None else request.seed
        feet = Footprints.of(camera.height, camera.elevations, camera.row_step, camera.columns, camera.column_step)
        metres = feet.finest() if request.cell is None else request.cell
        deep = max(sensor.frames, 4 * field.reach[0] + 1) if field.reach[0] else 1
        need, what = BYTES_PER_PIXEL * deep * int(np.prod(request.size)), f"a field of {deep} x {request.size[0]} x {request.size[1]} cells"
        require_room(need, what, "give a smaller size, or fewer sensor.frames")
        plane = PeriodicField(latent(field, (deep, *request.size[::-1]), seed, texture.modulation), metres, feet)
        total = means["radiance"].to_numpy().astype(np.float64)
        glint = request.contrast == "glint" or (request.contrast == "auto" and float(means["glint_std"].max()) > 0.0)
        if glint:
            lively, spread = (means[name].to_numpy().astype(np.float64) for name in ("glint_radiance", "glint_std"))
        else:
            lively = total - means["path_radiance"].to_numpy().astype(np.float64)
            spread = lively * (_contrast(texture.marginal.variance, texture.marginal.mean) * plane.averaging)[:, None]
        still = total - lively

        def image(number: int) -> dict[str, FloatArray]:
            return {"radiance": still + _seen(plane, number, feet, lively, spread, texture.marginal.kind)}

        layout = Layout(
            azimuth_deg=np.degrees(camera.azimuths),
            elevation_deg=np.degrees(camera.elevations),
            frames=numbers,
            frame_rate=sensor.frame_rate_hz,
            band=stored_band(means.attrs),
            attributes=provenance(
                "Statistical texture in the perspective of a scenario",
                scenario.model_dump_json(exclude_none=True),
                seed,
                texture_model="gauss-markov",
                texture_source=str(stored.source.get("input", "")),
                texture_cell_m=list(metres),
                texture_contrast="glint" if glint else "model",
                loop_frames=sensor.frames,
            ),
        )
        return write_sequence(output, layout, image, overwrite=request.overwrite, progress=progress)


def _seen(plane: PeriodicField, number: int, feet: Footprints, mean: FloatArray, spread: FloatArray, tails: str) -> FloatArray:
    out = mean.copy()
    sea = feet.sea
    out[sea] = fluctuation(plane.frame(number)[sea], mean[sea], spread[sea], tails)  # type: ignore[arg-type]
    return out


def _contrast(variance: float, mean: float) -> float:
    """Standard deviation over mean of the data.

    Raises
    ------
    DataError
        A mean that is not above 0: of filtered data, say.
    """
    if not mean > 0.0:
        raise DataError(
            f"the texture's mean is {mean:g}: its ratio to the standard deviation means nothing; fit it to radiances or counts, or take "
            "contrast = 'glint'"
        )
    return float(np.sqrt(variance) / mean)
