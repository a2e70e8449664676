"""Fits: known parameters come back, from any start; frozen and molten fits are named; what cannot be fitted is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from seaglint.base.errors import DataError, DomainError
from seaglint.textures.autobinomial import Autobinomial, classes
from seaglint.textures.autobinomial_fit import BATCHES, _last, fit, inside_products, newton
from seaglint.textures.autobinomial_sampler import exchange, sample
from seaglint.textures.autobinomial_texture import GreyLevels
from seaglint.textures.pseudo_likelihood import conditional_log_likelihood
from seaglint.textures.regime import Regime, correlations, mean_field, regime

KNOWN = Autobinomial.of(8, 2, -1.4, (0.09, 0.05, -0.02, 0.03), isotropic=False)


@pytest.fixture(scope="module")
def texture() -> np.ndarray:
    return sample(KNOWN, (128, 128), 100, seed=11)


@pytest.fixture(scope="module")
def sea() -> np.ndarray:
    """Smooth positive picture of short correlation, in place of glint."""
    return np.exp(gaussian_filter(np.random.default_rng(3).standard_normal((96, 96)), 1.0, mode="wrap") / 0.28)


@pytest.mark.parametrize("periodic", [True, False])
def test_known_parameters_come_back(texture: np.ndarray, periodic: bool) -> None:
    found = fit(texture, 8, 2, isotropic=False, periodic=periodic, check=False)
    assert found.converged
    assert (np.abs(found.parameters - KNOWN.parameters) < 3.0 * found.standard_errors).all()
    assert (found.standard_errors[1:] < 0.006).all()
    assert found.pixels == (128 * 128 if periodic else 126 * 126)


def test_one_optimum_from_ten_random_starts(texture: np.ndarray) -> None:
    best = fit(texture, 8, 2, isotropic=False, check=False)
    for start in np.random.default_rng(1).normal(0.0, [3.0, 0.5, 0.5, 0.5, 0.5], size=(10, 5)):
        again = fit(texture, 8, 2, isotropic=False, check=False, start=start)
        assert again.converged
        assert again.parameters == pytest.approx(best.parameters, rel=1e-7)


def test_pseudo_likelihood_is_the_sum_over_pixels() -> None:
    """A picture of 4 x 4, pixel by pixel from the conditional law as it is printed."""
    from math import comb, exp, log

    picture = np.random.default_rng(2).integers(0, 3, (4, 4))
    model = Autobinomial.of(3, 2, -0.3, (0.4, -0.2))
    total = 0.0
    for (y, x), level in np.ndenumerate(picture):
        eta = model.alpha
        for one, beta in zip(model.neighbours, model.beta, strict=True):
            eta += beta * sum(int(picture[(y + s * dy) % 4, (x + s * dx) % 4]) for dy, dx in one for s in (1, -1))
        chance = 1.0 / (1.0 + exp(-eta))
        total += log(comb(2, level) * chance**level * (1.0 - chance) ** (2 - level))
    assert conditional_log_likelihood(picture, model, periodic=True) == pytest.approx(total / 16, rel=1e-12)


@pytest.mark.validation
def test_standard_errors_are_those_of_repeats() -> None:
    """Spread over 100 pictures against the mean sandwich error; without the pairs of scores it would be 0.75 of it."""
    fits = [fit(sample(KNOWN, (40, 40), 40, seed=s), 8, 2, isotropic=False, periodic=True, check=False) for s in range(100)]
    spread = np.std([f.parameters for f in fits], axis=0, ddof=1)
    # 100 repeats tell a standard deviation within 7 %, the mean over five within some 4 %.
    assert np.mean(np.mean([f.standard_errors for f in fits], axis=0) / spread) == pytest.approx(1.0, abs=0.12)
    assert np.mean([f.parameters for f in fits], axis=0) == pytest.approx(KNOWN.parameters, abs=4.0 * spread.max() / 10.0)


@pytest.mark.parametrize("periodic", [True, False])
def test_monte_carlo_likelihood_agrees_and_is_sharper(periodic: bool) -> None:
    model = Autobinomial.of(4, 1, -1.8, (0.3,))
    picture = sample(model, (40, 40), 100, seed=5)
    pseudo = fit(picture, 4, periodic=periodic, check=False)
    found = fit(picture, 4, periodic=periodic, method="monte-carlo", check=False, seed=1)
    assert found.converged
    assert (np.abs(found.parameters - model.parameters) < 3.0 * found.standard_errors).all()
    assert (found.standard_errors < 1.1 * pseudo.standard_errors).all()
    assert found.log_pseudo_likelihood < pseudo.log_pseudo_likelihood  # whose maximum lies elsewhere


def test_likelihood_of_an_exact_torus() -> None:
    """4 x 4 with two levels: at the maximum the mean sums are the picture's; here from all 65 536 pictures."""
    picture = np.array([[0, 0, 1, 1], [0, 1, 1, 0], [0, 0, 1, 0], [1, 0, 0, 0]])
    from seaglint.textures.autobinomial_fit import maximum_likelihood

    first = Autobinomial.of(2, 1, -1.0, (0.1,))
    found = maximum_likelihood(picture.astype(np.int16), first, 3, periodic=True).model
    pictures = (np.arange(2**16)[:, None] >> np.arange(16) & 1).reshape(-1, 4, 4)
    sums = np.stack([pictures.sum(axis=(1, 2)), sum((pictures * np.roll(pictures, 1, axis=k)).sum(axis=(1, 2)) for k in (1, 2))])
    theta = np.zeros(2)
    wanted = np.array([picture.sum(), sum((picture * np.roll(picture, 1, axis=k)).sum() for k in (0, 1))])
    for _ in range(30):
        weights = np.exp(theta @ sums)
        weights /= weights.sum()
        theta = theta + np.linalg.solve(np.cov(sums, aweights=weights), wanted - sums @ weights)
    error = np.sqrt(np.diag(np.linalg.inv(np.cov(sums, aweights=weights))))
    # 1500 sweeps tell the mean sums within 0.05 of their standard deviation.
    assert np.abs(found.parameters - theta) == pytest.approx(np.zeros(2), abs=0.2 * error.min())


