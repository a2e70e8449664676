"""Presets of scenes, with the source of their numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from seaglint.base.free_form import TomlTables
from seaglint.base.optional import remedy


@dataclass(frozen=True)
class Preset:
    """Keys of a scenario that differ from the defaults, with the reasons."""

    title: str
    notes: tuple[str, ...]  #: Sources and remarks, one line each.
    values: TomlTables = field(default_factory=dict)
    files: tuple[str, ...] = ()  #: Files of the package that the scenario names, which are written beside it.


#: Presets of scenes by the name that the parameter ``preset`` takes.
PRESETS: Final[dict[str, Preset]] = {
    "glint": Preset(
        "the glint corridor of a low Sun, seen from a ship's mast",
        (
            "Band: 3.5-5 um as in the source article's glint calculations. Air: LOWTRAN7 midlatitude summer, Navy maritime aerosol",
            "(Kneizys et al. 1988). Slopes: Cox and Munk 1954. Waves: Elfouhaily et al. 1997. Sea at 288.15 K as in the source article.",
        ),
    ),
    "calm": Preset(
        "a nearly calm sea and its bright, narrow glint",
        (
            "Sensor at 100 m, wind 0.5 m/s: the article's 'calm', where the brightest point looks as warm as 526 K.",
            "Waves this small stay facet density: the mean picture.",
        ),
        {
            "sensor": {"height_m": 100.0, "elevation_deg": -13.0, "fov_deg": [32.0, 16.0]},
            "wind": {"speed_m_s": 0.5},
            "sea": {"resolve_waves": False, "slopes": {"kind": "cox-munk-isotropic"}},
        },
    ),
    "article-10ms": Preset(
        "10 m/s of wind in the article's own manner, for mean maps",
        (
            "Settings of the headline row '62 K rise at 10 m/s': isotropic Cox-Munk slopes at the wind as given, the article's water,",
            "band means, sky and sea as one blackbody, the viewer's shadowing only. Brightest at a depression of 1.5 to 2.5 deg.",
        ),
        {
            "sun": {"zenith_deg": 77.0, "azimuth_deg": 180.0},
            "sensor": {"height_m": 100.0},
            "wind": {"speed_m_s": 10.0},
            "sea": {"water": "article", "resolve_waves": False, "slopes": {"kind": "cox-munk-isotropic"}},
            "mean": {"mode": "article"},
        },
    ),
    "buoy": Preset(
        "waves measured by a buoy",
        (
            "Directional spectrum of NDBC station 41010 (Canaveral East) of 8 June 2020: NOAA, public domain. The five files beside this",
            "one hold three hours; put a buoy's own in their place (ndbc.noaa.gov, realtime2: .data_spec, .swdir, .swdir2, .swr1, .swr2)",
            f"and set the time to an hour that they hold. Reading them needs wavespectra: {remedy('wavespectra')}.",
        ),
        {"sea": {"spectrum": {"kind": "file", "path": "41010.data_spec", "time": "2020-06-08T03:50:00Z"}}},
        tuple(f"41010.{ending}" for ending in ("data_spec", "swdir", "swdir2", "swr1", "swr2")),
    ),
    "sounding": Preset(
        "air of a sounding",
        (
            "sounding.csv beside this file: a midlatitude summer up to 10 km (Anderson et al. 1986); put your own in its place.",
            "Read are also the lists of the University of Wyoming, IGRA, SHARPpy, bufkit, Vaisala and AVAPS, sondes in NetCDF, and ERA5;",
            "'seaglint atmosphere info sounding.csv' says what is understood.",
        ),
        {"atmosphere": {"source": "lowtran", "sounding": "sounding.csv"}},
        ("sounding.csv",),
    ),
    "swell": Preset(
        "a long swell that crosses the wind sea",
        (
            "Swell of 2 m and 12 s (JONSWAP shape, Hasselmann et al. 1973), narrow, 60 deg off the wind;",
            "the wind sea is Elfouhaily et al. 1997 at the scenario's wind.",
        ),
        {
            "sea": {
                "spectrum": {
                    "kind": "systems",
                    "systems": [
                        {
                            "kind": "jonswap",
                            "significant_height_m": 2.0,
                            "peak_period_s": 12.0,
                            "gamma": 5.0,
                            "from_deg": 330.0,
                            "spreading_deg": 12.0,
                        },
                        {"kind": "elfouhaily"},
                    ],
                }
            }
        },
    ),
    "furnace": Preset(
        "everything at one temperature: the picture must be flat",
        ("A closed isothermal cavity looks like a blackbody whatever its walls are: the test scene of every thermal renderer.",),
        {
            "sensor": {"frames": 2, "pixels": [128, 64]},
            "sea": {"temperature_k": 288.15},
            "atmosphere": {"source": "isothermal", "temperature_k": 288.15},
        },
    ),
}
