from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import corridor_verdicts
from seaglint.base.errors import DataError
from seaglint.clutter.segmentation import FineStructure, _peak, _refusal, _sparkle, otsu_threshold, segment
from seaglint.formats.recording import open_recording

ROWS, COLUMNS = 192, 256
Y, X = np.mgrid[:ROWS, :COLUMNS]


def noise(seed, sigma=0.0):
    values = np.random.default_rng(seed).standard_normal((ROWS, COLUMNS))
    return gaussian_filter(values, sigma) * (2.0 * np.sqrt(np.pi) * sigma if sigma else 1.0)


def corridor(seed, centre=120.0, width=30.0):
    """Sky of 30 rows, sea brighter downwards, glints whose rate is Gaussian in azimuth: dense within, sparse beside."""
    sea = 8.0 + Y / 100.0 + 0.1 * noise(seed, 1.0)
    glints = np.random.default_rng(seed + 1).poisson(0.02 + 2.0 * np.exp(-(((X - centre) / width) ** 2)))
    picture = sea + gaussian_filter(5.0 * glints, (0.5, 1.5))
    picture[:30] = 5.0 + 0.02 * noise(seed)[:30]
    return picture


@pytest.mark.parametrize("offset", [0.0, -200.0])
@pytest.mark.parametrize("gain", [1.0, 1e-3])
def test_corridor_is_found_in_any_unit(gain, offset):
    found = segment(gain * corridor(1) + offset)
    assert found.found, found.reason
    truth = (np.abs(X - 120.0) < 30.0) & (Y >= 30)  # half to a third of the peak
    assert np.sum(found.glint & truth) / np.sum(found.glint | truth) > 0.75
    assert not found.glint[:30].any()
    assert 28 <= found.sky.any(axis=1).sum() <= 34
    assert not (found.glint & found.background).any()


def test_corridor_cut_by_the_edge():
    found = segment(corridor(2, centre=250.0))
    assert found.found, found.reason
    assert found.glint[100, 245]
    assert not found.glint[:, :150].any()


def scenes():
    sky_and_sea = np.where(Y < 50, 5.0, 8.0 + Y / 50.0)
    rolled = np.where(Y - 0.05 * X < 50, 5.0, 8.0 + Y / 50.0)
    return {
        "white noise": noise(1),
        "waves": noise(2, 3.0),
        "long waves": noise(3, 10.0),
        "skewed waves": noise(4, 4.0) ** 2,
        "horizon": sky_and_sea + 0.5 * noise(5),
        "horizon without noise in the sky": sky_and_sea + np.where(Y < 50, 0.0, 0.5) * noise(5),
        "rolled horizon": rolled + 0.5 * noise(6),
        "brighter to one side": X / 50.0 + 0.5 * noise(7),
        "vignetting": -10.0 * (((X - 128) / 128) ** 2 + ((Y - 96) / 96) ** 2) + 0.5 * noise(8),
        "concave sea": np.where(Y < 20, 5.0, 8.0 + 4.0 * np.sqrt(np.maximum(Y - 20, 0) / 172.0)) + 0.5 * noise(9, 1.0),
    }


def shore(edge, brighter, rough, grain):
    """Sea beside land that is brighter and rougher, under a lens that darkens the corners by a third."""
    land = {
        "side": 150 + 25 * np.sin(Y / 25.0) + 10 * noise(9, 12) < X,
        "corner": (X > 120) & (80 + 20 * np.sin(X / 20.0) < Y),
        "tilted": 70 + 12 * np.sin(X / 30.0) + 0.35 * (X - 128) > Y,
    }[edge]
    lens = 1.0 - 0.175 * (((X - 128) / 128) ** 2 + ((Y - 96) / 96) ** 2)
    return np.where(land, 10.0 + brighter + rough * noise(51, grain), 10.0 + 0.4 * noise(1, 1.0)) * lens


@pytest.mark.parametrize("grain", [1.0, 3.0])
@pytest.mark.parametrize(("edge", "brighter", "rough"), [("side", 3, 1.0), ("side", 5, 2.0), ("corner", 3, 1.0), ("tilted", 5, 2.0)])
def test_a_shore_under_vignetting_is_no_glint(edge, brighter, rough, grain):
    found = segment(shore(edge, brighter, rough, grain))
    assert not found.found
    assert found.contrast > 2.0  # two classes of brightness there are


