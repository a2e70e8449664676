"""Regions, their courses, pictures over time and profiles: the numbers are those of plain NumPy."""

from __future__ import annotations

import io
import json
import zipfile

import numpy as np
import pytest

from seaglint.base.errors import BackendError, DataError
from seaglint.viewer.frame_source import open_source
from seaglint.viewer.jobs import Jobs, StoppedError
from seaglint.viewer.library import Library
from seaglint.viewer.over_time import courses, profile, project, statistics
from seaglint.viewer.picture import Show
from seaglint.viewer.regions import MOST_CORNERS, PictureRegion, of_csv, of_file, of_imagej, to_csv, to_imagej

from .conftest import COLUMNS, FRAMES, ROWS, radiance

REGIONS = [
    PictureRegion.rectangle(5, 4, 20, 10),
    PictureRegion("ellipse", (20.0, 10.0, 30.0, 25.0), "glint, middle"),
    PictureRegion("polygon", (2.5, 3.0, 60.0, 8.5, 30.0, 45.0), "corridor"),
]


def nothing(done: int, total: int) -> None:
    pass


@pytest.fixture
def gaps(tmp_path):
    """A recording with pixels without a value, one of them in every frame."""
    values = np.random.default_rng(3).normal(280.0, 2.0, (9, 12, 15))
    values[2, 3:6, 4:9] = values[:, 0, 0] = np.nan
    np.save(tmp_path / "gaps.npy", values)
    return tmp_path / "gaps.npy", values


def test_rectangle_is_the_slice_of_its_pixels():
    expected = np.zeros((ROWS, COLUMNS), bool)
    expected[4:14, 5:25] = True
    assert np.array_equal(REGIONS[0].mask(ROWS, COLUMNS), expected)


def test_ellipse_and_polygon_have_the_areas_of_their_shapes():
    ellipse = PictureRegion("ellipse", (10.0, 20.0, 300.0, 200.0)).mask(300, 400)
    assert ellipse.sum() == pytest.approx(np.pi * 150 * 100, rel=2e-3)  # the edge's pixels count wholly or not
    rows, columns = np.nonzero(ellipse)
    assert (columns.mean(), rows.mean()) == pytest.approx((159.5, 119.5), abs=0.01)
    assert (columns.min(), columns.max(), rows.min(), rows.max()) == (10, 309, 20, 219)
    triangle = PictureRegion("polygon", (10.0, 10.0, 310.0, 10.0, 10.0, 210.0)).mask(300, 400)
    assert triangle.sum() == pytest.approx(300 * 200 / 2, rel=5e-3)
    assert np.array_equal(PictureRegion("polygon", (5, 4, 25, 4, 25, 14, 5, 14)).mask(ROWS, COLUMNS), REGIONS[0].mask(ROWS, COLUMNS))


def star(corners: int) -> PictureRegion:
    """A star about the middle of the picture, of as many corners as a region drawn freely by hand."""
    angle, radius = np.linspace(0.0, 2 * np.pi, corners, endpoint=False), np.where(np.arange(corners) % 2, 20.0, 14.0)
    points = np.stack([32.0 + radius * np.cos(angle), 24.0 + radius * np.sin(angle)], axis=1)
    return PictureRegion("polygon", tuple(points.round(4).ravel().tolist()), "star")


def test_polygon_of_many_corners_is_what_matplotlib_fills():
    path = pytest.importorskip("matplotlib.path")
    region = star(3000)
    centres = np.stack(np.meshgrid(np.arange(COLUMNS) + 0.5, np.arange(ROWS) + 0.5), axis=-1).reshape(-1, 2)
    corners = np.reshape(region.numbers, (-1, 2))
    expected = path.Path(np.vstack([corners, corners[:1]])).contains_points(centres).reshape(ROWS, COLUMNS)
    assert np.array_equal(region.mask(ROWS, COLUMNS), expected)
    assert np.array_equal(region.mask(ROWS, COLUMNS), of_csv(to_csv([region]))[0].mask(ROWS, COLUMNS))
    with pytest.raises(DataError, match="regions with 30000 corners in all: give at most 20000"):
        of_file(to_csv([star(3000)] * 10).encode())


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("circle 1 2 3 4", "allowed are rectangle, ellipse, polygon"),
        ("rectangle 1 2 3", "give left, top, width and height"),
        ("ellipse 1 2 0 4", "the last two above 0"),
        ("polygon 1 2 3 4", "3 to 10000 corners"),
        ("polygon " + "1 2 " * (MOST_CORNERS + 1), "3 to 10000 corners"),
        ("rectangle a b c d", "such as 'ellipse 10 8 36 33'"),
        ("rectangle 1 2 inf 4", "give finite numbers"),
        ("", "allowed are rectangle"),
    ],
)
def test_texts_that_are_no_regions_are_refused(text, reason):
    with pytest.raises(DataError, match=reason):
        PictureRegion.of_text(text)


