"""One line per mistake: file, key path, value, what is allowed, the nearest valid key."""

from __future__ import annotations

import pytest

from seaglint.base.errors import ScenarioError
from seaglint.scenario.load import load_scenario, parse_scenario

MISTAKES = {
    "misspelt key": ({"sensor": {"hieght_m": 3}}, ["sensor.hieght_m", "unknown key", "sensor.height_m?"]),
    "wrong unit in a key": ({"sensor": {"height_ft": 3}}, ["sensor.height_ft", "sensor.height_m?"]),
    "far key of another table": ({"wind": {"direction_deg": 3}}, ["wind.direction_deg", "unknown key; allowed here: speed_m_s, from_deg"]),
    "nearest key of the same table first": (
        {"sensor": {"zenith_deg": 3}},
        ["sensor.zenith_deg", "did you mean sensor.azimuth_deg or sun.zenith_deg?"],
    ),
    "below the air table": ({"sensor": {"height_m": 0.001}}, ["sensor.height_m = 0.001", "0.01 to 100000 m", "atmosphere.source = 'none'"]),
    "above the air table": ({"sensor": {"height_m": 200_000}}, ["sensor.height_m = 200000", "100000 m", "'space'"]),
    "band below the air tables": ({"band": {"min_um": 1.5}}, ["band.min_um = 1.5", "2 to 5.5 um or 7.5 to 14 um"]),
    "band above the air tables": ({"band": {"min_um": 8, "max_um": 15}}, ["band.max_um = 15", "2 to 5.5 um or 7.5 to 14 um"]),
    "band in the gap": ({"band": {"min_um": 6, "max_um": 7}}, ["band.min_um = 6", "2 to 5.5 um or 7.5 to 14 um"]),
    "band across the gap": ({"band": {"min_um": 3, "max_um": 12}}, ["band.max_um = 12", "band.min_um = 3", "no band across the gap"]),
    "a word for a truth": ({"sea": {"resolve_waves": "yes"}}, ["sea.resolve_waves = 'yes'", "must be true or false"]),
    "a number for a truth": ({"sea": {"resolve_waves": 1}}, ["sea.resolve_waves = 1", "must be true or false"]),
    "missing buoy file": (
        {"sea": {"spectrum": {"kind": "file", "path": "nix.data_spec"}}},
        ["sea.spectrum.path = 'nix.data_spec'", "not a file"],
    ),
    "key in the wrong table": ({"sensor": {"speed_m_s": 3}}, ["sensor.speed_m_s", "wind.speed_m_s?"]),
    "unknown table": ({"winds": {"speed_m_s": 3}}, ["winds", "wind?"]),
    "nothing near": ({"sensor": {"qqq": 3}}, ["sensor.qqq", "allowed here: height_m"]),
    "key of another kind": ({"atmosphere": {"source": "none", "model": "x"}}, ["atmosphere.model", "does not go with this source"]),
    "above all air": ({"sensor": {"height_m": "200 km"}}, ["sensor.height_m = '200 km'", "above 0 to 100000 m", "write 'space'"]),
    "above LOWTRAN7's program": (
        {"sensor": {"height_m": 60e3}, "atmosphere": {"source": "lowtran-fortran"}},
        ["sensor.height_m = 60000", "0.01 to 50000 m", "atmosphere.source = 'lowtran'"],
    ),
    "below the range": ({"sensor": {"height_m": -3}}, ["sensor.height_m = -3", "above 0 to 100000 m"]),
    "above the range": ({"sea": {"temperature_k": 400}}, ["sea.temperature_k = 400", "260 to 320 K"]),
    "Celsius as kelvin": ({"sea": {"temperature_k": 15}}, ["sea.temperature_k = 15", "260 to 320 K"]),
    "text out of range": ({"sensor": {"height_m": "-30 ft"}}, ["sensor.height_m = '-30 ft'", "above 0 to 100000 m"]),
    "unit of another kind": ({"sensor": {"height_m": "30 kg"}}, ["sensor.height_m = '30 kg'", "another kind", "m"]),
    "unknown unit": ({"sensor": {"height_m": "30 blah"}}, ["unknown unit 'blah'", "30 ft"]),
    "text without unit": ({"sensor": {"height_m": "30"}}, ["sensor.height_m = '30'", "no unit"]),
    "hostile unit": ({"sensor": {"height_m": "30 __import__('os')"}}, ["sensor.height_m", "unknown unit"]),
    "braces in text": ({"sensor": {"height_m": "30 {0}{text}"}}, ["sensor.height_m = '30 {0}{text}'"]),
    "NaN": ({"sensor": {"elevation_deg": float("nan")}}, ["sensor.elevation_deg = nan", "not finite", "-90 to 90 deg"]),
    "infinite": ({"wind": {"speed_m_s": float("inf")}}, ["wind.speed_m_s = inf", "not finite"]),
    "zero pixels": ({"sensor": {"pixels": [0, 256]}}, ["sensor.pixels[0] = 0", "1 to 65536"]),
    "half a frame": ({"sensor": {"frames": 2.5}}, ["sensor.frames = 2.5", "whole number"]),
    "a truth for a number": ({"sensor": {"frames": True}}, ["sensor.frames = true"]),
    "one number for a pair": ({"sensor": {"pixels": 512}}, ["sensor.pixels = 512", "[width, height]"]),
    "three numbers for a pair": ({"sensor": {"fov_deg": [1, 2, 3]}}, ["sensor.fov_deg = [1, 2, 3]", "[width, height]"]),
    "a number for a table": ({"sea": 3}, ["sea = 3", "table [sea]", "temperature_k"]),
    "a text for a union": ({"sea": {"spectrum": "file"}}, ["sea.spectrum = 'file'", "table [sea.spectrum]"]),
    "unknown kind": ({"sea": {"spectrum": {"kind": "elfouhali"}}}, ["kind = 'elfouhali'", "'flat'", "did you mean 'elfouhaily'"]),
    "unknown kind of a system": (
        {"sea": {"spectrum": {"kind": "systems", "systems": [{"kind": "swell"}]}}},
        ["sea.spectrum.systems[0].kind = 'swell' is not one of 'elfouhaily'", "'jonswap'"],
    ),
    "system without a kind": (
        {"sea": {"spectrum": {"kind": "systems", "systems": [{}]}}},
        ["sea.spectrum.systems[0].kind is missing; add one of 'elfouhaily'"],
    ),
    "no system": (
        {"sea": {"spectrum": {"kind": "systems", "systems": []}}},
        ["sea.spectrum.systems = []", "one spectrum or more", "'flat'"],
    ),
    "missing key of a system": (
        {"sea": {"spectrum": {"kind": "systems", "systems": [{"kind": "elfouhaily"}, {"kind": "jonswap", "peak_period_s": 9}]}}},
        ["sea.spectrum.systems[1].significant_height_m is missing"],
    ),
    "system out of range": (
        {"sea": {"spectrum": {"kind": "systems", "systems": [{"kind": "jonswap", "significant_height_m": 40, "peak_period_s": 9}]}}},
        ["sea.spectrum.systems[0].significant_height_m = 40", "0.01 to 30 m"],
    ),
    "key of another kind of system": (
        {"sea": {"spectrum": {"kind": "systems", "systems": [{"kind": "elfouhaily", "gamma": 3}]}}},
        ["sea.spectrum.systems[0].gamma", "does not go with this kind of sea.spectrum.systems[0]"],
    ),
    "unknown format of waves": (
        {"sea": {"spectrum": {"kind": "file", "path": __file__, "format": "swn"}}},
        ["sea.spectrum.format = 'swn' is not one of 'auto', 'ndbc'", "did you mean 'swan'?"],
    ),
    "latitude alone": (
        {"sea": {"spectrum": {"kind": "file", "path": __file__, "latitude_deg": 3.0}}},
        ["sea.spectrum.longitude_deg is missing"],
    ),
    "longitude alone": (
        {"sea": {"spectrum": {"kind": "file", "path": __file__, "longitude_deg": 3.0}}},
        ["sea.spectrum.longitude_deg = 3.0 needs latitude_deg beside it"],
    ),
    "spreading too wide": (
        {"sea": {"spectrum": {"kind": "jonswap", "significant_height_m": 1, "peak_period_s": 9, "spreading_deg": 90}}},
        ["sea.spectrum.spreading_deg = 90", "1 to 80 deg"],
    ),
    "unknown choice": ({"atmosphere": {"model": "us-standard"}}, ["atmosphere.model = 'us-standard'", "did you mean 'us-standard-1976'"]),
    "lines that do not part": ({"render": {"lines_per_column": 3}}, ["render.lines_per_column = 3", "1, 2, 4, 8"]),
    "missing key": ({"sea": {"spectrum": {"kind": "file"}}}, ["sea.spectrum.path is missing"]),
    "missing file": ({"band": {"response": "nix.csv"}}, ["band.response = 'nix.csv'", "not a file"]),
    "no date": ({"time": {"utc": "2026-13-01"}}, ["time.utc = '2026-13-01'", "2026-06-21T17:30:00Z"]),
    "time without place": ({"time": {"utc": "2026-12-01"}}, ["place is missing", "latitude_deg"]),
    "place without time": ({"place": {"latitude_deg": 3, "longitude_deg": 4}}, ["time is missing"]),
    "two Suns": (
        {"sun": {}, "time": {"utc": "2026-12-01"}, "place": {"latitude_deg": 3, "longitude_deg": 4}},
        ["sun is given together with [time]"],
    ),
    "band upside down": ({"band": {"min_um": 5, "max_um": 4}}, ["band.min_um = 5", "band.max_um = 4"]),
    "wind above the fit": ({"wind": {"speed_m_s": 31}}, ["wind.speed_m_s = 31", "0 to 20 m/s", "sea.slopes.extrapolate = true"]),
    "extrapolated slopes under a table": (
        {"wind": {"speed_m_s": 25}, "sea": {"slopes": {"extrapolate": True}}},
        ["wind.speed_m_s = 25", "aerosol", "atmosphere.source = 'none'"],
    ),
    "slopes of no air": ({"wind": {"speed_m_s": 25}, "atmosphere": {"source": "none"}}, ["wind.speed_m_s = 25", "cox-munk-anisotropic"]),
    "over the pole": ({"sensor": {"elevation_deg": -88}}, ["sensor.elevation_deg = -88", "-92", "-90 to 90 deg"]),
}  # fmt: skip