def test_a_shore_in_a_sequence_is_no_glint():
    found = segment(shore("side", 5, 2.0, 1.0), 0.3 + 0.02 * noise(3) + 0.4 * (X > 150))
    assert not found.found


def test_the_border_of_a_gaussian_corridor_is_as_steep_as_its_density():
    """Without noise: brightness at distances of half to two smoothings (2 px to 8 px) inside and outside, over that of the core."""
    width, smoothing = 60.0, 192 / 24
    found = segment(10.0 * np.exp(-(((X - 128.0) / width) ** 2)) + 1e-6 * noise(1))
    # Otsu's threshold of the profile itself, in units of its width from the axis.
    smooth = gaussian_filter(10.0 * np.exp(-(((X[0] - 128.0) / width) ** 2)), smoothing, mode="nearest")
    border = np.abs(X[0] - 128)[smooth > otsu_threshold(smooth)[0]].max() + 0.5
    profile = lambda x: 10.0 * np.exp(-((x / width) ** 2))  # noqa: E731
    near = np.linspace(smoothing / 4, smoothing, 99)
    core, rest = np.linspace(0.0, border / 2, 99), np.linspace((border + 128.0) / 2, 128.0, 99)
    expected = (profile(border - near) - profile(border + near)).mean() / (profile(core).mean() - profile(rest).mean())
    # The border is looked for again and rounded to whole pixels.
    assert found.border_step == pytest.approx(expected, rel=0.1)


def test_a_narrow_failure_is_no_corridor_and_says_so():
    whole = segment(corridor(1))
    assert whole.found, whole.reason
    weak = next(found for found in (segment(in_noise(s)) for s in np.arange(0.5, 0.02, -0.02)) if not found.found)
    assert not weak.glint.any()
    assert weak.reason


@pytest.mark.parametrize("name", scenes())
def test_no_corridor_is_an_answer(name):
    found = segment(scenes()[name])
    assert not found.found
    assert found.reason
    assert not found.glint.any()


def test_missing_pixels_are_in_no_region():
    picture = corridor(3)
    picture[:, 118] = np.nan
    picture[100] = np.nan
    found = segment(picture)
    assert found.found, found.reason
    assert not (found.glint | found.background | found.sky)[~np.isfinite(picture)].any()
    assert (found.glint | found.background | found.sky)[np.isfinite(picture)].all()


@pytest.mark.parametrize("picture", [np.ones((64, 64)), np.full((64, 64), np.nan), noise(1)[:20]], ids=["constant", "empty", "small"])
def test_not_decidable(picture):
    found = segment(picture)
    assert not found.found
    assert np.isnan(found.symmetry)
    assert found.reason


def test_spread_in_time_must_fit():
    with pytest.raises(DataError, match="differ in shape"):
        segment(np.ones((64, 64)), np.ones((64, 65)))
    with pytest.raises(DataError, match="rows, columns"):
        segment(np.ones((2, 64, 64)))


def test_otsu():
    values = np.repeat([1.0, 3.0], [300, 100])
    threshold, separability = otsu_threshold(values)
    assert 1.0 < threshold <= 3.0
    assert separability == pytest.approx(1.0)
    # Split in the middle: 2/pi of a Gaussian's variance lies between the halves, 3/4 of a uniform density's.
    assert otsu_threshold(np.random.default_rng(1).normal(size=100_000))[1] == pytest.approx(2 / np.pi, abs=0.005)
    assert otsu_threshold(np.linspace(0.0, 1.0, 100_000))[1] == pytest.approx(0.75, abs=0.001)


@pytest.mark.parametrize("name", sorted(corridor_verdicts.BY_EYE))
def test_measured_pictures_are_judged_as_by_eye(data_dir, name):
    found = segment(open_recording(data_dir / "imagery" / f"{name}.png", channel="mean").read(0, 1)[0])
    assert found.found is corridor_verdicts.BY_EYE[name].startswith("glint")
    assert found.glint.any() is np.bool_(found.found)


