"""Levels of soundings: pressures that repeat, air without humidity, descents and several ascents in one file."""

import numpy as np
import pytest
from sounding_files import ascent, save

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import AirProfile, sounding_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.base.errors import DataError
from seaglint.formats.soundings.sounding import Sounding, continuations, percent, read_sounding
from seaglint.optics.band import Band, apparent_temperature

NAMES = "height_m,pressure_hpa,temperature_k,relative_humidity_percent\n"


def table(folder, truth, *, digits=(0, 1, 1, 1), holes=(), order=None, name="air.csv"):
    """Our CSV of an ascent, rounded, with holes in the humidity."""
    rows = [
        f"{z:.{digits[0]}f},{p:.{digits[1]}f},{t:.{digits[2]}f},{'' if i in holes else f'{u:.{digits[3]}f}'}"
        for i, (z, p, t, u) in enumerate(zip(truth.z, truth.p, truth.t, truth.u, strict=True))
    ]
    rows = rows if order is None else [rows[i] for i in order]
    return save(folder, name, NAMES + "\n".join(rows) + "\n")


def second_by_second(top, step=5.0):
    return ascent("us-standard-1976", np.arange(5.0, top, step))


@pytest.mark.parametrize("top", [25e3, 27e3, 30e3, 33e3])
@pytest.mark.parametrize("step", [5.0, 10.0])
def test_an_ascent_of_one_second_keeps_every_level(tmp_path, top, step):
    """Pressures of 0.1 hPa repeat aloft; the truth has all digits."""
    truth = second_by_second(top, step)
    found = read_sounding(table(tmp_path, truth))
    assert found.given == truth.z.size
    assert not found.reported
    assert any("none is left out" in note for note in found.notes)
    np.testing.assert_allclose(found.height[1:], truth.z)
    assert np.all(np.diff(found.pressure) < 0.0)
    assert np.max(np.abs(found.pressure[1:] - truth.p)) < 0.051  # the rounding of the file
    np.testing.assert_allclose(found.pressure[1:], np.round(truth.p, 1), atol=0.0501)
    np.testing.assert_allclose(np.median(np.abs(found.pressure[1:] / truth.p - 1.0)), 0.0, atol=1e-3)
    profile = found.profile("us-standard-1976")
    assert profile.water_above(5.0) == pytest.approx(truth.water, rel=0.005)


def test_pressures_that_repeat_are_nearer_to_the_truth_than_the_file(tmp_path):
    truth = second_by_second(33e3)
    found = read_sounding(table(tmp_path, truth))
    high = truth.z > 28e3
    ours, theirs = np.abs(found.pressure[1:] - truth.p)[high], np.abs(np.round(truth.p, 1) - truth.p)[high]
    assert ours.mean() < 0.35 * theirs.mean()


def test_ten_thousand_levels_with_heights_that_repeat_are_averaged_and_counted(tmp_path):
    truth = ascent("us-standard-1976", np.linspace(5.0, 4000.0, 10_000))
    found = read_sounding(table(tmp_path, truth, digits=(0, 2, 2, 1)))
    assert found.given == 3996
    assert any(note.startswith("6004 of 10000 levels repeat a height and are averaged") for note in found.notes)
    np.testing.assert_allclose(found.temperature[1:], np.interp(found.height[1:], truth.z, truth.t), atol=0.01)


def test_a_level_given_twice_counts_once(tmp_path):
    truth = ascent()
    order = np.sort(np.r_[np.arange(truth.z.size), [3, 9, 9]])
    found = read_sounding(table(tmp_path, truth, order=order))
    assert found.given == truth.z.size
    assert any(note.startswith("3 of 67 levels repeat a height") for note in found.notes)