@pytest.mark.validation
def test_a_smooth_picture_freezes_and_exchange_keeps_it(sea: np.ndarray) -> None:
    grey = GreyLevels.of(sea, 16, "equal-share").to_levels(sea)
    found = fit(grey, 16, 2)
    assert found.converged
    assert found.regime is not None
    assert found.regime.name == "frozen"
    assert found.regime.susceptibility > 1.0
    assert any("exchange" in note for note in found.notes)
    kept = exchange(grey, found.model, 20, seed=1)
    assert kept.std() == grey.std()


@pytest.mark.validation
def test_fine_grain_of_many_levels_melts() -> None:
    """Pixels spread evenly over 64 levels: a binomial pixel has a deviation of 4 levels, whatever the picture's 18."""
    grain = gaussian_filter(np.random.default_rng(4).standard_normal((80, 80)), 0.5, mode="wrap")
    found = fit(GreyLevels.of(grain, 64, "equal-share").to_levels(grain), 64, 1)
    assert found.regime is not None
    assert found.regime.name == "molten"
    assert found.regime.sample_std < 0.4 * found.regime.data_std
    assert "molten" in found.notes[0]


@pytest.mark.validation
def test_couplings_come_back_from_a_picture_of_any_histogram() -> None:
    """A histogram that no Gibbs sample has, and couplings under which one would freeze: the exchange likelihood finds them."""
    even = np.random.default_rng(5).permutation(np.repeat(np.arange(6), 384)).reshape(48, 48)
    known = Autobinomial.of(6, 1, 0.0, (0.22, 0.12), isotropic=False)
    picture = exchange(even, known, 400, seed=2)
    pseudo = fit(picture, 6, 1, isotropic=False, periodic=True, check=False)
    found = fit(picture, 6, 1, isotropic=False, periodic=True, method="monte-carlo-exchange", check=False)
    assert found.converged
    assert (np.abs(found.parameters - known.parameters)[1:] < 3.0 * found.standard_errors[1:]).all()
    assert (found.standard_errors[1:] < 0.02).all()
    assert found.model.alpha == pseudo.model.alpha
    assert np.isnan(found.standard_errors[0])