def test_measured_corridor(data_dir):
    """The bright patch below the middle of the picture, and neither sky, ship on the horizon, nor the dark foreground."""
    found = segment(open_recording(data_dir / "imagery" / "Misc_66.png", channel="mean").read(0, 1)[0])
    assert found.found, found.reason
    assert found.glint[175, 200]
    assert not found.glint[:90].any()
    assert not found.glint[:, :50].any()
    assert not found.glint[245:].any()
    assert 0.2 < found.glint.mean() < 0.5
    assert 70 < found.axis_column < 280
    assert found.sparkle.saturated > 0.01


@pytest.mark.parametrize("kind", corridor_verdicts.KINDS)
def test_random_pictures_without_glint_are_not_called_glint(kind):
    """Ten draws of each kind besides those of the table, whose numbers begin at 0."""
    for number in range(1000, 1010):
        picture = corridor_verdicts.KINDS[kind](np.random.default_rng(number))
        found = segment(picture)
        assert not found.found, (number, found)
        assert found.reason


@pytest.mark.parametrize("centre", [-6.0, 0.0, 64.0, 128.0, 255.0, 262.0])
@pytest.mark.parametrize("seed", [11, 12])
def test_the_axis_is_where_the_sun_is(centre, seed):
    """Inside the picture, at its border and beside it, where half of the corridor or less is seen."""
    found = segment(corridor(seed, centre=centre))
    assert found.found, found.reason
    assert found.axis_column == pytest.approx(centre, abs=16.0)  # a quarter of the grid's width


@pytest.mark.parametrize(("gain", "level"), [(1.0, 0.0), (4.0, -30.0)])
@pytest.mark.parametrize("seed", [21, 22, 23])
def test_a_gain_leaves_skewness_and_raises_structure_like_brightness(seed, gain, level):
    """A skewed texture under a symmetric vignetting: everything but the sparkle of a corridor."""
    texture = 1.0 + 0.2 * (noise(seed, 1.5) ** 2 - 1.0)
    shade = 0.3 + 0.7 * np.exp(-(((X - 100.0) / 60.0) ** 2))
    found = segment(gain * texture * shade + level)
    assert not found.found
    assert found.symmetry > 0.9
    assert found.sparkle.skewness_within == pytest.approx(found.sparkle.skewness_beside, abs=0.25)
    # The level is unknown: brightness above the darkest sea is the most that a gain can be.
    assert 1.1 < found.sparkle.structure_ratio < 1.05 * found.sparkle.brightness_ratio


def test_radiances_have_a_zero():
    """A corridor of dense facets on a bright sea, of one skewness all over: a gain makes it of counts, but not of radiances."""
    glint = np.exp(-(((X - 128.0) / 40.0) ** 2))
    sea = 100.0 + 4.0 * glint + 0.3 * noise(31, 1.0) * (1.0 + 2.0 * glint)
    assert not segment(sea).found
    assert segment(sea, radiance=True).found
    assert not segment((100.0 + 5.0 * noise(31, 1.0)) * (1.0 + 3.0 * glint), radiance=True).found


def test_noise_has_no_border_to_speak_of():
    """A share of the step across a border that chance drew is any number; reports leave it out."""
    found = segment(noise(1))
    assert not found.found
    assert np.isnan(found.border_step)


@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_a_gap_changes_nothing_beside_it(offset):
    """A block without data at the corridor's flank, at any level of the picture: what is left is found as in the whole picture."""
    picture = corridor(4) + offset
    whole = segment(picture)
    picture[80:110, 130:170] = np.nan
    found = segment(picture)
    assert found.found, found.reason
    there = np.isfinite(picture)
    assert np.sum(found.glint & whole.glint) / np.sum((found.glint | whole.glint) & there) > 0.9
    assert found.symmetry == pytest.approx(whole.symmetry, abs=0.03)
    assert found.contrast == pytest.approx(whole.contrast, rel=0.1)


