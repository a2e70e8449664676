"""A recording through the whole analysis: what is said of good data, and that bad data are never given a number that looks fine."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import norm

from seaglint.analysis import AnalysisOptions, analyze, analyze_recording
from seaglint.analysis.recording import Recording, survey
from seaglint.base.errors import DataError, DomainError
from seaglint.clutter.fits import goodness
from seaglint.formats.recording import open_recording

RNG = np.random.default_rng(12)
WHITE = RNG.normal(100.0, 5.0, (40, 96, 128)).astype(np.float32)
SMALL = WHITE[:12, :48, :64]


def recording(frames: np.ndarray, **more: Any) -> Recording:
    known = {"frame_rate": 25.0, "units": "counts"} | more
    return Recording("memory", *frames.shape, lambda a, b: frames[a:b], **known)


def result(frames: np.ndarray, options: AnalysisOptions | None = None, **more: Any) -> dict[str, Any]:
    return of(recording(frames, **more), options)


def of(given: Recording, options: AnalysisOptions | None = None) -> dict[str, Any]:
    found = analyze(given, options).as_dict()
    json.dumps(found, allow_nan=False)  # JSON has no NaN
    return found


@pytest.fixture
def few_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tenth of the draws behind the levels of the fits, for tests that do not look at these."""
    monkeypatch.setattr("seaglint.analysis.region.goodness", partial(goodness, replicates=19))


quick = pytest.mark.usefixtures("few_draws")


@pytest.fixture(scope="module")
def white() -> dict[str, Any]:
    return result(WHITE, AnalysisOptions(thresholds=(2.0,)))


def test_the_promised_keys_are_there(white: dict[str, Any]) -> None:
    assert {"frames", "units", "regions"} <= set(white)
    assert set(white["regions"]) == {"all", "glint", "background"}
    region = white["regions"]["all"]
    assert {
        "pixels",
        "mean",
        "std",
        "skewness",
        "excess_kurtosis",
        "fits",
        "false_alarms",
        "correlation_length_px",
        "correlation_time_s",
    } <= set(region)
    assert set(region["fits"]) == {"gamma", "lognormal", "weibull", "k", "gaussian"}
    assert {"shape", "scale", "loc", "ks", "ks_p"} <= set(region["fits"]["gamma"])
    entry = {"filter", "threshold_sigma", "rate", "rate_low", "rate_high", "gaussian_rate", "correlation_time_s"}
    assert all(entry <= set(alarm) for alarm in region["false_alarms"])
    assert [alarm["threshold_sigma"] for alarm in region["false_alarms"]] == [2.0, 3.0, 3.5]
    assert region["fits"]["gamma"]["loc"] == 0.0


def test_white_noise_is_white(white: dict[str, Any]) -> None:
    region = white["regions"]["all"]
    values = WHITE.size
    assert region["mean"] == pytest.approx(100.0, abs=4 * 5.0 / np.sqrt(values))
    assert region["std"] == pytest.approx(5.0, abs=4 * 5.0 / np.sqrt(2 * values))
    assert region["skewness"] == pytest.approx(0.0, abs=4 * np.sqrt(6 / values))
    assert region["excess_kurtosis"] == pytest.approx(0.0, abs=4 * np.sqrt(24 / values))
    assert region["fits"]["gaussian"]["ks_p"] > 0.01
    assert region["correlation_length_px"]["x"] < 1.0
    assert white["regions"]["glint"] is None
    assert not any("saturated" in note for note in white["notes"])
    assert region["saturated"] == 0.0
    for alarm in region["false_alarms"]:
        # neighbours share a filter's pixels, which widens the interval by less than a factor of two
        expected = norm.sf(alarm["threshold_sigma"])
        assert alarm["rate"] == pytest.approx(expected, abs=4 * np.sqrt(2.0 * expected / values))
        assert alarm["gaussian_rate"] == pytest.approx(expected, rel=1e-9)


