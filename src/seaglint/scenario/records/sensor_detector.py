"""Table ``[sensor.detector]``: the pixels."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import InputFile, Record, default_tag, rule


class PhotonDetector(Record):
    """Pixels that count photons: InSb, MCT and others; what is left out is neutral."""

    kind: Literal["photon"] = "photon"
    pitch_um: Annotated[float, Quantity("um", gt=0, le=1000), Field(description="distance of the pixels' centres")]
    fill_factor: Annotated[float, Quantity(gt=0, le=1), Field(description="share of a pixel's area that is sensitive")] = 1.0
    integration_time_s: Annotated[
        Annotated[float, Quantity("s", gt=0, le=1e4)] | None, Field(description="integration time; default: a whole frame")
    ] = None
    short_integration_time_s: Annotated[
        Annotated[float, Quantity("s", gt=0, le=1e4)] | None,
        Field(description="second, shorter integration after the first, taken where that saturates (high dynamic range)"),
    ] = None
    quantum_efficiency: Annotated[float, Quantity(gt=0, le=1), Field(description="electrons for each photon in the band")] = 1.0
    quantum_efficiency_file: Annotated[
        InputFile | None,
        Field(description="CSV file with columns wavelength_um, response; its peak is quantum_efficiency, over the whole band"),
    ] = None
    well_capacity_e: Annotated[
        Annotated[float, Quantity("", gt=0, le=1e12)] | None, Field(description="electrons that a pixel holds; any number where left out")
    ] = None
    read_noise_e: Annotated[float, Quantity("", ge=0, le=1e9), Field(description="rms noise of a reading in electrons")] = 0.0
    dark_current_e_s: Annotated[float, Quantity("", ge=0, le=1e15), Field(description="dark current in electrons per second")] = 0.0
    bit_depth: Annotated[int, Quantity(ge=1, le=16, integer=True), Field(description="bits of a count")] = 16
    gain_e_per_count: Annotated[
        Annotated[float, Quantity("", gt=0, le=1e9)] | None,
        Field(description="electrons for each count; where left out a full well (or a blackbody of 400 K) fills the counts"),
    ] = None
    offset_counts: Annotated[float, Quantity("", ge=0, le=65_535), Field(description="counts without electrons")] = 0.0
    crosstalk: Annotated[float, Quantity(ge=0, le=0.8), Field(description="share of the electrons that the four neighbours get")] = 0.0
    netd_k: Annotated[
        Annotated[float, Quantity("K", gt=0, le=100)] | None,
        Field(
            description="noise-equivalent temperature difference of the data sheet: gives the read noise beside integration_time_s, the "
            "integration time without it"
        ),
    ] = None
    netd_temperature_k: Annotated[
        float, Quantity("K", ge=200, le=400), Field(description="blackbody temperature for which netd_k is stated")
    ] = 300.0

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        if self.netd_k is not None and self.integration_time_s is not None and self.read_noise_e > 0.0:
            text = (
                f"= {self.netd_k:g} is given beside integration_time_s and read_noise_e, and any two of the three give the third; "
                "leave one out ('seaglint sensor' prints it)"
            )
            raise rule("sensor.detector.netd_k", text, value=self.netd_k)
        if self.well_capacity_e is not None and self.well_capacity_e <= self.read_noise_e:
            text = f"= {self.well_capacity_e:g} is not above sensor.detector.read_noise_e = {self.read_noise_e:g}; correct one of them"
            raise rule("sensor.detector.well_capacity_e", text, value=self.well_capacity_e, allowed=f"above {self.read_noise_e:g}")
        if self.short_integration_time_s is not None and self.well_capacity_e is None:
            text = "is missing beside short_integration_time_s, which is taken where the well is full; add it"
            raise rule("sensor.detector.well_capacity_e", text)
        if self.offset_counts >= (1 << self.bit_depth) - 1:
            text = f"= {self.offset_counts:g} leaves nothing of {self.bit_depth} bits; give a lower offset or a greater bit_depth"
            raise rule("sensor.detector.offset_counts", text, value=self.offset_counts)
        return self


class ThermalDetector(Record):
    """Pixels that answer to absorbed power, with a lag and the noise that a data sheet states: microbolometers."""

    kind: Literal["thermal"]
    pitch_um: Annotated[float, Quantity("um", gt=0, le=1000), Field(description="distance of the pixels' centres")]
    netd_k: Annotated[float, Quantity("K", gt=0, le=100), Field(description="noise-equivalent temperature difference of the data sheet")]
    netd_f_number: Annotated[float, Quantity(ge=0.5, le=20), Field(description="f-number of the optics for which netd_k is stated")] = 1.0
    netd_temperature_k: Annotated[
        float, Quantity("K", ge=200, le=400), Field(description="blackbody temperature for which netd_k is stated")
    ] = 300.0
    time_constant_s: Annotated[float, Quantity("s", ge=0, le=10), Field(description="time constant of the exponential lag")] = 0.0
    fill_factor: Annotated[float, Quantity(gt=0, le=1), Field(description="share of a pixel's area that absorbs")] = 1.0
    absorptance: Annotated[float, Quantity(gt=0, le=1), Field(description="share of the power that is absorbed")] = 1.0
    full_scale_k: Annotated[float, Quantity("K", ge=300, le=3000), Field(description="blackbody that fills the counts")] = 433.15
    bit_depth: Annotated[int, Quantity(ge=1, le=16, integer=True), Field(description="bits of a count")] = 16
    offset_counts: Annotated[float, Quantity("", ge=0, le=65_535), Field(description="counts without power")] = 0.0

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        if self.offset_counts >= (1 << self.bit_depth) - 1:
            text = f"= {self.offset_counts:g} leaves nothing of {self.bit_depth} bits; give a lower offset or a greater bit_depth"
            raise rule("sensor.detector.offset_counts", text, value=self.offset_counts)
        return self


Detector = Annotated[
    Annotated[PhotonDetector | ThermalDetector, Field(discriminator="kind")],
    default_tag("kind", "photon"),
]
