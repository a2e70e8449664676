"""Pictures of clutter show the numbers that were counted, in their units; the report holds all of them and asks for nothing."""

from __future__ import annotations

import base64
import errno
import json
import re
from html import unescape
from html.parser import HTMLParser

import numpy as np
import pytest
import scipy.stats

from seaglint.analysis import Analysis, AnalysisOptions, analyze
from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError, StorageError
from seaglint.clutter.segmentation import segment
from seaglint.detection.interface import UserDetector
from seaglint.plot.analysis_report import number, report, write_report
from seaglint.plot.clutter_pictures import (
    PICTURES,
    draw_exceedances,
    draw_histograms,
    draw_memory,
    draw_rates,
    draw_regions,
    draw_slices,
    histogram_edges,
    unit_of,
)
from seaglint.plot.figures_and_pages import png

# Warnings of drawing are errors; garbage of other tests, collected meanwhile, is none of it.
pytestmark = pytest.mark.filterwarnings("error", "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
FRAMES, SIDE, RATE = 40, 64, 20.0
SHAPE = 4.0
MASK = np.zeros((SIDE, SIDE), np.bool_)
MASK[8:56, 12:40] = True


def recording(frames, **more) -> Recording:
    frames = np.asarray(frames)
    return Recording("made here", *frames.shape, read_block=lambda start, stop: frames[start:stop], **more)


@pytest.fixture(autouse=True)
def _coarse(monkeypatch):
    """Coarse pictures, for speed."""
    monkeypatch.setattr("seaglint.plot.figures_and_pages._DOTS_PER_INCH", 40)


@pytest.fixture(scope="module")
def sequence() -> Analysis:
    """Independent gamma values, two regions alike, a detector that is the picture itself."""
    frames = np.random.default_rng(3).gamma(SHAPE, 0.5, (FRAMES, SIDE, SIDE)).astype(np.float32)
    detector = UserDetector(lambda block: block, "the <picture> itself")
    given = recording(frames, frame_rate=RATE, units="W m-2 sr-1")
    return analyze(given, AnalysisOptions(mask=MASK, detectors=(detector,), border="keep"))


@pytest.fixture(scope="module")
def single() -> Analysis:
    """One frame of whole numbers, rate and units not known."""
    return analyze(recording(np.random.default_rng(4).poisson(40.0, (1, SIDE, SIDE))))


@pytest.fixture(scope="module")
def constant() -> Analysis:
    return analyze(recording(np.full((10, SIDE, SIDE), 7.0), frame_rate=RATE))


def words(figure) -> str:
    return " ".join(text.get_text() for axes in figure.axes for text in axes.texts)


def panel(figure, title: str):
    return next(axes for axes in figure.axes if axes.get_title().startswith(title))


def line(axes, label: str):
    return next(drawn for drawn in axes.lines if str(drawn.get_label()).startswith(label))


# Rates


@pytest.mark.parametrize("threshold", [3.0, 3.5])
def test_rate_curve_passes_through_the_counted_rates(sequence, threshold):
    x, y = line(panel(draw_rates(sequence), "all"), "laplacian").get_data()
    above = int((_laplacian_z(sequence) > threshold).sum())
    # One count: a value that single precision puts on the threshold itself.
    assert y[np.argmin(abs(x - threshold))] * FRAMES * SIDE**2 == pytest.approx(above, abs=1.01)


def _laplacian_z(analysis: Analysis) -> np.ndarray:
    frames = analysis.recording.read(0, FRAMES).astype(np.float64)
    padded = np.pad(frames, ((0, 0), (1, 1), (1, 1)), mode="edge")
    out = 4 * frames - padded[:, :-2, 1:-1] - padded[:, 2:, 1:-1] - padded[:, 1:-1, :-2] - padded[:, 1:-1, 2:]
    return (out - out.mean(axis=(1, 2), keepdims=True)) / out.std(axis=(1, 2), keepdims=True)


def test_gaussian_tail_and_the_level_of_one_exceedance(sequence):
    axes = panel(draw_rates(sequence), "all")
    x, y = line(axes, "Gaussian").get_data()
    assert np.interp(3.0, x, np.log(y)) == pytest.approx(np.log(0.001349898), abs=0.01)  # table of the normal distribution; between nodes
    levels = [drawn.get_ydata()[0] for drawn in axes.lines if len(set(drawn.get_ydata())) == 1 and drawn.get_linestyle() == ":"]
    assert levels == [pytest.approx(1 / (FRAMES * SIDE**2), rel=1e-12)]
    assert "one in 163\u202f840 pixels" in words(draw_rates(sequence))


def test_detectors_have_their_own_curve(sequence):
    assert line(panel(draw_rates(sequence), "glint"), "the <picture> itself, measured") is not None


def test_intervals_are_those_of_the_results(sequence):
    entry = sequence.as_dict()["regions"]["all"]["false_alarms"][0]
    ends = [tuple(drawn.get_ydata()) for drawn in panel(draw_rates(sequence), "all").lines if drawn.get_marker() == "_"]
    assert (entry["rate_low"], entry["rate_high"]) in ends


# Distributions


def test_histogram_is_a_density_and_the_gamma_fit_lies_on_it(sequence):
    axes = panel(draw_histograms(sequence), "glint")
    stairs = axes.patches[0].get_data()
    assert np.nansum(stairs.values * np.diff(stairs.edges)) == pytest.approx(1.0, rel=1e-9)
    x, y = line(axes, "gamma").get_data()
    middle = (x > 0.5) & (x < 5.0)
    # 5 %: the fit of some 50 000 values has 1 % in its shape, which the density feels threefold in the tail.
    np.testing.assert_allclose(y[middle], scipy.stats.gamma.pdf(x[middle], SHAPE, scale=0.5), rtol=0.05)


def test_legends_tell_distance_and_level(sequence):
    labels = [str(drawn.get_label()) for drawn in panel(draw_histograms(sequence), "all").lines]
    assert len(labels) == 4  # a K distribution has at least the contrast of an exponential one
    assert all(re.fullmatch(r"(gamma|lognormal|Weibull|Gaussian): KS 0\.\d{3}, p [<=] [\d.e-]+", label) for label in labels), labels
    assert next(label for label in labels if label.startswith("Gaussian")).split(", ")[1].startswith("p <")


@pytest.mark.parametrize("whole", [[3, 5, 9, 200], list(range(256)) * 20, [7, 7, 7, 8]])
def test_cells_of_whole_numbers_hold_as_many_each(whole):
    edges = histogram_edges(np.array(whole, float))
    assert np.all(np.diff(edges) == np.diff(edges)[0])
    assert np.all(edges % 1.0 == 0.5)
    assert np.histogram(whole, edges)[0].sum() == len(whole)


def test_cells_are_few_whatever_the_tail():
    values = np.random.default_rng(1).pareto(1.0, 10_000) + 0.25
    edges = histogram_edges(values)
    assert len(edges) <= 151
    assert np.histogram(values, edges)[0].sum() == values.size


# Time and space


def test_slices_show_every_exceedance_at_its_time(sequence):
    figure = draw_slices(sequence)
    axes = next(a for a in figure.axes if a.get_title() == f"row {sequence.slices.row}: above 3 σ")
    segments = np.array(axes.collections[0].get_segments())
    above = sequence.slices.along_row[2]
    assert len(segments) == above.sum()
    frame, column = np.nonzero(above)
    np.testing.assert_allclose(segments[:, :, 0].mean(axis=1), column)
    np.testing.assert_allclose(segments[:, :, 1].mean(axis=1), frame / RATE, atol=1e-12)
    assert axes.get_ylim() == pytest.approx(((FRAMES - 0.5) / RATE, -0.5 / RATE))
    assert axes.get_ylabel() == "time [s]"


def test_exceedances_start_at_their_rate_and_step_by_a_frame(sequence):
    left, right = draw_exceedances(sequence).axes
    x, y = line(left, "all, 3 σ").get_data()
    assert x[1] == pytest.approx(1 / RATE)
    assert y[0] == pytest.approx((_laplacian_z(sequence) > 3.0).mean(), abs=2 / (FRAMES * SIDE**2))
    assert line(right, "all, 3 σ").get_ydata()[0] == pytest.approx(1.0)
    assert "1/e" in words(draw_exceedances(sequence))


def test_white_clutter_has_no_memory_and_a_flat_spectrum(sequence):
    figure = draw_memory(sequence)
    variance = SHAPE * 0.25
    space = line(panel(figure, "brightness in space"), "all, x").get_ydata()
    assert abs(space[1]) < 5 / np.sqrt(sequence.regions["all"].moments.count / 4)
    density = line(panel(figure, "spectrum, mean"), "all").get_ydata()
    # Two-sided density of white values is their variance; the rings' scatter is below 5 % from tens of squares.
    np.testing.assert_allclose(density[5:], variance, rtol=0.1)
    assert "W m⁻² sr⁻¹" in panel(figure, "spectrum, mean").get_ylabel()


def test_outline_of_the_corridor_encloses_its_pixels(sequence):
    paths = draw_regions(sequence).axes[0].collections[0].get_paths()
    box = paths[0].get_extents()
    assert (box.x0, box.x1, box.y0, box.y1) == pytest.approx((11.5, 39.5, 7.5, 55.5))


# What cannot be told


@pytest.mark.parametrize("draw", [draw_exceedances, draw_slices, draw_memory])
def test_a_single_frame_says_so_where_time_is_needed(single, draw):
    assert "a single frame" in words(draw(single))


@pytest.mark.parametrize("name", list(PICTURES))
def test_a_constant_recording_draws_and_says_so(constant, name):
    figure = PICTURES[name].draw(constant)
    said = {"histograms": "all values are equal", "rates": "no pixel", "exceedances": "no exceedances", "memory": "no pixel changes"}
    assert said.get(name, "") in words(figure)


def test_unknown_units_and_rate_are_told(single, sequence):
    assert "unit not known" in draw_histograms(single).axes[0].get_xlabel()
    bare = analyze(recording(sequence.recording.read(0, 12)[:, :12, :12]))
    assert draw_exceedances(bare).axes[0].get_xlabel() == "lag [frames]"


@pytest.mark.parametrize(
    ("given", "shown"), [("W m-2 sr-1", "W m⁻² sr⁻¹"), ("K", "K"), ("counts 2", "counts 2"), ("cm2", "cm²"), (None, "unit"), ("", "unit")]
)
def test_powers_in_units_are_raised(given, shown):
    assert unit_of(given) == shown


# The report


class _Outside(HTMLParser):
    """What a page would load, and whether it runs anything."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.images: list[str] = []
        self.links: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        if tag not in ("meta", "img"):
            self.open.append(tag)
        for name, value in attrs:
            if name == "src":
                self.images.append(value)
            elif name in ("href", "srcset", "action", "data") or name.startswith("on"):
                self.links.append(value)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def parsed(text: str) -> _Outside:
    page = _Outside()
    page.feed(text)
    page.close()
    return page


def test_report_is_self_contained_and_complete(sequence):
    steps: list[tuple[int, int]] = []
    text = report(sequence, lambda done, total: steps.append((done, total)))
    assert steps[-1] == (len(PICTURES), len(PICTURES))
    page = parsed(text)
    assert page.open == []
    assert page.links == []
    assert not {"script", "link", "iframe", "object"} & set(page.tags)
    assert "url(" not in text
    assert "@import" not in text
    assert len(page.images) == len(PICTURES)
    for image in page.images:
        kind, _, data = image.partition(",")
        assert kind == "data:image/png;base64"
        assert base64.b64decode(data, validate=True).startswith(b"\x89PNG")
    assert "<picture>" not in text
    for told in ("the &lt;picture&gt; itself", "W m⁻² sr⁻¹", "20 Hz", "mask given"):
        assert told in text
    inside = re.search(r"<pre>\n?(.*?)</pre>", text, re.S)
    assert inside is not None
    assert json.loads(unescape(inside[1])) == json.loads(json.dumps(sequence.as_dict()))
    entry = sequence.as_dict()["regions"]["glint"]["false_alarms"][1]
    assert f"<td>{number(entry['rate'])}</td><td>{number(entry['rate_low'])} … {number(entry['rate_high'])}</td>" in text
    assert text.index("How it was done") > text.index("Distributions") > text.index("False alarms")


@pytest.mark.parametrize("name", ["rates", pytest.param("slices", marks=pytest.mark.validation)])
def test_equal_numbers_give_equal_pictures(single, name):
    assert png(PICTURES[name].draw(single)) == png(PICTURES[name].draw(single))


def test_report_has_notes_on_top_and_equal_bytes(single, tmp_path, monkeypatch):
    monkeypatch.setattr("seaglint.plot.analysis_report.png", lambda figure: b"")
    paths = [write_report(single, tmp_path / name) for name in ("a.html", "b.html")]
    first, second = (path.read_bytes() for path in paths)
    assert first == second
    text = first.decode("utf-8")
    for note in single.notes:
        assert note in text[: text.index("<h2>")]
    assert not re.search(r"20\d\d-\d\d-\d\d", text)  # no date
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.html", "b.html"]


def test_report_refuses_what_exists_and_replaces_when_told(constant, tmp_path, monkeypatch):
    monkeypatch.setattr("seaglint.plot.analysis_report.png", lambda figure: b"")
    path = tmp_path / "out.html"
    path.write_text("mine")
    with pytest.raises(DataError, match="exists already"):
        write_report(constant, path)
    assert path.read_text() == "mine"
    assert write_report(constant, path, overwrite=True) == path
    assert "all pixels of all frames are equal" in path.read_text("utf-8")


def test_report_leaves_nothing_behind_on_a_full_disk(constant, tmp_path, monkeypatch):
    from seaglint.plot import analysis_report as module

    monkeypatch.setattr(module, "report", lambda *_: "text")

    def full(self, *_, **__):
        self.touch()
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(StorageError, match="no room left"):
        write_report(constant, tmp_path / "out.html")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("value", "shown"),
    [(None, "–"), (0.00135, "0.00135"), (2.3263e-4, "0.000233"), (3.05e-6, "3.05e−6"), (1234567, "1\u202f234\u202f567"), (-0.5, "−0.5")],
)
def test_numbers_in_tables(value, shown):
    assert number(value) == shown


@pytest.mark.validation
def test_tables_of_many_columns_may_wrap_and_say_what_is_saturated(sequence):
    """At a width of 1240 pixels the last columns were beyond the edge: numbers kept to one line and padding was wide."""
    text = report(sequence)
    tables = re.findall(r'<div class="([^"]*)"><table>\n<thead>(.*?)</thead>', text, re.DOTALL)
    assert len(tables) >= 8
    assert {("wide" in kind) == (head.count("<th") >= 9) for kind, head in tables} == {True}
    assert sum("wide" in kind for kind, _ in tables) >= 5
    assert ".table.wide td { white-space: normal;" in text
    assert ".table { overflow-x: auto;" in text
    assert "<th>saturated [%]</th>" in text


def test_smooth_rows_on_top_are_not_called_sky_alone(sequence):
    """Sea beyond the waves that a pixel resolves is as smooth as the sky."""
    import dataclasses

    rng = np.random.default_rng(6)
    image = rng.normal(size=(SIDE, SIDE))
    top = np.arange(SIDE)[:, None] < 10
    found = dataclasses.replace(segment(image), sky=np.broadcast_to(top, image.shape))
    legend = draw_regions(dataclasses.replace(sequence, segmentation=found)).axes[0].get_legend()
    labels = [text.get_text() for text in legend.get_texts()]
    assert "smooth rows on top (sky, far sea), in neither region" in labels
