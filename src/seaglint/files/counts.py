"""Radiance from the counts of a detector, by the linear relation in the attributes of ``signal``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from seaglint.base.errors import DataError
from seaglint.base.schema import default_image

if TYPE_CHECKING:
    import xarray as xr


def pictures(dataset: xr.Dataset) -> xr.DataArray:
    """Return the variable that pictures are made of: ``signal``, or ``radiance`` where there is none.

    Raises
    ------
    DataError
        A dataset that has neither.
    """
    name = default_image(str(held) for held in dataset.data_vars)
    if name is not None and name != "texture":
        return dataset[name]
    available = ", ".join(map(str, dataset.data_vars)) or "none"
    raise DataError(
        f"the dataset has no variable 'radiance' (it has: {available}); give the variable itself, e.g. dataset['path_radiance'], or counts "
        "as 'signal'"
    )


def count_line(variable: xr.DataArray) -> tuple[float, float]:
    """Return the radiance of one count and of zero counts [W m-2 sr-1]; (1, 0) for a variable that is radiance.

    Raises
    ------
    DataError
        Counts without their line.
    """
    if variable.name != "signal":
        return 1.0, 0.0
    try:
        return float(variable.attrs["radiance_scale"]), float(variable.attrs["radiance_offset"])
    except (KeyError, TypeError, ValueError):
        raise DataError(
            "signal lacks its attributes radiance_scale and radiance_offset, which make radiance of counts; give a file that "
            "'seaglint render' or 'seaglint sense' wrote"
        ) from None


def radiance_of(dataset: xr.Dataset) -> xr.DataArray:
    """Return the radiance of a dataset [W m-2 sr-1]: its own, or that of its counts."""
    images = pictures(dataset)
    if images.name == "radiance":
        return images
    scale, offset = count_line(images)
    from seaglint.base.schema import VARIABLES

    radiance = (images.astype("float64") * scale + offset).rename("radiance")
    return radiance.assign_attrs(VARIABLES["radiance"].attributes)