def test_statistics_leave_out_pixels_without_a_value(gaps):
    path, values = gaps
    regions = [PictureRegion.rectangle(2, 1, 9, 8), PictureRegion.rectangle(0, 0, 1, 1), PictureRegion.rectangle(90, 0, 5, 5)]
    inside, empty, outside = statistics(open_source(path), 2, regions)
    expected = values[2, 1:9, 2:11]
    assert (inside["pixels"], inside["values"]) == (72, np.isfinite(expected).sum())
    numpys = {"mean": np.nanmean, "std": np.nanstd, "minimum": np.nanmin, "maximum": np.nanmax}
    assert {key: inside[key] for key in numpys} == pytest.approx({key: of(expected) for key, of in numpys.items()}, rel=1e-12)
    assert empty["reason"] == "none of the 1 pixels has a value"
    assert "outside the image of 12 rows" in outside["reason"]


def test_courses_are_the_means_of_every_frame(store, gaps):
    told = courses(open_source(store), REGIONS, "radiance", nothing)
    masks = [region.mask(ROWS, COLUMNS) for region in REGIONS]
    expected = [[radiance(n)[mask].astype(float).mean() for n in range(FRAMES)] for mask in masks]
    assert np.allclose(told["means"], expected, rtol=1e-12)
    assert told["times_s"] == pytest.approx([n / 25.0 for n in range(FRAMES)])
    assert courses(open_source(gaps[0]), [PictureRegion.rectangle(4, 3, 3, 3)], None, nothing)["means"][0][2] is None


def test_a_region_outside_the_picture_leaves_the_means_of_the_others(store):
    outside = PictureRegion.rectangle(1000, 0, 5, 5)
    told = courses(open_source(store), [REGIONS[0], outside, REGIONS[1]], "radiance", nothing)
    alone = courses(open_source(store), REGIONS[:2], "radiance", nothing)
    assert [told["means"][0], told["means"][2]] == alone["means"]
    assert [reason is not None for reason in told["left_out"]] == [False, True, False]
    assert f"outside the image of {ROWS} rows" in told["left_out"][1]
    with pytest.raises(DataError, match="outside the image"):
        courses(open_source(store), [outside], "radiance", nothing)


def test_pictures_over_time_are_those_of_numpy_and_become_layers(gaps):
    path, values = gaps
    source = open_source(path)
    assert project(source, None, nothing)["layers"] == ["value_mean", "value_deviation", "value_maximum"]
    with np.errstate(all="ignore"), pytest.warns(RuntimeWarning):
        expected = np.nanmean(values, 0), np.nanstd(values, 0), np.nanmax(values, 0)
    for name, image in zip(("mean", "deviation", "maximum"), expected, strict=True):
        assert np.allclose(source.read(4, f"value_{name}"), image, rtol=1e-10, equal_nan=True)
    assert source.layer("value_mean").label == "value, mean over 9 frames"
    with pytest.raises(DataError, match="is computed over time already"):
        project(source, "value_mean", nothing)


def test_pictures_over_time_vanish_with_the_file_they_are_of(gaps):
    path, values = gaps
    source = open_source(path)
    project(source, None, nothing)
    before = Show(source, "value_mean").key
    np.save(path, values[:5])
    assert list(source.opened.layers) == ["value"]
    project(source, None, nothing)
    assert Show(source, "value_mean").key != before
    assert np.allclose(source.read(0, "value_mean")[6:], values[:5, 6:].mean(0), rtol=1e-12)


def test_celsius_stands_beside_kelvin_and_deviations_stay_kelvin(store):
    source = open_source(store)
    names = list(source.opened.layers)
    assert names.index("apparent_temperature_celsius") == names.index("apparent_temperature") + 1
    celsius = source.read(3, "apparent_temperature_celsius")
    assert np.allclose(celsius + 273.15, source.read(3, "apparent_temperature"), atol=1e-4)
    project(source, "apparent_temperature_celsius", nothing)
    units = [source.layer(f"apparent_temperature_celsius_{word}").unit for word in ("mean", "deviation", "maximum")]
    assert units == ["°C", "K", "°C"]


def test_profile_interpolates_between_centres_and_keeps_gaps_where_they_are():
    image = np.add.outer(10.0 * np.arange(6), np.arange(8)).astype(np.float32)
    distance, columns, rows, values = profile(image, (1, 2, 6, 2))
    assert np.array_equal(values, image[2, 1:7])
    assert distance == pytest.approx(np.arange(6.0))
    distance, columns, rows, values = profile(image, (0, 0, 7, 5))
    assert np.allclose(values, 10 * rows + columns)  # a plane is its own interpolation
    assert distance[-1] == pytest.approx(np.hypot(7, 5))
    image[2, 4] = np.nan
    assert np.isnan(profile(image, (1, 2, 6, 2))[3]).tolist() == [False, False, False, True, False, False]
    assert np.isfinite(profile(image, (1, 3, 6, 3))[3]).all()
    assert profile(np.ones((1, 1)), (0, 0, 0, 0))[3].tolist() == [1.0, 1.0]
    with pytest.raises(DataError, match="reaches outside the 8 x 6 pixels"):
        profile(image, (0, 0, 8, 0))