@pytest.mark.validation
def test_a_samples_own_fit_is_usable(texture: np.ndarray) -> None:
    found = regime(texture, KNOWN, seed=1, sweeps=100)
    assert found.name == "usable"
    assert found.phases == 1
    assert found.memory < 0.02
    assert found.sample_std == pytest.approx(found.data_std, rel=0.05)


def test_mean_field_orders_where_its_slope_is_one() -> None:
    """Four neighbours, levels N + 1: at a mean of N/2 the slope is N beta; beyond 1 there are two phases."""
    for beta, phases in ((0.9 / 63, 1), (1.1 / 63, 2)):
        slope, found = mean_field(Autobinomial.of(64, 1, -0.5 * 63 * 4 * beta, (beta,)), 0.5)
        assert slope == pytest.approx(63 * beta, rel=1e-12)
        assert found == phases
    against = Autobinomial.of(64, 1, 0.0, (-0.5 / 63,))  # a chequerboard grows, not the mean
    assert mean_field(against, 0.5)[0] == pytest.approx(0.5, rel=1e-12)


def test_grey_levels_and_back(sea: np.ndarray) -> None:
    even, share = GreyLevels.of(sea, 16), GreyLevels.of(sea, 16, "equal-share")
    assert np.bincount(share.to_levels(sea).ravel()).tolist() == [576] * 16
    assert np.ptp(np.diff(even.edges)) < 1e-12 * sea.max()
    for grey in (even, share):
        assert grey.to_values(grey.to_levels(sea)).mean() == pytest.approx(sea.mean(), rel=1e-12)
        assert grey.levels == 16


def test_model_goes_through_json(texture: np.ndarray) -> None:
    import json

    found = fit(texture[:40, :40], 8, 1)
    held = json.loads(json.dumps(found.as_dict()))
    assert Autobinomial.from_dict(held["model"]) == found.model


def test_orders_follow_distance() -> None:
    assert [len(one) for one in classes(6)] == [2, 2, 2, 4, 2, 2]
    assert classes(6)[5] == ((0, 3), (3, 0))
    assert all(len(one) == 1 for one in classes(5, isotropic=False))


NOISE = np.random.default_rng(0).integers(0, 8, (32, 32))
STRIPES = np.tile(np.arange(32) % 8, (32, 1))


@pytest.mark.parametrize(
    ("image", "settings", "text"),
    [
        (np.full((32, 32), 3), {}, "constant picture"),
        (2 * (NOISE > 3), {}, "two values only .0 and 2. for levels = 8: set levels = 2"),
        (NOISE[:6, :6], {"order": 5, "isotropic": False}, "4 of them have all their neighbours, 390 are needed"),
        (NOISE[:3, :4], {"order": 3}, "needs 5 x 5 pixels or more"),
        (np.where(NOISE == 7, np.nan, NOISE), {}, "pixels are NaN or infinite: choose a region"),
        (NOISE / 2.0, {}, "whole numbers 0 to 7"),
        (NOISE + 1, {}, "grey levels 1 to 8: the field has 0 to 7"),
        (STRIPES, {"isotropic": False}, "sums over different classes|no maximum|one sum"),
        (NOISE, {"order": 0}, "order = 0: allowed are 1"),
        (NOISE, {"levels": 1}, "levels = 1: allowed are 2 to"),
        (NOISE, {"method": "guess"}, "method = 'guess'"),
        (np.indices((32, 32)).sum(axis=0) % 2, {"levels": 2}, "one sum|no maximum|proportional"),
    ],
)
def test_what_cannot_be_fitted_is_named(image: np.ndarray, settings: dict, text: str) -> None:
    with pytest.raises(DomainError, match=text):
        fit(image, **({"levels": 8, "check": False} | settings))


@pytest.mark.parametrize(
    ("change", "text"), [({"kind": "gauss-markov"}, "not an autobinomial field"), ({"beta": None}, "not a whole autobinomial field")]
)
def test_models_of_another_kind_are_named(change: dict, text: str) -> None:
    with pytest.raises(DataError, match=text):
        Autobinomial.from_dict(KNOWN.to_dict() | change)


