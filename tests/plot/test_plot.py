"""Pictures, videos and the summary of known images."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from seaglint.base.brightness import Scale, scale_limits
from seaglint.base.errors import BackendError, DataError, StorageError
from seaglint.optics.band import Band
from seaglint.plot import preview, video
from seaglint.plot.preview import draw, write_picture
from seaglint.plot.scale import scale_of, tick_labels
from seaglint.plot.video import captioned, grey, video_available, write_video
from seaglint.store.layout import Layout
from seaglint.store.provenance import band_attributes
from seaglint.store.sequence_store import open_sequence, write_sequence
from seaglint.store.stored_images import GLINT_FACTOR, grid_of, summarise, to_temperature

BAND = Band.rectangular(3.5, 5.0)
SEA = 288.15
STORED = 1e-6  # relative; radiance is kept in float32
QUADRATURE = 0.01  # K; blackbody on the plots' own grid against that of the atmosphere's


def sequence(tmp_path: Path, frames, **attributes) -> xr.Dataset:
    frames = np.asarray(frames, dtype=np.float32)
    layout = Layout(
        azimuth_deg=np.linspace(172, 188, frames.shape[2]),
        elevation_deg=np.linspace(0, -7, frames.shape[1]),
        frames=range(len(frames)),
        frame_rate=25.0,
        band=BAND,
        attributes={"scenario": json.dumps({"sea": {"temperature_k": SEA}}), "seed": 1} | attributes,
    )
    return open_sequence(write_sequence(tmp_path / "run.zarr", layout, lambda number: {"radiance": frames[number]}))


def blackbody(temperature: float) -> float:
    return float(BAND.radiance(temperature, grid_of(BAND)))


def test_summary_of_blackbodies(tmp_path):
    frames = np.full((2, 4, 8), blackbody(SEA))
    frames[1, 0, 0] = blackbody(400.0)
    frames[0, 0, 0] = 0.9 * GLINT_FACTOR * blackbody(SEA)
    found = summarise(sequence(tmp_path, frames))
    assert found.frames == 2
    assert found.mean == pytest.approx(frames.mean(), rel=STORED)
    assert found.peak_apparent_temperature == pytest.approx(400.0, abs=QUADRATURE)
    assert found.glint_fraction == 1 / 64
    assert "µW cm⁻² sr⁻¹" in found.line
    assert "2 frames" in found.line


def test_summary_counts_what_is_not_finite_and_survives_it(tmp_path):
    frames = np.full((1, 4, 8), blackbody(SEA))
    frames[0, 1, :3] = np.nan
    found = summarise(sequence(tmp_path, frames))
    assert found.non_finite == 3
    assert found.mean_apparent_temperature == pytest.approx(SEA, abs=QUADRATURE)
    assert "3 pixels not finite" in found.line


def test_a_picture_of_nothing_is_refused(tmp_path):
    with pytest.raises(DataError, match="32 x 16 pixels without a finite value"):
        draw(sequence(tmp_path, np.full((1, 16, 32), np.nan)))


def test_pixels_of_a_single_row_are_as_high_as_they_are_wide(tmp_path):
    left, right, bottom, top = draw(sequence(tmp_path, np.ones((1, 1, 32)))).axes[0].images[0].get_extent()
    assert top - bottom == pytest.approx((right - left) / 32)


def test_apparent_temperature_of_the_plots_is_that_of_the_band():
    temperatures = np.array([220.0, 288.0, 600.0])
    fine = np.linspace(1995.0, 2900.0, 2000)
    np.testing.assert_allclose(to_temperature(BAND.radiance(temperatures, fine), BAND), temperatures, atol=QUADRATURE)


def test_scale_limits_ignore_sparkles_and_are_never_empty():
    values = np.linspace(1.0, 2.0, 10_000)
    values[0] = 1e6
    low, high = scale_limits(values)
    assert 1.0 <= low < high <= 2.0
    for flat in (np.full(9, 3.0), np.zeros(9), np.full(9, np.nan), 3.0 + 1e-7 * np.arange(9)):
        low, high = scale_limits(flat)
        assert low < high


def test_the_picture_has_angles_units_and_both_scales(tmp_path):
    figure = draw(sequence(tmp_path, np.random.default_rng(1).gamma(2, 1, (1, 16, 32))))
    labels = " ".join(axes.get_xlabel() + axes.get_ylabel() + axes.get_title() for axes in figure.axes)
    children = [child.get_ylabel() for axes in figure.axes for child in axes.child_axes]
    for word in ("azimuth [deg]", "elevation [deg]", "radiance", "apparent temperature", "W m⁻² sr⁻¹", "K"):
        assert word in labels
    assert "µW cm⁻² sr⁻¹" in children


def test_rows_are_shown_at_their_elevation(tmp_path):
    image = np.ones((1, 8, 16))
    image[0, 0] = 5.0  # the top row
    axes = draw(sequence(tmp_path, image)).axes[0]
    left, right, bottom, top = axes.images[0].get_extent()
    assert (top > 0.0 > bottom, left < 172.0, right > 188.0) == (True, True, True)
    assert float(np.asarray(axes.images[0].get_array())[0, 0]) == 5.0
    assert axes.images[0].origin == "upper"


@pytest.mark.parametrize(
    "shape", [(1, 1), (3, 400), *(pytest.param(s, marks=pytest.mark.validation) for s in ((1, 40), (40, 1), (64, 16)))]
)
def test_pictures_of_any_shape(tmp_path, shape):
    dataset = sequence(tmp_path, np.random.default_rng(1).gamma(2, 1, (1, *shape)))
    path = write_picture(dataset, tmp_path / "run.png")
    assert path.read_bytes().startswith(b"\x89PNG")


def test_a_map_without_time_is_drawn_too(tmp_path):
    values = xr.Dataset(
        {"radiance": (("y", "x"), np.ones((4, 8)))},
        {"azimuth": ("x", np.arange(8.0)), "elevation": ("y", -np.arange(4.0))},
        {**band_attributes(BAND), "scenario": "{}"},
    )
    assert write_picture(values, tmp_path / "mean.png").exists()
    assert summarise(values).frames == 1


def test_a_failed_picture_leaves_nothing(tmp_path, monkeypatch):
    dataset = sequence(tmp_path, np.ones((1, 4, 8)))

    class Full:
        def savefig(self, path, **_):
            Path(path).write_bytes(b"half")
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(preview, "draw", lambda dataset, scale: Full())
    with pytest.raises(StorageError, match="no room"):
        write_picture(dataset, tmp_path / "run.png")
    assert [path.name for path in tmp_path.iterdir()] == ["run.zarr"]


def test_grey_pictures_are_even_clipped_and_keep_their_pixels():
    image = np.array([[0.0, 1.0, 2.0], [0.5, np.nan, -1.0], [0.0, 0.0, 0.0]], dtype=np.float32)
    shown = grey(image, 0.0, 1.0)
    assert shown.shape[0] % 2 == 0 == shown.shape[1] % 2
    factor = shown.shape[0] // 3
    assert [int(v) for v in shown[0, [0, factor, 2 * factor]]] == [0, 255, 255]
    assert [int(v) for v in shown[factor, [0, factor, 2 * factor]]] == [128, 0, 0]


@pytest.mark.parametrize("shape", [(20, 9001), (1, 9001), (9001, 3)])
def test_wide_panoramas_are_averaged_down(shape):
    shown = grey(np.full(shape, 0.5, np.float32), 0.0, 1.0)
    assert max(shown.shape) <= 4096
    assert set(np.unique(shown)) == {128}


@pytest.mark.skipif(not video_available(), reason="PyAV is not installed")
def test_the_video_has_all_frames_at_their_rate(tmp_path):
    import av

    ramp = np.linspace(0.0, 1.0, 5)[:, None, None] * np.ones((5, 10, 21))
    path = write_video(sequence(tmp_path, ramp), tmp_path / "run.mp4")
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        assert float(stream.average_rate) == pytest.approx(25.0)
        levels = [frame.to_ndarray(format="gray").mean() for frame in container.decode(stream)]
    assert len(levels) == 5
    assert levels == sorted(levels)
    assert not (tmp_path / "run.mp4.partial").exists()


def test_without_pyav_a_video_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setattr(video, "video_available", lambda: False)
    with pytest.raises(BackendError, match=r"a video needs av.*pip install 'av>=14'"):
        write_video(sequence(tmp_path, np.ones((1, 4, 8))), tmp_path / "run.mp4")


def panorama(tmp_path, frames=1):
    """A corridor 30 times as bright as a sea of slow ripples, in a tenth of the columns."""
    x = np.arange(240)
    image = 1.0 + 0.05 * np.sin(x / 7.0) + 30.0 * (abs(x - 120) < 12)
    return sequence(tmp_path, np.repeat(np.repeat(image[None, None], 40, axis=1), frames, axis=0))


def test_glint_of_decades_leaves_the_sea_visible(tmp_path):
    dataset = panorama(tmp_path)
    figure = draw(dataset)
    for axes in (figure.axes[0], figure.axes[1]):
        image = axes.images[0]
        shown = np.asarray(image.norm(image.get_array()))[20]
        assert np.ptp(shown[:100]) > 0.1  # about ln(1 + 0.1/0.07) / ln(1 + 30/0.07) = 0.146, width from the median; on a linear scale 0.003
        assert shown[120] > 0.9
    linear = draw(dataset, "linear").axes[0].images[0]
    assert np.ptp(np.asarray(linear.norm(linear.get_array()))[20, :100]) < 0.005


def test_a_logarithmic_scale_is_even_in_decades_and_turns_back():
    scale = Scale(2.0, 1002.0, width=1.0)
    shares = scale.share(np.array([2.0, 11.0, 101.0, 1001.0]))
    assert np.diff(shares) == pytest.approx(np.log(10.0) / np.log(1001.0), rel=1e-12)
    np.testing.assert_allclose(scale.value(shares), [2.0, 11.0, 101.0, 1001.0])
    # low 0.2 %, middle of 1 to 2: half of the pixels within one width of the lower limit
    assert scale_of(np.linspace(1.0, 2.0, 10_001), kind="log").width == pytest.approx(0.498, rel=1e-3)
    assert not scale_of(np.linspace(1.0, 2.0, 10_001)).logarithmic


def test_the_scale_spans_horizon_and_sky_too():
    """Night in long wave: sea at 30, horizon at 45, cold sky at 5; each keeps a brightness of its own, none is cut off."""
    image = np.full((64, 32), 5.0)
    image[10:20] = 45.0
    image[20:] = 30.0 + np.linspace(0.0, 0.5, 32)
    found = scale_of(image)
    assert (found.low, found.high, found.logarithmic) == (5.0, 45.0, False)


@pytest.mark.parametrize("low", [-1.0, 0.0, 28.0, 285.0])
@pytest.mark.parametrize("span", [1e-3, 0.03, 1.0, 400.0])
def test_labels_of_a_bar_differ(low, span):
    for width in (span, 1e-3 * span):
        values = Scale(low, low + span, width).value(np.linspace(0.0, 1.0, 9))
        labels = tick_labels(values)
        assert len(set(labels)) == 9
        assert [float(label) for label in labels] == sorted(float(label) for label in labels)


def test_the_caption_has_time_bar_and_ends():
    picture = np.full((10, 600), 77, np.uint8)
    scale = Scale(1.0, 100.0, width=1.0)
    one, other = (captioned(picture, scale, "1 … 100 W m⁻² sr⁻¹", time) for time in (0.0, 1.25))
    assert one.shape == (66, 600)
    assert (one[:10] == 77).all()
    assert np.diff(one[10 + 14, 120:592].astype(int)).min() >= 0
    assert (one[10 + 14, 120], one[10 + 14, 591]) == (0, 255)
    assert (one != other).any()
    assert (one != other)[:, 120:].sum() == 0  # only the time differs
    assert captioned(picture[:, :20], scale, "", None).shape[1] % 2 == 0


@pytest.mark.skipif(not video_available(), reason="PyAV is not installed")
def test_the_video_shows_the_sea_beside_glint(tmp_path):
    import av

    path = write_video(panorama(tmp_path, frames=2), tmp_path / "run.mp4")
    with av.open(str(path)) as container:
        frame = next(container.decode(container.streams.video[0])).to_ndarray(format="gray").astype(float)
    assert frame.shape[0] == 40 * 4 + 56
    assert np.ptp(frame[80, :400]) > 30.0  # 0.17 of 255 grey levels are 44; on a linear scale below 1
