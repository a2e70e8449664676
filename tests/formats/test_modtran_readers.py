"""MODTRAN's and LOWTRAN7's results: every format gives the same air, in SI; what is cut, moved or impossible is one line."""

import json

import modtran_files as made
import numpy as np
import pytest

from seaglint.base.errors import DataError, SeaglintError
from seaglint.formats.air_file import read_atmosphere, write_atmosphere
from seaglint.formats.modtran.modtran_air import read_air, read_spectra
from seaglint.formats.modtran.output_files import fortran_number

WRITERS = {
    "TAPE7": (made.lowtran7, 6e-3),
    "four.tp7": (made.modtran, 6e-5),
    "five.tp7": (lambda cases: made.modtran(cases, 5), 6e-5),
    "six.csv": (made.modtran6_csv, 1e-5),
    "six.json": (made.modtran6_json, 1e-12),
}
"""Formats, and half a unit of their last digit."""


@pytest.mark.parametrize("name", WRITERS)
def test_each_format_gives_path_sky_sun_and_scattered_light_in_si(tmp_path, name):
    """1 W cm-2 sr-1 per cm-1 is 1e4 W m-2 sr-1 per cm-1; wavenumbers ascend."""
    write, rounding = WRITERS[name]
    cases = [made.case(2, 2, 0.03, 91.0, 20.0), made.case(1, 3, 0.0, 60.0), made.case(3, 3, 0.0, 85.0)]
    (tmp_path / name).write_text(write(cases))
    path, sky, sun = read_spectra(tmp_path / name)
    np.testing.assert_allclose(path.wavenumber_cm, made.NU)
    np.testing.assert_allclose(path.need("thermal"), 1e4 * cases[0].thermal, rtol=rounding)
    np.testing.assert_allclose(path.need("scattered"), 1e4 * cases[0].scattered, rtol=rounding)
    np.testing.assert_allclose(path.need("transmittance"), cases[0].transmittance, atol=6e-5)
    np.testing.assert_allclose(sky.need("thermal"), 1e4 * cases[1].thermal, rtol=rounding)
    np.testing.assert_allclose(sun.need("sun"), 1e4 * cases[2].toa * cases[2].transmittance, rtol=6e-3)


@pytest.mark.parametrize(("unit", "name"), [("MCRN", "tape7.scn"), ("NM", "run.7sc")])
def test_scanned_files_over_wavelength_come_back_over_wavenumber(tmp_path, unit, name):
    """Per um (and uW per nm) to per cm-1: lambda^2 / 1e4; rising wavelengths are falling wavenumbers."""
    c = made.case(2, 2, 0.03, 91.0, 20.0)
    (tmp_path / name).write_text(made.scanned([c], unit))
    (found,) = read_spectra(tmp_path / name)
    np.testing.assert_allclose(found.wavenumber_cm, made.NU, rtol=1e-6)
    np.testing.assert_allclose(found.need("thermal"), 1e4 * c.thermal, rtol=1e-4)
    np.testing.assert_allclose(found.need("scattered"), 1e4 * c.scattered, rtol=1e-4)


# LOWTRAN7's own, run on a path 1 deg down from 30 m, midlatitude summer, Navy maritime aerosol, 7 m/s, Sun 14 deg high 20 deg aside.
REAL = """    2    2    2    0    2    2    2    2    2    2    1    0    0   0.001   0.00
    3    1    1    3    0    0    41.472     7.000     7.000     0.000     0.000
   -99.000   -99.000   -99.000       -99
   -99.000   -99.000   -99.000
   33MIDLATITUDE SUMMER
     0.030     0.000    91.000     1.730     0.016     0.000    0
    2    2   93    0
    20.000    76.000     0.000     0.000     0.000     0.000     0.000     0.000
  2400.000  2405.000     5.000
    0
  FREQ   TRANS     ATMOS   PATH     SINGLE   GROUND DIRECT   TOTAL RAD
  2400.  0.6018 5.22E-08 1.19E-09 1.19E-09 0.00E+00 0.00E+00 5.34E-08  0.0400  0.0546           5.078E-01
  2405.  0.6435 4.59E-08 1.61E-09 1.61E-09 0.00E+00 0.00E+00 4.75E-08  0.0538  0.0722           4.408E-01
 -9999.
"""


