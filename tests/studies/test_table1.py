"""Table 1 from a rendered sequence, and what goes through the whole analysis, file to JSON, when the truth is known."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.optimize import brentq
from scipy.stats import binom, multivariate_normal, norm

from seaglint.analysis import AnalysisOptions, analyze
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.formats.recording import open_recording
from seaglint.instrument.figures_of_merit import blur_px, mtf
from seaglint.studies.article import table1 as table1_module
from seaglint.studies.article.table1 import ARTICLE, BLUR_PX, BLURS_PX, MARGIN, Table1, corridor, detector, scene, sequence, table1
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import prepare_sequence


@pytest.fixture(scope="module")
def small() -> Table1:
    """Six frames of the scene in a twentieth of its pixels."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(table1_module, "PIXELS", (96, 32))
        patch.setattr(table1_module, "SHORTEST_WAVE", 8.0)
        return table1(frames=6)


def test_every_number_of_the_article_has_ours_beside_it(small: Table1) -> None:
    rows = small.rows()
    json.dumps([row.as_dict() for row in rows.values()], allow_nan=False)
    assert len(rows) == 3 * 2 * 2  # rate, ratio and time; two regions; two thresholds
    assert all(list(row.numbers) == ["article", "as rendered", "detector", "waves", "waves, detector"] for row in rows.values())
    assert rows["rate_glint_3.5_sigma"].article == 0.0050
    assert rows["times_gaussian_glint_3.5_sigma"].article == pytest.approx(21.0, abs=0.6)  # the article: 21 times
    assert rows["rate_background_3.5_sigma"].article is None  # not measured
    for region, thresholds in ARTICLE.items():
        for m in thresholds:
            ratio, rate = rows[f"times_gaussian_{region}_{m:g}_sigma"].ours, rows[f"rate_{region}_{m:g}_sigma"].ours
            assert ratio == pytest.approx(rate / norm.sf(m), rel=1e-9)
            for column in ("through_detector", "waves", "waves_through_detector"):
                seen = [rows[f"{what}_{region}_{m:g}_sigma"].as_dict()[column] for what in ("times_gaussian", "rate")]
                assert seen[0] == pytest.approx(seen[1] / norm.sf(m), rel=1e-9)


def test_columns_hold_the_rows(small: Table1) -> None:
    columns, rows = small.columns(), small.rows()
    assert columns["threshold_sigma"].tolist() == [3.0, 3.5]
    assert columns["glint_rate"].tolist() == [rows[f"rate_glint_{m}_sigma"].ours for m in ("3", "3.5")]
    assert np.isnan(columns["background_article_rate"][1])
    for prefix, key in (("detector", "through_detector"), ("waves", "waves"), ("waves_detector", "waves_through_detector")):
        for what, unit in (("rate", ""), ("correlation_time", "_s")):
            row = [rows[f"{what}_glint_{m}_sigma"].as_dict()[key] for m in ("3", "3.5")]
            np.testing.assert_array_equal(columns[f"glint_{prefix}_{what}{unit}"], [np.nan if v is None else v for v in row])
    assert list(columns)[:2] == ["threshold_sigma", "gaussian_rate"]
    assert list(columns).index("detector_blur_px") == 2 + 2 * 7  # what was there before comes first


def test_the_detector_is_one_of_the_blurs_beside_it(small: Table1) -> None:
    """Counted twice: by the whole analysis, and without its fits."""
    regions = small.through_detector.regions
    for region, rates in small.by_blur[BLUR_PX].items():
        alarms = {alarm.threshold_sigma: alarm for alarm in regions[region].false_alarms}
        assert len(rates) == 2
        for rate in rates:
            assert rate.rate == pytest.approx(alarms[rate.threshold_sigma].rate, rel=1e-12)
            assert rate.exceedances == alarms[rate.threshold_sigma].exceedances


def test_the_sensor_resolves_what_the_articles_detectors_do() -> None:
    """A tenth of the contrast is left at the Nyquist frequency of detectors of 1.0 mrad; the blur is nearly all that of the Gaussian."""
    model = detector()
    for way in mtf(model, [500.0]).values():
        assert way["total"][0] == pytest.approx(0.1, abs=0.02)
    assert blur_px(model) == pytest.approx(BLUR_PX, rel=0.03)
    assert 1e3 * model.ifov == pytest.approx(0.561, abs=5e-4)
    assert model.optics.aperture == pytest.approx(2 * 0.0254, rel=0.01)


