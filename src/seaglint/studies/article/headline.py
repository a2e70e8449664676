"""The source article's headline numbers: each row with the article's value, ours and the settings.

Only the article's values and the settings are constants; a change of any model changes these rows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Final

import numpy as np
from scipy.special import ndtr

from seaglint.air.protocol import wavenumber_grid
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.free_form import JsonObject
from seaglint.facet.legs import VIEWER
from seaglint.facet.sea_view import SeaView
from seaglint.optics import sea_water
from seaglint.optics.band import ARTICLE_UNIT, ApparentTemperature, Band
from seaglint.radiance.article import article_radiance
from seaglint.radiance.mean_radiance import SeaRadiance, mean_radiance
from seaglint.radiance.variance import capillary_length
from seaglint.sea.slopes.cox_munk import WIND_HEIGHT, cox_munk_isotropic
from seaglint.studies.build.profile_air import model_air


@dataclass(frozen=True)
class ArticleRow:
    """Number of the source article beside ours."""

    article: float | None  #: The article's value; None where it has none.
    ours: float | None  #: Our value; None where there is none.
    unit: str  #: Their unit.
    settings: JsonObject = field(default_factory=dict)  #: Settings and conditions, plain numbers and text by name.

    @property
    def numbers(self) -> dict[str, float | None]:
        """Return the values by the heads of their columns."""
        return {"article": self.article, "ours": self.ours}

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)


@dataclass(frozen=True)
class SensedRow(ArticleRow):
    """Number of the source article beside ours of pictures as rendered (``ours``), and of others; None where a value does not exist."""

    through_detector: float | None = None  #: Value of the same pictures through the detector.
    waves: float | None = None  #: Value of pictures whose sparkles follow from the waves, as rendered.
    waves_through_detector: float | None = None  #: Value of these through the detector.

    @property
    def numbers(self) -> dict[str, float | None]:
        """Return the values by the heads of their columns."""
        return {
            "article": self.article,
            "as rendered": self.ours,
            "detector": self.through_detector,
            "waves": self.waves,
            "waves, detector": self.waves_through_detector,
        }


MODEL: Final = "midlatitude-summer"  #: The article's model atmosphere.

SEA_TEMPERATURE: Final = 288.15  #: Temperature of the article's sea [K].

_SENSOR_HEIGHT: Final = 100.0
_CALM: Final = 0.5  # the article's calm: its 526 K is the peak near 0.5 m/s (0 m/s 570 K, 1 m/s 500 K)
_BAND: Final = Band.rectangular(3.5, 5.0)

Radiance = Callable[[SeaView, FloatArray, FloatArray], SeaRadiance]


@dataclass(frozen=True)
class BrightestPoint:
    """Maximum of the sea's apparent temperature over depression and Sun zenith, looking towards the Sun."""

    apparent_temperature: float
    background: float
    depression_deg: float
    solar_zenith_deg: float

    @property
    def rise(self) -> float:
        """Apparent temperature above the same place without Sun [K]."""
        return self.apparent_temperature - self.background


def article_sea(band: Band, wind_speed: float, sensor_height: float) -> SeaView:
    """Return the article's sea and air at a wind [m/s] from a height [m], under a Sun at the zenith."""
    return SeaView(
        atmosphere=model_air(MODEL, wind_speed, (band.min_um, band.max_um), "lowtran", "lowtran7"),
        band=band,
        water=sea_water.article(),
        slopes=cox_munk_isotropic(wind_speed, height=WIND_HEIGHT),
        sea_temperature=SEA_TEMPERATURE,
        sensor_height=sensor_height,
        solar_zenith=0.0,
        shadowing=VIEWER,
        background="blackbody",
    )


def brightest_point(wind_speed: float, sensor_height: float = _SENSOR_HEIGHT, radiance: Radiance = mean_radiance) -> BrightestPoint:
    """Return the brightest mean glint of the article's case at a wind speed.

    LOWTRAN7 midlatitude summer with the Navy maritime aerosol at that wind, sea 288.15 K, the article's index, isotropic Cox-Munk
    slopes with the unchanged wind, the viewer's leg shadowed, sea and mirrored sky a blackbody, 3.5-5 um.

    Parameters
    ----------
    wind_speed : float
        Wind [m/s].
    sensor_height : float
        Height of the sensor [m].
    radiance : callable
        :func:`seaglint.radiance.mean_radiance.mean_radiance` (per wavenumber) or :func:`seaglint.radiance.article.article_radiance`.

    Returns
    -------
    BrightestPoint
        From a search over 60-89 deg Sun zenith and depressions from the horizon to 12 deg, refined once to 0.3 deg of the Sun
        (0.1 K of a peak several degrees wide).
    """
    view = article_sea(_BAND, wind_speed, sensor_height)
    inverse = ApparentTemperature.create(_BAND, view.atmosphere.wavenumber_cm)
    depression = np.geomspace(1.05 * horizon_depression(sensor_height), np.radians(12.0), 120)
    # Two searches over the Sun: steps of 2 deg, then of 0.3 deg around the best.
    coarse = max((_at(view, z, depression, inverse, radiance) for z in np.arange(60.0, 89.5, 2.0)), key=_temperature)
    centre = coarse.solar_zenith_deg
    return max((_at(view, z, depression, inverse, radiance) for z in centre + np.arange(-1.8, 1.81, 0.3)), key=_temperature)


