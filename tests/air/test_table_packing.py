"""How the tables are packed: small, quick to read, true to their integers, and only what the band needs."""

from importlib import resources

import numpy as np
import pytest

from seaglint.air import lowtran_table
from seaglint.air.lowtran_table import BatchAtmosphere, models, read_table
from seaglint.base.errors import DataError

QUANTITIES = ("path_depth", "path_temperature", "sun_depth", "sky_temperature")
PACKAGE_BYTES = 15e6


def test_all_tables_together_stay_small():
    folder = resources.files("seaglint.air").joinpath("data")
    assert sum(len(f.read_bytes()) for f in folder.iterdir() if f.name.endswith(".npz")) < PACKAGE_BYTES


@pytest.mark.parametrize("region", ["mwir", "lwir"])
def test_a_table_is_decoded_once_a_process(region, monkeypatch):
    decoded = []
    original = lowtran_table._decoded
    monkeypatch.setattr(lowtran_table, "_decoded", lambda table, name: decoded.append(name) or original(table, name))
    read_table.cache_clear()
    first = read_table("us-standard-1976", region)
    assert read_table("us-standard-1976", region) is first
    assert sorted(decoded) == sorted(QUANTITIES)


@pytest.mark.parametrize("region", ["mwir", "lwir"])
@pytest.mark.parametrize("name", QUANTITIES)
def test_components_are_orthonormal_rows(name, region):
    # A scale lost in decoding would show here; 16 bits of a row whose largest entry is below 1 leave 1e-4.
    components = read_table("us-standard-1976", region)[f"{name}_components"]
    np.testing.assert_allclose(components @ components.T, np.eye(len(components)), atol=1e-4)


@pytest.mark.parametrize("name", QUANTITIES)
def test_byte_planes_of_differences_decode(name):
    # Two winds, one node, one component, written by hand: 300 and 300 - 65537; step 0.5, component [0.25] as 8192 / 32768.
    planes = np.array([[300, -65537]], dtype="<i4").view(np.uint8).reshape(2, 4).T.reshape(4, 1, 2, 1)
    decoded = lowtran_table._decoded(
        {
            f"{name}_scores": planes,
            f"{name}_step": np.array(0.5),
            f"{name}_components": np.array([[8192]], dtype=np.int16),
            f"{name}_scale": np.array([1.0 / 32768.0], dtype=np.float32),
        },
        name,
    )
    np.testing.assert_array_equal(decoded[f"{name}_scores"], [[[150.0]], [[150.0 - 32768.5]]])
    np.testing.assert_array_equal(decoded[f"{name}_components"], [[0.25]])


def test_a_band_reads_its_own_file_only(monkeypatch):
    read = []
    original = lowtran_table.read_table
    monkeypatch.setattr(lowtran_table, "read_table", lambda model, region: read.append((model, region)) or original(model, region))
    BatchAtmosphere.load("us-standard-1976", (8.0, 12.0))
    assert read == [("us-standard-1976", "lwir")]


def test_tables_cannot_be_written_to():
    with pytest.raises(ValueError, match="read-only"):
        read_table("us-standard-1976", "lwir")["winds"][0] = 1.0


def test_a_damaged_file_is_reported_in_one_line(tmp_path, monkeypatch):
    name = f"{models('lwir')[0]}_lwir.npz"
    content = resources.files("seaglint.air").joinpath("data", name).read_bytes()
    (tmp_path / name).write_bytes(content[: len(content) // 2])
    monkeypatch.setattr(lowtran_table, "_DATA", tmp_path)
    read_table.cache_clear()
    with pytest.raises(DataError, match=r"is damaged .*install seaglint again"):
        read_table(name.removesuffix("_lwir.npz"), "lwir")


@pytest.fixture(autouse=True)
def _fresh_cache():
    yield
    read_table.cache_clear()
