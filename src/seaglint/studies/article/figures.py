"""The source article's Figures 2, 3, 4 and 10: each a labelled dataset for the plots and for a CSV file.

Figures 2 to 4 share LOWTRAN7's midlatitude summer with the Navy maritime aerosol at the wind, a sea of 288.15 K, the article's refractive
index, Cox-Munk slopes with the unchanged wind, and shadowing of the viewer's leg. The article does not state the heights of Figs. 3 and 4,
the winds of all three, and the Sun of Fig. 4; they are chosen here and reported in the attributes.

Figure 10 has autobinomial textures of a glinting sea seen from straight above. The article fitted isotropic couplings and ones that
emphasise the horizontal, and reports estimates that did not converge and Gibbs samples that melted into white noise or crystallised into
constants. Here both are fitted to a rendered picture; pseudo-likelihoods converge, and Gibbs sweeps at them freeze as the article's did,
because couplings of so smooth a picture lie beyond the phase transition. The textures are exchange samples at the maximum of the
likelihood given the histogram. The article does not state picture, levels and order; they are chosen here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from seaglint.air.protocol import slant_range
from seaglint.base.conventions import FloatArray, Progress, horizon_depression, horizon_range, surface_range, view_zenith
from seaglint.base.free_form import Attributes, TomlTables
from seaglint.facet.sea_view import SeaView
from seaglint.optics.band import ApparentTemperature, Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.radiance.article import ArticleAtmosphere, article_radiance, wavelength_mean
from seaglint.radiance.mean_radiance import SeaRadiance, mean_radiance
from seaglint.radiance.variance import capillary_length, sea_variance
from seaglint.scenario.load import parse_scenario
from seaglint.sea.slopes.cox_munk import WIND_HEIGHT, cox_munk_anisotropic
from seaglint.studies.article.headline import MODEL, SEA_TEMPERATURE, article_sea
from seaglint.studies.sequence.labelled_frames import image
from seaglint.textures.autobinomial import Autobinomial, classes
from seaglint.textures.autobinomial_fit import AutobinomialFit, fit
from seaglint.textures.autobinomial_sampler import exchange, sample
from seaglint.textures.autobinomial_texture import GreyLevels
from seaglint.textures.regime import Regime, correlations, mean_field, regime

if TYPE_CHECKING:
    import xarray as xr


Item = TypeVar("Item")

#: Straight down on half a metre a pixel; waves run down the picture, so that its crests lie along the rows.
SCENE: Final[TomlTables] = {
    "sensor": {"height_m": 150, "projection": "pinhole", "fov_deg": [24, 24], "elevation_deg": -90, "azimuth_deg": 0, "pixels": [128, 128]},
    "wind": {"speed_m_s": 8, "from_deg": 0},
    "sun": {"zenith_deg": 8, "azimuth_deg": 0},
    "sea": {"shortest_wave_m": 0.5},
    "atmosphere": {"spectroscopy": "lowtran7"},
}

LEVELS: Final = 8
ORDER: Final = 2
TEXTURES: Final = ("isotropic", "horizontal")
#: The picture, the exchange sample at the fit, the Gibbs sample at the pseudo-likelihood's, and that with weaker couplings.
PICTURES: Final = ("sea", "exchange", "frozen", "molten")

SWEEPS: Final = 300
#: Slope of the mean field to which couplings are weakened for the molten sample: on the other side of the transition, at 1.
MOLTEN_SLOPE: Final = 0.8

PATH_BAND: Final = (3.0, 5.0)
PATH_HEIGHT: Final = 130.0
PATH_WINDS: Final = (1.0, 5.0, 10.0, 15.0, 20.0)
PATH_BLACKBODY: Final = 292.4  #: Temperature of the air that the article names beside Fig. 2 [K].

GLINT_BAND: Final = (3.5, 5.0)
GLINT_HEIGHT: Final = 100.0
#: Winds of Fig. 3: its calm, whose 526 K is the peak near 0.5 m/s; the 10 m/s of its text; and one between.
SURFACE_WINDS: Final = (0.5, 5.0, 10.0)

#: Zenith angles of the Sun in Fig. 3 [deg].
SURFACE_SUNS: Final = np.concatenate([np.arange(70.0, 80.0, 1.0), np.arange(80.0, 90.01, 0.5)])

SURFACE_DEPRESSIONS: Final = 140  #: Depressions of the sensor in Fig. 3, from the horizon to 12 deg.

IMAGE_WINDS: Final = (2.0, 5.0, 10.0)
IMAGE_WIND_DIRECTIONS: Final = (0.0, 45.0, 90.0)  #: Where the wind of Fig. 4 comes from, clockwise from the Sun [deg].

IMAGE_SUN: Final = 65.0  #: Zenith angle of the Sun in Fig. 4 [deg]: the whole glint pattern lies in view.

IMAGE_IFOV: Final = 1e-3  #: Side of the article's detector [rad].

IMAGE_FIELD: Final = (50.0, 35.0)  #: Azimuths, centred on the Sun's, and depressions from the horizontal down in Fig. 4 [deg].

#: Every how many values of a coordinate the CSV file holds: the images are smooth, and whole would be 200 MB.
CSV_STEP: Final[dict[str, dict[str, int]]] = {"fig4": {"elevation_deg": 5, "azimuth_from_sun_deg": 10}}

#: Variables that the CSV file does not hold: samples, which seeds give again.
CSV_WITHOUT: Final[dict[str, tuple[str, ...]]] = {"fig10": ("grey_level",)}

_ALONG_RANGE: Final = ("transmittance", "transmittance_eq_9", "path_radiance_W_m2_sr", "boundary_radiance_W_m2_sr")
_ALONG_ZENITH: Final = ("solar_irradiance_W_m2", "sky_radiance_W_m2_sr")


def ignore_progress(done: int, total: int) -> None:
    """Ignore progress."""


def reported(items: Sequence[Item], report: Progress) -> Iterator[tuple[int, Item]]:
    """Yield items with their numbers; report the number of finished items before each and after the last."""
    for number, item in enumerate(items):
        report(number, len(items))
        yield number, item
    report(len(items), len(items))


def glint_from_above() -> NDArray[np.float64]:
    """Return the in-band radiance of the sea of ``SCENE`` [W m-2 sr-1]."""
    return np.asarray(image(parse_scenario(SCENE))["radiance"].to_numpy(), dtype=np.float64)


def weakened(model: Autobinomial, share: float, slope: float) -> Autobinomial:
    """Return the field with couplings reduced to a slope of the mean field, and an unchanged mean."""
    # The slope of the mean field is proportional to the couplings, so one factor scales them all.
    factor = slope / mean_field(model, share)[0]
    pull = 2.0 * model.most * sum(beta * len(one) for one, beta in zip(model.neighbours, model.beta, strict=True)) * factor
    # The weaker pull of the neighbours is replaced in alpha, so that the mean level remains.
    alpha = np.log(share / (1.0 - share)) - pull * share
    return model.with_parameters(np.array([alpha, *(factor * beta for beta in model.beta)]))


def figure_10(report: Progress = ignore_progress) -> xr.Dataset:
    """Autobinomial textures of the article's Fig. 10.

    Returns
    -------
    xarray.Dataset
        ``grey_level`` over texture (0 isotropic, 1 horizontal), picture (``PICTURES``), row and column; ``coupling`` and its standard
        error over texture, method (0 pseudo-likelihood, 1 likelihood given the histogram), rows down and columns right to the neighbour;
        statistics that distinguish fits and samples over texture and picture.
    """
    import xarray as xr

    radiance = glint_from_above()
    grey = GreyLevels.of(radiance, LEVELS)
    sea = grey.to_levels(radiance)
    # Both textures are shown by the couplings of single pairs, also if isotropic ones share a value.
    offsets = [offset for one in classes(ORDER, isotropic=False) for offset in one]
    results = [_texture(sea, isotropic=name == "isotropic") for _, name in reported(TEXTURES, report)]
    pictures, fits, regimes = [row[0] for row in results], [row[1] for row in results], [row[2] for row in results]
    couplings = np.array([[[_of(one, offset, one.parameters) for offset in offsets] for one in pair] for pair in fits])
    errors = np.array([[[_of(one, offset, one.standard_errors) for offset in offsets] for one in pair] for pair in fits])
    ties = np.array([[correlations(picture, classes(ORDER, isotropic=False)) for picture in row] for row in pictures])
    return xr.Dataset(
        {
            "grey_level": (("texture", "picture", "row", "column"), np.array(pictures)),
            "coupling": (("texture", "method", "pair"), couplings),
            "coupling_standard_error": (("texture", "method", "pair"), errors),
            "converged": (("texture", "method"), [[float(one.converged) for one in pair] for pair in fits]),
            "newton_steps": (("texture", "method"), [[float(one.steps) for one in pair] for pair in fits]),
            "mean_field_slope": (("texture", "method"), [[_slope(one, sea) for one in pair] for pair in fits]),
            "correlation": (("texture", "picture", "pair"), ties),
            "mean_level": (("texture", "picture"), [[float(picture.mean()) for picture in row] for row in pictures]),
            "std_level": (("texture", "picture"), [[float(picture.std()) for picture in row] for row in pictures]),
        },
        coords={
            "texture": np.arange(len(TEXTURES)),
            "picture": np.arange(len(PICTURES)),
            "method": [0, 1],
            "pair": np.arange(len(offsets)),
            "down": ("pair", [float(dy) for dy, _ in offsets]),
            "right": ("pair", [float(dx) for _, dx in offsets]),
        },
        attrs={
            "title": "Autobinomial textures",
            "levels": LEVELS,
            "order": ORDER,
            "sweeps": SWEEPS,
            "regimes": [[one.name for one in pair] for pair in regimes],
        },
    )


def _texture(
    sea: NDArray[np.int16], *, isotropic: bool
) -> tuple[list[NDArray[np.int16]], tuple[AutobinomialFit, AutobinomialFit], tuple[Regime, Regime]]:
    """Pictures of a row of the figure, both fits, and the regimes of the samples that froze and melted."""
    pseudo = fit(sea, LEVELS, ORDER, isotropic=isotropic)
    given = fit(sea, LEVELS, ORDER, isotropic=isotropic, method="monte-carlo-exchange", check=False)
    weak = weakened(pseudo.model, float(sea.mean()) / pseudo.model.most, MOLTEN_SLOPE)
    # Exchanges keep the histogram, so they start from the picture's own levels in random order.
    shuffled = np.random.Generator(np.random.Philox(10)).permutation(sea.ravel()).reshape(sea.shape)
    drawn = [
        exchange(shuffled, given.model, SWEEPS, seed=10),
        sample(pseudo.model, sea.shape, SWEEPS, seed=10, start=sea),
        sample(weak, sea.shape, SWEEPS, seed=10, start=sea),
    ]
    assert pseudo.regime is not None  # asked for
    return [sea, *drawn], (pseudo, given), (pseudo.regime, regime(sea, weak, seed=10))


def _of(result: AutobinomialFit, offset: tuple[int, int], values: NDArray[np.float64]) -> float:
    """Return a fit's value for a pair."""
    return float(values[1 + next(k for k, one in enumerate(result.model.neighbours) if offset in one)])


