"""Mutated scenarios and files: every one is read or refused in lines of our own, soon, and what is read is finite.

Seeded: a mutation is a function of its number. The normal run takes the first few of each; ``-m validation`` takes all of them.
"""

from __future__ import annotations

import contextlib
import gc
import io
import math
import random
import shutil
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import wave_files
import xarray as xr
from hdf5_walker import Hdf5Walker
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from seaglint.base.errors import ScenarioError, SeaglintError
from seaglint.formats.air_file import read_atmosphere, write_atmosphere
from seaglint.formats.recording import open_recording
from seaglint.formats.tables.input_tables import read_cases, read_track
from seaglint.formats.tables.spectra import read_response
from seaglint.formats.waves import WaveChoice, read_waves
from seaglint.optics.band import Band
from seaglint.scenario.keys import key_paths
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.text.template import template
from seaglint.store.layout import Layout
from seaglint.store.netcdf import write_netcdf
from seaglint.store.provenance import band_attributes, provenance
from seaglint.store.sequence_store import write_sequence
from seaglint.studies.air_files import export_air
from seaglint.studies.file_contents import describe, lines

PATIENCE = 600.0
"""Seconds of the processor from which reading a small file counts as a hang: no machine is that slow."""

FEW, MANY_SCENARIOS, MANY_FILES = 40, 10_000, 1_000

VALUES: list[Any] = [
    *(0, -1, 1, 3, 10**400, -(10**400), 2**63, 1e-320, 1e308, -1e308, math.inf, -math.inf, math.nan, 0.5, True, False),
    *("", "3 dB", "50 %", "12 kn", "-5 m", "1e999 m", "٣ m", "nan", "inf deg", "{}", "table", "file", "a" * 300, "\0", "\ud7ff", "none"),
    *([], [1], [1, 2, 3], ["3 deg", 2], [[1]], {}, {"kind": "file"}, {"a": {"b": 1}}, None),
]


def quick_and_all(many: int) -> pytest.MarkDecorator:
    """Shares of the numbers of the mutations: the first few in the normal run, all marked ``validation``."""
    return pytest.mark.parametrize(
        "numbers", [pytest.param(range(FEW), id="few"), pytest.param(range(FEW, many), id="all", marks=pytest.mark.validation)]
    )


@contextlib.contextmanager
def quietly() -> Iterator[None]:
    """No hang, and nothing that fails when it is collected and tells it after the line."""
    unraised: list[str] = []
    before, sys.unraisablehook = sys.unraisablehook, lambda args: unraised.append(repr(args.exc_value))
    start = time.process_time()
    try:
        yield
        gc.collect(0)
    finally:
        sys.unraisablehook = before
    assert time.process_time() - start < PATIENCE
    assert not unraised


def told(error: SeaglintError) -> None:
    assert str(error)
    assert "Traceback" not in str(error)
    assert len(str(error)) < 5000


def mutated_values(raw: dict[str, Any], rnd: random.Random) -> dict[str, Any]:
    """A scenario with one to three keys of any table set to odd values."""
    for _ in range(rnd.randint(1, 3)):
        path = rnd.choice(list(key_paths())).split(".")
        table = raw
        for part in path[:-1]:
            if not isinstance(table.get(part), dict):
                table[part] = {}
            table = table[part]
        table[path[-1]] = rnd.choice(VALUES)
    return raw


def finite(value: Any) -> bool:
    if isinstance(value, dict):
        return all(map(finite, value.values()))
    if isinstance(value, list | tuple):
        return all(map(finite, value))
    return not isinstance(value, float) or math.isfinite(value)


@quick_and_all(MANY_SCENARIOS)
def test_scenarios(numbers):
    whole = tomllib.loads(template("glint"))
    for number in numbers:
        rnd = random.Random(number)
        raw = mutated_values({key: dict(value) if isinstance(value, dict) else value for key, value in whole.items()}, rnd)
        with quietly():
            try:
                assert finite(parse_scenario(raw).model_dump()), raw
            except ScenarioError as error:
                told(error)


