"""Ranges of five cameras and spheres, drawn and searched, against closed forms that are computed apart."""

from __future__ import annotations

from pathlib import Path

import pytest

from detection_ranges import CASES, DEFAULT, range_of
from seaglint.store.detection_results import StudyParts


@pytest.mark.validation
@pytest.mark.parametrize("number", range(len(CASES)), ids=[case.name.split(";")[0] for case in CASES])
def test_ranges_in_a_cavity_are_those_of_the_closed_form(number: int, tmp_path: Path) -> None:
    """A cavity of one temperature hides sea, sky and horizon, so that noise, blur, extinction and distance alone decide."""
    found = range_of(number, DEFAULT, StudyParts.at(tmp_path / "ranges", resume=False, overwrite=True))
    closed = CASES[number].closed_form()
    assert found is not None
    print(f"closed form {closed:.0f} m, first estimate {found.first_estimate_m:.0f} m, found {found.range_m:.0f} m")
    assert found.range_m == pytest.approx(closed, rel=0.10)
    assert found.first_estimate_m == pytest.approx(closed, rel=0.10)
