"""Decks of the lines of sight: where rays meet the sea, cards in their columns, JSON by its keys, the manifest that orders them."""

import itertools
import json

import numpy as np
import pytest

from seaglint.air.lowtran_table import BandTable
from seaglint.base.errors import DataError
from seaglint.formats.lowtran.deck import Aerosol, LowtranAir, ProfileLevel
from seaglint.formats.modtran.decks import (
    AZIMUTHS,
    DIP_NODES,
    PATH_NODES,
    SKY_NODES,
    Manifest,
    ModtranCase,
    deck,
    json_deck,
    needed_lines,
    read_manifest,
)

AIR = LowtranAir("midlatitude-winter", Aerosol(wind=7.0, wind_24h=5.0), 2435, 2565)
LINES = [
    ModtranCase("path", 30.0, 91.2345678, 1400.0, azimuth_deg=20.0),
    ModtranCase("sky", 0.0, 60.0, azimuth_deg=180.0),
    ModtranCase("sun", 0.0, 85.0),
]


@pytest.fixture(scope="module")
def refraction():
    return BandTable.read("midlatitude-summer", (3.5, 5.0)).refraction


def test_rays_of_lowtran7_meet_the_sea_where_it_says(refraction):
    """Arcs that LOWTRAN7 computed for these zenith angles at 30 m and 2.5 km, midlatitude summer [m]."""
    for height, zenith, found in ((30.0, 91.51617867, 1136.60624), (30.0, 90.18122429, 12934.61870), (2500.0, 92.55090913, 61880.518)):
        cosine = refraction.sea_cosine(height, np.radians(zenith - 90.0))
        assert float(refraction.sea_arc(height, cosine)) == pytest.approx(found, rel=3e-5)


def test_the_lines_of_a_scenario(refraction):
    plain = needed_lines(refraction, 30.0, None)
    kinds = [(line.kind, line.height_m) for line in plain]
    assert kinds.count(("path", 30.0)) == PATH_NODES
    assert kinds.count(("sky", 0.0)) == kinds.count(("sun", 0.0)) == SKY_NODES
    assert kinds.count(("sky", 30.0)) == SKY_NODES + DIP_NODES - 1
    paths = [line for line in plain if line.kind == "path"]
    assert paths[0].zenith_deg == 180.0
    assert all(a.range_m < b.range_m for a, b in itertools.pairwise(paths))
    lit = needed_lines(refraction, 30.0, np.radians(76.0))
    assert len(lit) == (len(plain) - SKY_NODES) * len(AZIMUTHS) + SKY_NODES
    assert {line.azimuth_deg for line in lit if line.kind == "sun"} == {None}


def cards(modtran, lines=LINES, air=AIR):
    return deck(lines, air, 76.0, modtran=modtran, co2_ppmv=425.0).splitlines()


def test_lowtran7_cards_stand_in_their_columns():
    found = cards(False)
    assert [int(found[0][k : k + 5]) for k in (0, 5, 10)] == [3, 2, 2]
    assert found[1].startswith("    3    0    0    3")
    assert [float(found[2][k : k + 10]) for k in (0, 10, 20)] == pytest.approx([0.03, 0.0, 91.234568])
    assert [int(found[3][k : k + 5]) for k in (0, 5, 10, 15)] == [2, 2, 93, 0]
    assert [float(found[4][k : k + 10]) for k in (0, 10)] == [20.0, 76.0]
    assert [float(found[5][k : k + 10]) for k in (0, 10, 20)] == [2435.0, 2565.0, 5.0]
    assert [int(found[6]), int(found[13]), int(found[-1])] == [1, 1, 0]
    sun = found[14:]
    assert (int(sun[0][5:10]), int(sun[0][10:15]), float(sun[2][20:30]), int(sun[2][30:35])) == (3, 3, 85.0, 93)