def test_wrong_families_are_told_apart() -> None:
    frames = np.random.default_rng(3).gamma(1.5, 2.0, (24, 64, 64)).astype(np.float32)
    fits = result(frames)["regions"]["all"]["fits"]
    assert fits["gamma"]["shape"] == pytest.approx(1.5, rel=0.03)
    assert fits["gamma"]["scale"] == pytest.approx(2.0, rel=0.03)
    assert fits["gamma"]["ks_p"] > 0.01
    assert fits["gaussian"]["ks_p"] < 0.01
    assert fits["gaussian"]["ks"] > 3.0 * fits["gamma"]["ks"]


@quick
def test_same_input_same_numbers_however_it_is_blocked(monkeypatch: pytest.MonkeyPatch) -> None:
    once = result(SMALL, AnalysisOptions(thresholds=(2.0,)))
    whole = analyze_recording.ahead
    monkeypatch.setattr(analyze_recording, "ahead", lambda recording, prepare: whole(recording, prepare, memory=3 * SMALL[0].nbytes))
    again = result(SMALL, AnalysisOptions(thresholds=(2.0,)))
    assert again["regions"]["all"]["false_alarms"] == once["regions"]["all"]["false_alarms"]
    assert again["regions"]["all"]["fits"] == once["regions"]["all"]["fits"]


@quick
def test_a_mask_makes_the_regions() -> None:
    mask = np.zeros((96, 128), bool)
    mask[:, 40:80] = True
    frames = WHITE.copy()
    frames[:, mask] += 20.0
    found = result(frames, AnalysisOptions(mask=mask))
    assert found["regions"]["glint"]["pixels"] == mask.sum()
    assert found["regions"]["glint"]["mean"] - found["regions"]["background"]["mean"] == pytest.approx(20.0, abs=0.1)
    assert found["segmentation"]["method"] == "mask given"


def test_a_mask_of_another_size_is_refused() -> None:
    with pytest.raises(DataError, match="mask has 10 x 10"):
        result(WHITE, AnalysisOptions(mask=np.ones((10, 10), bool)))


@quick
def test_rows_are_counted_after_the_filter_saw_all() -> None:
    frames = WHITE[:12].copy()
    frames[:, :48] += 1000.0 * np.arange(48)[::-1, None] ** 2  # a steep sky above the rows analysed
    part = result(frames, AnalysisOptions(rows=(0.6, 1.0)))["regions"]["all"]
    assert part["pixels"] == (96 - 57) * 128  # from floor(0.6 x 96) down
    assert part["std"] == pytest.approx(5.0, rel=0.02)


@pytest.mark.parametrize("rows", [(0.5, 0.5), (-0.1, 1.0), (0.0, 1.2)])
def test_impossible_rows(rows: tuple[float, float]) -> None:
    with pytest.raises(DomainError, match="rows"):
        result(WHITE, AnalysisOptions(rows=rows))


def constant() -> np.ndarray:
    return np.full((10, 64, 64), 7.0, np.float32)


@quick
@pytest.mark.parametrize("frames", [1, 10])
def test_a_constant_has_no_rates(frames: int) -> None:
    found = result(constant()[:frames])
    region = found["regions"]["all"]
    assert any("equal" in note for note in found["notes"])
    assert region["std"] == 0.0
    assert region["skewness"] is None
    assert all(alarm["rate"] is None for alarm in region["false_alarms"])
    assert all(fit["shape"] is None and fit["ks"] is None for fit in region["fits"].values())


@quick
def test_dead_rows_and_pixels_are_left_out_and_named() -> None:
    frames = WHITE[:20].copy()
    frames[:, [5, 40]] = 0.0
    frames[:, 60, 17] = 4000.0
    found = result(frames)
    assert any("2 rows left out" in note and "5, 40" in note for note in found["notes"])
    assert any("1 pixels left out: they never change" in note for note in found["notes"])
    region = found["regions"]["all"]
    assert region["pixels"] == 94 * 128 - 1
    assert region["mean"] == pytest.approx(100.0, abs=0.1)
    assert region["false_alarms"][0]["rate"] == pytest.approx(norm.sf(3.0), rel=0.3)