def _slope(result: AutobinomialFit, sea: NDArray[np.int16]) -> float:
    return mean_field(result.model, float(sea.mean()) / result.model.most)[0]


def _attributes(title: str, band: tuple[float, float], height: float, **more: Any) -> Attributes:
    from seaglint.version import __version__

    common = {"title": title, "seaglint_version": __version__, "atmosphere": f"LOWTRAN7 {MODEL}, Navy maritime aerosol", "band_um": band}
    return {**common, "sensor_height_m": height, "sea_temperature_k": SEA_TEMPERATURE, **more}


def figure_2(report: Progress = ignore_progress) -> xr.Dataset:
    """Path and boundary properties against range and zenith angle at several winds, 3-5 um, from 130 m down to the sea.

    Returns
    -------
    Dataset
        Over ``wind_speed_m_s`` and ``slant_range_m``: flat mean of the path's transmittance over wavelength, the article's fit to it
        (Eq. 9), path radiance, and radiance of a blackbody sea behind the path; over ``wind_speed_m_s`` and ``zenith_deg``:
        sunlight at the sea (normal to the beam, 1 au) and the sky seen from there.

    Notes
    -----
    The article's paths end 2 m above the sea, these on it. At the sea horizon a path is 44 km long.
    """
    import xarray as xr

    band = Band.rectangular(*PATH_BAND)
    # Paths end at the sea horizon of the sensor; the first is straight down.
    arc = np.concatenate([[0.0], np.geomspace(50.0, horizon_range(PATH_HEIGHT), 119)])
    slant = slant_range(PATH_HEIGHT, arc)
    # Angles are finer near the horizon, where the air mass grows fast.
    zenith = np.concatenate([np.arange(0.0, 80.0, 2.0), np.arange(80.0, 90.01, 0.5)])
    paths: dict[str, list[FloatArray]] = {name: [] for name in _ALONG_RANGE}
    skies: dict[str, list[FloatArray]] = {name: [] for name in _ALONG_ZENITH}
    for _, wind in reported(PATH_WINDS, report):
        view = article_sea(band, wind, PATH_HEIGHT)
        over = view.in_band
        spectral = view.atmosphere.transmittance(PATH_HEIGHT, arc)[..., over.grid]
        path = over(view.atmosphere.path_radiance(PATH_HEIGHT, arc))
        paths["transmittance"].append(spectral @ wavelength_mean(over.weights, over.wavenumber_cm))
        paths["transmittance_eq_9"].append(ArticleAtmosphere.fit(view.atmosphere, band, PATH_HEIGHT, SEA_TEMPERATURE).transmittance(slant))
        paths["path_radiance_W_m2_sr"].append(path)
        paths["boundary_radiance_W_m2_sr"].append(path + spectral @ (over.weights * planck_wavenumber(over.wavenumber_cm, SEA_TEMPERATURE)))
        skies["solar_irradiance_W_m2"].append(over(view.atmosphere.solar_irradiance(np.radians(zenith))))
        skies["sky_radiance_W_m2_sr"].append(over(view.atmosphere.sky_radiance(np.radians(zenith), 0.0)))
    blackbody = float(band.radiance(PATH_BLACKBODY, view.atmosphere.wavenumber_cm))
    return xr.Dataset(
        {name: (("wind_speed_m_s", "slant_range_m"), np.array(rows)) for name, rows in paths.items()}
        | {name: (("wind_speed_m_s", "zenith_deg"), np.array(rows)) for name, rows in skies.items()},
        coords={"wind_speed_m_s": list(PATH_WINDS), "slant_range_m": slant, "zenith_deg": zenith},
        attrs=_attributes(
            "Path and boundary properties",
            PATH_BAND,
            PATH_HEIGHT,
            blackbody_temperature_k=PATH_BLACKBODY,
            blackbody_radiance_W_m2_sr=blackbody,
        ),
    )