def test_a_balloon_that_falls_back_loses_those_levels_and_they_are_counted(tmp_path):
    truth = ascent("us-standard-1976", np.arange(5.0, 12e3, 50.0))
    order = np.r_[np.arange(100), np.arange(94, 99), np.arange(100, truth.z.size)]  # 250 m down and up again
    found = read_sounding(table(tmp_path, truth, order=order))
    assert found.given == truth.z.size
    assert any(text.startswith(f"5 of {order.size} levels fall back") for text in found.reported)


def test_small_reversals_are_put_in_the_order_of_heights(tmp_path):
    truth = ascent("us-standard-1976", np.arange(5.0, 20e3, 5.0))
    order = np.arange(truth.z.size)
    order[[3400, 3401]] = 3401, 3400  # at 17 km 5 m are less than 0.1 hPa
    found = read_sounding(table(tmp_path, truth, order=order))
    assert found.given == truth.z.size
    assert not found.reported
    assert any("out of order" in note for note in found.notes)


TWO = {
    "an ascent and its descent": (lambda n: np.r_[np.arange(n), np.arange(n)[-2::-1]], "falls to .* and rises again to .* give one of"),
    "a descent and an ascent": (lambda n: np.r_[np.arange(n - 1, -1, -1), np.arange(1, n)], "falls to .* and rises again|two soundings"),
    "two ascents": (lambda n: np.r_[np.arange(n), np.arange(n)], "rises again from .* hPa at level 65 of 128; is it one ascent"),
    "two descents": (lambda n: np.r_[np.arange(n)[::-1], np.arange(n)[::-1]], "two soundings in one file"),
    "three ascents": (lambda n: np.tile(np.arange(n), 3), "two soundings in one file"),
    "no order at all": (lambda n: np.random.default_rng(3).permutation(n), "is it one ascent"),
}  # fmt: skip


@pytest.mark.parametrize("what", TWO)
def test_more_than_one_ascent_is_refused_in_one_line(tmp_path, what):
    truth = ascent()
    order, told = TWO[what]
    with pytest.raises(DataError, match=told) as caught:
        read_sounding(table(tmp_path, truth, order=order(truth.z.size)))
    assert "\n" not in str(caught.value)
    assert "air.csv" in str(caught.value)


BAND, GRID = Band.rectangular(8.0, 12.0), np.arange(830.0, 1251.0, 5.0)


def sky(profile: AirProfile, height: float, zenith_deg: float) -> float:
    """Apparent temperature of the sky in 8-12 um [K]."""
    emitted = AirSums(profile, HazeWeather(wind=7.0, wind_24h=7.0), GRID).along(height, np.radians(zenith_deg)).emitted
    return float(apparent_temperature(float(emitted @ BAND.weights(GRID)), BAND, GRID))


def of_truth(truth, model):
    """Profile of the whole ascent, from the sea."""
    z, p, t, u = (
        np.append(first, row)
        for first, row in zip((0.0, 1012.0, truth.t[0], truth.u[0]), (truth.z, truth.p, truth.t, truth.u), strict=True)
    )
    return sounding_profile("truth", model, z, p, t, u)


@pytest.mark.parametrize(("height", "zenith"), [(20.0, 60.0), (20.0, 78.0), (10e3, 78.0), (10e3, 45.0)])
def test_half_the_levels_without_dew_point_change_the_sky_by_little(tmp_path, height, zenith):
    """52 of 116 levels of a real list; the others keep their temperatures, up to 23 km."""
    truth = ascent("midlatitude-summer", np.r_[5.0, np.linspace(100.0, 23e3, 115)], warmer=-6.0)
    holes = set(range(64, 116))
    found = read_sounding(table(tmp_path, truth, digits=(1, 2, 2, 2), holes=holes))
    assert found.given == 116
    assert found.top == pytest.approx(23e3, abs=1.0)
    assert found.humidity_top == pytest.approx(truth.z[63], abs=1.0)
    assert sky(found.profile("midlatitude-summer"), height, zenith) == pytest.approx(
        sky(of_truth(truth, "midlatitude-summer"), height, zenith), abs=0.1
    )