def mutated(content: bytes, rnd: random.Random) -> bytes:
    """Bytes changed, cut, doubled or moved."""
    out = bytearray(content)
    match rnd.randrange(4):
        case 0:
            del out[rnd.randrange(len(out)) :]
        case 1:
            at, size = rnd.randrange(len(out)), rnd.randint(1, 40)
            out[at:at] = out[at : at + size] if rnd.random() < 0.5 else rnd.randbytes(size)
        case 2:
            at = rnd.randrange(len(out))
            del out[at : at + rnd.randint(1, 40)]
        case _:
            for _ in range(rnd.choice([1, 3, 30])):
                out[rnd.randrange(len(out))] = rnd.choice([0, 255, 45, 46, 44, 10, 34, 101, rnd.randrange(256)])
    return bytes(out)


@quick_and_all(MANY_SCENARIOS // 10)
def test_scenario_files(tmp_path, numbers):
    path, whole = tmp_path / "my.toml", template("glint").encode()
    for number in numbers:
        path.write_bytes(mutated(whole, random.Random(number)))
        with quietly():
            try:
                assert finite(load_scenario(path).model_dump())
            except ScenarioError as error:
                told(error)


FRAMES = np.random.default_rng(1).integers(0, 4000, (3, 8, 12)).astype(np.uint16)


def picture(kind: str) -> bytes:
    stream = io.BytesIO()
    Image.fromarray(FRAMES[0]).save(stream, format=kind)
    return stream.getvalue()


def numpy_file() -> bytes:
    stream = io.BytesIO()
    np.save(stream, FRAMES)
    return stream.getvalue()


def map_file(folder: Path) -> bytes:
    attributes = provenance("Noise", "{}", 1, **band_attributes(Band.rectangular(3.5, 5.0)))
    data = xr.Dataset(
        {"radiance": (("y", "x"), np.ones((4, 6), np.float32))}, {"azimuth": ("x", np.arange(6.0)), "elevation": ("y", -np.arange(4.0))},
        attributes,
    )  # fmt: skip
    return write_netcdf(data, folder / "whole.nc", overwrite=True).read_bytes()


def air_csv() -> bytes:
    rows = [f"path,30,{r},,{v},0.9,1e-5," for r in (10, 1000) for v in (2000, 2005)]
    rows += [f"sky,0,,{z},{v},,1e-4," for z in (0, 90) for v in (2000, 2005)]
    rows += [f"sun,,,{z},{v},,,1e-3" for z in (0, 90) for v in (2000, 2005)]
    return ("\n".join(["kind,height_m,range_m,zenith_deg,wavenumber_cm,transmittance,radiance,irradiance", *rows]) + "\n").encode()


def air_netcdf(folder: Path) -> bytes:
    """What ``atmosphere export`` writes, on few wavenumbers."""
    wanted = parse_scenario({"band": {"min_um": 3.9, "max_um": 4.0}, "atmosphere": {"source": "isothermal", "temperature_k": 288}})
    return write_atmosphere(export_air(wanted), folder / "whole.nc", overwrite=True).read_bytes()


def hdf5_file(folder: Path) -> bytes:
    with h5py.File(folder / "whole.h5", "w") as file:
        file.create_dataset("frames", data=FRAMES, compression="gzip")
    return (folder / "whole.h5").read_bytes()


def archive() -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, frames=FRAMES)
    return stream.getvalue()


def look(path: Path) -> None:
    found = open_recording(path)
    count = min(found.frames, 3)
    assert found.read(0, count).shape == (count, found.rows, found.columns)


def look_at_air(path: Path) -> None:
    spectra = read_atmosphere(path, 30.0).path(30.0, [500.0])
    assert all(np.isfinite(part).all() for part in spectra)


def look_at_track(path: Path) -> None:
    assert all(np.isfinite(values).all() for values in read_track(path)[0].values())


def look_at_cases(path: Path) -> None:
    cases = read_cases(path)
    for name in cases.header:
        assert np.isfinite(cases.numbers(name)).all()


READERS: dict[str, tuple[Callable[[Path], bytes], Callable[[Path], object]]] = {
    "a.png": (lambda _: picture("png"), look),
    "a.tif": (lambda _: picture("tiff"), look),
    "a.npy": (lambda _: numpy_file(), look),
    "a.npz": (lambda _: archive(), look),
    "a.h5": (hdf5_file, look),
    "map.nc": (map_file, lambda path: lines(describe(path))),
    "rec.nc": (map_file, look),
    "air.csv": (lambda _: air_csv(), look_at_air),
    "air.nc": (air_netcdf, look_at_air),
    "track.csv": (lambda _: b"time_s,east_m,height_m\n0,0,30\n1,5,31\n2,9,32\n", look_at_track),
    "response.csv": (lambda _: b"wavelength_um,response\n3.0,0\n3.5,0.5\n4,1\n4.5,0.5\n5,0\n", read_response),
    "cases.csv": (lambda _: b"wavelength_um,wind_speed_m_s,zenith_deg\n4,5,30\n4,6,40\n", look_at_cases),
}