def figure_3(report: Progress = ignore_progress) -> xr.Dataset:
    """Sunlight scattered by the sea and its apparent temperature against the zenith angles of Sun and sensor, at three winds.

    Returns
    -------
    Dataset
        Over ``wind_speed_m_s``, ``solar_zenith_deg`` and ``sensor_zenith_deg`` (from the sea to the sensor, looking towards the Sun):
        mirrored Sun and apparent temperature of the whole sea, from products per wavenumber and, with ``_band_means``, from the
        article's products of band means and its interpolators (Eqs. 3, 7-9); ``background_temperature_k`` is the sea without Sun.
    """
    import xarray as xr

    band = Band.rectangular(*GLINT_BAND)
    # Evenly spaced in the logarithm of depression: the brightest points of low Suns lie within a degree of the horizon.
    depression = np.geomspace(1.01 * horizon_depression(GLINT_HEIGHT), np.radians(12.0), SURFACE_DEPRESSIONS)[::-1]
    sun = SURFACE_SUNS
    methods: tuple[tuple[str, Callable[[SeaView, FloatArray, FloatArray], SeaRadiance]], ...]
    methods = (("", mean_radiance), ("_band_means", article_radiance))
    shape = (len(SURFACE_WINDS), sun.size, depression.size)
    maps = {name + suffix: np.zeros(shape) for suffix, _ in methods for name in ("solar_radiance_W_m2_sr", "apparent_temperature_k")}
    background = np.zeros((len(SURFACE_WINDS), depression.size))
    for i, wind in reported(SURFACE_WINDS, report):
        view = article_sea(band, wind, GLINT_HEIGHT)
        inverse = ApparentTemperature.create(band, view.atmosphere.wavenumber_cm)
        for j, zenith in enumerate(np.radians(sun)):
            for suffix, radiance in methods:
                components = radiance(replace(view, solar_zenith=float(zenith)), -depression, np.zeros(1))
                maps["solar_radiance_W_m2_sr" + suffix][i, j] = components.sun[:, 0]
                maps["apparent_temperature_k" + suffix][i, j] = inverse(components.total[:, 0])
                if suffix == "":
                    background[i] = inverse((components.path + components.emission + components.sky)[:, 0])
    return xr.Dataset(
        {name: (("wind_speed_m_s", "solar_zenith_deg", "sensor_zenith_deg"), values) for name, values in maps.items()}
        | {"background_temperature_k": (("wind_speed_m_s", "sensor_zenith_deg"), background)},
        coords={
            "wind_speed_m_s": list(SURFACE_WINDS),
            "solar_zenith_deg": sun,
            "sensor_zenith_deg": np.degrees(view_zenith(GLINT_HEIGHT, depression)),
            "depression_deg": ("sensor_zenith_deg", np.degrees(depression)),
            "slant_range_m": ("sensor_zenith_deg", slant_range(GLINT_HEIGHT, surface_range(GLINT_HEIGHT, depression))),
        },
        attrs=_attributes("Solar radiation scattered from the sea", GLINT_BAND, GLINT_HEIGHT, slopes="isotropic Cox-Munk"),
    )


