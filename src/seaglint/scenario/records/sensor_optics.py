"""Table ``[sensor.optics]``: what stands before the detector."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StrictBool

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import Record


class Optics(Record):
    """Aperture, focal length, blur and losses; what is left out is neutral."""

    aperture_m: Annotated[Annotated[float, Quantity("m", gt=0, le=10)] | None, Field(description="diameter of the entrance pupil")] = None
    f_number: Annotated[
        Annotated[float, Quantity(ge=0.5, le=200)] | None, Field(description="focal length over aperture; 0.5 is the sine condition's end")
    ] = None
    focal_length_m: Annotated[Annotated[float, Quantity("m", gt=0, le=100)] | None, Field(description="focal length")] = None
    ifov_urad: Annotated[
        Annotated[float, Quantity("urad", gt=0, le=1e5)] | None,
        Field(description="angle between pixels, pitch over focal length; one of several ways to give the focal length"),
    ] = None
    transmission: Annotated[float, Quantity(gt=0, le=1), Field(description="transmission of the optics in the band")] = 1.0
    obscuration: Annotated[float, Quantity(ge=0, lt=1), Field(description="diameter of the central obscuration over that of the pupil")] = (
        0.0
    )
    wavefront_error_waves: Annotated[
        float, Quantity(ge=0, le=0.18), Field(description="rms wavefront error in waves of the mean wavelength (Shannon's fit)")
    ] = 0.0
    defocus_waves: Annotated[
        float, Quantity(ge=0, le=10), Field(description="path error of defocus at the pupil's edge, in waves of the mean wavelength")
    ] = 0.0
    jitter_urad: Annotated[
        float, Quantity("urad", ge=0, le=1e5), Field(description="rms movement of the line of sight in an exposure, each direction")
    ] = 0.0
    drift_along_urad_s: Annotated[
        float, Quantity("urad/s", ge=-1e8, le=1e8), Field(description="steady movement of the line of sight along rows")
    ] = 0.0
    drift_across_urad_s: Annotated[float, Quantity("urad/s", ge=-1e8, le=1e8), Field(description="the same across rows")] = 0.0
    solid_angle: Annotated[
        Literal["sine", "thin-lens"],
        Field(description="pi/(4F^2) of optics that obey the sine condition, or pi/(4F^2 + 1) of a thin lens; 6 % apart at F/2"),
    ] = "sine"
    temperature_k: Annotated[float, Quantity("K", ge=50, le=400), Field(description="temperature of warm optics and housing")] = 293.15
    emissivity: Annotated[float, Quantity(ge=0, le=1), Field(description="emissivity of warm optics, 1 - transmission for lenses")] = 0.0
    cold_shield_f_number: Annotated[
        Annotated[float, Quantity(ge=0.5, le=200)] | None,
        Field(description="f-number of the cold shield; below that of the optics it lets the warm housing in, else it fits"),
    ] = None
    stray_share: Annotated[float, Quantity(ge=0, lt=1), Field(description="share of the light scattered evenly over the picture")] = 0.0
    cos4: Annotated[StrictBool, Field(description="illumination falls with the fourth power of the field angle's cosine")] = False
    distortion: Annotated[
        float, Quantity(ge=-0.3, le=0.3), Field(description="relative radial shift of the picture's corners; positive is pincushion")
    ] = 0.0
