import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from seaglint.base.errors import DataError
from seaglint.clutter.segmentation import otsu_threshold, segment

ROWS, COLUMNS = 192, 256
Y, X = np.mgrid[:ROWS, :COLUMNS]


def noise(seed, sigma=0.0):
    values = np.random.default_rng(seed).standard_normal((ROWS, COLUMNS))
    return gaussian_filter(values, sigma) * (2.0 * np.sqrt(np.pi) * sigma if sigma else 1.0)


def corridor(seed, centre=120.0, width=30.0):
    """Sky of 30 rows, sea brighter downwards, glints whose rate is Gaussian in azimuth."""
    sea = 8.0 + Y / 100.0 + 0.5 * noise(seed, 1.0)
    glints = 10.0 * np.exp(-(((X - centre) / width) ** 2)) * np.random.default_rng(seed + 1).exponential(size=sea.shape)
    picture = sea + gaussian_filter(glints, (0.5, 1.5))
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
    assert "shore" in found.reason
    assert found.separability > 0.69  # two classes of brightness there are


def test_a_shore_in_a_sequence_is_no_glint():
    found = segment(shore("side", 5, 2.0, 1.0), 0.3 + 0.02 * noise(3) + 0.4 * (X > 150))
    assert not found.found


def test_the_border_of_a_gaussian_corridor_is_as_steep_as_its_density():
    """Without noise: brightness at distances of half to two smoothings (2 px to 8 px) inside and outside, over that of the core."""
    width, smoothing = 60.0, 192 / 24
    found = segment(10.0 * np.exp(-(((X - 128.0) / width) ** 2)) + 1e-6 * noise(1))
    border = np.abs(X[0] - 128)[found.glint[100]].max() + 0.5
    profile = lambda x: 10.0 * np.exp(-((x / width) ** 2))  # noqa: E731
    near = np.linspace(smoothing / 4, smoothing, 99)
    core, rest = np.linspace(0.0, border / 2, 99), np.linspace((border + 128.0) / 2, 128.0, 99)
    expected = (profile(border - near) - profile(border + near)).mean() / (profile(core).mean() - profile(rest).mean())
    # The border is looked for again and rounded to whole pixels.
    assert found.border_step == pytest.approx(expected, rel=0.1)


def test_doubt_is_said_of_what_passes_narrowly():
    assert segment(corridor(1)).doubt == ""
    flat = segment(0.35 * corridor(1) + 3.0 * noise(9, 2.0) / 4.0 + 2e-2 * X)
    assert flat.found, flat.reason
    assert flat.doubt, flat


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
    assert np.isnan(found.separability)
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


def test_measured_corridor(data_dir):
    """The bright patch below the middle of the picture, and neither sky, ship on the horizon, nor the dark foreground."""
    import matplotlib.image

    picture = matplotlib.image.imread(data_dir / "imagery" / "Misc_66.png")[..., 0].astype(float)
    found = segment(picture)
    assert found.found, found.reason
    assert found.glint[175, 200]
    assert not found.glint[:90].any()
    assert not found.glint[:, :50].any()
    assert not found.glint[245:].any()
    assert 0.2 < found.glint.mean() < 0.5
    assert "separability 0.71" in found.doubt
    assert found.border_step < 0.3


@pytest.mark.parametrize(("name", "corridor_there"), [("Misc_107", True), ("Misc_26", False)])
def test_other_measured_scenes(data_dir, name, corridor_there):
    import matplotlib.image

    found = segment(matplotlib.image.imread(data_dir / "imagery" / f"{name}.png")[..., 0].astype(float))
    assert found.found is corridor_there
    assert bool(found.doubt) is corridor_there  # a thin margin: texture 1.57 of the background's


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
    assert found.separability == pytest.approx(whole.separability, abs=0.03)
    assert found.contrast == pytest.approx(whole.contrast, rel=0.1)


def in_noise(strength):
    return strength * corridor(5) + 0.8 * noise(6, 1.0) + 0.4 * noise(7, 2.0)


def as_wide_as(width):
    glint = np.exp(-(((X - 128.0) / width) ** 2))
    return 10.0 * glint + 0.3 * noise(1) * (1.0 + 2.0 * glint)


@pytest.mark.parametrize(
    ("picture", "ends", "says", "number", "limit"),
    [
        (in_noise, (0.09, 0.16), "no two classes", "separability", 0.69),
        (in_noise, (0.2, 0.32), "standard deviations above the background", "contrast", 2.0),
        (in_noise, (0.45, 0.6), "sharp border", "border_step", 0.44),
        (in_noise, (0.6, 0.9), "at the border", "border_step", 0.38),
        (as_wide_as, (120.0, 145.0), "contrast", "contrast", 3.0),
        (as_wide_as, (70.0, 100.0), "texture", "texture_ratio", 1.6),
        (as_wide_as, (150.0, 175.0), "background's texture", "texture_ratio", 1.2),
    ],
)
def test_verdicts_change_at_the_limits_of_the_method(picture, ends, says, number, limit):
    """Halving the way between two pictures of other verdicts, six times: there the number passes its limit."""

    def said(of):
        return says in of.reason + of.doubt

    low, high = ends
    first, last = segment(picture(low)), segment(picture(high))
    assert said(first) is not said(last)
    for _ in range(6):
        middle = 0.5 * (low + high)
        found = segment(picture(middle))
        low, high, first, last = (middle, high, found, last) if said(found) is said(first) else (low, middle, first, found)
    assert np.mean([getattr(first, number), getattr(last, number)]) == pytest.approx(limit, rel=0.02)
