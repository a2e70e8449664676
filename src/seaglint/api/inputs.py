"""Conversion of the inputs that the functions of ``import seaglint as sg`` accept in several forms."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from seaglint.analysis import Recording
    from seaglint.optics.band import Band


AXES = ("time", "y", "x")
"""Names of the last axes of an array without names."""


def recording_of(given: Any, frame_rate: float | None, units: str | None, variable: str | None) -> Recording:
    """Return the recording to analyse, from a file or from memory."""
    from dataclasses import replace

    import numpy as np
    import xarray as xr

    from seaglint.analysis import Recording
    from seaglint.files.recording import open_recording
    from seaglint.files.recording.arrays import ArrayFacts, ArrayReading, of_array
    from seaglint.files.recording.labelled import of_dataset

    if isinstance(given, str | Path):
        return open_recording(given, frame_rate=frame_rate, units=units, variable=variable)
    if isinstance(given, xr.DataArray):
        given = given.to_dataset(name=str(given.name or "values"))
    if isinstance(given, xr.Dataset):
        ordered = given.transpose("time", ...) if "time" in given.dims else given
        recording = of_dataset(ordered, "dataset", ArrayReading(variable))
    elif isinstance(given, Recording):
        recording = given
    else:
        recording = of_array(np.asarray(given), "array", ArrayReading(), ArrayFacts(frame_rate, units))
    return replace(recording, frame_rate=frame_rate or recording.frame_rate, units=units or recording.units)


def kelvin_of(radiance: Any, band: Band | tuple[float, float] | None) -> xr.DataArray:
    """Apparent temperature [K] of radiance in any accepted form."""
    import numpy as np
    import xarray as xr

    from seaglint.air.protocol import wavenumber_grid
    from seaglint.base.schema import VARIABLES
    from seaglint.files.counts import radiance_of
    from seaglint.optics.band import Band
    from seaglint.optics.band import apparent_temperature as kelvin

    if isinstance(radiance, xr.Dataset):
        given = radiance_of(radiance)
        attributes = {**radiance.attrs, **given.attrs}
    elif isinstance(radiance, xr.DataArray):
        given, attributes = radiance, radiance.attrs
    else:
        values = np.asarray(radiance)
        given, attributes = xr.DataArray(values, dims=AXES[3 - values.ndim :] if values.ndim <= 3 else None), {}
    over = band if isinstance(band, Band) else band_of(attributes) if band is None else Band.rectangular(*band)
    grid = wavenumber_grid(over.min_um, over.max_um)
    kind = given.dtype if given.dtype.kind == "f" else np.dtype(np.float64)

    def converted(values: NDArray[Any]) -> NDArray[np.floating[Any]]:
        return kelvin(values, over, grid).astype(kind)

    result = xr.apply_ufunc(converted, given, dask="parallelized", output_dtypes=[kind], keep_attrs=True)
    out: xr.DataArray = result.rename("apparent_temperature")
    return out.assign_attrs(VARIABLES["apparent_temperature"].attributes)


def band_of(attributes: Mapping[Any, Any]) -> Band:
    """Return the spectral band that the attributes of a file state."""
    from seaglint.base.errors import DataError
    from seaglint.files.provenance import stored_band

    try:
        return stored_band(attributes)
    except KeyError:
        text = "no band given, and none in the attributes (band_wavelength_um and band_response)"
        raise DataError(f"{text}; give band=(min_um, max_um), or a seaglint dataset instead of its variable") from None


def with_band(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with the band attributes on every in-band radiance, so that each variable can be saved alone."""
    from seaglint.base.schema import VARIABLES
    from seaglint.files.netcdf import plain_attributes

    dataset.attrs = plain_attributes(dataset.attrs)
    band = {key: dataset.attrs[key] for key in ("band_wavelength_um", "band_response")}
    for name, variable in dataset.data_vars.items():
        if variable.attrs.get("units") == VARIABLES["radiance"].units:
            dataset[name].attrs = {**variable.attrs, **band}
    return dataset