@pytest.mark.parametrize(
    "fields",
    [
        {"levels": 1},
        {"beta": (0.1,)},
        {"beta": (0.1, np.nan)},
        {"neighbours": (((0, 1),), ((0, -1),))},
        {"neighbours": (((0, 1),), ((0, 1),))},
        {"neighbours": (((0, 1),), ())},
    ],
)
def test_fields_that_are_none_are_refused(fields: dict) -> None:
    with pytest.raises(DomainError):
        Autobinomial(**({"levels": 4, "neighbours": (((0, 1),), ((1, 0),)), "alpha": 0.0, "beta": (0.1, 0.1)} | fields))


@pytest.mark.parametrize(
    ("picture", "levels", "text"),
    [(np.ones((4, 4)), 4, "constant"), ([[0.0, np.nan]], 4, "NaN"), (np.eye(4), 8, "fewer levels"), (np.eye(4), 1, "allowed are 2")],
)
def test_pictures_without_levels_are_named(picture: np.ndarray, levels: int, text: str) -> None:
    with pytest.raises(DomainError, match=text):
        GreyLevels.of(picture, levels, "equal-share")


REPEATS = 100


@pytest.mark.validation
@pytest.mark.parametrize(
    ("model", "isotropic", "order"),
    [
        (Autobinomial.of(64, 1, -1.6, (0.02, 0.005), isotropic=False), False, 1),
        (Autobinomial.of(4, 2, -1.9, (0.2, 0.08)), True, 2),
        (Autobinomial.of(2, 1, -2.0, (1.0,)), True, 1),
    ],
    ids=["64-levels", "4-levels", "ising"],
)
def test_intervals_of_95_percent_hold_90_to_99_of_100_times(model: Autobinomial, isotropic: bool, order: int) -> None:
    held = np.zeros(len(model.parameters), dtype=int)
    for seed in range(REPEATS):
        found = fit(sample(model, (128, 128), 150, seed=seed), model.levels, order, isotropic=isotropic, periodic=True, check=False)
        distance = np.abs(found.parameters - model.parameters) / found.standard_errors
        held += distance < 1.96
        assert (distance < 4.0).all()  # once in 5000 parameters by chance
    assert (held >= 90).all(), held
    assert (held <= 99).all(), held


@pytest.mark.parametrize(
    ("low", "high", "own", "name"),
    [
        (7.8, 8.2, 8.0, "usable"),
        (7.64, 8.36, 8.0, "usable"),  # 4.8 % of the largest level apart
        (7.61, 8.39, 8.0, "frozen"),  # 5.2 %
        (8.0, 8.0, 10.1, "usable"),  # 14 % of the largest level from the picture's mean
        (8.0, 8.0, 10.4, "frozen"),  # 16 %
        (8.0, 8.0, 5.6, "frozen"),
    ],
)
def test_samples_that_remember_or_drift_are_frozen(monkeypatch: pytest.MonkeyPatch, low: float, high: float, own: float, name: str) -> None:
    picture = np.random.default_rng(1).normal(8.0, 2.0, (100, 100))
    picture += 8.0 - picture.mean()
    made = iter([picture + (low - 8.0), picture + (high - 8.0), picture + (own - 8.0)])
    monkeypatch.setattr("seaglint.textures.regime.sampler.sample", lambda *given, **more: next(made))
    model = Autobinomial.of(16, 1, 0.0, (0.0,))
    found = regime(picture, model, seed=1)  # type: ignore[arg-type]
    assert found.name == name
    assert found.memory == pytest.approx((high - low) / 15.0)
    assert found.sample_mean - found.data_mean == pytest.approx(own - 8.0)


