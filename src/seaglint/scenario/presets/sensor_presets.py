"""Presets of sensors from published data sheets, with the source of each number.

What a source says was read there. A number without one that could be read is marked *assumed*, with the reason for it; where a maker's
data sheet is known to say so but no copy of it was at hand, that is said too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from seaglint.base.errors import ScenarioError
from seaglint.base.free_form import TomlTables


@dataclass(frozen=True)
class SensorPreset:
    """Tables of a scenario that describe a sensor, with the source of each number."""

    title: str
    sensor: Mapping[str, Any]  #: Content of the table ``[sensor]``.
    band: Mapping[str, Any]
    sources: Mapping[str, str]  #: Sources by dotted key below ``[sensor]``, or ``band``.


_A6700 = "FLIR, product page of the A6700 MWIR (flir.com/products/a6700-mwir)"
_A6700_SHEET = "assumed: as the data sheet of the FLIR A6700 is cited, no copy at hand"
_BOSON = "Teledyne FLIR Boson data sheet, document 102-2013-40, release 340 (March 2021)"
_BOSON_SHEET = "assumed: as the lens table of the FLIR Boson is cited, no copy at hand"
_SCORPIO = "Sofradir EC, brochure of cooled infrared cameras (Scorpio LWIR, HgCdTe)"
_SCORPIO_SHEET = "assumed: as the data sheet of the Lynred Scorpio LW is cited, no copy at hand"
_RULE_07 = "Tennant et al., J. Electronic Materials 37, 1406 (2008), Rule 07: 9.3 um cut-off, 80 K, 15 um"
_PANORAMA = "assumed: a turn a second and a column of 640 pixels, as panoramic infrared search sensors are sold"

#: Presets of sensors by the name that the parameter ``sensor`` takes.
SENSORS: Final[dict[str, SensorPreset]] = {
    "mwir-insb-640": SensorPreset(
        "cooled InSb camera, 3-5 um, 640 x 512 pixels of 15 um, F/2.5",
        {
            "pixels": [640, 512],
            "frame_rate_hz": 60.0,
            "optics": {"focal_length_m": 0.05, "f_number": 2.5, "transmission": 0.9, "wavefront_error_waves": 0.05},
            "detector": {
                "pitch_um": 15.0,
                "fill_factor": 0.9,
                "integration_time_s": 0.003,
                "quantum_efficiency": 0.9,
                "well_capacity_e": 7.2e6,
                "read_noise_e": 600.0,
                "bit_depth": 14,
            },
            "noise": {"gain_spread": 0.0002, "offset_spread": 200.0, "dead_share": 0.0005},
        },
        {"min_um": 3.0, "max_um": 5.0},
        {
            "band": f"{_A6700}: 3.0-5.0 um (A6701, A6703)",
            "pixels": f"{_A6700}: 640 x 512",
            "frame_rate_hz": f"{_A6700}: up to 60 Hz at full size",
            "optics.focal_length_m": f"{_A6700_SHEET}: 50 mm lens",
            "optics.f_number": "FLIR, field-of-view calculator, part 29440-200 (A6700): F/2.5",
            "optics.transmission": "assumed: five coated germanium and silicon lenses",
            "optics.wavefront_error_waves": "assumed: close to the diffraction limit (Strehl ratio 0.9)",
            "detector.pitch_um": f"{_A6700}: 15 um",
            "detector.fill_factor": "assumed: InSb arrays of 15 um",
            "detector.integration_time_s": "assumed: NETD is then 18 mK; the product page says 20 mK or less, typically",
            "detector.quantum_efficiency": "Gemini Observatory, GNIRS detector properties: InSb with a coating about 0.9 up to 5 um",
            "detector.well_capacity_e": f"{_A6700_SHEET}: 7.2 million electrons",
            "detector.read_noise_e": "assumed: with it NETD stays below the product page's 20 mK",
            "detector.bit_depth": f"{_A6700_SHEET}: 14 bits",
            "noise.gain_spread": "assumed: residual of a two-point correction of 0.02 %",
            "noise.offset_spread": "assumed: a tenth of the temporal noise",
            "noise.dead_share": f"{_A6700_SHEET}: operability above 99.8 %, 99.95 % typical",
        },
    ),
    "lwir-mct-640": SensorPreset(
        "cooled MCT camera, 7.7-9.3 um, 640 x 512 pixels of 15 um, F/2",
        {
            "pixels": [640, 512],
            "frame_rate_hz": 100.0,
            "optics": {"focal_length_m": 0.05, "f_number": 2.0, "transmission": 0.9, "wavefront_error_waves": 0.05},
            "detector": {
                "pitch_um": 15.0,
                "fill_factor": 0.9,
                "integration_time_s": 0.00041,
                "quantum_efficiency": 0.7,
                "well_capacity_e": 1.1e7,
                "read_noise_e": 1000.0,
                "dark_current_e_s": 2.0e7,
                "bit_depth": 14,
            },
            "noise": {"gain_spread": 0.0003, "offset_spread": 500.0, "dead_share": 0.002},
        },
        {"min_um": 7.7, "max_um": 9.3},
        {
            "band": f"{_SCORPIO_SHEET}: 7.7-9.3 um (the brochure says 7.7-9.5 um)",
            "pixels": f"{_SCORPIO}: 640 x 512",
            "frame_rate_hz": "assumed: a camera's rate, with which a frame is far longer than the integration",
            "optics.focal_length_m": "assumed: field of view of 11 deg",
            "optics.f_number": f"{_SCORPIO_SHEET}: F/2",
            "optics.transmission": "assumed: coated germanium lenses",
            "optics.wavefront_error_waves": "assumed: close to the diffraction limit (Strehl ratio 0.9)",
            "detector.pitch_um": f"{_SCORPIO_SHEET}: 15 um",
            "detector.fill_factor": "assumed",
            "detector.integration_time_s": "assumed: NETD is then 22 mK, that of arrays of this kind",
            "detector.quantum_efficiency": f"{_SCORPIO_SHEET}: above 70 %",
            "detector.well_capacity_e": "assumed: the order that NETD of 22 mK at 300 K needs",
            "detector.read_noise_e": "assumed",
            "detector.dark_current_e_s": _RULE_07,
            "detector.bit_depth": "assumed: camera electronics",
            "noise.gain_spread": "assumed: residual of a two-point correction of 0.03 %",
            "noise.offset_spread": "assumed: a quarter of the temporal noise",
            "noise.dead_share": "assumed: operability of 99.8 %",
        },
    ),
    "lwir-microbolometer-640": SensorPreset(
        "uncooled VOx microbolometer, 7.5-13.5 um, 640 x 512 pixels of 12 um, F/1",
        {
            "pixels": [640, 512],
            "frame_rate_hz": 60.0,
            "optics": {"focal_length_m": 0.018, "f_number": 1.0, "wavefront_error_waves": 0.05},
            "detector": {
                "kind": "thermal",
                "pitch_um": 12.0,
                "netd_k": 0.04,
                "netd_f_number": 1.0,
                "time_constant_s": 0.008,
                "bit_depth": 16,
            },
            "scan": {"row_time_s": 3.2e-5},
        },
        {"min_um": 7.5, "max_um": 13.5},
        {
            "band": "FLIR, answer on spectral response (groupgets.com): 7.5-13.5 um, window and bolometer",
            "pixels": f"{_BOSON}: 640 x 512",
            "frame_rate_hz": f"{_BOSON}: 60 Hz",
            "optics.focal_length_m": f"{_BOSON_SHEET}: 18 mm, 24 deg wide",
            "optics.f_number": f"{_BOSON}: NETD is stated at F/1.0",
            "optics.wavefront_error_waves": "assumed",
            "detector.kind": f"{_BOSON}: uncooled VOx microbolometer",
            "detector.pitch_um": "assumed: 12 um, with 18 mm and 640 pixels the 24 deg of the lens",
            "detector.netd_k": f"{_BOSON}: below 40 mK at F/1.0, the lens's transmission in it",
            "detector.netd_f_number": f"{_BOSON}: F/1.0",
            "detector.time_constant_s": "assumed: 8 ms; AT Sensors, basics of microbolometers: 7 to 12 ms",
            "detector.bit_depth": "assumed: 16 bits without gain control",
            "scan.row_time_s": "FLIR ADK (a Boson) user manual, 5.2: about 32 us from line to line",
        },
    ),
    "mwir-panoramic": SensorPreset(
        "rotating MWIR scanner, 3.4-4.9 um, 360 deg by 20 deg once a second",
        {
            "pixels": [11310, 640],
            "frame_rate_hz": 1.0,
            "projection": "equal-angle",
            "optics": {"focal_length_m": 0.027, "f_number": 2.0, "transmission": 0.85, "wavefront_error_waves": 0.05},
            "detector": {
                "pitch_um": 15.0,
                "fill_factor": 0.9,
                "integration_time_s": 8.8e-5,
                "quantum_efficiency": 0.9,
                "well_capacity_e": 1.0e6,
                "read_noise_e": 150.0,
                "bit_depth": 14,
            },
            "scan": {"kind": "panoramic", "period_s": 1.0},
            "noise": {"gain_spread": 0.0003, "row": 100.0},
        },
        {"min_um": 3.4, "max_um": 4.9},
        {
            "band": "assumed: InSb behind a cold filter for the mid-wave window",
            "pixels": _PANORAMA,
            "frame_rate_hz": _PANORAMA,
            "projection": "a rotating column has equal steps of azimuth",
            "optics.focal_length_m": "assumed: 640 pixels see 20 deg",
            "optics.f_number": "assumed: cold shield of F/2",
            "optics.transmission": "assumed: lenses and window",
            "optics.wavefront_error_waves": "assumed: close to the diffraction limit (Strehl ratio 0.9)",
            "detector.pitch_um": f"{_A6700}: 15 um",
            "detector.fill_factor": "assumed: InSb arrays of 15 um",
            "detector.integration_time_s": "the time in which the scanner moves on by a pixel",
            "detector.quantum_efficiency": "Gemini Observatory, GNIRS detector properties: InSb with a coating about 0.9 up to 5 um",
            "detector.well_capacity_e": "assumed: gain for short exposures",
            "detector.read_noise_e": "assumed: small wells have low read noise",
            "detector.bit_depth": "assumed: 14 bits, as cameras of this kind have",
            "scan.kind": _PANORAMA,
            "scan.period_s": _PANORAMA,
            "noise.gain_spread": "assumed: residual of a two-point correction of 0.03 %",
            "noise.row": "assumed: every row of a scanned picture is one pixel of the column, whose offset makes a stripe",
        },
    ),
}

TABLES: Final = ("optics", "detector", "scan", "noise")  #: Tables of ``[sensor]`` that a preset replaces as a whole.


def with_sensor(raw: Mapping[str, Any], name: str) -> TomlTables:
    """Return a scenario's raw tables with the pixels, rate, band and four tables of a preset's sensor in place of its own.

    Height, direction and projection stay the scenario's, and so does everything else.

    Raises
    ------
    ScenarioError
        For a name that is no preset.
    """
    try:
        chosen = SENSORS[name]
    except KeyError:
        raise ScenarioError(f"sensor='{name}' is not one of {', '.join(SENSORS)}") from None
    own = raw.get("sensor", {})
    replaced = (*TABLES, "fov_deg", "pixels", "frame_rate_hz")
    remaining = {key: value for key, value in own.items() if key not in replaced} if isinstance(own, Mapping) else {}
    new = {key: dict(value) if isinstance(value, Mapping) else value for key, value in chosen.sensor.items()}
    return {**raw, "sensor": {**remaining, **new}, "band": dict(chosen.band)}