@pytest.mark.parametrize("case", MISTAKES)
def test_each_mistake_is_one_line_that_helps(case):
    values, words = MISTAKES[case]
    with pytest.raises(ScenarioError) as caught:
        parse_scenario(values, name="my.toml")
    text = str(caught.value)
    assert "\n" not in text
    assert text.startswith("my.toml: ")
    for word in words:
        assert word in text


def test_several_mistakes_are_told_at_once():
    with pytest.raises(ScenarioError) as caught:
        parse_scenario({"sensor": {"height_m": -3, "frames": 0}, "wind": {"speed": 3}})
    assert len(str(caught.value).splitlines()) == 3


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"[sensor\nheight_m = 3", ["not valid TOML", "line 1"]),
        (b"[sensor]\nheight_m = ", ["not valid TOML", "is the file whole"]),
        (b"[wind]\nspeed_m_s = 12 kn", ["not valid TOML", "quotes"]),
        (b"seed = 1\nseed = 2", ["not valid TOML"]),
        (b"\xff\xfe\x00", ["not UTF-8"]),
        (b"\x00\x01", ["not valid TOML"]),
    ],
)
def test_files_that_are_no_scenario(tmp_path, content, words):
    path = tmp_path / "my.toml"
    path.write_bytes(content)
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert str(path) in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_a_byte_order_mark_is_no_mistake(tmp_path):
    path = tmp_path / "my.toml"
    path.write_bytes(b"\xef\xbb\xbfseed = 7\n")
    assert load_scenario(path).seed == 7


def test_an_empty_file_is_the_default_scenario(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text("")
    assert load_scenario(path) == parse_scenario({})


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(ScenarioError, match="no such file; 'seaglint init"):
        load_scenario(tmp_path / "nix.toml")
    with pytest.raises(ScenarioError, match="is a folder"):
        load_scenario(tmp_path)


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("2020-06-07T18:40:00", True),
        ('"2020-06-07 18:40"', True),
        ("2020-06-07T18:40:00Z", False),
        ("2020-06-07T18:40:00-05:00", False),
        ('"2020-06-07T18:40+02:00"', False),
    ],
)
def test_a_time_without_a_zone_is_told(written, told, tmp_path, caplog):
    path = tmp_path / "my.toml"
    path.write_text(f"[time]\nutc = {written}\n[place]\nlatitude_deg = 30\nlongitude_deg = -78\n")
    load_scenario(path)
    said = [record.getMessage() for record in caplog.records]
    assert bool(said) == told
    if told:
        assert "time.utc = 2020-06-07T18:40:00 has no time zone and is taken as UTC" in said[0]
