"""Figure 10: textures of the article, from the fit to the picture."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from scipy.special import expit

from seaglint.formats.tables.table_text import write_columns
from seaglint.plot.article_figures import write_figure
from seaglint.studies.article import figures
from seaglint.studies.article import figures as texture_figure
from seaglint.textures.autobinomial import Autobinomial
from seaglint.textures.autobinomial_sampler import exchange
from seaglint.textures.regime import mean_field


def test_weakened_couplings_keep_the_mean_and_have_the_slope() -> None:
    model = Autobinomial.of(8, 2, -2.6, (0.24, 0.19, -0.02, -0.03), isotropic=False)
    weak = texture_figure.weakened(model, 0.4, 0.8)
    assert mean_field(weak, 0.4)[0] == pytest.approx(0.8, rel=1e-12)
    assert expit(weak.alpha + 2 * 7 * sum(weak.beta) * 0.4) == pytest.approx(0.4, rel=1e-12)
    assert weak.beta[0] / weak.beta[1] == pytest.approx(0.24 / 0.19, rel=1e-12)


@pytest.mark.validation
def test_figure_10_of_known_couplings(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    """A picture of even histogram, with couplings beyond the transition, stands in for the sea."""
    even = np.random.default_rng(5).permutation(np.repeat(np.arange(8), 512)).reshape(64, 64)
    known = Autobinomial.of(8, 2, 0.0, (0.17, 0.11, 0.0, 0.0), isotropic=False)
    picture = exchange(even, known, 500, seed=2)
    monkeypatch.setattr(texture_figure, "glint_from_above", lambda: picture.astype(float))
    found = figures.FIGURES["fig10"](lambda done, total: None)
    assert found.attrs["regimes"] == [["frozen", "molten"], ["frozen", "molten"]]
    assert (found["converged"] == 1.0).all()
    gap = np.abs(found["coupling"].to_numpy()[1, 1] - known.beta)
    assert (gap < 3.5 * found["coupling_standard_error"].to_numpy()[1, 1]).all()
    tie = found["correlation"].to_numpy()
    assert tie[1, 1] == pytest.approx(tie[1, 0], abs=0.05)
    assert tie[0, 1, 0] == pytest.approx(tie[0, 1, 1], abs=0.05)
    assert tie[1, 1, 0] > tie[1, 1, 1] + 0.03
    for row in found["grey_level"].to_numpy():
        assert np.array_equal(np.bincount(row[1].ravel()), np.bincount(picture.ravel()))
    output = write_columns(figures.table("fig10", found), tmp_path / "fig10.csv")
    with output.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["coupling"] for row in rows} - {""}
    assert "grey_level" not in rows[0]
    first, second = (write_figure("fig10", found, tmp_path / f"{i}.png").read_bytes() for i in (1, 2))
    assert first == second
