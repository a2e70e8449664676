"""Files with random combinations of tags: every value, gap, unit and rate is right, or the file is refused in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from odd_recordings import MAKERS

from seaglint.base.errors import DataError
from seaglint.formats.recording import open_recording

FEW, MANY = 40, 500


def judge(form: str, number: int, folder: Path) -> None:
    rng = np.random.default_rng([number_of(form), number])
    odd = MAKERS[form](rng, folder)
    if odd.says:
        with pytest.raises(DataError, match=odd.says) as caught:
            open_recording(odd.path, **odd.how)
        assert "\n" not in str(caught.value)
        return
    recording = open_recording(odd.path, **odd.how)
    assert (recording.frames, recording.rows, recording.columns) == odd.values.shape
    found = recording.read(0, recording.frames).astype(np.float64) + recording.offset
    np.testing.assert_array_equal(np.isnan(found), np.isnan(odd.values))
    scale = float(np.nanmax(np.abs(odd.values))) if np.isfinite(odd.values).any() else 1.0
    np.testing.assert_allclose(found, odd.values, rtol=0.0, atol=odd.tolerance * scale)
    last = recording.frames - 1
    np.testing.assert_array_equal(recording.read(last, last + 1)[0], recording.read(0, recording.frames)[-1])
    assert recording.units == odd.units
    assert recording.frame_rate == (None if odd.rate is None else pytest.approx(odd.rate, rel=1e-6))


def number_of(form: str) -> int:
    """Number of a format's name, the same in every run."""
    return sum(ord(letter) << i for i, letter in enumerate(form))


@pytest.mark.parametrize("form", MAKERS)
def test_random_tags_are_honoured(form: str, tmp_path: Path) -> None:
    for number in range(FEW):
        folder = tmp_path / str(number)
        folder.mkdir()
        judge(form, number, folder)


@pytest.mark.validation
@pytest.mark.parametrize("form", MAKERS)
def test_five_hundred_files_of_random_tags(form: str, tmp_path: Path) -> None:
    for number in range(FEW, FEW + MANY):
        folder = tmp_path / str(number)
        folder.mkdir()
        judge(form, number, folder)
