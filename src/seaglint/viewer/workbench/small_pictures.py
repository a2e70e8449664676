"""Small pictures of a scenario, computed in a separate process so that the page responds meanwhile."""

from __future__ import annotations

import math
import pickle
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import SeaglintError
from seaglint.scenario.model import Scenario

Job = Literal["mean", "frame"]

#: Largest number of pixels of a small picture; most of the time is spent on tables, which do not depend on it.
MOST_PIXELS: Final = 160 * 80

_COARSE: Final = {"lines_per_column": 2, "variance_error": 0.2, "layers": (), "apparent_temperature": False}


@dataclass(frozen=True, eq=False)
class PreviewPicture:
    """Radiance [W m-2 sr-1] and apparent temperature [K] of a small picture, (rows, columns) from the top."""

    radiance: NDArray[np.float32]  #: Radiance [W m-2 sr-1], (rows, columns) from the top.
    temperature: NDArray[np.float32]  #: Apparent temperature [K], (rows, columns) from the top.
    azimuth: (
        tuple[float, float] | None
    )  #: Edges of the picture across, of a grid of angles [deg]; None for other pictures, which count pixels.
    elevation: tuple[float, float] | None  #: Edges of the picture in elevation, of a grid of angles [deg]; None for other pictures.
    pixels: tuple[int, int]  #: Width and height of the whole picture.
    seconds: float  #: Time of the computation [s].
    #: Angle of the pixels below the sea's horizon [deg], of a shape that broadcasts to the shape of the picture.
    depression: NDArray[np.float64] | None = None


def reduced(scenario: Scenario, most: int = MOST_PIXELS) -> Scenario:
    """Return a scenario with few pixels and coarse waves: radiance at the aperture, without a detector.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> small = reduced(parse_scenario({}))
    >>> small.sensor.pixels, small.sensor.fov_deg
    ((160, 80), (16.0, 8.0))
    """
    columns, rows = scenario.sensor.pixels
    share = min(1.0, math.sqrt(most / (columns * rows)))
    # Both sides shrink alike, but a scanned line keeps at least one pixel and no side exceeds the whole.
    pixels = (max(1, min(most, round(columns * share))), max(1, min(most, round(rows * share))))
    bare = {"optics": None, "detector": None, "scan": None, "noise": None}
    sensor = scenario.sensor.model_copy(update={"pixels": pixels, "frames": 1, "pixel_shape": "any", **bare})
    coarse = _COARSE | {"tile_size": min(scenario.render.tile_size, 128)}
    return scenario.model_copy(update={"sensor": sensor, "render": scenario.render.model_copy(update=coarse)})


def picture(job: Job, scenario: Scenario) -> PreviewPicture:
    """Compute one small picture.

    Raises
    ------
    SeaglintError
        The models do not cover the scenario.
    """
    from seaglint.store.provenance import stored_band
    from seaglint.store.stored_images import below_horizon, to_temperature
    from seaglint.studies.mean.mean_map import mean
    from seaglint.studies.sequence.labelled_frames import image

    begin = time.perf_counter()
    small = reduced(scenario)
    dataset = mean(small) if job == "mean" else image(small)
    radiance = np.asarray(dataset["radiance"].values, np.float32)
    if job == "mean":
        temperature = np.asarray(dataset["apparent_temperature"].values, np.float32)
    else:
        temperature = np.asarray(to_temperature(radiance, stored_band(dataset.attrs)), np.float32)
    edges = [_edges(dataset[name].values) if dataset[name].ndim == 1 else None for name in ("azimuth", "elevation")]
    return PreviewPicture(
        radiance=radiance,
        temperature=temperature,
        azimuth=edges[0],
        elevation=edges[1],
        pixels=scenario.sensor.pixels,
        seconds=time.perf_counter() - begin,
        depression=below_horizon(dataset),
    )


def _edges(centres: NDArray[Any]) -> tuple[float, float]:
    step = (centres[-1] - centres[0]) / (centres.size - 1) if centres.size > 1 else 1.0
    return float(centres[0] - 0.5 * step), float(centres[-1] + 0.5 * step)


class Overtaken(Exception):  # noqa: N818 - no error: a newer change made the picture needless
    """Error of a picture that a newer change replaces."""


class Order:
    """Request for one picture; ``drop`` cancels it when a newer picture is requested."""

    def __init__(self, job: Job, scenario: Scenario) -> None:
        self.job: Job = job
        self.scenario = scenario
        self.dropped = threading.Event()

    def drop(self) -> None:
        """Cancel the request."""
        self.dropped.set()


class Painter:
    """Process that computes pictures one after the other; started with the first picture, and again if it died.

    A cancelled picture is not begun. A picture in progress is finished, which takes a second and leaves tables for the next one; after
    ``patience`` seconds its process is ended instead.
    """

    patience = 8.0

    def __init__(self) -> None:
        self._line = ThreadPoolExecutor(1, thread_name_prefix="painter")
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()

    @property
    def line(self) -> ThreadPoolExecutor:
        """Return the thread in which ``paint`` waits for the process."""
        return self._line

    def paint(self, order: Order) -> PreviewPicture:
        """Wait for a picture; called in ``line``.

        Raises
        ------
        Overtaken
            The request was cancelled.
        SeaglintError
            The models do not cover the scenario, or the process died.
        """
        if order.dropped.is_set():
            raise Overtaken
        process, begin = self._running(), time.monotonic()
        done = threading.Event()
        threading.Thread(target=self._watch, args=(process, order, begin, done), daemon=True).start()
        try:
            assert process.stdin is not None
            assert process.stdout is not None
            pickle.dump((order.job, order.scenario), process.stdin)
            process.stdin.flush()
            kind, result = pickle.load(process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError):
            self.stop()
            if order.dropped.is_set():
                raise Overtaken from None
            raise SeaglintError(
                "the process that computes the pictures ended, for lack of memory perhaps; the next change starts it"
            ) from None
        finally:
            done.set()
        if kind == "error":
            raise result
        assert isinstance(result, PreviewPicture)
        return result

    def _watch(self, process: subprocess.Popen[bytes], order: Order, begin: float, done: threading.Event) -> None:
        while not done.wait(0.2):
            if order.dropped.is_set() and time.monotonic() - begin > self.patience:
                process.kill()
                return

    def _running(self) -> subprocess.Popen[bytes]:
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                command = [sys.executable, "-m", "seaglint.viewer.workbench.painting"]
                self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            return self._process

    def warm(self) -> None:
        """Start the process in advance, since loading takes a second."""
        self._running()

    def stop(self) -> None:
        """End the process."""
        with self._lock:
            if self._process is not None:
                self._process.kill()
                self._process.wait()
                for end in (self._process.stdin, self._process.stdout):
                    if end is not None:
                        with suppress(OSError):  # an order that nobody took is still to be written
                            end.close()
                self._process = None
