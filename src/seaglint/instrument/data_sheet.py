"""Figures of merit of a sensor as a record, in the order in which a data sheet prints them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal

from seaglint.base.free_form import JsonObject


@dataclass(frozen=True)
class TransferCurves:
    """Modulation transfer function of a sensor."""

    frequency_cycles_per_mrad: list[float]  #: Frequencies [cycles mrad-1].
    along: list[float]  #: Transfer along rows [1].
    across: list[float]  #: Transfer across rows [1].
    nyquist_cycles_per_mrad: float  #: Nyquist frequency [cycles mrad-1].
    parts: dict[str, dict[str, list[float]]]  #: Factors of the transfer by their causes, for ``along`` and ``across`` [1].


@dataclass(frozen=True)
class BudgetAtMean:
    """Noise of a pixel at the mean radiance of a scene, by its causes."""

    scene_radiance: float  #: Mean radiance [W m-2 sr-1].
    scene_apparent_temperature_k: float | None  #: Apparent temperature of the mean radiance [K]; None for a radiance without one.
    signal: float  #: Mean signal [units].
    parts: dict[str, float]  #: Temporal noise by its causes, rms [units].
    total_temporal: float  #: Total temporal noise, the root of the sum of squares of the causes [units].
    fixed_pattern: float  #: Spread between pixels, rms [units].

    @property
    def noise(self) -> dict[str, float]:
        """Noise by its causes, the total and the fixed pattern last, rms [units]."""
        return {**self.parts, "total_temporal": self.total_temporal, "fixed_pattern": self.fixed_pattern}

    def as_dict(self) -> JsonObject:
        """Return plain numbers."""
        scene = {"scene_radiance": self.scene_radiance, "scene_apparent_temperature_k": self.scene_apparent_temperature_k}
        return {**scene, "signal": self.signal, **self.noise}


@dataclass(frozen=True)
class ConversionError:
    """Error of the conversion of radiance to photons for spectra other than the reference."""

    reference_k: float  #: Temperature of the blackbody for which the conversion is exact [K].
    at_280_k: float  #: Relative error for a blackbody of 280 K [1].
    at_320_k: float  #: Relative error for a blackbody of 320 K [1].
    sunlight: float  #: Relative error for sunlight [1].

    def as_dict(self) -> JsonObject:
        """Return plain numbers."""
        return {"reference_k": self.reference_k, "280_k": self.at_280_k, "320_k": self.at_320_k, "sunlight": self.sunlight}


@dataclass(frozen=True)
class SensorDataSheet:
    """Figures of merit of a sensor; its signals are electrons of a photon detector or nanowatts of a thermal one."""

    detector: Literal["photon", "thermal"]  #: Kind of detector.
    band_um: list[float]  #: Limits of the band [um].
    mean_wavelength_um: float  #: Mean wavelength of the photons [um].
    aperture_m: float  #: Diameter of the pupil [m].
    focal_length_m: float  #: Focal length [m].
    f_number: float  #: Focal ratio [1].
    solid_angle_sr: float  #: Solid angle of the pupil at the pixel [sr].
    ifov_mrad: float  #: Angle of a pixel [mrad].
    oversampling: int  #: Pixels of the drawn picture along a pixel of the detector.
    background_k: float  #: Temperature against which the noise is stated [K].
    netd_k: float  #: Noise-equivalent temperature difference [K].
    sitf_counts_per_k: float  #: Slope of the signal against temperature [counts K-1].
    nei_w_m2: float  #: Noise-equivalent irradiance at the aperture [W m-2].
    nep_w: float  #: Noise-equivalent power on the pixel [W].
    point_share: float  #: Share of the light of a point at the centre of a pixel that falls on the pixel's sensitive area [1].
    #: Contrast of a point at the centre of a pixel, relative to its light spread evenly over the pixel: the share over the fill factor [1].
    point_response: float
    electrons_per_count: float | None  #: Gain of a photon detector [electrons]; None for a thermal detector.
    nw_per_count: float | None  #: Gain of a thermal detector [nW]; None for a photon detector.
    offset_counts: float  #: Counts without a signal.
    radiance_per_count: float  #: Scale of counts [W m-2 sr-1].
    radiance_at_zero_counts: float  #: Offset of counts [W m-2 sr-1].
    dynamic_range_db: float | None  #: Full scale over the noise in the dark; None without noise [dB].
    saturation_temperature_k: float | None  #: Apparent temperature that saturates [K].
    saturation_radiance: float  #: Radiance that saturates [W m-2 sr-1].
    mtf: TransferCurves  #: Modulation transfer.
    noise_budget: BudgetAtMean  #: Noise at the scene's mean.
    three_d_noise: dict[str, float]  #: Components of 3-D noise, rms [units].
    conversion_error: ConversionError  #: Error of the conversion to photons.
    time_s: float  #: Integration time, or frame interval of a thermal detector [s].

    @property
    def unit(self) -> str:
        """Printed unit of the signals."""
        return "electrons" if self.detector == "photon" else "nW"

    def as_dict(self) -> JsonObject:
        """Return plain numbers under names with their units."""
        units = self.unit.lower()
        names = {"noise_budget": f"noise_budget_{units}", "three_d_noise": f"three_d_noise_{units}"}
        parts = {"noise_budget": self.noise_budget.as_dict(), "conversion_error": self.conversion_error.as_dict()}
        return {names.get(name, name): value for name, value in (asdict(self) | parts).items()}