def in_noise(strength):
    return strength * corridor(5) + 0.8 * noise(6, 1.0) + 0.4 * noise(7, 2.0)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"contrast": 1.0}, "above the background"),
        ({"contrast": 1.4}, "not surely glint: contrast"),
        ({"symmetry": 0.5}, "no peak about a vertical axis"),
        ({"symmetry": 0.8}, "not surely glint: a vertical axis explains 80 %"),
        ({"step": 0.6}, "a shore"),
        ({"step": 0.46}, "not surely glint: 46 % of the step"),
        ({"skewness_within": 0.75}, "not surely glint: skewness"),
        ({"skewness_within": 0.95}, "does not sparkle"),
        ({"error": 0.3}, "does not sparkle"),
        ({"structure_ratio": 1.0}, "not surely glint: fine structure 1.00"),
        ({"structure_ratio": 0.5}, "fine structure 0.50"),
        ({"saturated": 0.05}, "saturated"),
        ({"error": np.nan}, "no rows show both"),
        ({"skewness_within": 0.95, "structure_ratio": 7.0}, ""),
        ({"skewness_within": 0.95, "saturated": 0.05, "brightness_ratio": 4.0}, ""),
        ({"skewness_within": 0.95, "radiance": True, "brightness_ratio": 1.1}, ""),
        ({}, ""),
    ],
)
def test_each_criterion_refuses_beyond_its_limit(change, says):
    """A clear corridor, with one number changed."""
    fine = FineStructure(2.0, 2.2, skewness_within=0.4, skewness_beside=1.0, error=0.05)
    known = {"symmetry": 0.95, "contrast": 3.0, "step": 0.3} | {k: v for k, v in change.items() if k in ("symmetry", "contrast", "step")}
    reason = _refusal(**known, sparkle=replace(fine, **{k: v for k, v in change.items() if k not in known}))
    assert says in reason if says else reason == ""
    assert ("--regions" in reason) is says.startswith("not surely")


@pytest.mark.parametrize("number", [2, 10, *(pytest.param(n, marks=pytest.mark.validation) for n in (4, 9, 11, 13, 16, 17))])
def test_rendered_corridors_lie_where_the_mean_glint_is(number):
    """Seas in both bands, with the Sun inside the picture, at its border and beside it; half of the true pixels or more are shared."""
    sea = corridor_verdicts.rendered(number)
    found = segment(sea.frames.mean(axis=0), sea.frames.std(axis=0), sea.frames[0], radiance=True)
    assert found.found, found.reason
    assert corridor_verdicts.overlap(found.glint, sea.corridor) > 0.6
    inside = 0.0 <= found.axis_column < corridor_verdicts.COLUMNS
    assert inside or sea.place != "inside"


@pytest.mark.parametrize("half", [32, 64])
def test_the_error_of_the_sparkle_is_its_scatter(half):
    """Exponential texture, the same within a stripe and beside it: the difference of skewnesses scatters as its standard error says."""
    stripe, valid = np.abs(X - 128) < half, np.ones((ROWS, COLUMNS), bool)
    draws = (gaussian_filter(np.random.default_rng(seed).exponential(size=(ROWS, COLUMNS)), 1.0) for seed in range(40))
    found = [_sparkle(draw, stripe, valid, False) for draw in draws]
    drop = np.array([one.skewness_beside - one.skewness_within for one in found])
    errors = np.array([one.error for one in found])
    assert drop.std() == pytest.approx(np.sqrt(np.mean(errors**2)), rel=0.4)
    assert abs(drop.mean()) < 4.0 * drop.std() / np.sqrt(drop.size)


@pytest.mark.parametrize("width", [0.3, 0.4, 0.5])
@pytest.mark.parametrize("side", [1, -1])
def test_a_peak_that_fades_to_one_side_only_has_its_axis_near_the_border(width, side):
    """An axis at a fifth of the width, and a peak that has not fallen to 0.6 at the border: the next axis that may be one is at 0.125."""
    peak = np.exp(-0.5 * ((X / COLUMNS - 0.2) / width) ** 2)[:, ::side]
    _, axis = _peak(peak)
    assert axis / COLUMNS == pytest.approx(0.125 if side > 0 else 0.875, abs=0.01)