@pytest.mark.parametrize(
    ("of", "model", "within"),
    [
        ("midlatitude-summer", "midlatitude-summer", 1.0),
        ("tropical", "midlatitude-summer", 2.5),
        ("midlatitude-winter", "midlatitude-summer", 2.5),
        ("subarctic-winter", "midlatitude-summer", 2.5),
        ("midlatitude-winter", "subarctic-winter", 2.5),
    ],
)
def test_two_dew_points_near_the_ground_go_on_by_relative_humidity(tmp_path, of, model, within):
    """The model's mixing ratio would miss the low sky by up to 8 K in these airs, air without vapour by 20 K and more."""
    truth = ascent(of)
    found = read_sounding(table(tmp_path, truth, digits=(1, 2, 2, 2), holes=set(range(2, truth.z.size))))
    given, whole = sky(found.profile(model), 20.0, 78.0), sky(of_truth(truth, model), 20.0, 78.0)
    assert given == pytest.approx(whole, abs=within)
    (part,) = continuations(found, found.profile(model), model)
    assert part.share > 0.85
    assert part.text.startswith(f"humidity ends at 0.1 km; above it is that of {model}, 9")


@pytest.mark.parametrize("first", [85.0, 5.0])
def test_continued_humidity_is_joined_and_never_above_saturation(tmp_path, first):
    truth = ascent("tropical", wetter=first / 60.0)
    found = read_sounding(table(tmp_path, truth, digits=(1, 2, 2, 2), holes=set(range(12, truth.z.size))))
    whole = found.humidity("tropical")
    assert np.isnan(found.relative_humidity[13:]).all()
    assert np.isfinite(whole).all()
    assert whole.max() <= 100.0
    assert whole[13] == pytest.approx(whole[12], rel=0.25)  # 150 m higher


def test_gaps_in_humidity_are_interpolated_in_height(tmp_path):
    truth = ascent("us-standard-1976", np.arange(100.0, 20_001.0, 100.0))
    holes = {i for i in range(1, 150) if i % 3}
    found = read_sounding(table(tmp_path, truth, digits=(1, 3, 3, 3), holes=holes))
    np.testing.assert_allclose(found.relative_humidity[1:], truth.u, atol=1.0)
    assert any(text.startswith(f"{len(holes)} of 200 levels lack humidity between others") for text in found.reported)


def test_humidity_that_begins_aloft_goes_on_below(tmp_path):
    truth = ascent()
    found = read_sounding(table(tmp_path, truth, digits=(1, 2, 2, 2), holes={0, 1, 2}))
    np.testing.assert_allclose(found.relative_humidity[:4], truth.u[3], atol=0.01)
    assert any(text.startswith(f"humidity begins at {truth.z[3]:.0f} m") for text in found.notes)


def test_no_humidity_at_all_is_refused(tmp_path):
    truth = ascent()
    with pytest.raises(DataError, match="has 0 levels with pressure, temperature and humidity"):
        read_sounding(table(tmp_path, truth, holes=set(range(truth.z.size))))


def test_nothing_is_said_where_nothing_is_continued(tmp_path):
    truth = second_by_second(25e3, 100.0)
    found = read_sounding(table(tmp_path, truth))
    assert continuations(found, found.profile("tropical"), "tropical", 20.0) == ()
    (part,) = continuations(found, found.profile("tropical"), "tropical", 30e3)
    assert "ends at 24.9 km, below the sensor at 30.0 km; above it is the air of tropical" in part.text


def test_the_water_of_a_station_is_that_above_it(tmp_path):
    truth = ascent("midlatitude-summer", np.r_[345.0, np.arange(400.0, 24_000.0, 100.0)], 1013.0)
    found: Sounding = read_sounding(table(tmp_path, truth, digits=(1, 3, 3, 3)))
    profile = found.profile("midlatitude-summer")
    assert profile.water_above(345.0) == pytest.approx(truth.water, rel=0.002)
    assert profile.precipitable_water > 1.1 * truth.water
    assert profile.water_above(200.0) == pytest.approx(0.5 * (profile.water_above(100.0) + profile.water_above(300.0)), rel=0.01)
    assert profile.water_above(100e3) == 0.0