@quick
def test_even_columns_are_named() -> None:
    frames = SMALL[:4].copy()
    frames[:, :, [1, 2, 3]] = 0.0
    assert any("3 columns (1, 2, 3)" in note for note in result(frames)["notes"])


@quick
def test_missing_values_are_counted_and_do_not_spread() -> None:
    frames = WHITE[:20].copy()
    frames[3, 10:20, 10:20] = np.nan
    frames[7] = np.inf
    found = result(frames)
    region = found["regions"]["all"]
    assert any("missing" in note for note in found["notes"])
    assert region["values"] == frames.size - 100 - 96 * 128
    assert np.isfinite(region["std"])
    assert region["false_alarms"][0]["rate"] == pytest.approx(norm.sf(3.0), rel=0.3)


def test_nothing_finite_is_an_error() -> None:
    with pytest.raises(DataError, match="no pixel"):
        result(np.full((2, 8, 8), np.nan, np.float32))


@quick
def test_saturation_is_told() -> None:
    found = result(np.minimum(SMALL, 104.0), saturation=104.0)
    assert any("saturated at 104" in note for note in found["notes"])
    assert any("saturated" in note for note in found["regions"]["all"]["notes"])


@quick
def test_a_single_frame_has_no_times() -> None:
    found = result(SMALL[:1])
    region = found["regions"]["all"]
    assert any("single frame" in note for note in found["notes"])
    assert region["correlation_time_s"] is None
    assert all(alarm["correlation_time_s"] is None for alarm in region["false_alarms"])


@quick
def test_without_a_frame_rate_times_are_in_frames_only() -> None:
    slow = np.repeat(RNG.normal(size=(12, 64, 64)), 6, axis=0).astype(np.float32) + 0.3 * RNG.normal(size=(72, 64, 64)).astype(np.float32)
    region = result(slow, frame_rate=None)["regions"]["all"]
    assert region["correlation_time_s"] is None
    assert region["correlation_time_frames"] > 1.0
    seconds = result(slow, frame_rate=50.0)["regions"]["all"]
    assert seconds["correlation_time_s"] == pytest.approx(region["correlation_time_frames"] / 50.0, rel=1e-9)


@quick
@pytest.mark.parametrize(
    ("blur", "says"), [(None, "not known"), (0.0, "correlation times of a real sensor are longer"), (0.42, "0.42 px (standard deviation")]
)
def test_times_come_with_the_blur_of_what_made_the_frames(blur: float | None, says: str) -> None:
    from seaglint.cli.analyze import lines

    analysis = analyze(recording(SMALL, blur_px=blur))
    assert analysis.as_dict()["blur_px"] == blur
    assert says in analysis.as_dict()["blur"]
    text = lines(analysis)
    assert text[1] == f"blur of the frames: {analysis.recording.blur}"
    assert not any(line.startswith("blur") for line in lines(analyze(recording(SMALL[:1], blur_px=blur))))


@quick
def test_repeated_frames_betray_a_wrong_rate() -> None:
    found = result(np.repeat(SMALL[:10], 2, axis=0))
    assert any("10 frames repeat" in note for note in found["notes"])


@quick
def test_tiny_pictures_are_answered() -> None:
    found = result(WHITE[:2, :12, :12])
    assert found["regions"]["glint"] is None
    assert found["regions"]["all"]["pixels"] == 144


@quick
def test_a_detector_is_judged_beside_the_filter() -> None:
    from seaglint.detection.named_detectors import named

    found = result(WHITE, AnalysisOptions(detectors=(named("ca-cfar"), named("frame-difference"))))
    names = {alarm["filter"] for alarm in found["regions"]["all"]["false_alarms"]}
    assert names == {"laplacian", "ca-cfar", "frame-difference"}
    cfar = [a for a in found["regions"]["all"]["false_alarms"] if a["filter"] == "ca-cfar" and a["threshold_sigma"] == 3.0]
    # exact for white Gaussian clutter; edges give no answer
    assert cfar[0]["rate"] == pytest.approx(norm.sf(3.0), rel=0.25)