def _temperature(point: BrightestPoint) -> float:
    return point.apparent_temperature


def _at(view: SeaView, solar_zenith_deg: float, depression: FloatArray, inverse: ApparentTemperature, radiance: Radiance) -> BrightestPoint:
    components = radiance(replace(view, solar_zenith=float(np.radians(solar_zenith_deg))), -depression, np.zeros(1))
    temperature = inverse(components.total[:, 0])
    row = int(np.nanargmax(temperature))
    background = float(inverse((components.path + components.emission + components.sky)[row, 0]))
    return BrightestPoint(float(temperature[row]), background, float(np.degrees(depression[row])), float(solar_zenith_deg))


def _contrast(min_um: float, max_um: float) -> float:
    cold, warm = Band.rectangular(min_um, max_um).radiance([300.0, 310.0], wavenumber_grid(min_um, max_um))
    return float((warm - cold) / cold)


def headline() -> dict[str, ArticleRow]:
    """Return the rows of the article's headline numbers.

    Returns
    -------
    dict
        Rows by name.

    References
    ----------
    Source article: footnote on the midwave infrared (contrasts), Fig. 2 (blackbody, background), section "Computing temporally
    averaged sea radiance" and Fig. 3 (peaks), Table 1 (tails), Eq. 17 (lengths).
    """
    return _blackbody_rows() | _glint_rows() | _statistics_rows()


def _row(article: float, ours: float, unit: str, **settings: Any) -> ArticleRow:
    return ArticleRow(article, ours, unit, settings)


def _blackbody_rows() -> dict[str, ArticleRow]:
    blackbody = ARTICLE_UNIT * float(Band.rectangular(3.0, 5.0).radiance(292.4, wavenumber_grid(3.0, 5.0)))
    return {
        "contrast_mwir": _row(0.42, _contrast(3.0, 5.0), "1", band_um=[3.0, 5.0], temperatures_k=[300.0, 310.0]),
        "contrast_lwir": _row(0.17, _contrast(8.0, 12.0), "1", band_um=[8.0, 12.0], temperatures_k=[300.0, 310.0]),
        "blackbody_292_uw_cm2_sr": _row(145.0, blackbody, "uW cm-2 sr-1", band_um=[3.0, 5.0], temperature_k=292.4),
    }


def _glint_rows() -> dict[str, ArticleRow]:
    calm, windy = brightest_point(_CALM), brightest_point(10.0)
    means = brightest_point(10.0, 50.0, article_radiance)
    common = {
        "atmosphere": f"LOWTRAN7 {MODEL}, Navy maritime aerosol",
        "band_um": [_BAND.min_um, _BAND.max_um],
        "sensor_height_m": _SENSOR_HEIGHT,
        "sea_temperature_k": SEA_TEMPERATURE,
        "water": "article",
        "slopes": "isotropic Cox-Munk, viewer's leg shadowed",
        "background": "sea and mirrored sky a blackbody",
        "spectral": "per wavenumber",
    }

    def place(point: BrightestPoint) -> dict[str, float]:
        return {"depression_deg": round(point.depression_deg, 2), "solar_zenith_deg": round(point.solar_zenith_deg, 1)}

    other = {"ours_with_band_means_from_50_m": round(means.rise, 1)}
    return {
        "calm_peak_apparent_k": _row(526.0, calm.apparent_temperature, "K", **common, wind_speed_m_s=_CALM, **place(calm)),
        "rise_10ms_k": _row(62.0, windy.rise, "K", **common, wind_speed_m_s=10.0, **place(windy), **other),
        "background_k": _row(292.4, windy.background, "K", **common, wind_speed_m_s=10.0, **place(windy)),
    }


def _statistics_rows() -> dict[str, ArticleRow]:
    length = {"relation": "Eq. 17 as printed: surface tension 76.3 dyn/cm, 1.025 g/cm3, no gravity"}
    return {
        "tail_3_sigma": _row(0.0014, float(ndtr(-3.0)), "1", threshold_sigma=3.0, distribution="Gaussian, one-sided"),
        "tail_3_5_sigma": _row(0.00023, float(ndtr(-3.5)), "1", threshold_sigma=3.5, distribution="Gaussian, one-sided"),
        "capillary_length_70ms_cm": _row(0.210, 100.0 * capillary_length(0.07), "cm", correlation_time_s=0.07, **length),
        "capillary_length_300ms_cm": _row(0.554, 100.0 * capillary_length(0.3), "cm", correlation_time_s=0.3, **length),
    }
