"""A sequence on disk is whole or plainly unfinished, whatever interrupts the work."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import DataError, StorageError
from seaglint.optics.band import Band
from seaglint.store.layout import Layout
from seaglint.store.outputs import stop_on_signal
from seaglint.store.provenance import provenance
from seaglint.store.sequence_store import Interrupted, open_sequence, partial_path, write_sequence
from seaglint.store.shards import Shards

ROWS, COLUMNS = 6, 9


def layout(frames=range(5), **attributes) -> Layout:
    given = {"scenario_json": '{"wind": {"speed_m_s": 7.0}}', "seed": 1} | attributes
    return Layout(
        azimuth_deg=np.linspace(170, 190, COLUMNS),
        elevation_deg=np.linspace(0, -6, ROWS),
        frames=frames,
        frame_rate=25.0,
        band=Band.rectangular(3.5, 5.0),
        attributes=provenance("Sea radiance", **given),
    )


def pixels(number: int) -> np.ndarray:
    return np.full((ROWS, COLUMNS), number, dtype=np.float32) + np.arange(COLUMNS, dtype=np.float32) / 16


def frame(number: int) -> dict[str, np.ndarray]:
    return {"radiance": pixels(number)}


@pytest.fixture
def output(tmp_path: Path) -> Path:
    return tmp_path / "run.zarr"


class Stopper:
    """Computes frames, and raises or signals at one of them."""

    def __init__(self, at: int, action) -> None:
        self.at, self.action, self.asked = at, action, []

    def __call__(self, number: int) -> dict[str, np.ndarray]:
        self.asked.append(number)
        if number == self.at:
            self.action()
        return frame(number)


def interrupt() -> None:
    os.kill(os.getpid(), signal.SIGINT)


def test_what_is_written_is_what_is_read(output):
    assert write_sequence(output, layout(), frame) == output
    with open_sequence(output) as found:
        assert found["radiance"].dims == ("time", "y", "x")
        assert found["radiance"].dtype == np.float32
        np.testing.assert_array_equal(found["radiance"], np.stack([pixels(i) for i in range(5)]))
        np.testing.assert_allclose(found["time"], np.arange(5) / 25.0, rtol=1e-15)
        np.testing.assert_array_equal(found["azimuth"], layout().azimuth_deg)
        np.testing.assert_array_equal(found["elevation"], layout().elevation_deg)
        assert set(found["radiance"].coords) >= {"azimuth", "elevation", "time", "frame", "wavelength"}
        assert found["radiance"].attrs["units"] == "W m-2 sr-1"
        assert found["azimuth"].attrs["units"] == "degree"
        assert found.attrs["Conventions"].startswith("CF-")
    assert not partial_path(output).exists()


def test_xarray_opens_a_store_without_a_warning(output):
    write_sequence(output, layout(), frame)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with xr.open_zarr(output) as found:
            assert found["radiance"].shape == (5, ROWS, COLUMNS)


def test_a_part_of_a_sequence_keeps_its_frame_numbers_and_times(output):
    write_sequence(output, layout(frames=range(37, 39)), frame)
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["frame"], [37, 38])
        np.testing.assert_allclose(found["time"], [37 / 25, 38 / 25], rtol=1e-15)
        np.testing.assert_array_equal(found["radiance"][0], pixels(37))


def test_black_frames_are_written_and_missing_ones_are_nan(output):
    write_sequence(output, layout(), lambda number: {"radiance": np.zeros((ROWS, COLUMNS), np.float32)})
    with open_sequence(output) as found:
        assert float(abs(found["radiance"]).max()) == 0.0
        assert bool(found["frame_done"].all())


def test_several_variables(output):
    two = replace(layout(), variables=("radiance", "apparent_temperature"))
    write_sequence(output, two, lambda number: frame(number) | {"apparent_temperature": 100 + pixels(number), "range": pixels(0)})
    with open_sequence(output) as found:
        np.testing.assert_allclose(found["apparent_temperature"], 100 + found["radiance"], rtol=1e-6)
        assert found["apparent_temperature"].attrs["standard_name"] == "brightness_temperature"
        assert "range" not in found  # nobody asked for it


def test_progress_counts_from_what_is_there(output):
    seen = []
    write_sequence(output, layout(), frame, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(n, 5) for n in range(6)]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_finishes_the_frame_and_resume_goes_on(output, number):
    stopper = Stopper(2, lambda: os.kill(os.getpid(), number))
    with pytest.raises(Interrupted, match=r"after 3 of 5 frames.*resume=True") as caught:
        write_sequence(output, layout(), stopper)
    assert caught.value.exit_code == 130
    assert not output.exists()
    assert stopper.asked == [0, 1, 2]
    rest = Stopper(-1, lambda: None)
    write_sequence(output, layout(), rest, resume=True)
    assert rest.asked == [3, 4]
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"], np.stack([pixels(i) for i in range(5)]))


def test_signals_are_given_back(output):
    before = signal.getsignal(signal.SIGINT)
    write_sequence(output, layout(), frame)
    assert signal.getsignal(signal.SIGINT) is before


def test_a_signal_ends_the_whole_of_which_a_sequence_is_a_piece(output):
    with stop_on_signal() as stopped:
        assert write_sequence(output, layout(), Stopper(4, interrupt)) == output  # in its last frame: this piece is whole
        assert stopped == [signal.SIGINT]
        second = Stopper(-1, interrupt)
        with pytest.raises(Interrupted, match="after 0 of 5 frames"):
            write_sequence(output.with_name("second.zarr"), layout(), second)
        assert second.asked == []
    assert write_sequence(output.with_name("third.zarr"), layout(), frame).exists()


def test_a_second_signal_does_not_wait(output):
    def twice() -> None:
        interrupt()
        interrupt()

    with pytest.raises(KeyboardInterrupt):
        write_sequence(output, layout(), Stopper(2, twice))
    assert not output.exists()


def test_a_crash_leaves_the_frames_done(output):
    def crash() -> None:
        raise RuntimeError("a defect")

    with pytest.raises(RuntimeError):
        write_sequence(output, layout(), Stopper(3, crash))
    with pytest.raises(DataError, match="unfinished"):
        open_sequence(output)
    with open_sequence(partial_path(output), allow_partial=True) as found:
        assert found["frame_done"].to_numpy().tolist() == [1, 1, 1, 0, 0]
        assert bool(np.isnan(found["radiance"][3:]).all())
    with pytest.raises(DataError, match=r"2 of 5 frames are missing.*resume=True"):
        open_sequence(partial_path(output))


def test_pixels_without_their_record_are_computed_again(output, monkeypatch):
    # Killed between the pixels and frame_done: the frame counts as absent.
    real = Shards.write

    def torn(shards, unit, *rest):
        if unit == 1:
            shards.arrays["radiance"][unit] = np.full((ROWS, COLUMNS), 99.0)
            raise RuntimeError("killed here")
        real(shards, unit, *rest)

    monkeypatch.setattr(Shards, "write", torn)
    with pytest.raises(RuntimeError):
        write_sequence(output, layout(), frame)
    monkeypatch.undo()
    write_sequence(output, layout(), frame, resume=True)
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"][1], pixels(1))


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG])
def test_a_full_disk_is_a_storage_error_and_can_be_resumed(output, monkeypatch, number):
    real = Shards.write

    def full(shards, unit, *rest):
        if unit == 2:
            raise OSError(number, os.strerror(number))
        real(shards, unit, *rest)

    monkeypatch.setattr(Shards, "write", full)
    with pytest.raises(StorageError, match=r"no room left.*resume=True") as caught:
        write_sequence(output, layout(), frame)
    assert caught.value.exit_code == 3
    assert not output.exists()
    monkeypatch.undo()
    rest = Stopper(-1, lambda: None)
    write_sequence(output, layout(), rest, resume=True)
    assert rest.asked == [2, 3, 4]


def test_other_errors_of_a_frame_are_not_taken_for_a_full_disk(output):
    def defect(number: int) -> dict[str, np.ndarray]:
        raise OSError(errno.ENOSPC, "raised by the computation, not by writing")

    with pytest.raises(OSError, match="by the computation"):
        write_sequence(output, layout(), defect)


def test_existing_output_is_refused_and_kept(output):
    write_sequence(output, layout(), frame)
    with pytest.raises(DataError, match=r"exists already.*overwrite=True"):
        write_sequence(output, layout(), lambda number: frame(number + 1))
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"][0], pixels(0))


def test_overwrite_keeps_the_old_one_until_the_new_one_is_whole(output):
    write_sequence(output, layout(), frame)
    with pytest.raises(Interrupted):
        write_sequence(output, layout(), Stopper(1, interrupt), overwrite=True)
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"][0], pixels(0))
    write_sequence(output, layout(), lambda number: frame(number + 1), overwrite=True)
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"][0], pixels(1))
    assert [path.name for path in output.parent.iterdir()] == [output.name]


def test_overwrite_never_deletes_what_is_not_ours(output):
    output.mkdir()
    (output / "thesis.txt").write_text("years of work")
    with pytest.raises(DataError, match="left alone"):
        write_sequence(output, layout(), frame, overwrite=True)
    assert (output / "thesis.txt").exists()


def test_an_unfinished_sequence_is_not_overrun_by_mistake(output):
    with pytest.raises(Interrupted):
        write_sequence(output, layout(), Stopper(2, interrupt))
    with pytest.raises(DataError, match=r"resume=True, or begin anew with overwrite=True"):
        write_sequence(output, layout(), frame)
    anew = Stopper(-1, lambda: None)
    write_sequence(output, layout(), anew, overwrite=True)
    assert anew.asked == [0, 1, 2, 3, 4]


@pytest.mark.parametrize(
    ("other", "names"),
    [
        (layout(scenario_json='{"wind": {"speed_m_s": 9.0}}'), "wind.speed_m_s"),
        (layout(seed=2), "seed"),
        (layout(table_sha256="abc"), "table_sha256"),
        (layout(frames=range(1, 6)), "frames"),
        (replace(layout(), frame_rate=50.0), "frame_rate_hz"),
    ],
)
def test_resume_refuses_another_sequence_and_names_the_difference(output, other, names):
    with pytest.raises(Interrupted):
        write_sequence(output, layout(), Stopper(2, interrupt))
    with pytest.raises(DataError, match=f"another {names};"):
        write_sequence(output, other, frame, resume=True)


def test_resume_of_a_whole_sequence_and_of_nothing(output):
    write_sequence(output, layout(), frame, resume=True)
    untouched = Stopper(-1, lambda: None)
    write_sequence(output, layout(), untouched, resume=True)
    assert untouched.asked == []
    with pytest.raises(DataError, match="one of the two"):
        write_sequence(output, layout(), frame, resume=True, overwrite=True)


def test_a_missing_folder_is_told_before_anything_is_computed(tmp_path):
    untouched = Stopper(-1, lambda: None)
    with pytest.raises(DataError, match="does not exist"):
        write_sequence(tmp_path / "no" / "run.zarr", layout(), untouched)
    assert untouched.asked == []


def test_damaged_sequences_are_told(output, tmp_path):
    with pytest.raises(DataError, match="no such sequence"):
        open_sequence(output)
    write_sequence(output, layout(), frame)
    cut = tmp_path / "cut.zarr"
    shutil.copytree(output, cut)
    (cut / "zarr.json").write_text((cut / "zarr.json").read_text()[:40])
    with pytest.raises(DataError, match="cut"):
        open_sequence(cut)
    (output / "frame_done" / "c" / "3").unlink()
    with pytest.raises(DataError, match="1 of 5 frames are missing"):
        open_sequence(output)