def test_what_lies_beyond_the_border_is_drawn_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The picture is the inner part of the wider one: same directions, same waves."""
    monkeypatch.setattr(table1_module, "PIXELS", (48, 16))
    plain, wide = scenario_physics.camera(scene()), scenario_physics.camera(scene(margin=MARGIN))
    inner = slice(MARGIN, -MARGIN)
    np.testing.assert_allclose(wide.azimuths[inner], plain.azimuths, rtol=1e-12)
    np.testing.assert_allclose(wide.elevations[inner], plain.elevations, rtol=1e-12)


def test_sparkles_are_the_articles_or_of_the_waves() -> None:
    """The scene's own default does not decide: one column has the article's 70 ms, the other none."""
    glint = {correlation: scene(correlation=correlation).sea.glint for correlation in ("time", "waves")}
    assert (glint["time"].correlation, glint["time"].correlation_time_s) == ("time", 0.07)
    assert glint["waves"].correlation == "waves"
    assert scene().sea.glint == glint["time"]
    assert scene(correlation="waves").model_copy(update={"sea": scene().sea}) == scene()


def test_both_sparkles_have_the_same_waves_and_regions(small: Table1) -> None:
    """The means of the sunlit sea agree; the waves that are geometry are the same, so that the two pictures are no other seas."""
    plain, waves = small.analysis.regions, small.waves.regions
    for region in ("glint", "background"):
        assert waves[region].pixels == plain[region].pixels
        assert waves[region].mean == pytest.approx(plain[region].mean, rel=0.02)  # sparkles of 1e4 pixels average to a per cent
        assert waves[region].moments.variance != plain[region].moments.variance


def test_scene_is_what_it_says() -> None:
    s = scene(wind_speed=2.0, solar_zenith_deg=50.0)
    assert s.sensor.elevation_deg + 0.5 * s.sensor.fov_deg[1] == pytest.approx(-1.5)
    assert s.sensor.elevation_deg - 0.5 * s.sensor.fov_deg[1] == pytest.approx(-6.0)
    assert s.sensor.ifov_deg[0] == pytest.approx(s.sensor.ifov_deg[1])
    assert s.sensor.frames / s.sensor.frame_rate_hz == pytest.approx(2.0)  # the article: about two seconds
    assert (s.wind.speed_m_s, s.sun.zenith_deg if s.sun else None) == (2.0, 50.0)


def test_the_corridor_is_under_the_sun_and_widens_with_wind(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table1_module, "PIXELS", (96, 30))
    widths = []
    for wind in (2.0, 10.0):
        mask = corridor(scenario_physics.view(scene(wind, 70.0)), scenario_physics.camera(scene(wind, 70.0)))
        assert mask[:, 47:49].all()
        assert not mask[:, [0, -1]].any()
        widths.append(mask.mean())
    assert widths[1] > 1.3 * widths[0]


def test_frames_come_at_their_times(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table1_module, "PIXELS", (48, 16))
    monkeypatch.setattr(table1_module, "SHORTEST_WAVE", 8.0)
    run = prepare_sequence(scene())
    told: list[tuple[int, int]] = []
    images = sequence(run.scene, np.array([0.4, 0.0]), lambda done, total: told.append((done, total)))
    np.testing.assert_array_equal(images[0], run.at(0.4).radiance)
    np.testing.assert_array_equal(images[1], run.at(0.0).radiance)
    assert told == [(0, 2), (1, 2), (2, 2)]


def drifting(frames: int, side: int, sigma: float, speed: float, seed: int) -> np.ndarray:
    """White noise smoothed by ``sigma`` px that drifts along rows by ``speed`` px a frame: covariance exp(-d^2 / 4 sigma^2)."""
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal((side, side)))
    kx, ky = 2.0 * np.pi * np.fft.rfftfreq(side), 2.0 * np.pi * np.fft.fftfreq(side)[:, None]
    smooth = 2.0 * np.sqrt(np.pi) * sigma * np.exp(-0.5 * sigma**2 * (kx**2 + ky**2)) * white
    return np.stack([np.fft.irfft2(smooth * np.exp(-1j * kx * speed * t), (side, side)) for t in range(frames)]).astype(np.float32)


def closed_time(sigma: float, speed: float, threshold: float) -> float:
    """Time [frames] in which exceedances of that noise behind the Laplacian have lost all but 1/e of their correlation.

    The Laplacian's covariance is that of the field summed over pairs of its five weights; both values exceed with the probability of a
    bivariate normal distribution.
    """
    weights = {(0, 0): 4.0, (1, 0): -1.0, (-1, 0): -1.0, (0, 1): -1.0, (0, -1): -1.0}

    def covariance(d: float) -> float:
        pairs = itertools.product(weights.items(), repeat=2)
        return sum(a * b * np.exp(-((d + x[0] - y[0]) ** 2 + (x[1] - y[1]) ** 2) / (4.0 * sigma**2)) for (x, a), (y, b) in pairs)

    p = norm.sf(threshold)

    def above(d: float) -> float:
        r = covariance(d) / covariance(0.0)
        both = multivariate_normal.cdf([-threshold, -threshold], cov=[[1.0, r], [r, 1.0]])
        return (both - p * p) / (p - p * p) - np.exp(-1.0)

    return float(brentq(above, 0.05, 2.0 * sigma)) / speed


@pytest.mark.parametrize("blur", [0.0, 1.2])
def test_blur_lengthens_correlation_times_as_it_widens_a_gaussian(blur: float) -> None:
    """Squares of widths add; some thousand spots above 1.5 sigma in each frame, of which times err by 2 %."""
    sigma, speed, border = 0.9, 0.12, 8
    frames = 20.0 + drifting(30, 400, sigma, speed, seed=3)
    model = detector(blur) if blur else None
    seen = frames if model is None else model.focal_plane(frames)
    filtered = Laplacian().apply(seen)[:, border:-border, border:-border]
    alarms = FalseAlarms((1.5, 2.0))
    alarms.add(standardise(filtered, np.ones(filtered.shape[1:], bool)))
    width = np.hypot(sigma, 0.0 if model is None else blur_px(model))
    for rate in alarms.rates():
        assert rate.correlation_time == pytest.approx(closed_time(width, speed, rate.threshold_sigma), rel=0.05)
        assert rate.rate == pytest.approx(norm.sf(rate.threshold_sigma), rel=0.05)


@pytest.mark.validation
def test_blur_brings_correlation_times_to_those_of_the_article() -> None:
    """One second in 256 x 80 pixels: half of the article's times as rendered, between 0.6 and 1.4 of them through the detector.

    Halves of the whole picture scatter by a fifth about its own times. Blurs order those of the corridor; beside it, in a picture as narrow
    as this, exceedances are too few for it.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(table1_module, "PIXELS", (256, 80))
        patch.setattr(table1_module, "DEPRESSIONS_DEG", (2.0, 2.0 + 80 * 4.5 / 140))
        found = table1(frames=25).rows()
    for name in ("glint_3_sigma", "background_3_sigma"):
        row = found[f"correlation_time_{name}"].as_dict()
        assert row["ours"] < 0.65 * row["article"]
        assert row["through_detector"] > 1.5 * row["ours"]
        assert 0.6 * row["article"] < row["through_detector"] < 1.4 * row["article"]
        of_blurs = list(row["settings"].values())
        if name == "glint_3_sigma":
            assert of_blurs == sorted(of_blurs)
        assert of_blurs[BLURS_PX.index(BLUR_PX)] == pytest.approx(row["through_detector"], rel=1e-9)


