"""Lines of sight that a scenario needs, and the manifest that assigns each case of an output to its line."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np

from seaglint.air.coordinates import elevation_of_coordinate, straight_sea_cosine, straight_slant
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.sky_spline import grazing_share
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files.text_file import read_json

MANIFEST: Final = "manifest.json"

VERSION: Final = 1

PATH_NODES: Final = 28
SKY_NODES: Final = 28
#: Numbers of nodes: paths from straight down to the horizon, sky and Sun down to the horizontal, sky down to the horizon.
DIP_NODES: Final = 24

#: Azimuths from the Sun at which sunlight scattered by the air is sampled [deg]: the aureole is 10 deg wide.
AZIMUTHS: Final = (0.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 150.0, 180.0)

SHORT_OF_HORIZON: Final = 1e-3
#: Part of the horizon's depression by which paths end below it: rays there may miss the sea in another code, or by rounding.
SHORT_OF_LOWTRAN7_HORIZON: Final = 1e-4


@dataclass(frozen=True)
class ModtranCase:
    """Line of sight of one case: ``path`` from the sensor to the sea, ``sky`` from sensor or sea, ``sun`` from the sea to the Sun."""

    kind: Literal["path", "sky", "sun"]
    height_m: float  #: Height of the eye: H1 [m].
    zenith_deg: float  #: Zenith angle of the line there: ANGLE, OBSZEN [deg].
    range_m: float | None = None  #: Arc of a path along the sea [m].
    horizon_share: float | None = None  #: Depression of sky below the horizontal over that of the calculation's own horizon [1].
    azimuth_deg: float | None = None  #: From the Sun [deg]; None without scattered sunlight.


@dataclass(frozen=True)
class Manifest:
    """Lines of sight in the order of the deck's cases, and their common properties."""

    lines: tuple[ModtranCase, ...]
    sensor_height_m: float
    solar_zenith_deg: float | None  #: Zenith angle of the Sun whose scattered light is included [deg]; None without scattered light.
    outputs: tuple[str, ...]  #: Names of the results that the decks make; the first one that exists is read.

    def text(self) -> str:
        """Return the manifest as JSON."""
        shared = {k: v for k, v in asdict(self).items() if k != "lines"}
        lines = [{k: v for k, v in asdict(line).items() if v is not None} for line in self.lines]
        head = json.dumps({"seaglint_manifest": VERSION, **shared}, indent=2)[:-2]
        return head + ',\n  "lines": [\n    ' + ",\n    ".join(json.dumps(line) for line in lines) + "\n  ]\n}\n"


def read_manifest(path: Path) -> Manifest:
    """Read the manifest of a folder.

    Raises
    ------
    DataError
        Not a manifest, or damaged.
    """
    again = "write the decks again with seaglint atmosphere write"
    content = read_json(path, again)
    if not isinstance(content, dict) or content.get("seaglint_manifest") != VERSION:
        raise DataError(f"{path}: is no manifest of this version of seaglint; {again}")
    try:
        lines = tuple(_line(entry) for entry in content["lines"])
        height, solar = content["sensor_height_m"], content["solar_zenith_deg"]
        if not lines or not isinstance(height, int | float) or not (solar is None or 0.0 <= solar <= 90.0):
            raise ValueError("no lines")
        return Manifest(lines, float(height), solar, tuple(map(str, content["outputs"])))
    except (ValueError, KeyError, TypeError) as error:
        raise DataError(f"{path}: is damaged ({' '.join(str(error).split())[:80] or type(error).__name__}); {again}") from None


def _line(entry: JsonObject) -> ModtranCase:
    line = ModtranCase(**entry)
    numbers = [value for name, value in asdict(line).items() if name != "kind" and value is not None]
    if line.kind not in ("path", "sky", "sun") or not all(isinstance(x, int | float) and abs(x) < 1e9 for x in numbers):
        raise ValueError(f"line {entry}")
    if line.kind == "path" and line.range_m is None:
        raise ValueError("a path without range_m")
    return line


def needed_lines(air: RefractingAir, height: float, solar_zenith: float | None, *, to_horizon: bool = False) -> list[ModtranCase]:
    """Return the lines for a sensor at ``height`` [m], with scattered sunlight for a Sun at ``solar_zenith`` [rad], if any.

    ``to_horizon`` lets the farthest path come closer to the horizon, which is LOWTRAN7's own.
    """
    short = SHORT_OF_LOWTRAN7_HORIZON if to_horizon else SHORT_OF_HORIZON
    cosine = _path_cosines(air, height, float(air.sea_cosine(height, air.dip(height) * (1.0 + short))))
    paths = [
        ModtranCase("path", height, 90.0 + float(np.degrees(d)), range_m=float(a))
        for d, a in zip(air.depression(height, cosine), air.sea_arc(height, cosine), strict=True)
    ]
    above = 90.0 - np.degrees(elevation_of_coordinate(np.linspace(0.0, 1.0, SKY_NODES), 0.0))
    above = np.clip(above, 0.0, 90.0)[::-1].tolist()
    share = (1.0 - 2e-3) * grazing_share(np.linspace(0.0, 1.0, DIP_NODES))[1:]
    dip = np.degrees(air.dip(height))
    sky = [ModtranCase("sky", 0.0, z) for z in above] + [ModtranCase("sky", height, z) for z in above]
    sky += [ModtranCase("sky", height, 90.0 + float(s * dip), horizon_share=float(s)) for s in share]
    suns = [ModtranCase("sun", 0.0, z) for z in above]
    if solar_zenith is None:
        return [*paths, *sky, *suns]
    lit = [ModtranCase(**{**asdict(line), "azimuth_deg": azimuth}) for line in (*paths, *sky) for azimuth in AZIMUTHS]
    return [*lit, *suns]


def _path_cosines(air: RefractingAir, height: float, least: float) -> FloatArray:
    """Return cosines of zenith angles at the sea, from straight down, evenly spaced in the logarithm of the slant path."""
    slant = height * (straight_slant(height, least) / height) ** np.linspace(0.0, 1.0, PATH_NODES)
    cosine = np.clip(straight_sea_cosine(height, slant), least, 1.0)
    cosine[0] = 1.0
    return np.asarray(cosine)


def horizon_zenith_deg(line: ModtranCase) -> float:
    """Return the zenith angle of a sky line over the package's own horizon, onto which lines below the horizontal are stretched [deg]."""
    if line.horizon_share is None:
        return line.zenith_deg
    return 90.0 + float(np.degrees(horizon_depression(line.height_m))) * line.horizon_share