def figure_4(report: Progress = ignore_progress) -> xr.Dataset:
    """Images of the mirrored Sun, mean and standard deviation in detectors of 1 mrad, for three winds from three directions.

    Returns
    -------
    Dataset
        Over ``wind_speed_m_s``, ``wind_from_sun_deg``, ``elevation_deg`` and ``azimuth_from_sun_deg``: mean radiance of the mirrored
        Sun (Eq. 8, products per wavenumber, directional slopes), and its standard deviation in a detector (Eq. 18 with the share of
        sea area) with the correlation length of Eq. 17 at 70 ms.
    """
    import xarray as xr

    band = Band.rectangular(*GLINT_BAND)
    step = np.degrees(IMAGE_IFOV)
    columns, rows_down = (int(size / step) for size in IMAGE_FIELD)
    azimuth = step * (np.arange(columns) - 0.5 * (columns - 1))
    elevation = -step * (np.arange(rows_down) + 0.5)
    rows = np.radians(elevation)
    # Columns are steps of azimuth, which shrink with the cosine of elevation.
    solid_angle = IMAGE_IFOV**2 * np.cos(rows)
    # The article's correlation time of glint is 70 ms (Eq. 17).
    length = capillary_length(0.07)
    shape = (len(IMAGE_WINDS), len(IMAGE_WIND_DIRECTIONS), elevation.size, azimuth.size)
    mean, deviation = (np.zeros(shape, dtype=np.float32) for _ in range(2))
    for i, wind in reported(IMAGE_WINDS, report):
        calm = replace(article_sea(band, wind, GLINT_HEIGHT), solar_zenith=float(np.radians(IMAGE_SUN)))
        for j, wind_from in enumerate(IMAGE_WIND_DIRECTIONS):
            view = replace(calm, slopes=cox_munk_anisotropic(wind, np.radians(wind_from + 180.0), height=WIND_HEIGHT))
            components = mean_radiance(view, rows, np.radians(azimuth))
            mean[i, j] = components.sun
            deviation[i, j] = np.sqrt(sea_variance(view, components, rows, solid_angle, length))
    dims = ("wind_speed_m_s", "wind_from_sun_deg", "elevation_deg", "azimuth_from_sun_deg")
    return xr.Dataset(
        {"solar_radiance_W_m2_sr": (dims, mean), "glint_std_W_m2_sr": (dims, deviation)},
        coords={
            "wind_speed_m_s": list(IMAGE_WINDS),
            "wind_from_sun_deg": list(IMAGE_WIND_DIRECTIONS),
            "elevation_deg": elevation,
            "azimuth_from_sun_deg": azimuth,
        },
        attrs=_attributes(
            "Glint images",
            GLINT_BAND,
            GLINT_HEIGHT,
            slopes="directional Cox-Munk",
            solar_zenith_deg=IMAGE_SUN,
            ifov_mrad=1e3 * IMAGE_IFOV,
            correlation_length_m=length,
        ),
    )


