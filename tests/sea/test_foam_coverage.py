"""Laws of foam coverage against published numbers, at their limits and beyond."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.base.limits import FOAM_WINDS
from seaglint.sea.foam.coverage_laws import coverage

LAWS = sorted(FOAM_WINDS)

# Per cent at 5, 10, 15, 20 m/s, computed by hand from the published fits with logarithms of five digits.
PUBLISHED = {
    "monahan-1980": (0.0851, 0.977, 4.07, 11.2),
    "monahan-1980-robust": (0.0929, 0.987, 3.93, 10.5),
    "callaghan-2008": (0.00699, 0.795, 2.36, 5.12),
    "salisbury-2013": (0.175, 0.837, 2.09, 4.01),
}


@pytest.mark.parametrize("law", LAWS)
def test_published_numbers(law: str) -> None:
    percent = [100.0 * coverage(law, wind, extrapolate=True) for wind in (5.0, 10.0, 15.0, 20.0)]
    assert percent == pytest.approx(PUBLISHED[law], rel=5e-3)


@pytest.mark.parametrize("law", LAWS)
def test_coverage_rises_with_wind_without_steps(law: str) -> None:
    winds = np.linspace(0.0, 40.0, 4001)
    values = np.array([coverage(law, wind, extrapolate=True) for wind in winds])
    assert np.all(np.diff(values) >= 0.0)
    assert values[0] == 0.0
    assert values.max() <= 1.0
    assert np.diff(values).max() < 1.5e-3  # in 0.01 m/s, below 40 m/s


def test_no_foam_below_the_threshold() -> None:
    assert coverage("callaghan-2008", 3.7) == 0.0
    assert coverage("callaghan-2008", 3.8) > 0.0


def test_monahan_reaches_the_whole_sea_and_no_more() -> None:
    assert coverage("monahan-1980", 40.0, extrapolate=True) == 1.0


@pytest.mark.parametrize("law", LAWS)
def test_winds_outside_the_law_are_refused(law: str) -> None:
    low, high = FOAM_WINDS[law]
    coverage(law, low), coverage(law, high)
    with pytest.raises(DomainError, match=f"of the foam law {law}; choose another law or pass extrapolate = true") as refused:
        coverage(law, np.nextafter(high, np.inf))
    assert refused.value.allowed == (low, high)
    with pytest.raises(DomainError, match=r"outside 0-40 m/s of the wind profile"):
        coverage(law, 41.0, extrapolate=True)


def test_the_guide_shows_these_numbers() -> None:
    page = (Path(__file__).parents[2] / "docs/guide/foam.md").read_text(encoding="utf-8")
    block = page.split("<!-- begin coverage")[1].split("<!-- end coverage")[0]
    head, _, *rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in block.splitlines() if line.startswith("|")]
    winds = [float(cell.removesuffix(" m/s")) for cell in head[1:]]
    assert [row[0].strip("`") for row in rows] == list(FOAM_WINDS)
    for law, *cells in rows:
        for wind, cell in zip(winds, cells, strict=True):
            beyond = cell.endswith(" (extrapolated)")
            assert beyond == (wind > FOAM_WINDS[law.strip("`")][1])
            assert cell.removesuffix(" (extrapolated)") == f"{100.0 * coverage(law.strip('`'), wind, extrapolate=beyond):.3g}"


def test_unknown_law() -> None:
    with pytest.raises(DomainError, match="law = 'wu-1979' is not known; allowed: monahan-1980, monahan-1980-robust"):
        coverage("wu-1979", 10.0)
