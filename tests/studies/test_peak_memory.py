"""Peak memory of the source article's case, in processes of their own."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("resource", reason="peak memory is read with getrusage")

# Article: 14 km long, 3.5 km wide at 14 km (14.25 deg), 1 m lattice; it needed 1.1 GB, then 40-fold less.
ALLOWED_MB = 150.0

PROGRAM = """
import resource, sys
from seaglint.studies.sequence.render_sequence import render
from seaglint.scenario.load import parse_scenario
pixels, output = int(sys.argv[1]), sys.argv[2]
scenario = parse_scenario({
    "sun": {"zenith_deg": 75.0, "azimuth_deg": 180.0},
    "sensor": {"height_m": 50.0, "azimuth_deg": 180.0, "elevation_deg": -6.9, "fov_deg": [14.25, 14.25],
               "pixels": [pixels, pixels], "frames": 2},
    "wind": {"speed_m_s": 10.0, "from_deg": 200.0},
    "sea": {"shortest_wave_m": 4.0},
})
render(scenario, output, threads=2)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


def _peak_mb(pixels: int, folder: Path) -> float:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(pixels), str(folder / f"{pixels}.zarr")], capture_output=True, text=True, check=True
    )
    unit = 1024.0 if sys.platform != "darwin" else 1024.0 * 1024.0
    return float(done.stdout.split()[-1]) / unit


@pytest.mark.validation
def test_the_articles_case_needs_little_more_than_a_tiny_frame(tmp_path):
    warm = tmp_path / "warm"
    warm.mkdir()
    for pixels in (16, 512):  # compile and cache the kernels, which costs memory of its own
        _peak_mb(pixels, warm)
    small, large = _peak_mb(16, tmp_path), _peak_mb(512, tmp_path)
    print(f"peak memory: 16 x 16 pixels {small:.0f} MB, 512 x 512 pixels {large:.0f} MB, difference {large - small:.0f} MB")
    assert large - small < ALLOWED_MB