def test_shares_have_two_figures():
    assert [percent(share) for share in (0.1432, 0.93, 1.0, 2.34e-5)] == ["14 %", "93 %", "100 %", "0.0023 %"]


@pytest.mark.parametrize("height", [300.0, 500.0, 800.0])
def test_a_launch_that_was_given_up_is_no_part_of_the_ascent(tmp_path, height):
    """However short it was: the air near the ground would be that of the other launch."""
    truth = ascent("us-standard-1976", np.arange(5.0, 12e3, 5.0))
    first = np.flatnonzero(truth.z < height)
    with pytest.raises(DataError, match=r"rises again from .* at level \d+ of \d+; is it one ascent"):
        read_sounding(table(tmp_path, truth, order=np.r_[first, np.arange(truth.z.size)]))


def test_levels_without_one_humidity_have_another_of_the_file(tmp_path):
    truth = ascent("us-standard-1976", np.arange(5.0, 12e3, 100.0))
    low = truth.z < 5000.0
    lines = ["height_m,pressure_hpa,temperature_k,dew point [K],rh (%)"]
    for z, p, t, dew, u, below in zip(truth.z, truth.p, truth.t, truth.dew, truth.u, low, strict=True):
        lines.append(f"{z:.1f},{p:.3f},{t:.3f}," + (f"{dew:.3f}," if below else f",{u:.3f}"))
    (tmp_path / "two.csv").write_text("\n".join(lines) + "\n")
    found = read_sounding(tmp_path / "two.csv")
    np.testing.assert_allclose(found.relative_humidity[1:], truth.u, atol=0.1)
    assert any("have the humidity of another column" in note for note in found.notes)


def test_the_share_of_vapour_below_the_first_humidity_is_reported(tmp_path):
    """It is most of the water where humidity begins high."""
    from seaglint.formats.soundings.sounding import continuations

    truth = ascent("us-standard-1976", np.arange(5.0, 12e3, 100.0))
    lines = ["height_m,pressure_hpa,temperature_k,rh (%)"]
    lines += [
        f"{z:.1f},{p:.3f},{t:.3f}," + (f"{u:.3f}" if z > 5700.0 else "")
        for z, p, t, u in zip(truth.z, truth.p, truth.t, truth.u, strict=True)
    ]
    (tmp_path / "a.csv").write_text("\n".join(lines) + "\n")
    found = read_sounding(tmp_path / "a.csv")
    profile = found.profile("us-standard-1976")
    (part, *_) = continuations(found, profile, "us-standard-1976")
    assert part.below
    assert part.share == pytest.approx(1.0 - profile.water_above(5705.0) / profile.precipitable_water)
    assert part.share > 0.8
    assert "humidity begins at 5705 m; below it is the relative humidity of that level, 9" in part.text


def test_humidity_aloft_joins_that_of_the_model_within_its_scale_height():
    """Half of the model's humidity where it ends: the factor 0.5 ** exp(-z / 2 km) above, in the troposphere."""
    from seaglint.air.profile.air_profile import continued_humidity, model_levels, saturation_density

    z = np.arange(0.0, 8001.0, 250.0)
    pressure, kelvin, vapour, _ = model_levels("us-standard-1976", z)
    model = 100.0 * vapour / saturation_density(kelvin)
    given = np.where(z <= 2000.0, 0.5 * model, np.nan)
    found = continued_humidity("us-standard-1976", z, pressure, kelvin, given)
    factor = np.where(z <= 2000.0, 0.5, 0.5 ** np.exp(-(z - 2000.0) / 2000.0))
    np.testing.assert_allclose(found / model, factor, rtol=1e-3)