@quick
@pytest.mark.parametrize("scope", ["sequence", "local"])
def test_other_standard_deviations(scope: Any) -> None:
    region = result(WHITE[:12], AnalysisOptions(scope=scope))["regions"]["all"]
    assert region["false_alarms"][0]["rate"] == pytest.approx(norm.sf(3.0), rel=0.35)


@quick
@pytest.mark.parametrize(
    ("name", "rates"),
    [
        ("Misc_66", (0.0069, 0.0050)),
        ("Misc_107", (0.0072, 0.0035)),
        pytest.param("Misc_26", (0.0051, 0.0037), marks=pytest.mark.validation),
    ],
)
def test_measured_images_give_their_known_rates(name: str, rates: tuple[float, float], data_dir: Path) -> None:
    """Counted before by an independent program: Laplacian of the whole image, rows from floor(0.45 H) down, sigma of that crop."""
    found = of(open_recording(data_dir / "imagery" / f"{name}.png"), AnalysisOptions(rows=(0.45, 1.0)))
    alarms = found["regions"]["all"]["false_alarms"]
    assert tuple(round(alarm["rate"], 4) for alarm in alarms) == rates


def clipped(kind: str) -> np.ndarray:
    noise = np.random.default_rng(17).normal(8000.0, 1000.0, (24, 96, 128))
    match kind:
        case "14 bits in 16":
            return np.clip(np.round(noise * 1.4), 0, 16383).astype(np.uint16)
        case "float":
            return np.minimum(noise, 10500.0).astype(np.float32)
        case "8 bits":
            return np.clip(np.round(noise / 80.0), 0, 128).astype(np.uint8)
    raise ValueError(kind)


@quick
@pytest.mark.parametrize(("kind", "ceiling"), [("14 bits in 16", 16383), ("float", 10500), ("8 bits", 128)])
def test_a_spike_at_the_largest_value_is_saturation(kind: str, ceiling: float) -> None:
    frames = clipped(kind)
    found = result(frames, saturation=None)
    share = (frames == ceiling).mean()
    assert any(f"saturated at {ceiling}" in note for note in found["notes"])
    region = found["regions"]["all"]
    assert region["saturated"] == pytest.approx(share, rel=1e-6)
    assert all("saturated" in alarm["note"] for alarm in region["false_alarms"])


@quick
@pytest.mark.parametrize("step", [5.0, pytest.param(1.0, marks=pytest.mark.validation)])
def test_noise_in_steps_has_no_spike(step: float) -> None:
    found = result(np.round(WHITE / step) * step)
    assert not any("saturated" in note for note in found["notes"])
    assert found["regions"]["all"]["saturated"] == 0.0


@quick
def test_a_stuck_bright_pixel_is_no_ceiling() -> None:
    frames = np.repeat(WHITE[:, :48, :64], 2, axis=0) + np.float32(0.01) * np.arange(80, dtype=np.float32)[:, None, None]
    frames[:, 5, 5] = 4095.0
    assert not any("saturated" in note for note in result(frames)["notes"])


@quick
@pytest.mark.parametrize(("line", "where"), [("row 40", np.s_[:, 40]), ("column 0", np.s_[:, :, 0])])
def test_a_bad_line_is_named_and_left_out_of_correlation_and_fits(line: str, where: tuple[slice | int, ...]) -> None:
    frames = WHITE[:20].copy()
    frames[where] += 100.0
    found = result(frames, AnalysisOptions(border="keep"))
    assert any(f"{line} alone" in note for note in found["notes"])
    region = found["regions"]["all"]
    assert region["false_alarms"][0]["rate"] > 4 * norm.sf(3.0)  # as the picture has it
    assert region["fits"]["gaussian"]["scale"] == pytest.approx(5.0, rel=0.02)
    assert region["correlation_length_px"]["x"] < 1.0
    assert region["correlation_length_px"]["y"] < 1.0


