"""The ranges of the models stand in one place, and that place says what tables, fits and scenario files do."""

from __future__ import annotations

import subprocess
import sys
from typing import get_args

import numpy as np
import pytest

from seaglint.air.lowtran_table import models, read_table
from seaglint.base import limits
from seaglint.base.errors import DomainError, ScenarioError
from seaglint.formats.lowtran.deck import Aerosol
from seaglint.imaging.camera.imager import Imager
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.records.sea_tables import Slopes
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic, cox_munk_slick
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wind_profile import friction_velocity
from seaglint.studies.sequence.memory import BYTES_PER_LATTICE_POINT, memory_needed

KINDS = {record.model_fields["kind"].default: record for record in get_args(get_args(Slopes)[0])}

FITS = {
    "cox-munk-isotropic": lambda wind: cox_munk_isotropic(wind),
    "cox-munk-anisotropic": lambda wind: cox_munk_anisotropic(wind, 0.0),
    "cox-munk-gram-charlier": lambda wind: cox_munk_gram_charlier(wind, 0.0),
    "cox-munk-slick": lambda wind: cox_munk_slick(wind, 0.0),
    "breon-henriot": lambda wind: breon_henriot(wind, 0.0),
}


@pytest.mark.parametrize("region", [0, 1], ids=["mwir", "lwir"])
def test_the_shipped_tables_reach_to_the_limits(region):
    name = ("mwir", "lwir")[region]
    assert models(name)
    for model in models(name):
        table = read_table(model, name)
        assert (table["heights"][0], table["heights"][-1]) == limits.TABLE_HEIGHTS
        assert (table["winds"][0], table["winds"][-1]) == limits.NAVY_AEROSOL_WIND
        low, high = 1e4 / table["wavenumber_cm"][[-1, 0]]
        # the margin of the files is a few samples of 5 cm-1
        assert low <= limits.TABLE_BANDS_UM[region][0]
        assert limits.TABLE_BANDS_UM[region][1] <= high < 1.03 * limits.TABLE_BANDS_UM[region][1]


@pytest.mark.parametrize("kind", FITS)
def test_scenario_and_fit_end_at_the_same_wind(kind):
    low, high = KINDS[kind].winds
    assert FITS[kind](low).mss >= 0.0
    assert FITS[kind](high).mss > 0.0
    with pytest.raises(DomainError) as refused:
        FITS[kind](np.nextafter(high, np.inf))
    assert refused.value.allowed == (low, high)
    values = {"sea": {"slopes": {"kind": kind}}, "atmosphere": {"source": "none"}}
    parse_scenario(values | {"wind": {"speed_m_s": high}})
    with pytest.raises(ScenarioError) as told:
        parse_scenario(values | {"wind": {"speed_m_s": float(np.nextafter(high, np.inf))}})
    assert told.value.mistakes[0].allowed == (low, high)


def test_winds_that_no_law_knows_are_refused_by_both():
    most = limits.WIND_PROFILE[1]
    values = {"sea": {"slopes": {"extrapolate": True}}, "atmosphere": {"source": "none"}}
    assert friction_velocity(parse_scenario(values | {"wind": {"speed_m_s": most}}).wind.speed_m_s) > 0.0
    with pytest.raises(DomainError):
        friction_velocity(most + 1.0)
    with pytest.raises(ScenarioError, match=f"0 to {most:g} m/s"):
        parse_scenario(values | {"wind": {"speed_m_s": most + 1.0}})


@pytest.mark.parametrize("source", ["table", "lowtran"])
def test_the_aerosol_ends_at_one_wind(source):
    most = limits.NAVY_AEROSOL_WIND[1]
    Aerosol(wind=most).card()
    with pytest.raises(DomainError):
        Aerosol(wind=most + 0.1).card()
    slopes = {"slopes": {"extrapolate": True}}
    with pytest.raises(ScenarioError) as told:
        parse_scenario({"sea": slopes, "atmosphere": {"source": source}, "wind": {"speed_m_s": most + 0.1}})
    assert told.value.mistakes[0].allowed == limits.NAVY_AEROSOL_WIND


def test_the_widest_plane_image_is_the_same():
    widest = limits.WIDEST_PINHOLE_DEG
    Imager("pinhole", np.radians(widest), np.radians(1.0), 2, 2)
    with pytest.raises(DomainError):
        Imager("pinhole", np.radians(widest + 1.0), np.radians(1.0), 2, 2)
    sensor = {"projection": "pinhole", "pixels": [64, 64]}
    parse_scenario({"sensor": sensor | {"fov_deg": [widest, widest]}})
    with pytest.raises(ScenarioError, match=f"up to {widest:g} deg"):
        parse_scenario({"sensor": sensor | {"fov_deg": [widest + 1.0, widest + 1.0]}})


def test_memory_is_counted_for_the_tiles_that_are_planned():
    small, large = (parse_scenario({"render": {"tile_size": n}}) for n in (128, 256))
    points = sum(tile.n**2 for tile in plan_tiles(ElfouhailySpectrum(7.0), 2.0, 256)) - sum(
        tile.n**2 for tile in plan_tiles(ElfouhailySpectrum(7.0), 2.0, 128)
    )
    assert memory_needed(large) - memory_needed(small) == points * BYTES_PER_LATTICE_POINT


def test_scenarios_are_checked_without_what_physics_needs():
    code = "import sys, seaglint.scenario.load; print(*(name for name in ('numpy', 'scipy', 'numba') if name in sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split() == []
