"""Memory that a scenario's images need, and refusal of scenarios that need more than is available."""

from __future__ import annotations

import ctypes
import math
import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from seaglint.base.errors import DataError, ScenarioError
from seaglint.imaging.refraction import FINER
from seaglint.instrument.chain import SensorModel
from seaglint.scenario.model import Scenario
from seaglint.sea.tiles import TILES
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.scenario_physics import bends_by_profile
from seaglint.studies.build.sensor_model import sensor_model

BYTES_PER_PIXEL = 80  #: Images of one frame on the sweep's own grid: two of doubles by column, two of floats by row, and what is written.

#: Bytes per pixel of a turned camera: corners (50), nine or more cells of the sweep (9 x 40), weights of about 25 cells (25 x 16).
BYTES_PER_RESAMPLED_PIXEL = 1000

#: Images before a detector: the picture, its spectrum and the transfer. 49 measured for staring arrays, 38 for scanners.
BYTES_PER_SENSED_PIXEL = 60

BYTES_PER_LATTICE_POINT = 200  #: Amplitudes, transforms and surface of one wave tile.

BYTES_PER_MEAN_PIXEL = 90  #: Maps of a mean: seven of doubles, and what is written.

#: Components and variance along one line of sight of a mean map, by its mode. 34 to 73 and 118 measured, with all of refraction.
BYTES_PER_MEAN_SIGHT = {"spectral": 70, "article": 130}

BASE = 250 << 20  #: Program, atmosphere and tables of facets.


def memory_needed(scenario: Scenario, oversampling: int = 1, model: SensorModel | None = None) -> int:
    """Estimate the largest memory that rendering a frame takes, ``oversampling`` times finer than the sensor's pixels [bytes].

    With ``model`` the margins of its blur are counted.
    """
    columns, rows = (oversampling * size for size in scenario.sensor.pixels)
    scan = scenario.sensor.scan
    scanned = scan is not None and scan.kind != "staring" and scan.period_s != 0.0  # column after column, however it is turned
    each = BYTES_PER_SENSED_PIXEL if scenario.sensor.senses else BYTES_PER_PIXEL
    if not scanned and scenario_physics.upright_camera(scenario) is None:
        each = BYTES_PER_RESAMPLED_PIXEL
    if bends_by_profile(scenario):
        # Refraction by a profile draws additional finer rows.
        rows *= 1 + FINER
    pixels = columns * rows * each * (2 if scenario.render.layers else 1)
    waves = TILES * scenario.render.tile_size**2 * BYTES_PER_LATTICE_POINT if scenario.sea.resolve_waves else 0
    blurred = 0 if model is None else model.transfer_bytes((scenario.sensor.pixels[1], scenario.sensor.pixels[0]), oversampling)
    return BASE + max(pixels, blurred) + waves


def memory_available() -> int | None:
    """Return the available memory [bytes]: the system's, or a container's limit if that is less; None if it is unknown."""
    limits = []
    with suppress(OSError, ValueError):
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                limits.append(1024 * int(line.split()[1]))
    with suppress(OSError, ValueError):
        limit = Path("/sys/fs/cgroup/memory.max").read_text().strip()
        if limit != "max":
            limits.append(int(limit) - int(Path("/sys/fs/cgroup/memory.current").read_text()))
    if not limits and hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        limits.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    return max(min(limits), 0) if limits else None


def require_room(need: int, what: str, remedy: str) -> None:
    """Refuse work that takes more memory than is available.

    Raises
    ------
    DataError
        With the needed and the available memory.
    """
    available = memory_available()
    if available is not None and need > available:
        raise DataError(f"{what} needs about {need / 1e9:.1f} GB of memory, and {available / 1e9:.1f} GB are free; {remedy}")


def require_memory(scenario: Scenario, oversampling: int = 1, model: SensorModel | None = None) -> None:
    """Refuse a scenario whose images cannot fit.

    Raises
    ------
    ScenarioError
        With the needed and the available memory.
    """
    need, available = memory_needed(scenario, oversampling, model), memory_available()
    if available is None or need <= available:
        return
    (columns, rows), tile = scenario.sensor.pixels, scenario.render.tile_size
    # The finest oversampling that fits is recommended.
    coarser = next((n for n in range(oversampling - 1, 0, -1) if memory_needed(scenario, n, model) <= available), None)
    drawn = f" drawn {oversampling} x {oversampling} finer (render.oversampling)" if oversampling > 1 else ""
    remedy = "fewer pixels or a smaller render.tile_size"
    if coarser is not None:
        remedy = f"render.oversampling = {coarser}, which folds finer detail into the picture, or {remedy}"
    raise ScenarioError(
        f"sensor.pixels = [{columns}, {rows}]{drawn} with render.tile_size = {tile} needs about {need / 1e9:.1f} GB of memory, and "
        f"{available / 1e9:.1f} GB are free; give {remedy}"
    )


BYTES_PER_SEA = 12  #: Memory for a pixel of the maps of a drawn sea [bytes]: three numbers of four bytes.


def require_mean_memory(scenario: Scenario, sights: int | None = None, seas: int = 0) -> None:
    """Refuse a mean map that cannot fit, by its lines of sight; by default one through each pixel.

    ``seas`` is the number of drawn seas of which maps are stored together.

    Raises
    ------
    ScenarioError
        With the needed and the available memory.
    """
    columns, rows = scenario.sensor.pixels
    lines = columns * rows if sights is None else sights
    need = BASE + (BYTES_PER_MEAN_PIXEL + BYTES_PER_SEA * seas) * columns * rows + BYTES_PER_MEAN_SIGHT[scenario.mean.mode] * lines
    available = memory_available()
    if available is None or need <= available:
        return
    # Memory grows with the pixels, so sides shrink with the root of the ratio.
    side = math.sqrt((available - BASE) / max(need - BASE, 1)) if available > BASE else 0.0
    fewer = [2 ** math.floor(math.log2(side * size)) if side * size >= 1.0 else 1 for size in (columns, rows)]
    raise ScenarioError(
        f"sensor.pixels = [{columns}, {rows}] needs about {need / 1e9:.1f} GB of memory for a mean map, and {available / 1e9:.1f} GB are "
        f"free; give fewer pixels, e.g. sensor.pixels = [{fewer[0]}, {fewer[1]}]"
    )


def require_memory_of_all(scenarios: Iterable[Scenario]) -> None:
    """Refuse scenes of which one cannot fit; scenes with the same sensor are checked once.

    Raises
    ------
    SeaglintError
        With the needed and the available memory; a sensor that cannot be.
    """
    checked: set[str] = set()
    for scenario in scenarios:
        # The azimuth does not change the memory, so scenes that differ in it alone are checked once.
        drawn = (scenario.sensor.model_copy(update={"azimuth_deg": 0.0}), scenario.render, scenario.sea.resolve_waves)
        key = repr((drawn, scenario.platform is None, scenario.atmosphere.source))
        if key in checked:
            continue
        checked.add(key)
        model = sensor_model(scenario) if scenario.sensor.senses else None
        require_memory(scenario, 1 if model is None else scenario.render.oversampling or model.oversampling, model)


def give_back() -> None:
    """Return freed memory to the system, if the C library caches it.

    The C library caches freed memory per thread (2 GB after a hundred scenes of 128 x 128 pixels).
    """
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # of glibc; other libraries give memory back by themselves
        if trim is not None:
            trim(0)