@quick
@pytest.mark.parametrize("rows", [3, 40])
def test_rows_of_a_sky_without_noise_are_left_out(rows: int) -> None:
    """A rendered sky differs along its rows and never changes; it is neither dead pixels nor a still scene, however much there is."""
    frames = WHITE[:20].copy()
    frames[:, :rows] = np.linspace(90.0, 95.0, rows)[:, np.newaxis] + np.linspace(0.0, 1.0, frames.shape[2])
    found = result(frames, AnalysisOptions(border="keep"))
    assert [note for note in found["notes"] if "change" in note] == [
        f"{rows} rows left out ({', '.join(map(str, range(min(rows, 6))))}{', ...' if rows > 6 else ''}): none of their pixels ever "
        "changes, as in the sky of a sequence rendered without noise"
    ]
    assert found["regions"]["all"]["pixels"] == (96 - rows) * 128


@quick
def test_a_dead_column_is_told_once() -> None:
    frames = SMALL.copy()
    frames[:, :, 30] = 0.0
    notes = result(frames)["notes"]
    assert any("48 pixels left out: they never change" in note for note in notes)
    assert not any("even from top to bottom" in note for note in notes)


@quick
def test_repeated_border_pixels_are_left_out_of_sequences_and_told_of_images() -> None:
    """White noise of small pictures: kept borders lower sigma by 0.2 of their share, 3 % at 128 px; without, the tail comes back."""
    frames = np.random.default_rng(33).normal(0.0, 1.0, (200, 64, 64)).astype(np.float32)
    dropped, kept = (result(frames, AnalysisOptions(border=b)) for b in ("auto", "keep"))
    assert (dropped["border"], kept["border"]) == ("dropped", "kept")
    rate, biased = (r["regions"]["all"]["false_alarms"][0]["rate"] for r in (dropped, kept))
    # 8e5 pixels, 1080 expected: 99.9 % is 10 %
    assert rate == pytest.approx(norm.sf(3.0), rel=0.10)
    assert biased > rate
    single = result(frames[:1])
    assert single["border"] == "kept"
    assert any("within 1 px of the border" in note and "6.2 % high" in note for note in single["notes"])


@pytest.mark.validation
def test_long_white_sequence_of_small_pictures_gives_back_the_tail() -> None:
    from scipy.stats import binom

    frames = np.random.default_rng(6).normal(50.0, 2.0, (600, 128, 128)).astype(np.float32)
    count = 600 * 126 * 126
    for alarm in result(frames)["regions"]["all"]["false_alarms"]:
        low, high = binom.ppf([0.0005, 0.9995], count, norm.sf(alarm["threshold_sigma"])) / count
        assert low <= alarm["rate"] <= high


@quick
def test_a_constant_has_no_correlation_length() -> None:
    region = result(constant())["regions"]["all"]
    assert region["correlation_length_px"] == {"x": None, "y": None}
    assert region["correlation_length_reason"] == "all values are equal"


@quick
def test_values_rounded_to_single_precision_are_told() -> None:
    noise = np.random.default_rng(2).normal(1e6, 0.1, (6, 64, 64)).astype(np.float32)
    assert any("rounded" in note for note in result(noise)["notes"])


@quick
def test_records_hold_what_is_written_and_a_tail_without_a_fit_is_a_reason_alone() -> None:
    found = analyze(recording(SMALL))
    region, written = found.regions["all"], found.as_dict()["regions"]["all"]
    assert written["fits"]["gamma"] == region.fits["gamma"].as_dict()
    lowest, above = region.false_alarms
    assert above.tail is None
    fitted, reason = region.tail("laplacian")
    assert lowest.tail == ({"reason": reason} if fitted is None else fitted.as_dict())
    assert [entry["tail"] for entry in written["false_alarms"]] == [lowest.tail, None]