@pytest.mark.parametrize(("gain", "name"), [(0.68, "molten"), (0.72, "usable"), (1.40, "usable"), (1.45, "molten"), (2.5, "frozen")])
def test_samples_of_another_contrast_are_molten_or_in_domains(monkeypatch: pytest.MonkeyPatch, gain: float, name: str) -> None:
    """Ratios of standard deviations beyond 0.7 and its inverse; beyond twice that of pixels without neighbours, here 1.94, frozen."""
    picture = np.random.default_rng(1).normal(7.5, 1.7, (100, 100))
    picture += 7.5 - picture.mean()
    spread = 1.7 / picture.std()
    picture = 7.5 + spread * (picture - 7.5)
    monkeypatch.setattr("seaglint.textures.regime.sampler.sample", lambda *given, **more: 7.5 + gain * (picture - 7.5))
    found = regime(picture, Autobinomial.of(16, 1, 0.0, (0.0,)), seed=1)  # type: ignore[arg-type]
    assert found.name == name
    assert found.sample_std / found.data_std == pytest.approx(gain)


def test_correlations_are_those_of_the_pairs() -> None:
    """A plane wave: the correlation of pixels d apart is cos(k.d); each class takes the mean over its pairs."""
    y, x = np.mgrid[:120, :120]
    wave = np.cos(2.0 * np.pi * (x / 10.0 + y / 15.0))
    expected = [0.5 * (np.cos(0.2 * np.pi) + np.cos(2.0 * np.pi / 15.0)), np.cos(2.0 * np.pi * (1.0 / 10.0 + 1.0 / 15.0))]
    found = correlations(wave, (((0, 1), (1, 0)), ((1, 1),)))  # type: ignore[arg-type]
    assert found == pytest.approx(expected, abs=0.01)
    assert correlations(np.ones((9, 9)), (((0, 1),),)).tolist() == [0.0]  # type: ignore[arg-type]


def test_inside_products_are_those_of_a_torus_without_its_seams(texture: np.ndarray) -> None:
    """A large texture: the mean product of pairs inside it is that of all pairs of the torus, within the few that cross the edges."""
    levels = texture.astype(np.int64)
    expected = [sum(float(np.mean(levels * np.roll(levels, (-dy, -dx), (0, 1)))) for dy, dx in one) for one in KNOWN.neighbours]
    assert inside_products(texture, KNOWN.neighbours) == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("periodic", [True, False])