@pytest.mark.validation
def test_rendered_glint_is_far_from_gaussian() -> None:
    """The article: 7 and 21 times the Gaussian rate in the corridor, 10 times beside it. Six seas of one frame each scatter by 5 %."""
    found = table1(frames=3).rows()
    ratio = {key: row.ours for key, row in found.items() if key.startswith("times_gaussian")}
    assert 3.0 <= ratio["times_gaussian_glint_3_sigma"] <= 15.0
    assert ratio["times_gaussian_glint_3.5_sigma"] > ratio["times_gaussian_glint_3_sigma"]
    assert 3.0 <= ratio["times_gaussian_background_3_sigma"] <= 15.0


def analysed(frames: np.ndarray, folder: Path, **options: Any) -> dict[str, Any]:
    """Region "all" of a NumPy file's analysis, there and back through JSON."""
    np.save(folder / "frames.npy", frames)
    recording = open_recording(folder / "frames.npy", frame_rate=25.0, units="1")
    found = json.loads(json.dumps(analyze(recording, AnalysisOptions(**options)).as_dict(), allow_nan=False))
    region: dict[str, Any] = found["regions"]["all"]
    return region


def test_white_noise_from_file_to_json_gives_the_gaussian_tail(tmp_path: Path) -> None:
    """A million values through the Laplacian; within the 99.9 % interval of the binomial, widened by less than 1 % by its overlap."""
    frames = np.random.default_rng(5).normal(10.0, 2.0, (64, 128, 128)).astype(np.float32)
    region = analysed(frames, tmp_path)
    # Neighbours correlate by -0.4, diagonal ones by 0.1, next ones by 0.05; exceedances above 3 sigma of correlations
    # as small as these coincide with probability p^2 (1 + 9 r + ...), which widens the standard deviation by less than 1 %.
    for alarm in region["false_alarms"]:
        tail = norm.sf(alarm["threshold_sigma"])
        low, high = binom.ppf([0.0005, 0.9995], frames.size, tail) / frames.size
        assert low <= alarm["rate"] <= high
        assert alarm["rate_low"] <= tail * 1.03
        assert alarm["rate_high"] >= tail * 0.97
        assert alarm["gaussian_rate"] == pytest.approx(tail, rel=1e-12)


