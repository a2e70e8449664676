"""``seaglint texture``: from a recording to a model, a loop, a comparison and a picture of the sea."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr

import seaglint as sg
from seaglint.base.errors import DataError
from seaglint.formats.recording import open_recording
from seaglint.store.texture_file import read_texture, write_texture
from seaglint.studies.study_requests import FitRequest
from seaglint.studies.texture.texture_sequences import fit
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.gaussian_texture import GaussianTexture
from seaglint.textures.marginals import Marginal

TRUE = GaussianTexture(GaussMarkov(((1, 0, 1), (0, 0, 1), (0, 1, 0)), (0.2, 0.1, 0.1), 1.0), Marginal("gamma", 1.0, 0.5, 1.5))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory):
    """Twenty frames cut from a gamma texture that travels one column a frame."""
    path = tmp_path_factory.mktemp("data") / "sea.npy"
    np.save(path, TRUE.sample((32, 80, 80), 3)[:20, :64, :64])
    return path


@pytest.fixture(scope="module")
def model(recording):
    """A texture fitted to it."""
    found = fit(open_recording(recording, frame_rate=50.0, units="W m-2 sr-1"), FitRequest(tails="gamma"))
    return write_texture(found.stored, recording.with_name("model.json"))


def test_fit_sample_compare(seaglint, recording, tmp_path) -> None:
    model = tmp_path / "model.json"
    told = "--frame-rate", 50, "--units", "W m-2 sr-1"
    answer = seaglint("texture", "fit", recording, "--tails", "gamma", *told, "-o", model)
    assert answer.code == 0, answer.err
    assert "a Gaussian field, 3.5 sigma" in answer.out
    held = json.loads(model.read_text())
    assert held["version"] == 2
    assert sorted(map(tuple, held["model"]["offsets"])) == [(0, 0, 1), (0, 1, 0), (1, 0, 1)]
    assert held["model"]["marginal"]["shape"] == pytest.approx(1.5, rel=0.15)
    assert held["quality"]["held_out"]["log_pseudo_likelihood"] > held["quality"]["held_out"]["independent_pixels"]
    gaussian = held["quality"]["gaussian_filtered_rates"][1]["second_over_first"]
    assert gaussian < 0.2  # off by 5 and more, and the gamma field within 1.5
    assert 1.0 / 1.5 < held["quality"]["filtered_rates"][1]["second_over_first"] < 1.5

    loop = tmp_path / "loop.zarr"
    assert seaglint("texture", "sample", model, "--size", "48x40", "--frames", 16, "--seed", 1, "-o", loop).code == 0
    dataset = xr.open_dataset(loop, engine="zarr", consolidated=False, decode_times=False)
    assert dataset.texture.shape == (16, 40, 48)
    assert dataset.attrs["loop_frames"] == 16
    assert (dataset.texture.attrs["units"], dataset.attrs["frame_rate_hz"]) == ("W m-2 sr-1", 50.0)
    frames = dataset.texture.to_numpy()
    assert frames == pytest.approx(read_texture(model).texture.sample((16, 40, 48), 1))
    # From the last frame to the first the texture goes on as between any others.
    z = frames - frames.mean()
    steps = [(np.roll(z[k], 1, axis=1) * z[(k + 1) % 16]).mean() / z.var() for k in range(16)]
    assert steps[15] == pytest.approx(np.mean(steps[:15]), abs=float(4.0 * np.std(steps[:15])))
    opened = open_recording(loop)  # what analyze reads
    assert (opened.frames, opened.frame_rate, opened.units) == (16, 50.0, "W m-2 sr-1")

    report = tmp_path / "compare.html"
    answer = seaglint("texture", "compare", recording, loop, "--report", report, "--json")
    assert answer.code == 0, answer.err
    assert json.loads(answer.out)["filtered_rates"][0]["first_over_gaussian"] > 3.0
    assert "Side by side" in report.read_text()
    answer = seaglint("texture", "compare", recording, model)
    assert "log pseudo-likelihood per pixel of the data" in answer.out


@pytest.mark.validation
def test_loops_are_exported_and_told(seaglint, model, tmp_path) -> None:
    loop = tmp_path / "loop.zarr"
    assert seaglint("texture", "sample", model, "--size", "32x32", "--frames", 8, "-o", loop).code == 0
    assert seaglint("export", loop, "-o", tmp_path / "loop.npy").code == 0
    assert np.load(tmp_path / "loop.npy").shape == (8, 32, 32)
    told = seaglint("info", "--all", loop)
    assert told.code == 0, told.err
    assert "loop_frames" in told.out
    video = pytest.importorskip("av") and seaglint(
        "texture", "sample", model, "--size", "32x32", "--frames", 8, "-o", tmp_path / "loop.mp4"
    )
    assert video.code == 0, video.err
    assert (tmp_path / "loop.mp4").stat().st_size > 1000


@pytest.mark.validation
def test_an_autobinomial_texture_keeps_the_histogram(seaglint, recording, tmp_path) -> None:
    image = tmp_path / "image.npy"
    np.save(image, np.load(recording)[0])
    model = tmp_path / "model.json"
    arguments = ("--model", "autobinomial", "--levels", 8, "--order", 1, "--method", "pseudo-likelihood", "-o", model)
    answer = seaglint("texture", "fit", image, *arguments)
    assert answer.code == 0, answer.err
    assert "autobinomial field of 8 levels" in answer.out
    texture = read_texture(model).texture
    values, counts = np.unique(texture.sample((1, 64, 64), 5), return_counts=True)
    assert counts / 4096 == pytest.approx([share for share in texture.histogram if share > 0.0])
    assert values == pytest.approx([v for v, s in zip(texture.grey.values, texture.histogram, strict=True) if s > 0.0])
    refused = seaglint("texture", "sample", model, "--frames", 4, "--size", "64x64", "-o", tmp_path / "a.zarr")
    assert (refused.code, "has no time" in refused.err) == (2, True)


def test_models_of_another_version_and_damaged_ones_are_named(seaglint, model, tmp_path) -> None:
    held = json.loads(model.read_text())
    for change, told in (
        ({"version": 9}, "has version 9, this seaglint"),
        ({"format": "else"}, "is no texture"),
        ({"model": {**held["model"], "kind": "cubist"}}, "allowed are gauss-markov and autobinomial"),
        ({"model": {"kind": "gauss-markov"}}, "fit it anew"),
    ):
        other = tmp_path / "other.json"
        other.write_text(json.dumps({**held, **change}))
        answer = seaglint("texture", "sample", other, "-o", tmp_path / "x.zarr")
        assert answer.code == 2
        assert told in answer.err
        assert not (tmp_path / "x.zarr").exists()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--size", "512"), "COLUMNSxROWS"),
        (("--size", "2x2", "--frames", "8"), "too small for neighbours"),
        (("--size", "64x64", "--frames", "2"), "give at least 3"),
        (("--size", "100000x100000", "--frames", "8"), "give fewer frames or a smaller size"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(seaglint, model, tmp_path, arguments, told) -> None:
    answer = seaglint("texture", "sample", model, *arguments, "-o", tmp_path / "x.zarr")
    assert answer.code == 2
    assert told in answer.err


def test_bad_data_are_refused_in_a_line(seaglint, tmp_path) -> None:
    ramp = np.random.default_rng(1).normal(size=(80, 80)) + np.linspace(0.0, 9.0, 80)
    for name, image, told in (
        ("constant", np.ones((40, 40)), "all values are 1"),
        ("mask", np.eye(40), "two values only"),
        ("small", np.random.default_rng(1).normal(size=(10, 40)), "too few for a texture"),
        ("ramp", ramp, "is not stationary"),
    ):
        np.save(tmp_path / f"{name}.npy", image)
        answer = seaglint("texture", "fit", tmp_path / f"{name}.npy", "-o", tmp_path / "m.json")
        assert (answer.code, told in answer.err) == (2, True), answer.err
    mask = np.random.default_rng(2).integers(0, 2, (40, 40)).astype(float)
    np.save(tmp_path / "mask.npy", mask)  # what the error advises
    two = "--model", "autobinomial", "--levels", 2, "--order", 1, "-o", tmp_path / "two.json"
    assert seaglint("texture", "fit", tmp_path / "mask.npy", *two).code == 0
    assert set(np.unique(read_texture(tmp_path / "two.json").texture.sample((1, 32, 32), 1))) == {0.0, 1.0}
    assert seaglint("texture", "fit", tmp_path / "ramp.npy", "--detrend", "-o", tmp_path / "m.json").code == 0


SEA = GaussianTexture(GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.24, 0.22), 1.0), Marginal("gaussian", 40.0, 3.0)).sample((1, 96, 96), 5)[0]


def spoilt() -> np.ndarray:
    """Return a picture with an even row, a boat, and a missing pixel."""
    image = SEA.copy()
    image[40] = 12.0
    image[60:63, 20:26] += 90.0
    image[5, 7] = np.nan
    return image


def test_what_is_no_sea_is_left_out_and_said(seaglint, tmp_path) -> None:
    np.save(tmp_path / "whole.npy", SEA)
    np.save(tmp_path / "spoilt.npy", spoilt())
    whole, model = tmp_path / "whole.json", tmp_path / "spoilt.json"
    answer = seaglint("texture", "fit", tmp_path / "whole.npy", "-o", whole)
    assert "left out" not in answer.out
    answer = seaglint("texture", "fit", tmp_path / "spoilt.npy", "-o", model)
    assert answer.code == 0, answer.err
    for told in ("note: 1 values (0.0109 %) are left out", "note: 1 row left out (40)", "rows 58:65, columns 18:28"):
        assert told in answer.out
    clean, found = (json.loads(path.read_text()) for path in (whole, model))
    assert "left_out" not in clean["source"]
    assert found["source"]["left_out"] == {"missing": 1, "rows": 96, "objects": 70}
    assert found["fit"]["pixels"] == 96 * 96 - 96 - 1 - 70
    assert found["model"]["offsets"] == clean["model"]["offsets"]
    assert found["model"]["coefficients"] == pytest.approx(clean["model"]["coefficients"], abs=0.02)
    assert found["model"]["marginal"]["scale"] == pytest.approx(clean["model"]["marginal"]["scale"], rel=0.03)

    answer = seaglint("texture", "fit", tmp_path / "spoilt.npy", "--keep-defects", "--any-region", "-o", tmp_path / "kept.json")
    assert answer.code == 0, answer.err
    kept = json.loads((tmp_path / "kept.json").read_text())
    assert kept["source"]["left_out"] == {"missing": 1}
    assert kept["model"]["marginal"]["scale"] > 1.2 * clean["model"]["marginal"]["scale"]


def test_a_mask_leaves_pixels_out(seaglint, tmp_path) -> None:
    np.save(tmp_path / "sea.npy", SEA)
    mask = np.zeros(SEA.shape, bool)
    mask[:, :20] = True
    model = tmp_path / "m.json"
    np.save(tmp_path / "mask.npy", mask)
    answer = seaglint("texture", "fit", tmp_path / "sea.npy", "--mask", tmp_path / "mask.npy", "-o", model)
    assert answer.code == 0, answer.err
    assert "note: 1920 pixels (20.8 %) left out: the mask" in answer.out
    assert json.loads(model.read_text())["source"]["left_out"] == {"mask": 1920}
    # An image of the whole picture serves for a region of it.
    from PIL import Image

    Image.fromarray((255 * mask).astype(np.uint8)).save(tmp_path / "mask.png")
    arguments = "--mask", tmp_path / "mask.png", "--region", "10:90,10:90", "--overwrite", "-o", model
    assert seaglint("texture", "fit", tmp_path / "sea.npy", *arguments).code == 0
    assert json.loads(model.read_text())["source"]["left_out"] == {"mask": 800}
    for name, image, told in (
        ("all", np.ones(SEA.shape), "all pixels of the region are masked or missing"),
        ("most", np.arange(96)[:, None] * np.ones(96) < 60, "62 % of the region is masked or missing"),
        ("small", np.ones((5, 5)), "a mask of 5 x 5 pixels; give one of the picture's size, 96 x 96"),
        ("words", np.full(SEA.shape, "a"), "not real numbers"),
    ):
        np.save(tmp_path / f"{name}.npy", image)
        answer = seaglint("texture", "fit", tmp_path / "sea.npy", "--mask", tmp_path / f"{name}.npy", "--overwrite", "-o", model)
        assert (answer.code, told in answer.err, answer.err.strip().count("\n")) == (2, True, 0), answer.err
    answer = seaglint("texture", "fit", tmp_path / "sea.npy", "--mask", tmp_path / "none.npy", "--overwrite", "-o", model)
    assert answer.code == 2
    assert "none.npy" in answer.err


def test_an_autobinomial_field_is_fitted_to_a_part_without_gaps(seaglint, tmp_path) -> None:
    np.save(tmp_path / "spoilt.npy", spoilt())
    arguments = ("--model", "autobinomial", "--levels", 4, "--order", 1, "--method", "pseudo-likelihood", "-o", tmp_path / "m.json")
    answer = seaglint("texture", "fit", tmp_path / "spoilt.npy", *arguments)
    assert answer.code == 0, answer.err
    assert "rows and columns 41:96,28:96 of the region" in answer.out


def test_both_sides_are_treated_alike(seaglint, tmp_path) -> None:
    """A spoilt picture equals the whole one, and a model of a picture without its ramp is compared with the picture without it."""
    np.save(tmp_path / "whole.npy", SEA)
    np.save(tmp_path / "spoilt.npy", spoilt())
    answer = seaglint("texture", "compare", tmp_path / "whole.npy", tmp_path / "spoilt.npy", "--json")
    assert answer.code == 0, answer.err
    held = json.loads(answer.out)
    assert held["fails"] == []
    assert [note for note in held["notes"] if "spoilt.npy: 1 row left out (40)" in note]
    kept = json.loads(seaglint("texture", "compare", tmp_path / "whole.npy", tmp_path / "spoilt.npy", "--keep-defects", "--json").out)
    assert kept["fails"]
    assert [note for note in kept["notes"] if "missing" in note]

    np.save(tmp_path / "ramp.npy", SEA + np.linspace(-10.0, 10.0, 96))
    assert seaglint("texture", "fit", tmp_path / "ramp.npy", "--detrend", "-o", tmp_path / "m.json").code == 0
    answer = seaglint("texture", "compare", tmp_path / "ramp.npy", tmp_path / "m.json", "--json")
    held = json.loads(answer.out)
    assert held["marginal"]["ks"] < 0.1
    assert held["correlation_distance"] < 0.1
    assert held["notes"] == [f"slow changes of the mean are taken off both: {tmp_path / 'm.json'} was fitted to data without them"]
    assert held["likelihood"]["gain"] > 0.1
    answer = seaglint("texture", "compare", tmp_path / "ramp.npy", tmp_path / "whole.npy")
    assert "fails: distribution functions" in answer.out
    answer = seaglint("texture", "compare", tmp_path / "ramp.npy", tmp_path / "whole.npy", "--detrend")
    assert "distribution functions" not in answer.out
    assert "note: slow changes of the mean were taken off both" in answer.out


def test_bad_data_are_refused_by_compare(seaglint, tmp_path) -> None:
    np.save(tmp_path / "sea.npy", SEA)
    for name, image, told in (
        ("constant", np.ones((40, 40)), "all values are 1"),
        ("small", SEA[:8, :8], "8 x 8 pixels are too few"),
        ("empty", np.full((40, 40), np.nan), "all pixels of the region are masked or missing"),
    ):
        np.save(tmp_path / f"{name}.npy", image)
        answer = seaglint("texture", "compare", tmp_path / "sea.npy", tmp_path / f"{name}.npy")
        assert (answer.code, told in answer.err, f"{name}.npy" in answer.err, answer.err.strip().count("\n")) == (2, True, True, 0)


def test_numbers_without_a_meaning_are_not_printed(seaglint, tmp_path) -> None:
    """Whole-numbered data had hundreds of nat; a law that excludes much of the data has minus infinity."""
    image = np.round(SEA)
    np.save(tmp_path / "whole.npy", image)
    model = tmp_path / "m.json"
    answer = seaglint("texture", "fit", tmp_path / "whole.npy", "--tails", "empirical", "-o", model)
    assert answer.code == 0, answer.err
    held = json.loads(model.read_text())["quality"]["held_out"]
    assert held["step"] == 1.0
    assert -4.0 < held["log_pseudo_likelihood"] < 0.0
    assert held["gain"] == pytest.approx(held["log_pseudo_likelihood"] - held["independent_pixels"], abs=0.05)
    np.save(tmp_path / "far.npy", image + 200.0)
    answer = seaglint("texture", "compare", tmp_path / "far.npy", model)
    assert "log pseudo-likelihood per pixel of the data: none (100 % of the pixels have values that" in answer.out


def test_a_texture_stands_in_for_a_rendered_sequence(seaglint, model, tmp_path, monkeypatch) -> None:
    """With a map whose mean and deviation are known: the sequence has them, and nothing moves above the horizon."""
    scenario = tmp_path / "my.toml"
    scenario.write_text("[sensor]\nfov_deg = [4, 2]\nelevation_deg = -0.8\npixels = [48, 24]\nframes = 12\nframe_rate_hz = 50\n")
    from seaglint.optics.band import Band
    from seaglint.store.provenance import band_attributes
    from seaglint.studies.texture import perspective as texture_place

    def known(_: object) -> xr.Dataset:
        maps = {"radiance": 5.0, "path_radiance": 1.0, "glint_radiance": 2.0, "glint_std": 0.8}
        return xr.Dataset(
            {name: (("y", "x"), np.full((24, 48), value, np.float32)) for name, value in maps.items()},
            attrs=band_attributes(Band.rectangular(3.5, 5.0)),
        )

    monkeypatch.setattr(texture_place, "mean_map", known)
    output = tmp_path / "placed.zarr"
    answer = seaglint("texture", "place", model, scenario, "--size", "128x128", "-o", output)
    assert answer.code == 0, answer.err
    seen = xr.open_dataset(output, engine="zarr", consolidated=False, decode_times=False).radiance.to_numpy()
    sea = seen.std(axis=(0, 2)) > 0.0
    assert sea.sum() == 20  # of 24 rows from +0.2 to -1.8 deg, those whose lower edge is below the horizon at -0.16
    assert seen[:, ~sea] == pytest.approx(5.0)
    assert seen[:, sea].mean() == pytest.approx(5.0, rel=0.02)
    assert seen[:, sea].std() == pytest.approx(0.8, rel=0.1)
    refused = seaglint("texture", "place", model, scenario, "-o", output)
    assert refused.code == 2


def test_stored_textures_are_read_back(model, tmp_path) -> None:
    stored = read_texture(model)
    write_texture(stored, tmp_path / "again.json")
    assert read_texture(tmp_path / "again.json") == stored


@pytest.mark.validation
def test_the_report_says_what_was_fitted_and_how(seaglint, recording, tmp_path) -> None:
    image = tmp_path / "image.npy"
    np.save(image, np.load(recording)[0])
    report = tmp_path / "fit.html"
    arguments = "--model", "autobinomial", "--levels", 8, "--order", 1, "--method", "pseudo-likelihood", "--report", report
    answer = seaglint("texture", "fit", image, *arguments, "-o", tmp_path / "model.json")
    assert answer.code == 0, answer.err
    text = report.read_text()
    assert "The fit" in text
    assert "couplings by pseudo-likelihood, samples by exchange" in text
    assert "have another histogram" in text


def test_a_mask_in_memory_is_the_mask_of_a_file(tmp_path) -> None:
    mask = np.arange(96) < np.full((96, 1), 20)
    np.save(tmp_path / "mask.npy", mask)
    fitted = [sg.texture.fit(SEA, tails="gaussian", mask=one) for one in (mask, mask.astype(int).tolist(), tmp_path / "mask.npy")]
    models = [one.as_dict()["model"] for one in fitted]
    assert models[0] == models[1] == models[2]
    assert fitted[0].as_dict()["source"]["left_out"] == {"mask": 1920}
    with pytest.raises(DataError, match="an array of 5 x 5 pixels"):
        sg.texture.fit(SEA, mask=np.ones((5, 5)))