def test_csv_gives_the_regions_back():
    assert of_csv(to_csv(REGIONS)) == REGIONS
    with pytest.raises(DataError, match="first line must be 'name,shape,numbers'"):
        of_csv("a,b\n1,2\n")
    with pytest.raises(DataError, match="line 3: has 2 cells"):
        of_csv("name,shape,numbers\n\nx,rectangle\n")
    with pytest.raises(DataError, match=r"mine\.csv, line 2: region 'circle': allowed are"):
        of_file(b"name,shape,numbers\nx,circle,1 2 3 4\n", "mine.csv")
    for content in (b"\xff\xfe", b"name,shape,numbers\n"):
        with pytest.raises(DataError, match=r"neither CSV nor a file of ImageJ|0 regions"):
            of_file(content)


def test_imagej_gives_the_regions_back():
    roifile = pytest.importorskip("roifile", reason="roifile is not installed")
    content = to_imagej(REGIONS)
    assert [(one.shape, one.numbers) for one in of_file(content)] == [(one.shape, one.numbers) for one in REGIONS]
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        single = archive.read(archive.namelist()[1])
    assert of_imagej(single)[0].name == "glint_ middle"
    line = roifile.ImagejRoi(roitype=roifile.ROI_TYPE.LINE, name="edge", x1=1, y1=1, x2=5, y2=5).tobytes()
    with pytest.raises(DataError, match="'edge': is a line; allowed are rectangles, ovals and polygons"):
        of_imagej(line)
    with pytest.raises(DataError, match="is damaged"):
        of_file(b"PK\x03\x04 nonsense")
    with pytest.raises(DataError, match="cannot be read"):
        of_file(b"Iout\x00")


def test_imagej_without_its_library_is_one_line(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "roifile", None)
    with pytest.raises(BackendError, match="a file of ImageJ needs roifile, which is not installed; pip install 'roifile"):
        to_imagej(REGIONS)


def test_cancelled_jobs_end_at_their_next_step():
    jobs = Jobs()

    def work(progress):
        while True:
            progress(1, 2)

    number = jobs.start(work)
    jobs.get(number).cancelled = True
    assert jobs.get(number).finished.wait(60.0)
    assert jobs.get(number).error == "cancelled"
    with pytest.raises(StoppedError):
        jobs.get(number).progress(1, 2)


def test_a_run_is_listed_once(store, half, tmp_path, monkeypatch):
    folder = half.parent
    monkeypatch.chdir(folder)
    names = [entry["name"] for entry in Library(["half.zarr"], folder=folder).listed()]
    assert names == ["half.zarr"]  # by a relative path, by the folder, and as half.zarr.partial
    for n in range(3):
        np.save(folder / f"part{n}.npy", radiance(n))
    (folder / "again.npy").symlink_to(folder / "part0.npy")
    listed = [entry["name"] for entry in Library(["part1.npy"], folder=folder).listed()]
    assert len(listed) == 4
    assert len(set(listed)) == 4


def test_answers_of_the_server(store):
    pytest.importorskip("starlette", reason="the viewer's extra is not installed")
    from seaglint.viewer.server import make_app

    from .test_server import ask

    app = make_app(Library([store]))
    body = json.dumps({"regions": [[one.text, one.name] for one in REGIONS]})
    told = ask(app, "/api/regions/0/4?layer=radiance", "POST", content=body).json()
    assert told["regions"] == statistics(open_source(store), 4, REGIONS, "radiance")
    saved = ask(app, "/api/save/regions/csv", "POST", content=body)
    assert saved.headers["content-disposition"] == 'attachment; filename="regions.csv"'
    assert ask(app, "/api/load/regions", "POST", content=saved.content).json()["regions"] == json.loads(body)["regions"]
    for path, content, reason in [
        ("/api/regions/0/4", "{}", "regions of a request: give"),
        ("/api/regions/0/4", '{"regions": []}', "0 regions: give 1 to 100"),
        ("/api/regions/0/99", body, "frame 99"),
        ("/api/save/regions/exe", body, "allowed are csv, imagej"),
        ("/api/exceedances/0/0?sigma=3&filter=magic", "", "choose one of laplacian"),
        ("/api/exceedances/0/0?sigma=-3", "", "give standard deviations from 0 to 100"),
        ("/api/region/0/0", body, "3 regions are given; mark one on the picture"),
        ("/api/region/0/0", "", "regions of a request: give"),
        ("/api/trace/0?row=99&column=0", "", "the image has 48 rows and 64 columns"),
        ("/api/load/regions", "x", "the first line must be"),
    ]:
        refused = ask(app, path, "POST", content=content)
        assert refused.status_code == 409
        assert reason in refused.json()["error"]
    line = ask(app, "/api/profile/0/4?layer=radiance&column=3&row=7&to_column=20&to_row=7").json()
    assert line["values"] == radiance(4)[7, 3:21].astype(float).tolist()
    curve = ask(app, "/api/exceedances/0/4?sigma=2&filter=none", "POST").json()
    at = curve["curve"]["sigma"].index(2.0)
    assert curve["curve"]["rate"][at] == curve["rate"]
    assert curve["curve"]["gaussian"][at] == curve["gaussian_rate"]