def test_what_lowtran7_printed(tmp_path):
    (tmp_path / "TAPE7").write_text(REAL)
    (found,) = read_spectra(tmp_path / "TAPE7")
    np.testing.assert_allclose(found.need("transmittance"), [0.6018, 0.6435])
    np.testing.assert_allclose(found.need("thermal"), [5.22e-4, 4.59e-4])
    np.testing.assert_allclose(found.need("scattered"), [1.19e-5, 1.61e-5])
    sight = found.sight
    assert (sight.mode, sight.kind, sight.height_km, sight.zenith_deg, sight.azimuth_deg, sight.solar_zenith_deg) == (
        2,
        2,
        0.03,
        91.0,
        20.0,
        76.0,
    )


def test_columns_that_touch_and_exponents_without_e(tmp_path):
    """A negative rounding rest fills its eleven columns; 6.5300-144 is a Fortran number."""
    text = made.modtran([made.case(2, 2, 0.03, 91.0)])
    first = next(line for line in text.splitlines() if line.startswith(" 2400.00"))
    touching = first[:74] + "-1.2345E-15" + " 6.5300-144" + first[96:]
    (tmp_path / "a.tp7").write_text(text.replace(first, touching))
    (found,) = read_spectra(tmp_path / "a.tp7")
    assert fortran_number("6.5300-144") == 6.53e-144
    np.testing.assert_allclose(found.need("thermal")[0], 1e4 * made.case(2, 2, 0.03, 91.0).thermal[0], rtol=1e-4)


def test_the_total_tells_what_the_parts_hold(tmp_path):
    """Should MODTRAN 6's MULT_SCAT be without single scattering, and path emission without the scattered part, they are added."""
    content = json.loads(made.modtran6_json([made.case(2, 2, 0.03, 91.0)]))
    block = content["MODTRAN"][0]["MODTRANOUTPUT"]["SPECTRA"]["RADIANCE"]
    block["MULT_SCAT"] = (0.3 * np.array(block["SING_SCAT"])).tolist()
    block["THRML_SCT"] = (0.2 * np.array(block["THRML_EM"])).tolist()
    block["TOTAL_RAD"] = np.sum([block[k] for k in ("THRML_EM", "THRML_SCT", "MULT_SCAT", "SING_SCAT")], axis=0).tolist()
    (tmp_path / "a.json").write_text(json.dumps(content))
    (found,) = read_spectra(tmp_path / "a.json")
    np.testing.assert_allclose(found.need("thermal"), 1.2e4 * np.array(block["THRML_EM"]))
    np.testing.assert_allclose(found.need("scattered"), 1.3e4 * np.array(block["SING_SCAT"]))


@pytest.mark.parametrize("name", ["TAPE7", "four.tp7", "six.json"])
@pytest.mark.parametrize("ending", ["nc", "csv"])
def test_files_without_a_manifest_tell_their_lines_themselves(tmp_path, name, ending):
    (tmp_path / name).write_text(WRITERS[name][0](made.all_cases()))
    write_atmosphere(read_air([tmp_path / name]), tmp_path / f"air.{ending}")
    air = read_atmosphere(tmp_path / f"air.{ending}", 30.0)
    path = made.case(2, 2, 0.03, 95.0)
    arc = 30.0 / np.tan(np.radians(5.0))
    np.testing.assert_allclose(air.transmittance(30.0, arc), path.transmittance, rtol=1e-3)
    np.testing.assert_allclose(air.sky_radiance(np.radians(60.0), 0.0), 1e4 * made.case(2, 3, 0.0, 60.0).thermal, rtol=6e-3)
    np.testing.assert_allclose(np.degrees(air.scattered.azimuth), [0.0, 60.0, 180.0])
    assert np.degrees(air.scattered.solar_zenith) == pytest.approx(76.0)
    np.testing.assert_allclose(air.scattered.path[2, 1], 1e4 * made.case(2, 2, 0.03, 95.0, 60.0).scattered, rtol=6e-3)
    assert {sky.height for sky in air.scattered.skies} == {0.0, 30.0}