@pytest.fixture
def hdf5() -> Iterator[Hdf5Walker]:
    """Says which damaged files no reader that rests on HDF5 can get through."""
    walker = Hdf5Walker()
    yield walker
    walker.close()


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", READERS)
@quick_and_all(MANY_FILES)
def test_files(tmp_path, name, numbers, hdf5):
    make, read = READERS[name]
    whole, path = make(tmp_path), tmp_path / name
    for number in numbers:
        path.write_bytes(mutated(whole, random.Random(number)))
        if hdf5.hangs(path):
            continue
        with quietly():
            try:
                read(path)
            except SeaglintError as error:
                told(error)


def numbers_of(many: int) -> pytest.MarkDecorator:
    """As :func:`quick_and_all`, a tenth of them in the normal run: each of these takes some hundredths of a second."""
    few = FEW // 10
    return pytest.mark.parametrize(
        "numbers", [pytest.param(range(few), id="few"), pytest.param(range(few, many), id="all", marks=pytest.mark.validation)]
    )


WAVES = ("ndbc", "ndbc_historical", "ndbc_netcdf", "cdip", "mhkit", "spotter_json", "spotter_csv", "swan", "swan_netcdf", "ww3",
         "ww3_netcdf", "era5", "triaxys", "triaxys_plain", "octopus", "datawell", "own",
         "obscape", "awac", "awac_directions", "wwm")  # fmt: skip
THEN = WaveChoice(str(wave_files.TIMES[1]), wave_files.LATITUDE, wave_files.LONGITUDE)
FLAT = WaveChoice(THEN.time, THEN.latitude_deg, THEN.longitude_deg, from_deg=230.0, spreading_deg=30.0)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kind", WAVES)
@numbers_of(MANY_FILES // 5)
def test_wave_files(tmp_path, kind, numbers, hdf5):
    pytest.importorskip("wavespectra", reason="wavespectra, which reads wave files, is not installed")
    path = getattr(wave_files, kind)(tmp_path)
    whole, choice = path.read_bytes(), FLAT if kind == "triaxys_plain" else THEN
    assert read_waves(path, choice).spectrum.significant_height() > 1.0
    for number in numbers:
        path.write_bytes(mutated(whole, random.Random(number)))
        if hdf5.hangs(path):
            continue
        with quietly():
            try:
                assert math.isfinite(read_waves(path, choice).spectrum.significant_height())
            except SeaglintError as error:
                told(error)


@pytest.mark.filterwarnings("ignore")
@quick_and_all(MANY_FILES // 2)
def test_stores(tmp_path, numbers):
    """One file of the store changed, cut or removed."""
    layout = Layout(np.arange(6.0), -np.arange(4.0), range(3), 25.0, Band.rectangular(3.5, 5.0), attributes=provenance("Noise", "{}", 1))
    whole = write_sequence(tmp_path / "whole.zarr", layout, lambda number: {"radiance": np.full((4, 6), float(number), np.float32)})
    files = sorted(path.relative_to(whole) for path in whole.rglob("*") if path.is_file())
    for number in numbers:
        rnd, copy = random.Random(number), tmp_path / "run.zarr"
        shutil.copytree(whole, copy)
        spoiled = copy / rnd.choice(files)
        content = spoiled.read_bytes()
        if rnd.random() < 0.1:
            spoiled.unlink()
        else:
            spoiled.write_bytes(mutated(content, rnd))
        for read in (lambda path: lines(describe(path)), look):
            with quietly():
                try:
                    read(copy)
                except SeaglintError as error:
                    told(error)
        shutil.rmtree(copy)


TREES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from([p.split(".")[-1] for p in key_paths()]), inner, max_size=4)
    ),
    max_leaves=8,
)


@given(raw=st.dictionaries(st.sampled_from(sorted({p.split(".")[0] for p in key_paths()})), TREES, max_size=4))
@settings(max_examples=60)
def test_any_mapping(raw):
    try:
        assert finite(parse_scenario(raw).model_dump())
    except ScenarioError as error:
        told(error)
