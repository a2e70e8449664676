"""What readers get between lattice points: the spectrum's variance, on average and at every place of a cell."""

import numpy as np
import pytest
from render_scenes import CUBIC, SLOPE, spline

from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic
from seaglint.sea.spectra import CombinedSpectrum, ElfouhailySpectrum, JonswapSpectrum
from seaglint.sea.tiles import longest_wave_number, plan_tiles, resolve_limit
from seaglint.sea.wave_field import WaveField, _turns, gain, read_share

SEA = ElfouhailySpectrum(10.0, np.radians(60.0))


@pytest.mark.parametrize("reading", ["linear", "cubic"])
def test_kept_share_is_the_variance_of_a_wave_that_is_read_at_random(reading):
    turn, place = np.linspace(0.0, np.pi, 9), np.linspace(0.0, 1.0, 400, endpoint=False)[:, None]
    points = np.arange(-2, 4)
    basis = CUBIC(np.clip(place - points, -2.0, 2.0)) if reading == "cubic" else np.maximum(1.0 - np.abs(place - points), 0.0)
    read = np.abs(basis @ np.exp(1j * points[:, None] * turn)) ** 2
    assert read.mean(axis=0) == pytest.approx(read_share(turn, reading), abs=1e-5)
    assert gain(turn, reading) ** 2 * read_share(turn, reading) == pytest.approx(np.ones(9), rel=1e-12)


def _systems():
    """Seas of one to three systems, drawn: winds of 2 to 20 m/s, wind seas of any period, and swell beside."""
    rng = np.random.default_rng(6)
    for _ in range(10):
        wind, to = rng.uniform(2.0, 20.0), rng.uniform(0.0, 2.0 * np.pi)
        own = ElfouhailySpectrum(wind, to)
        swell = JonswapSpectrum(rng.uniform(0.2, 2.0), rng.uniform(8.0, 14.0), to + rng.uniform(-2.0, 2.0), 5.0, rng.uniform(0.1, 0.5), to)
        yield wind, own
        yield wind, JonswapSpectrum(0.03 * wind, rng.uniform(0.35, 0.6) * wind + 0.5, to, 3.3, rng.uniform(0.3, 0.6), to)
        yield wind, CombinedSpectrum((swell, own))


def _place_variance(waves, tile, reading, places):
    """Ensemble variance of height, and of the slopes together, at places (u, v) of a cell: the waves through the readers' weights."""
    points = np.arange(-1, 3)
    energy = waves.variance + waves.opposite
    q, p = _turns(tile)

    def response(turn, place, kind):
        if kind == "linear":
            weights = np.maximum(1.0 - np.abs(place - points), 0.0)
        else:
            weights = (CUBIC if kind == "cubic" else SLOPE)(place - points)
        return np.abs(weights @ np.exp(1j * points[:, None] * turn)) ** 2

    out = []
    for u, v in places:
        share = {kind: (response(q, v, kind), response(p, u, kind)) for kind in ("linear", "cubic", "slope")}
        height = energy * np.outer(gain(q, reading) ** 2 * share[reading][0], gain(p, reading) ** 2 * share[reading][1])
        steep = np.outer(share["cubic"][0], share["slope"][1]) + np.outer(share["slope"][0], share["cubic"][1])
        steep *= energy * np.outer(gain(q, "cubic") ** 2, gain(p, "cubic") ** 2) / tile.spacing**2
        out.append((height.sum(), steep.sum()))
    return np.array(out)


def test_the_variance_of_heights_and_slopes_is_the_spectrums_at_every_place_of_a_cell():
    """Of drawn seas, of their coarser levels too: 1 % on average, 3 % at nodes, edges and centres."""
    side = np.arange(8) / 8.0
    places = [(u, v) for u in side for v in side]
    checked = 0
    for wind, sea in _systems():
        model = cox_munk_anisotropic(wind, sea.wind_to_azimuth)
        cut = min(np.pi, resolve_limit(sea, model))
        if cut <= 1.2 * longest_wave_number(sea):
            continue
        field = WaveField.create(sea, plan_tiles(sea, 2.0 * np.pi / cut, 256), 1)
        assert field.height_variance == pytest.approx(sea.height_variance(cut), rel=0.01)
        assert field.height_excess < 0.03
        seas = [field, *([field.halved()] if 0.5 * field.tiles[0].k_max > 1.5 * longest_wave_number(sea) else [])]
        for held in seas:
            parts = zip(held._lattices, held.tiles, held.readings, strict=True)
            found, steep = sum(_place_variance(*part, places) for part in parts), sum(held.resolved_mss())
            assert found[:, 0].mean() == pytest.approx(held.height_variance, rel=1e-3)
            assert np.abs(found[:, 0] - held.height_variance).max() < 0.03 * field.height_variance
            assert np.abs(found[:, 1] - steep).max() < 0.03 * model.mss
            assert found[:, 1].mean() == pytest.approx(steep, abs=1e-3 * model.mss)
            checked += 1
    assert checked > 20


def test_heights_and_slopes_read_from_splines_are_the_sea_itself():
    """Between the points, against the same waves on a lattice of four times as many: all but the shortest waves' last few per cent."""
    field = WaveField.create(SEA, plan_tiles(SEA, 2.0, 128)[:1], 4)
    tile, fine = field.tiles[0], field.refined(4).surfaces(3.0)[0].astype(float)
    places = np.arange(4 * tile.n) * 0.25 * tile.spacing
    u, v = np.meshgrid(places, places)
    c, s = np.cos(tile.rotation), np.sin(tile.rotation)
    found = spline(field.splines(3.0)[0].astype(float), tile.spacing, tile.rotation, c * u - s * v, s * u + c * v)
    for component, share in enumerate((5e-5, 5e-3, 5e-3)):
        off = np.mean((found[..., component] - fine[..., component]) ** 2) / np.mean(fine[..., component] ** 2)
        assert off < share, component