#: Functions of ``seaglint reproduce`` by the name of the figure.
FIGURES: Final[dict[str, Callable[[Progress], xr.Dataset]]] = {"fig2": figure_2, "fig3": figure_3, "fig4": figure_4, "fig10": figure_10}


def table(name: str, dataset: xr.Dataset) -> dict[str, FloatArray]:
    """Return the columns of a figure's CSV file: coordinates first, a row for each point; quantities without a value in a row are NaN.

    Variables over the same coordinates share their rows; figures with several kinds follow one another.
    """
    import xarray as xr

    picked = dataset.drop_vars(CSV_WITHOUT.get(name, ())).isel(
        {dim: slice(None, None, step) for dim, step in CSV_STEP.get(name, {}).items()}
    )
    coordinates, variables = list(map(str, picked.coords)), list(map(str, picked.data_vars))
    kinds = {picked[v].dims for v in variables}
    # A variable of fewer coordinates is repeated in the rows of a variable that has these and more coordinates.
    # Only the largest sets of coordinates have blocks of rows.
    kinds = {dims for dims in kinds if not any(set(dims) < set(others) for others in kinds)}
    blocks = []
    for dims in sorted(kinds, key=lambda dims: next(i for i, v in enumerate(variables) if picked[v].dims == dims)):
        shape = {dim: picked.sizes[dim] for dim in dims}
        like = xr.DataArray(np.zeros(tuple(shape.values())), dims=dims)
        block = {column: np.full(like.size, np.nan) for column in [*coordinates, *variables]}
        for column in block:
            if set(picked[column].dims) <= set(dims):
                values = picked[column].reset_coords(drop=True).drop_indexes(list(picked[column].indexes), errors="ignore")
                block[column] = values.broadcast_like(like).transpose(*dims).to_numpy().ravel().astype(np.float64)
        blocks.append(block)
    return {column: np.concatenate([block[column] for block in blocks]) for column in [*coordinates, *variables]}