def test_a_level_taken_off_when_reading_is_in_means_and_fits(tmp_path: Path) -> None:
    noise = np.random.default_rng(2).normal(1e6, 1e-3, (6, 64, 64))
    np.save(tmp_path / "clip.npy", noise)
    region = analyze(open_recording(tmp_path / "clip.npy")).as_dict()["regions"]["all"]
    assert region["mean"] == pytest.approx(noise.mean(), abs=1e-7)
    assert region["std"] == pytest.approx(1e-3, rel=0.03)
    assert region["fits"]["gaussian"]["loc"] == pytest.approx(1e6, abs=1e-4)
    assert region["fits"]["gaussian"]["ks_p"] > 0.01


@quick
def test_dead_rows_of_a_file_that_is_mapped(tmp_path: Path) -> None:
    frames = SMALL[:10].copy()
    frames[:, 7] = 0.0
    frames[2, 3, 4] = np.nan
    np.save(tmp_path / "clip.npy", frames)
    from seaglint.detection.named_detectors import named

    found = of(open_recording(tmp_path / "clip.npy"), AnalysisOptions(detectors=(named("ca-cfar"),)))
    assert any("1 rows left out (7)" in note for note in found["notes"])
    assert found["regions"]["all"]["pixels"] == 47 * 64


@quick
@pytest.mark.parametrize(("scope", "detectors"), [("frame", ()), ("sequence", ("frame-difference",))])
def test_progress_counts_the_frames_of_the_recording(scope: Any, detectors: tuple[str, ...]) -> None:
    from seaglint.detection.named_detectors import named

    told: list[tuple[int, int]] = []
    frames = SMALL[:12]
    recording = Recording("made here", *frames.shape, read_block=lambda start, stop: frames[start:stop])
    options = AnalysisOptions(scope=scope, detectors=tuple(named(name) for name in detectors))
    analyze(recording, options, lambda done, total: told.append((done, total)))
    assert told[0] == (0, 12)
    assert told[-1] == (12, 12)
    assert told == sorted(told)
    # Half of the recording after the first of two passes, a quarter after the first of four.
    assert (12 // (2 if scope == "frame" else 4), 12) in told


@quick
def test_large_levels_of_few_values_are_not_given() -> None:
    from scipy.ndimage import gaussian_filter

    waves = gaussian_filter(np.random.default_rng(2).normal(size=(1, 96, 96)), (0, 8, 8), mode="wrap").astype(np.float32)
    fit = result(waves)["regions"]["all"]["fits"]["gaussian"]
    assert fit["effective_count"] < 50
    assert fit["ks"] is not None
    assert fit["ks_p"] is None or fit["ks_p"] <= 0.05


@quick
def test_blocks_of_the_fits_are_five_correlation_lengths_a_side(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sides of the blocks that are drawn for the fits' intervals, beside the lengths that the result gives."""
    from scipy.ndimage import gaussian_filter

    from seaglint.analysis import region

    sides: list[tuple[float, float]] = []
    labels = region.block_labels
    monkeypatch.setattr(region, "FAMILIES", ("gaussian",))
    monkeypatch.setattr(region, "block_labels", lambda shape, given: sides.append(given) or labels(shape, given))
    waves = gaussian_filter(np.random.default_rng(5).standard_normal((2, 48, 64)), (0.0, 0.7, 1.2)).astype(np.float32)
    found = result(10.0 + waves, AnalysisOptions(mask=np.ones((48, 64), bool)))["regions"]
    lengths = found["all"]["correlation_length_px"]
    assert lengths["x"] > 1.3 * lengths["y"]
    assert (5.0 * lengths["y"], 5.0 * lengths["x"]) in [pytest.approx(pair) for pair in sides]


@quick
@pytest.mark.parametrize("repeated", [(0,), (0, 4), (10,)])
def test_each_repeated_frame_is_counted_once(repeated: tuple[int, ...]) -> None:
    frames = SMALL.copy()
    for k in repeated:
        frames[k + 1] = frames[k]
    assert any(
        note.startswith(f"{len(repeated)} frames repeat the one before") for note in survey(recording(frames), lambda done: None).notes
    )