def gamma_field(frames: int, side: int, sigma: float, tau: float, pairs: int, seed: int) -> np.ndarray:
    """Half the sum of 2 x ``pairs`` squared Gaussian fields: gamma of shape ``pairs`` and scale 1.

    A squared Gaussian field has the square of its correlation: in space exp(-d^2 / 2 sigma^2) of a Gaussian smoothing by sigma, which is
    1/e at sqrt(2) sigma; in time exp(-2 t / tau).
    """
    rng = np.random.default_rng(seed)
    out = np.zeros((frames, side, side), np.float32)
    a = np.exp(-1.0 / tau)
    norm_ = 2.0 * np.sqrt(np.pi) * sigma
    for _ in range(2 * pairs):
        state = np.zeros((side, side))
        for t in range(frames):
            fresh = norm_ * gaussian_filter(rng.standard_normal((side, side)), sigma, mode="wrap")
            state = fresh if t == 0 else a * state + np.sqrt(1.0 - a * a) * fresh
            out[t] += 0.5 * state**2
    return out


@pytest.mark.validation
def test_gamma_field_from_file_to_json_is_given_back(tmp_path: Path) -> None:
    """Shape 2, scale 1, length sqrt(2) x 1.2 px and time 2 frames within 3 %, from about 2e5 independent values.

    The correlation sums to 2 pi sigma^2 pixels and coth(1/tau) frames to one independent value.
    """
    sigma, tau = 1.2, 4.0
    frames = gamma_field(frames=400, side=144, sigma=sigma, tau=tau, pairs=2, seed=8)
    independent = frames.size / (2.0 * np.pi * sigma**2) * np.tanh(1.0 / tau)
    assert independent > 1e5
    region = analysed(frames, tmp_path)
    fit = region["fits"]["gamma"]
    assert fit["shape"] == pytest.approx(2.0, rel=0.03)
    assert fit["scale"] == pytest.approx(1.0, rel=0.03)
    assert region["correlation_time_s"] == pytest.approx(0.5 * tau / 25.0, rel=0.03)
    for way in ("x", "y"):
        assert region["correlation_length_px"][way] == pytest.approx(np.sqrt(2.0) * sigma, rel=0.03)
    assert fit["ks_p"] > 0.01
    assert region["fits"]["gaussian"]["ks_p"] < 0.01