def test_modtran_cards_stand_in_their_columns():
    found = cards(True)
    assert (found[0][:2], int(found[0][2:5]), int(found[0][5:10]), int(found[0][10:15])) == ("TM", 3, 2, 2)
    assert (float(found[0][65:73]), float(found[0][73:80])) == (0.001, 0.0)
    assert (found[1][:2], int(found[1][2:5]), float(found[1][10:20])) == ("FF", 2, 425.0)
    assert found[1][40:] == " F F F F F     0.000"  # LSUNFL, LBMNAM, LFLTNM, H2OAER, LDATDR, SOLCON in columns 51-60
    assert found[2] == cards(False)[1]
    assert found[6][30:40].split() == ["20.0"]
    assert found[6][40:42] == "RW"


def test_a_sounding_goes_into_the_cards():
    air = LowtranAir(
        "tropical",
        Aerosol(),
        2435,
        2565,
        (ProfileLevel(0.0, 1013.0, 290.0, 80.0), ProfileLevel(10.0, 270.0, 230.0, 10.0), ProfileLevel(100.0)),
    )
    for modtran in (False, True):
        found = cards(modtran, LINES[:1], air)
        assert int(found[0][2:5]) == 7
        assert any(line.startswith("    3    0    0sounding") for line in found)
    with pytest.raises(DataError, match="modtran6-json takes model atmospheres"):
        json_deck(LINES, air, 76.0, "x", 425.0)


def test_modtran6_input_by_its_keys():
    assert json.loads(json_deck(LINES, AIR, 76.0, "x", 425.0))["MODTRAN"][0]["MODTRANINPUT"]["ATMOSPHERE"]["CO2MX"] == 425.0
    path, sky, sun = (case["MODTRANINPUT"] for case in json.loads(json_deck(LINES, AIR, 76.0, "x", 425.0))["MODTRAN"])
    assert path["RTOPTIONS"]["IEMSCT"] == "RT_SOLAR_AND_THERMAL"
    assert path["ATMOSPHERE"]["MODEL"] == "ATM_MIDLAT_WINTER"
    assert path["AEROSOLS"] == {"IHAZE": "AER_MARITIME_NAVY", "IPH": 2, "ICSTL": 3, "WSS": 7.0, "WHH": 5.0}
    wanted = {"ITYPE": 2, "H1ALT": 0.03, "H2ALT": 0.0, "OBSZEN": 91.2345678, "IPARM": 2, "PARM1": 20.0, "PARM2": 76.0, "IDAY": 93}
    assert path["GEOMETRY"] == wanted
    assert (sky["GEOMETRY"]["ITYPE"], sky["GEOMETRY"]["OBSZEN"], sky["GEOMETRY"]["H1ALT"]) == (3, 60.0, 0.0)
    assert (sun["GEOMETRY"]["OBSZEN"], sun["GEOMETRY"]["PARM2"]) == (0.0, 85.0)
    assert {key: path["SPECTRAL"][key] for key in ("V1", "V2", "DV")} == {"V1": 2435.0, "V2": 2565.0, "DV": 5.0}


def test_the_manifest_comes_back(tmp_path):
    manifest = Manifest(tuple(LINES), 30.0, 76.0, ("a.tp7",))
    (tmp_path / "manifest.json").write_text(manifest.text())
    assert read_manifest(tmp_path / "manifest.json") == manifest


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"seaglint_manifest": 1', '"seaglint_manifest": 9', "no manifest of this version"),
        ('"kind": "sky"', '"kind": "ray"', "is damaged"),
        ('"height_m": 0.0', '"height_m": "low"', "is damaged"),
        ('"range_m"', '"arc"', "is damaged"),
        ("]", "", "cut short"),
    ],
)
def test_a_damaged_manifest_is_one_line(tmp_path, old, new, told):
    (tmp_path / "manifest.json").write_text(Manifest(tuple(LINES), 30.0, 76.0, ("a.tp7",)).text().replace(old, new))
    with pytest.raises(DataError, match=told) as caught:
        read_manifest(tmp_path / "manifest.json")
    assert "\n" not in str(caught.value)
