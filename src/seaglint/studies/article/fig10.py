"""The source article's Figure 10, computed anew: autobinomial textures of a glinting sea seen from straight above.

The article fitted isotropic couplings and ones that emphasise the horizontal, and reports estimates that did not converge and Gibbs samples
that melted into white noise or crystallised into constants. Here both are fitted to a rendered picture; pseudo-likelihoods converge, and
Gibbs sweeps at them freeze as the article's did, because couplings of so smooth a picture lie beyond the phase transition. The textures
are exchange samples at the maximum of the likelihood given the histogram. What the article leaves open (picture, levels, order) is
chosen here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import Progress
from seaglint.base.free_form import TomlTables
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.image import image
from seaglint.textures.autobinomial import Autobinomial
from seaglint.textures.autobinomial_fit import AutobinomialFit, fit
from seaglint.textures.autobinomial_sampler import exchange, sample
from seaglint.textures.neighbourhood import classes
from seaglint.textures.quantisation import GreyLevels
from seaglint.textures.regime import Regime, correlations, mean_field, regime

if TYPE_CHECKING:
    import xarray as xr

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


def _silent(done: int, total: int) -> None:
    """Ignore progress."""


def glint_from_above() -> NDArray[np.float64]:
    """In-band radiance of the sea of :data:`SCENE` [W m-2 sr-1]."""
    return np.asarray(image(parse_scenario(SCENE))["radiance"].to_numpy(), dtype=np.float64)


def weakened(model: Autobinomial, share: float, slope: float) -> Autobinomial:
    """The field with its couplings reduced to a slope of the mean field, its mean kept."""
    factor = slope / mean_field(model, share)[0]
    pull = 2.0 * model.most * sum(beta * len(one) for one, beta in zip(model.neighbours, model.beta, strict=True)) * factor
    alpha = np.log(share / (1.0 - share)) - pull * share
    return model.with_parameters(np.array([alpha, *(factor * beta for beta in model.beta)]))


def figure_10(report: Progress = _silent) -> xr.Dataset:
    """Autobinomial textures of the article's Fig. 10.

    Returns
    -------
    xarray.Dataset
        ``grey_level`` over texture (0 isotropic, 1 horizontal), picture (:data:`PICTURES`), row and column; ``coupling`` and its standard
        error over texture, method (0 pseudo-likelihood, 1 likelihood given the histogram), rows down and columns right to the neighbour;
        what tells fits and samples apart over texture and picture.
    """
    import xarray as xr

    radiance = glint_from_above()
    grey = GreyLevels.of(radiance, LEVELS)
    sea = grey.to_levels(radiance)
    offsets = [offset for one in classes(ORDER, isotropic=False) for offset in one]
    results = []
    for done, name in enumerate(TEXTURES):
        report(done, len(TEXTURES))
        results.append(_texture(sea, isotropic=name == "isotropic"))
    report(len(TEXTURES), len(TEXTURES))
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