def test_several_files_make_one_air(tmp_path):
    cases = made.all_cases()
    (tmp_path / "a.tp7").write_text(made.modtran(cases[:7]))
    (tmp_path / "b.tp7").write_text(made.modtran(cases[7:]))
    (tmp_path / "all.tp7").write_text(made.modtran(cases))
    assert read_air([tmp_path / "a.tp7", tmp_path / "b.tp7"]).identical(read_air([tmp_path / "all.tp7"]))


def four(change):
    return "a.tp7", lambda: change(made.modtran(made.all_cases()))


def seven(change):
    return "TAPE7", lambda: change(made.lowtran7(made.all_cases()))


def comma(change):
    return "a.csv", lambda: change(made.modtran6_csv(made.all_cases()))


def keyed(change):
    def text():
        content = json.loads(made.modtran6_json(made.all_cases()))
        change(content["MODTRAN"])
        return json.dumps(content)

    return "a.json", text


def line_with(text, start, number=0):
    return [line for line in text.splitlines() if line.startswith(start)][number]


MISTAKES = {
    "empty": (("a.tp7", lambda: " \n"), "is empty"),
    "binary": (("a.tp7", lambda: "x\0y"), "is no text"),
    "another": (("a.tp7x", lambda: "tape6 of something\n"), "is of no known format"),
    "cut in a case": (four(lambda t: t[: len(t) // 2]), r"case \d+: (ends at line \d+ without -9999|line \d+: )"),
    "cut cards": (four(lambda t: t + "TM   2    2\n"), "something follows case 40"),
    "no names": (four(lambda t: t.replace("FREQ", "WAVE")), "has no line of column names"),
    "without a spectrum": (
        four(lambda t: t.replace("\n -9999.\n", "\n -9999.\n    0\n -9999.\n", 1)),
        "a case before case 2 has no spectrum",
    ),
    "repeated": (four(lambda t: t.replace(" 2405.00", " 2400.00", 1)), r"case 1: line 14: wavenumber = 2400 repeats the one before"),
    "unsorted": (four(lambda t: t.replace(" 2405.00", " 2415.00", 1)), r"case 1: line 15: wavenumber = 2410 is out of order"),
    "stars": (four(lambda t: t.replace("0.00E+00", "********", 1).replace(" 0.0000E+00", " **********", 1)), "did not fit its column"),
    "minus 99": (
        seven(lambda t: t.replace(line_with(t, "  2400. ")[:24], "  2400.  0.6000-9.90E+01", 1)),
        "thermal radiance = -99, allowed: 0 or more; that is the mark for no value",
    ),
    "zero wavenumber": (seven(lambda t: t.replace("  2400. ", "     0. ", 1)), "wavenumber = 0 is not above 0"),
    "zeros": (comma(lambda t: zeroed(t)), "case 1: .*thermal radiance is 0 everywhere|parts miss the total"),
    "no thermal": (keyed(lambda m: m[2]["MODTRANOUTPUT"]["SPECTRA"]["RADIANCE"].pop("THRML_EM")), "case 3: has no thermal path radiance"),
    "no transmittance": (
        comma(lambda t: t.replace("total transmittance", "x").replace("irradiance at observer", "y")),
        "TOT_TRANS .* missing",
    ),
    "moved": (
        four(lambda t: t.replace("SOL SCAT  SING SCAT", "SING SCAT  SOL SCAT").replace("PTH THRML", "REF THRML")),
        "case 3: has no thermal",
    ),
    "cells": (comma(lambda t: t.replace(",0,0", ",0", 1)), "the file is cut"),
    "no number": (comma(lambda t: t.replace("\n2405,", "\n2405,x", 1)), r"case 1: line 5: total transmittance = 'x"),
    "fewer rows": (comma(lambda t: t.replace(line_with(t, "2430,") + "\n", "", 1)), "has 6 of the 7 spectral samples"),
    "cut JSON": (("a.json", lambda: made.modtran6_json(made.all_cases())[:-300]), "is no JSON, or is cut short"),
    "input only": (keyed(lambda m: m[3].pop("MODTRANOUTPUT")), "case 4: has no MODTRANOUTPUT.SPECTRA"),
    "short list": (keyed(lambda m: m[0]["MODTRANOUTPUT"]["SPECTRA"]["RADIANCE"]["THRML_EM"].pop()), "has 6 of 7 spectral samples"),
    "other grid": (keyed(lambda m: m[2]["MODTRANINPUT"]["SPECTRAL"].update(V1=2500.0, V2=2530.0)), "give all lines of sight on one grid"),
    "other height": (
        keyed(lambda m: m[3]["MODTRANINPUT"]["GEOMETRY"].update(H1ALT=0.035)),
        "case 4: is a path from 35 m, those before are from 30 m",
    ),
    "above the horizon": (
        keyed(lambda m: m[9]["MODTRANINPUT"]["GEOMETRY"].update(OBSZEN=90.01)),
        r"passes above the sea.*does H1 fit the sensor",
    ),
    "up": (keyed(lambda m: m[9]["MODTRANINPUT"]["GEOMETRY"].update(OBSZEN=60.0)), "paths go from the sensor down to the sea"),
    "other Sun": (keyed(lambda m: m[3]["MODTRANINPUT"]["GEOMETRY"].update(PARM2=70.0)), "of Suns at 70, 76 deg"),
    "twice": (keyed(lambda m: m.append(m[0])), "same line of sight as"),
    "hole": (keyed(lambda m: m.pop(1)), "11 cases for 4 lines of sight and 3 azimuths"),
    "transmittance mode": (
        ("TAPE7", lambda: made.lowtran7([made.case(1, 2, 0.03, 91.0)]).replace("ATMOS   PATH", "H2O     CO2+")),
        "case 1: is of transmittance mode",
    ),
    "several lines at once": (four(lambda t: t.replace("    FREQ  TOT", "    FREQ LOS  TOT")), "several lines of sight side by side"),
    "no Sun": (keyed(lambda m: m.__delitem__(slice(-4, None))), "fewer than 2 zenith angles of the Sun"),
    "no geometry": (("a.csv", lambda: made.modtran6_csv(made.all_cases())), "does not say which line of sight it is; keep manifest.json"),
}


def zeroed(text):
    head, *rest = text.split("}\n", 1)
    lines = [line if not line[:1].isdigit() else ",".join([line.split(",")[0], "0.5"] + ["0"] * 9) for line in head.splitlines()]
    return "\n".join(lines) + "\n}\n" + rest[0]


@pytest.mark.parametrize("what", MISTAKES)
def test_mistakes_are_one_line_with_file_and_remedy(tmp_path, what):
    (name, text), told = MISTAKES[what]
    (tmp_path / name).write_text(text())
    with pytest.raises(DataError, match=told) as caught:
        read_air([tmp_path / name])
    assert str(caught.value).startswith(str(tmp_path / name))
    assert "\n" not in str(caught.value)


def mutated(text, rng):
    """A text with some bytes changed, dropped, doubled or cut off."""
    content = bytearray(text.encode())
    for _ in range(int(rng.integers(1, 6))):
        at, length = int(rng.integers(0, len(content))), int(rng.integers(1, 40))
        match rng.integers(0, 6):
            case 0:
                content[at] = int(rng.integers(1, 256))
            case 1:
                del content[at : at + length]
            case 2:
                content[at:at] = content[at : at + length]
            case 3:
                content[at : at + 1] = rng.choice([b"-99.", b"*", b"NaN", b"E", b"\n", b'"', b"[", b"1e999", b"0"])
            case 4:
                del content[at + len(content) // 2 :]
            case _:
                lines = content.split(b"\n")
                lines[int(rng.integers(0, len(lines)))] = lines[int(rng.integers(0, len(lines)))]
                content = bytearray(b"\n".join(lines))
        if not content:
            break
    return bytes(content)


@pytest.mark.parametrize("name", WRITERS)
def test_mutated_files_are_read_or_refused_in_a_line(tmp_path, name):
    """60 seeded mutations a format: never anything but an error of seaglint's own, of one line."""
    rng = np.random.default_rng([19, list(WRITERS).index(name)])
    text = WRITERS[name][0](made.all_cases(azimuths=(0.0, 180.0)))
    told: list[str] = []
    for _ in range(60):
        (tmp_path / name).write_bytes(mutated(text, rng))
        try:
            read_air([tmp_path / name])
        except SeaglintError as error:
            told.append(str(error))
    assert not [text for text in told if "\n" in text or len(text) > 600]
    assert 15 < len(told) <= 60
