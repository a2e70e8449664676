"""How often waves hide low objects, against lines of sight over profiles of the whole spectrum: no lattices, no levels of detail."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.imaging.sweep.walk import sight_lines
from seaglint.objects.drawing.crests import Span, in_sight
from seaglint.objects.drawing.launch_bodies import sea_before
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import prepare_sequence

EYE = 10.0
HEIGHTS = np.array([0.5, 1.0, 2.0, 3.0])
"""Heights of points over the mean sea [m]."""

STEP = 0.125
"""Distance of the profiles' points [m]; shorter waves have some millimetres of height."""


def along(spectrum, azimuth, k):
    """Spectrum of the heights along a line, both ways of travel together [m3/rad]: the plane spectrum without its part across the line."""
    angles = (np.arange(721) + 0.5) * (np.pi / 721) - 0.5 * np.pi
    out = np.zeros(k.size)
    high = spectrum.wavenumber_range[1]
    for angle in angles:
        whole = k / np.cos(angle)
        inside = whole < high
        held = np.where(inside, whole, high)
        spread = spectrum.spreading(held, azimuth + angle) + spectrum.spreading(held, azimuth + angle + np.pi)
        out += np.where(inside, spectrum.omnidirectional(held) * spread / np.cos(angle), 0.0) * (np.pi / 721)
    return out


def hidden_by_profiles(spectrum, azimuth, ranges, count, seed=0):
    """Shares (ranges, heights) of points hidden by Gaussian profiles along the line of sight over a round Earth."""
    n = 1 << int(np.ceil(np.log2(2.0 * ranges[-1] / STEP)))
    k = 2.0 * np.pi * np.arange(1, n // 2) / (n * STEP)
    # few nodes on a logarithmic axis: the law is smooth
    node = np.geomspace(k[0], k[-1], 500)
    law = np.exp(np.interp(np.log(k), np.log(node), np.log(np.maximum(along(spectrum, azimuth, node), 1e-30))))
    deviation = np.sqrt(law * k[0])
    assert np.sum(law) * k[0] == pytest.approx(spectrum.height_variance(), rel=0.01)
    rng, hidden = np.random.default_rng(seed), np.zeros((len(ranges), HEIGHTS.size))
    arcs = STEP * np.arange(1, int(ranges[-1] / STEP) + 1)
    drop = arcs**2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    for _ in range(count):
        amplitudes = np.zeros(n // 2 + 1, complex)
        amplitudes[1:-1] = deviation * (rng.standard_normal(k.size) + 1j * rng.standard_normal(k.size))
        z = np.fft.irfft(amplitudes, norm="forward")[: arcs.size] / 2.0
        highest = np.maximum.accumulate((z - EYE - drop) / arcs)
        for i, far in enumerate(ranges):
            at = int(far / STEP) - 1
            own = (HEIGHTS - EYE - drop[at]) / arcs[at]
            hidden[i] += own < highest[at]
    return hidden / count


def hidden_as_drawn(wind, ranges, seeds, turn_deg=0.0):
    """The same shares of the renderer's seas and levels of detail, and their standard errors."""
    sensor = {"pixels": [128, 64], "fov_deg": [8.0, 4.0], "elevation_deg": -0.2, "azimuth_deg": 0.0, "height_m": EYE}
    run = prepare_sequence(parse_scenario({"sensor": sensor, "wind": {"speed_m_s": wind, "from_deg": 180.0 + turn_deg}}))
    rise, fall = sight_lines(np.asarray(ranges, float), EYE)
    found = np.zeros((seeds, len(ranges), HEIGHTS.size))
    azimuths = np.radians(np.linspace(-4.0, 4.0, 7))
    for seed in range(seeds):
        scene = run.scene.reseeded(1000 + seed)
        sea = scene.sea(scene.pose, 0.0)
        for i, far in enumerate(ranges):
            tangents = rise[i] * HEIGHTS - fall[i]
            for azimuth in azimuths:
                span = Span((azimuth - 1e-9, azimuth + 1e-9), (far - 0.05, far + 0.05), float(tangents[0]), float(tangents[-1]))
                crest = sea_before(sea.levels, sea.surface, EYE, span)
                found[seed, i] += [not in_sight(crest, azimuth, far, h, t) for h, t in zip(HEIGHTS, tangents, strict=True)]
    found /= azimuths.size
    return found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(seeds), run.scene.waves.spectrum


def compared(wind, ranges, seeds, profiles, turn_deg=0.0):
    """Both shares and the standard error of their difference; printed."""
    drawn, error, spectrum = hidden_as_drawn(wind, ranges, seeds, turn_deg)
    counted = hidden_by_profiles(spectrum, 0.0, ranges, profiles)
    error = np.hypot(error, np.sqrt(np.maximum(counted * (1.0 - counted), 0.25 / profiles) / profiles))
    for i, far in enumerate(ranges):
        row = "; ".join(f"{h:g} m {d:.3f} {c:.3f} ({e:.3f})" for h, d, c, e in zip(HEIGHTS, drawn[i], counted[i], error[i], strict=True))
        print(f"{wind:g} m/s, {far:g} m: {row}")
    return drawn, counted, error


@pytest.mark.parametrize("wind", [10.0])
def test_waves_hide_low_points_as_often_as_those_of_the_spectrum(wind):
    drawn, counted, error = compared(wind, [1000.0, 3000.0], 40, 600)
    assert 0.2 < counted[1, 1] < 0.9
    assert np.all(np.abs(drawn - counted) < 0.02 + 3.0 * error)


@pytest.mark.validation
@pytest.mark.parametrize("turn_deg", [0.0, 70.0])
@pytest.mark.parametrize("wind", [3.0, 5.0, 8.0, 10.0, 15.0])
def test_waves_hide_low_points_as_often_as_those_of_the_spectrum_at_all_winds(wind, turn_deg):
    drawn, counted, error = compared(wind, [300.0, 1000.0, 3000.0, 6000.0, 10_000.0], 200, 3000, turn_deg)
    assert np.all(np.abs(drawn - counted) < 0.02 + 2.5 * error)
