"""Layers of pictures with objects, and labels where a panorama closes on itself."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import seaglint as sg
from seaglint.scenario.load import parse_scenario
from seaglint.store.sequence_store import write_sequence
from seaglint.studies.sequence.render_sequence import prepare_sequence

CALM = {"sea": {"resolve_waves": False}}
BOX = {"name": "box", "shape": {"kind": "box", "size_m": [12, 12, 8]}, "temperature_k": 320.0, "emissivity": 0.9, "height_m": 4}
LAYERS = ["range", "slope", "glint_share", "object_id"]


def scenario_with(*objects, sun=60.0, **sensor):
    about = {"pixels": [64, 48], "fov_deg": [4.0, 3.0], "azimuth_deg": 0.0, "elevation_deg": -1.0, "height_m": 20.0, "frames": 1, **sensor}
    scenario = {**CALM, "sun": {"zenith_deg": sun, "azimuth_deg": 0.0}}
    return parse_scenario({"sensor": about, "objects": list(objects), "render": {"layers": LAYERS}, **scenario})


def test_layers_have_the_object_where_it_stands(tmp_path):
    far = {**BOX, "name": "far", "shape": {"kind": "box", "size_m": [30, 2, 8]}, "east_m": 0, "north_m": 900}
    found = scenario_with({**BOX, "east_m": 3, "north_m": 600}, far)
    image, run = sg.image(found, layers=[*LAYERS, "glint_radiance"]), prepare_sequence(found)
    bare = run.scene.drawn(run.track.at(0.0), 0.0)
    number, cover = image.object_id.values, image.radiance.values != bare.radiance
    assert number.dtype == np.uint16
    assert set(np.unique(number)) == {0, 1, 2}
    assert np.array_equal(number > 0, cover)
    assert np.median(image.range.values[number == 1]) == pytest.approx(594.5, abs=2.0)
    assert np.median(image.range.values[number == 2]) == pytest.approx(899.5, abs=2.0)
    np.testing.assert_allclose(image.glint_share.values, image.glint_radiance.values / image.radiance.values, rtol=1e-6)
    assert np.median(image.glint_share.values[number == 1]) < 0.05 < 0.5 < np.median(bare["glint_share"][number == 1])
    near = number == 1
    inside = near[1:-1, 1:-1] & near[2:, 1:-1] & near[:-2, 1:-1] & near[1:-1, 2:] & near[1:-1, :-2]
    assert inside.any()
    assert np.isnan(image.slope.values[1:-1, 1:-1][inside]).all()
    assert np.array_equal(image.slope.values[number == 0], bare["slope"][number == 0], equal_nan=True)
    store = write_sequence(tmp_path / "run.zarr", run.layout, run.images)
    with xr.open_zarr(store, consolidated=False) as held, xr.open_zarr(store, group="truth", consolidated=False) as truth:
        assert np.array_equal(held.object_id.values[0], number)
        assert np.array_equal(truth.object_id.values[0], number)
        assert np.array_equal(held.glint_share.values[0], image.glint_share.values)


def labelled(**keys):
    run = prepare_sequence(scenario_with({**BOX, **keys}, sun=110.0, fov_deg=[360, 3], pixels=[720, 24], pixel_shape="any"))
    drawn = run.drawn(0.0)
    assert run.objects is not None
    truth = run.objects.truth(drawn.sights, drawn.sea, run.scene, (run.scene.pixels, run.track.at(0.0).attitude))
    return drawn, {name: float(values[0]) for name, values in truth.items() if name.endswith("_px")}, truth["object_mask"][0] > 0


@pytest.mark.parametrize(
    "shape",
    [
        BOX["shape"],
        {
            "kind": "union",
            "parts": [
                {"kind": "box", "size_m": [6, 12, 8], "at_m": [-4, 0, 0]},
                {"kind": "plume", "semi_axes_m": [4, 4, 4], "at_m": [4, 0, 0], "temperature_k": 400, "emissivity": 0.5},
            ],
        },
    ],
    ids=["box", "two parts"],
)
def test_labels_go_on_over_the_seam_of_a_panorama(shape):
    """The same object before the camera and behind it: half a circle away, the same box and mask."""
    ahead = labelled(shape=shape, east_m=0.7, north_m=500)
    behind = labelled(shape=shape, east_m=-0.7, north_m=-500, heading_deg=180)
    assert ahead[1]["bbox_width_px"] < 10
    for name in ("bbox_width_px", "bbox_height_px", "bbox_top_px", "row_px"):
        assert behind[1][name] == pytest.approx(ahead[1][name], abs=0.01), name
    for name in ("column_px", "bbox_left_px", "signal_column_px"):
        assert behind[1][name] == pytest.approx((ahead[1][name] + 360.0 + 0.5) % 720.0 - 0.5, abs=0.05), name
    assert behind[2][:, 0].any()
    assert behind[2][:, -1].any()
    assert np.array_equal(np.roll(behind[2], 360, axis=1), ahead[2])