def test_errors_are_the_sandwich_of_pairs_of_scores(periodic: bool) -> None:
    """Slopes of the conditional law of each pixel, by products of those of pixels that are neighbours or the same, one by one."""
    picture = sample(Autobinomial.of(4, 2, -1.2, (0.12, -0.05)), (16, 17), 30, seed=8)
    found = fit(picture, 4, 2, periodic=periodic, check=False)
    offsets = [[(s * dy, s * dx) for dy, dx in one for s in (1, -1)] for one in found.model.neighbours]
    places = list(np.ndindex(16, 17)) if periodic else [(y, x) for y in range(1, 15) for x in range(1, 16)]
    scores, information = {}, np.zeros((3, 3))
    for y, x in places:
        sums = np.array([1.0, *(sum(float(picture[(y + dy) % 16, (x + dx) % 17]) for dy, dx in one) for one in offsets)])
        chance = 1.0 / (1.0 + np.exp(-sums @ found.parameters))
        scores[y, x] = sums * (picture[y, x] - 3.0 * chance)
        information += 3.0 * chance * (1.0 - chance) * np.outer(sums, sums)
    middle = np.zeros((3, 3))
    for (y, x), score in scores.items():
        for dy, dx in [(0, 0), *(d for one in offsets for d in one)]:
            middle += np.outer(score, scores.get(((y + dy) % 16, (x + dx) % 17) if periodic else (y + dy, x + dx), np.zeros(3)))
    bread = np.linalg.inv(information)
    np.testing.assert_allclose(found.covariance, bread @ middle @ bread, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(sum(scores.values()), 0.0, atol=1e-5)
    assert found.log_pseudo_likelihood == pytest.approx(conditional_log_likelihood(picture, found.model, periodic=periodic), rel=1e-12)


def test_a_step_of_newton_solves_the_equations_of_the_gap() -> None:
    gap, root = np.array([3.0, -200.0, 0.5]), np.array([[2.0, 0.0, 0.0], [30.0, 90.0, 0.0], [0.1, 0.2, 0.3]])
    step, distance = newton(gap, root @ root.T)
    np.testing.assert_allclose(root @ root.T @ step, gap, rtol=1e-9)
    assert distance == pytest.approx(np.linalg.norm(np.linalg.solve(root, gap)))
    for twins in (np.ones((2, 2)), np.diag([1.0, 0.0])):
        assert newton(np.ones(2), twins)[1] == np.inf
        assert not newton(np.ones(2), twins)[0].any()


def test_the_last_step_finds_weights_under_which_sums_are_the_pictures() -> None:
    """Of normal differences: shift minus the inverse covariance times the mean, whose weights are those of so many samples."""
    root = np.array([[2.0, 0.0], [1.0, 0.7]])
    differences = np.random.default_rng(4).normal(size=(3990, 2)) @ root.T + 0.3 * root.sum(axis=1)
    shift, covariance, distance, share = _last(differences)
    weights = np.exp(differences @ shift)
    weights /= weights.sum()
    np.testing.assert_allclose(weights @ differences, 0.0, atol=1e-6)
    assert distance < 1e-6
    assert share == pytest.approx(1.0 / (3990.0 * np.sum(weights**2)))
    inverse = np.linalg.inv(np.cov(differences.T, aweights=weights))
    np.testing.assert_allclose(shift, -np.linalg.inv(root @ root.T) @ differences.mean(axis=0), rtol=0.1)
    batches = np.array([part.mean(axis=0) for part in np.split(differences, BATCHES)])
    np.testing.assert_allclose(covariance, inverse + inverse @ np.cov(batches.T) @ inverse / BATCHES, rtol=1e-9)


@pytest.mark.parametrize("name", ["usable", "frozen", "molten"])
@pytest.mark.parametrize("memory", [0.04, 0.06])
def test_findings_name_the_regime_and_the_remedy(name: str, memory: float) -> None:
    """What stays apart is told only of a frozen field that remembers its starts; who can use the fit needs no remedy."""
    found = Regime(name, 0.9, 1, memory, 4.0, 5.0, 1.2, 2.3, (0.4,), (0.6,))  # type: ignore[arg-type]
    assert ("keep the picture's contrast" in found.finding) is (name == "usable")
    assert found.finding.startswith(name) is (name != "usable")
    assert ("apart" in found.finding) is (name == "frozen" and memory > 0.05)
    assert ("wherever they begin" in found.finding) is (name == "frozen" and memory < 0.05)
    assert (found.text != found.finding) is (name != "usable")


@pytest.mark.parametrize(("ratio", "name"), [(0.68, "molten"), (0.72, "usable"), (1.40, "usable"), (1.45, "molten")])
@pytest.mark.parametrize("tied", [True, False])
def test_samples_of_another_correlation_are_molten(monkeypatch: pytest.MonkeyPatch, ratio: float, name: str, tied: bool) -> None:
    """Where the picture's own is above 0.1: below, chance alone changes it as much."""
    given = iter([np.array([0.2 if tied else 0.09]), np.array([ratio * (0.2 if tied else 0.09)])])
    monkeypatch.setattr("seaglint.textures.regime.correlations", lambda *parts: next(given))
    picture = np.random.default_rng(1).binomial(15, 0.5, (60, 60))
    monkeypatch.setattr("seaglint.textures.regime.sampler.sample", lambda *parts, **more: picture)
    assert regime(picture.astype(np.int16), Autobinomial.of(16, 1, 0.0, (0.0,)), seed=1).name == (name if tied else "usable")


def test_samples_are_as_large_as_the_picture_up_to_their_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """128 pixels a side, or four times the farthest neighbour and one."""
    shapes = []

    def sampled(model: Autobinomial, shape: tuple[int, int], *parts: object, **more: object) -> np.ndarray:
        shapes.append(shape)
        return picture[: shape[0], : shape[1]]

    monkeypatch.setattr("seaglint.textures.regime.sampler.sample", sampled)
    picture = np.random.default_rng(1).binomial(15, 0.5, (90, 300)).astype(np.int16)
    regime(picture, Autobinomial(16, (((0, 40), (1, 0)),), 0.0, (0.0,)), seed=1)
    assert set(shapes) == {(90, 161)}
    shapes.clear()
    regime(picture.T, Autobinomial.of(16, 1, 0.0, (0.0,)), seed=1)
    assert set(shapes) == {(128, 90)}
