"""Names, units, CF standard names and descriptions of all output variables, in one table.

Files, plot labels and the documentation read it; no other module may name a unit. Numbers of objects are in it, and not with their drawing,
as files are read without drawing.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal, get_args


@dataclass(frozen=True)
class Variable:
    """Output variable of a file or column of a table."""

    name: str
    units: str  #: Unit as UDUNITS text; empty for a variable without unit.
    long_name: str
    standard_name: str | None = None  #: CF standard name; None if CF has no suitable name.
    symbol: str = ""  #: Unit on plots; empty if equal to ``units``.
    dtype: str = "float32"  #: Data type of an image in files.

    @property
    def attributes(self) -> dict[str, str]:
        """CF attributes."""
        pairs = {"long_name": self.long_name, "units": self.units, "standard_name": self.standard_name}
        return {key: value for key, value in pairs.items() if value}

    @property
    def label(self) -> str:
        """Axis or colour-bar label, e.g. ``"apparent temperature [K]"``."""
        unit = self.symbol or self.units
        return f"{self.long_name} [{unit}]" if unit else self.long_name


#: Default images of all commands and functions; the first that exists is used: the signal of a detector, else radiance.
IMAGES: Final = ("signal", "radiance", "texture")

_RADIANCE = ("W m-2 sr-1", "W m⁻² sr⁻¹")


def _radiance(name: str, long_name: str) -> Variable:
    return Variable(name, _RADIANCE[0], long_name, symbol=_RADIANCE[1])


#: Ground-truth numbers of an object in a frame, in the order of table columns; unknown numbers of an object out of view are NaN.
_OBJECT_NUMBERS: Final = (
    Variable("column_px", "1", "column of an object's middle, pixel centres whole numbers", symbol="px"),
    Variable("row_px", "1", "row of an object's middle, from the top, pixel centres whole numbers", symbol="px"),
    Variable("range_m", "m", "distance from the sensor to an object's origin"),
    Variable("solid_angle_sr", "sr", "solid angle of an object above its waterline, whatever hides it"),
    Variable("visible_share", "1", "share of an object above its waterline that is seen in the image", symbol=" "),
    Variable("occluded_share", "1", "share of an object above its waterline and in the image that something hides", symbol=" "),
    Variable("truncated_share", "1", "share of an object above its waterline that is outside the image", symbol=" "),
    _radiance("contrast_W_m2_sr", "radiance of an object above that of the sea's image behind it, mean over what is seen of it"),
    Variable("bearing_deg", "degree", "azimuth of an object's origin, clockwise from north", symbol="deg"),
    Variable("elevation_deg", "degree", "elevation of an object's origin", symbol="deg"),
    Variable("bbox_left_px", "1", "first column that an object touches", symbol="px"),
    Variable("bbox_top_px", "1", "first row that an object touches", symbol="px"),
    Variable("bbox_width_px", "1", "columns that an object touches", symbol="px"),
    Variable("bbox_height_px", "1", "rows that an object touches", symbol="px"),
    Variable("temperature_difference_K", "K", "apparent temperature of an object above that of the sea's image behind it"),
    Variable("signal_to_clutter", "1", "largest change of a pixel over the deviation of the sea's image around an object", symbol=" "),
    Variable("pixels", "1", "pixels that an object fills, in parts", symbol=" "),
    Variable("irradiance_W_m2", "W m-2", "irradiance at the aperture that an object adds", symbol="W m⁻²"),
    Variable("signal_column_px", "1", "column of the middle of what an object adds", symbol="px"),
    Variable("signal_row_px", "1", "row of the middle of what an object adds", symbol="px"),
    Variable("velocity_column_px_s", "s-1", "speed of an object along columns in the image", symbol="px/s"),
    Variable("velocity_row_px_s", "s-1", "speed of an object along rows in the image, downwards positive", symbol="px/s"),
    Variable("motion_px", "1", "way of an object in the image during the exposure", symbol="px"),
    Variable("streak_begin_column_px", "1", "column of an object's middle at the beginning of the exposure", symbol="px"),
    Variable("streak_begin_row_px", "1", "row of an object's middle at the beginning of the exposure", symbol="px"),
    Variable("streak_end_column_px", "1", "column of an object's middle at the end of the exposure", symbol="px"),
    Variable("streak_end_row_px", "1", "row of an object's middle at the end of the exposure", symbol="px"),
    Variable("blur_px", "1", "blur of an object by optics, crosstalk and its motion, standard deviation", symbol="px"),
    Variable("size_class", "1", "class of an object's size: 0 point, 1 small, 2 extended", symbol=" "),
    Variable("counts_column_px", "1", "column of the middle of an object's counts", symbol="px"),
    Variable("counts_row_px", "1", "row of the middle of an object's counts", symbol="px"),
    Variable("counts_peak", "count", "largest change of a pixel's counts by an object, without noise", symbol="counts"),
    Variable("counts_snr", "1", "that change over the temporal noise of its pixel", symbol=" "),
    Variable("response_pixels", "1", "pixels of the mask of an object's response after the optics", symbol=" "),
    Variable("response_left_px", "1", "first column of that mask", symbol="px"),
    Variable("response_top_px", "1", "first row of that mask", symbol="px"),
    Variable("response_width_px", "1", "columns that this mask spans", symbol="px"),
    Variable("response_height_px", "1", "rows that this mask spans", symbol="px"),
)

#: All variables by name; numbers of objects are one part of the table.
VARIABLES: Final[dict[str, Variable]] = {
    variable.name: variable
    for variable in (
        # CF has no standard name for in-band radiance along a near-horizontal line of sight: long_name, units and band describe it
        _radiance("radiance", "in-band radiance at the aperture"),
        _radiance("path_radiance", "in-band radiance of the path (thermal emission and scattered sunlight)"),
        _radiance("emitted_radiance", "in-band radiance emitted by the sea, at the aperture"),
        _radiance("sky_radiance", "in-band sky radiance reflected by the sea, at the aperture; above the horizon that of the sky"),
        _radiance("glint_radiance", "in-band sunlight reflected by the sea, at the aperture"),
        _radiance("glint_std", "standard deviation of in-band sunlight reflected by the sea, in a pixel"),
        Variable("apparent_temperature", "K", "apparent temperature", "brightness_temperature"),
        *(
            Variable(f"{name}_sea_{end}", units, f"{what}, {share} of the seas between the campaigns are below", symbol=symbol)
            for name, units, symbol, what in (
                ("radiance", *_RADIANCE, "in-band radiance at the aperture"),
                ("apparent_temperature", "K", "", "apparent temperature"),
                ("glint_std", *_RADIANCE, "standard deviation of in-band sunlight reflected by the sea, in a pixel"),
            )
            for end, share in (("low", "5 %"), ("high", "95 %"))
        ),
        Variable("signal", "count", "signal of the detector", symbol="counts", dtype="uint16"),
        Variable("electrons", "1", "electrons of a pixel, noise and background in them", symbol="electrons"),
        Variable("texture", "1", "values of a statistical texture"),
        Variable("saturated_share", "1", "share of the pixels that are saturated", symbol=" "),
        # not the sensor_azimuth_angle of CF, which is measured at the visible point, towards the sensor: the opposite direction
        Variable("azimuth", "degree", "azimuth of the line of sight at the sensor, clockwise from north", symbol="deg"),
        Variable("elevation", "degree", "elevation of the line of sight above the horizontal at the sensor", symbol="deg"),
        Variable("sensor_east", "m", "position of the sensor towards east"),
        Variable("sensor_north", "m", "position of the sensor towards north"),
        Variable("sensor_height", "m", "height of the sensor above the mean sea"),
        Variable("sensor_azimuth", "degree", "azimuth of the image centre, clockwise from north", symbol="deg"),
        Variable("sensor_elevation", "degree", "elevation of the image centre above the horizontal", symbol="deg"),
        Variable("sensor_roll", "degree", "turn of the sensor about its line of sight, right side down", symbol="deg"),
        Variable("range", "m", "distance from the sensor to the sea, mean over what a pixel sees of it"),
        Variable("coverage", "1", "share of a pixel that the sea fills", symbol=" "),
        Variable("foam_share", "1", "share of a pixel that is foam", symbol=" "),
        Variable(
            "slope", "1", "slope of the sea away from the sensor, mean over what a pixel sees of it; facing it is positive", symbol=" "
        ),
        Variable("glint_share", "1", "share of reflected sunlight in the radiance", symbol=" "),
        *_OBJECT_NUMBERS,
        Variable("object_id", "1", "number, from 1, of the object that covers most of a pixel; 0 for none", symbol=" ", dtype="uint16"),
        Variable("object_mask", "1", "bit n: object n, from 0, touches the pixel", symbol=" ", dtype="uint64"),
        Variable(
            "response_mask", "1", "bit n: response of object n, from 0, is in the pixel, after the optics", symbol=" ", dtype="uint64"
        ),
        Variable("time", "s", "time from the start of the sequence"),
        Variable("utc", "seconds since the first frame's date", "UTC of the frame, where the scenario has a date", "time", symbol=" "),
        Variable("height", "m", "height of the sea above its mean level"),
        Variable("slope_east", "1", "slope of the resolved waves towards east", symbol=" "),
        Variable("slope_north", "1", "slope of the resolved waves towards north", symbol=" "),
        Variable("facet_slope_east_east", "1", "variance of the slopes towards east that are no geometry", symbol=" "),
        Variable("facet_slope_east_north", "1", "covariance of the slopes that are no geometry", symbol=" "),
        Variable("facet_slope_north_north", "1", "variance of the slopes towards north that are no geometry", symbol=" "),
        Variable("east", "m", "distance to the east of the sensor's foot"),
        Variable("north", "m", "distance to the north of the sensor's foot"),
        Variable("tile_u", "m", "distance along a tile's first axis"),
        Variable("tile_v", "m", "distance along a tile's second axis"),
        Variable("frame", "1", "number of the frame in the whole sequence, from 0", symbol=" "),
        Variable("frame_done", "1", "1 where the frame has been written completely", symbol=" "),
        Variable("frame_checksum", "1", "BLAKE2b of what is stored of the frame, 64 bits", symbol=" ", dtype="uint64"),
        Variable("wavelength", "um", "centre of the band", "sensor_band_central_radiation_wavelength", symbol="µm"),
        Variable("wavelength_bounds", "um", "edges of the band", symbol="µm"),
    )
}

NUMBERS: Final = tuple(variable.name for variable in _OBJECT_NUMBERS)  #: Names of the numbers of objects, in their order.

#: Classes of size by their number: solid angles of less than a pixel, of at most ``MOST_SMALL`` pixels, and larger.
SIZES: Final = ("point", "small", "extended")

MOST_SMALL: Final = 81  #: Greatest size of a small target [pixels]: 9 x 9, the definition of SPIE (0.12 % of 256 x 256).

#: Name of a variable that an image may have besides its radiance.
Layer = Literal[
    "path_radiance",
    "emitted_radiance",
    "sky_radiance",
    "glint_radiance",
    "range",
    "coverage",
    "foam_share",
    "slope",
    "glint_share",
    "object_id",
]

LAYERS: Final[tuple[str, ...]] = get_args(Layer)  #: Names of all layers, in the order in which they are listed.

#: Number of uW cm-2 sr-1 in one W m-2 sr-1: the unit of the source article, an alternative to SI in plots and reports.
ARTICLE_RADIANCE_PER_SI: Final = 100.0

ARTICLE_RADIANCE_SYMBOL: Final = "µW cm⁻² sr⁻¹"  #: That unit on plots.


def default_image(names: Iterable[str]) -> str | None:
    """Return the default image among several variables, the first of ``IMAGES``; None without any of them.

    >>> default_image(["range", "radiance", "signal"])
    'signal'
    """
    available = set(names)
    return next((name for name in IMAGES if name in available), None)
