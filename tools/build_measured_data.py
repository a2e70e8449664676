"""Measurements and outputs of other models that ``seaglint reproduce measured`` compares with, cut down to what it needs; measured seas.

    python tools/build_measured_data.py REFERENCE

``REFERENCE`` is a folder with ``measured_air``, ``modern_air`` and ``measured_sea``, whose files are named below. The tables go to
``src/seaglint/studies/data``, those of the measured seas to ``src/seaglint/sea/data``, each with its source, terms and processing in the
lines before it; run ``tools/write_checksums.py`` then.

Spectra are averaged with a triangle of 20 cm-1 full width at half maximum every 5 cm-1, as LOWTRAN7's band models were made.
"""

from __future__ import annotations

import hashlib
import itertools
import sys
from pathlib import Path

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.optics.band import triangular_average
from seaglint.sea.dispersion import wavenumber
from seaglint.studies.measured.buoy_records import RecordStatistics

PACKAGE = Path(__file__).resolve().parents[1] / "src" / "seaglint"

OUT = PACKAGE / "studies" / "data"

SEA_OUT = PACKAGE / "sea" / "data"

TRIANGLE = "averaged with a triangle of 20 cm-1 full width at half maximum, every 5 cm-1"

ARM = "data of the ARM programme of the US Department of Energy; cite ARM. The repository has no licence file"
SSEC = "public web page of the Space Science and Engineering Center, University of Wisconsin. The repository has no licence file"
NASA = "NASA, public domain. The repository has no licence file"
MIT = "MIT licence of pyradi"
BSD = "numbers computed here from the k-distributions of RTE+RRTMGP (BSD-3; LBLRTM, HITRAN, MT_CKD)"
SEAS = "numbers reduced from files that the authors published; the repository has no licence file: cite them"
CDIP = "CDIP: may be redistributed and used without restriction"

PATHS, UPPER = 60, 40
"""Paths kept of those near the sea and of those in the upper air."""

RATE = 1.28
"""Displacements of the buoy a second [Hz]."""

SEGMENT = 512
"""Displacements of a segment of the buoy's spectra: 400 s, bands of 0.0025 Hz."""

DECLINATION_DEG = 11.7
"""Magnetic north of the buoy in 2022, east of true north [deg]; its displacements are along magnetic axes, its spectra along true ones."""

WIND_CLASSES = ((0.0, 3.0), (4.0, 6.0), (6.0, 8.0), (8.0, 10.0))
"""Winds of the classes in which records of RaDyO are taken together [m/s]."""
BLOCKS = 16
"""Blocks of the buoy's record for standard errors: of 450 s, some fifty waves each."""

CREST_ERROR = 0.08
"""Standard error of the largest crest over the significant height, which has no blocks: the standard deviation of drawn records."""

SEA_BANDS = (0.05, 0.07, 0.085, 0.1, 0.12, 0.15, 0.19, 0.25, 0.35, 0.58)
"""Edges of the bands in which the buoy's waves are compared [Hz]."""


def columns(path: Path) -> dict[str, FloatArray]:
    """Columns of a CSV file by name."""
    with path.open(encoding="utf-8") as stream:
        names = stream.readline().strip().split(",")
        rows = np.genfromtxt(stream, delimiter=",")
    return dict(zip(names, rows.T, strict=True))


def write(
    name: str, inputs: tuple[Path, ...], source: str, terms: str, processing: str, held: dict[str, FloatArray], out: Path | None = None
) -> None:
    """Write a table behind the lines that say where it is from."""
    digests = ", ".join(f"{path.name} sha256 {hashlib.sha256(path.read_bytes()).hexdigest()[:16]}" for path in inputs)
    head = [f"# source: {source}", f"# terms: {terms}", f"# processing: {processing}", f"# made from: {digests}", ",".join(held)]
    lines = [",".join(f"{value:.6g}" for value in row) for row in zip(*(values.tolist() for values in held.values()), strict=True)]
    (OUT if out is None else out).joinpath(name).write_text("\n".join([*head, *lines]) + "\n", encoding="utf-8")


def spectra(folder: Path) -> None:
    """Write the three measured spectra and their soundings."""
    mlib = "repository ConnorJFlynn/mlib at 70ec7da, lbl_rrtm/lnfl_lblrtm_radsum_wrappers"
    cases = {
        "aeri": (
            "sgp_20010722_aeri.csv",
            "sgp_20010722_sounding.csv",
            1780.0,
            ("sgp_aeri_20010722_0522Z.txt", "sgp_aeri.full_atm"),
            f"AERI, zenith sky over the ARM Southern Great Plains site, 22 July 2001 0522 UT; {mlib}/sgp_example",
            ARM,
        ),
        "his": (
            "camex_1993_his.csv",
            "camex_1993_sounding.csv",
            1060.0,
            ("camex_19930922_00Z.txt", "camex.full_atm"),
            f"HIS on the ER-2 at 19.97 km over the sea off Wallops Island, September 1993, mean of 24 spectra; {mlib}/camex_example",
            SSEC,
        ),
        "iris": (
            "iris_19700427.csv",
            "iris_sounding.csv",
            1450.0,  # beyond it a few samples are negative: noise
            ("iris_spectrum_042770.txt", "iris.full_atm"),
            f"IRIS-D on Nimbus 4 over the sea off Guam, 27 April 1970 0202 UT; {mlib}/iris_example",
            NASA,
        ),
    }
    for name, (spectrum, sounding, last, files, source, terms) in cases.items():
        path = folder / spectrum
        fine, grid = columns(path), np.arange(700.0, last + 1.0, 5.0)
        nu = fine.pop("wavenumber_cm")
        held = {key: triangular_average(nu, values, grid) for key, values in fine.items()}
        write(f"measured_{name}.csv", (path,), f"{source}/{files[0]}", terms, TRIANGLE, {"wavenumber_cm": grid, **held})
        path = folder / sounding
        levels = columns(path)
        whole = np.all([np.isfinite(values) for values in levels.values()], axis=0)
        levels = {key: values[whole] for key, values in levels.items()}
        write(f"measured_{name}_sounding.csv", (path,), f"sounding for {source}/{files[1]}", terms, "levels as given there", levels)


def modtran(folder: Path) -> None:
    """Write MODTRAN 4's path and skies."""
    pyradi = "MODTRAN 4 in repository NelisW/pyradi at 61dc954"
    path = folder / "modtran4_5km_tropical_rural23.csv"
    fine = columns(path)
    nu = fine["wavenumber_cm"]
    grid = np.arange(685.0, 2991.0, 5.0)
    write(
        "measured_modtran_path.csv",
        (path,),
        f"{pyradi}, pyradi/data/horizon5kmtropical.fl7: 5 km at the sea, tropical, rural haze of 23 km",
        MIT,
        f"divided by the transmittance of its aerosol, {TRIANGLE}",
        {"wavenumber_cm": grid, "transmittance": triangular_average(nu, fine["transmittance"] / fine["aerosol"], grid)},
    )
    inputs = tuple(folder / f"modtran4_zenith_{part}_tropical_rural23.csv" for part in ("lwir", "mwir"))
    held: list[list[FloatArray]] = []
    for part, ends in zip(inputs, ((855.0, 1230.0), (2245.0, 2835.0)), strict=True):
        fine, grid = columns(part), np.arange(ends[0], ends[1] + 1.0, 5.0)
        nu, light = fine["wavenumber_cm"], 1e7 * fine["thermal_radiance_w_cm2_sr_cm"]
        held.append([grid, triangular_average(nu, fine["transmittance"], grid), triangular_average(nu, light, grid)])
    names = ("wavenumber_cm", "transmittance", "radiance_mw_m2_sr_cm")
    write(
        "measured_modtran_sky.csv",
        inputs,
        f"{pyradi}, pyradi/examples/SunMWIR and SunLWIR tape7: zenith from the ground, tropical, rural haze of 23 km",
        MIT,
        TRIANGLE,
        dict(zip(names, (np.concatenate(values) for values in zip(*held, strict=True)), strict=True)),
    )


def rrtmgp(folder: Path) -> None:
    """Write some of RRTMGP's paths, and its skies."""
    parts, inputs = [], (folder / "paths.csv", folder / "paths_upper_air.csv")
    for path, count in zip(inputs, (PATHS, UPPER), strict=True):
        every = columns(path)
        size = next(iter(every.values())).size
        parts.append({name: values[np.arange(count) * size // count] for name, values in every.items()})
    held = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    kept = f"{PATHS} homogeneous paths of 400-1030 hPa, then {UPPER} of 5-400 hPa, at even steps of the whole list"
    write("measured_rrtmgp_paths.csv", inputs, "homogeneous paths through random air", BSD, kept, held)
    path = folder / "skies.csv"
    rows = path.read_text(encoding="utf-8").splitlines()
    models = sorted({row.split(",")[0] for row in rows[1:]})
    fine = columns(path)
    fine["model"] = np.array([models.index(row.split(",")[0]) for row in rows[1:]], dtype=np.float64)
    write("measured_rrtmgp_skies.csv", (path,), "cloudless skies at the sea", BSD, f"model counts from 0 among {' '.join(models)}", fine)


def sea(folder: Path) -> None:
    """Write the buoy's own spectra, and what its displacements give in bands."""
    spectra_path, moved_path = folder / "cdip067_20220102_spectra.csv", folder / "cdip067_20220102_xyz.csv"
    source = "CDIP buoy 067, San Nicolas Island, 2 January 2022, 02:00-04:00 UT; repository alexgpitts/OSUGlider2 at d2f14ca"
    held = columns(spectra_path)
    shape = (np.unique(held.pop("start_minute_utc")).size, -1)
    held = {name: values.reshape(shape) for name, values in held.items()}
    energy = held["energy_m2_hz"]
    weight = energy / energy.sum(axis=0)
    mean = {name: (weight * values).sum(axis=0) for name, values in held.items()}
    mean |= {"frequency_hz": held["frequency_hz"][0], "energy_m2_hz": energy.mean(axis=0)}
    processing = "mean of its half hours, moments weighted by energy; directions that waves come from"
    write("measured_cdip_spectrum.csv", (spectra_path,), source, CDIP, processing, mean)
    moved = columns(moved_path)
    bands = buoy_bands(*(moved[f"{axis}_m"] for axis in "xyz"))
    processing = f"spectra of segments of {SEGMENT} displacements, half of each in the next, summed over bands"
    write("measured_cdip_bands.csv", (moved_path,), source, CDIP, processing, bands)
    processing = f"statistics of all displacements upwards; errors from {BLOCKS} blocks, the crest's from drawn records"
    write("measured_cdip_record.csv", (moved_path,), source, CDIP, processing, buoy_record(moved["z_m"]))


def buoy_record(z: FloatArray) -> dict[str, FloatArray]:
    """Return height, skewness, excess kurtosis and largest crest of the displacements, with standard errors."""
    whole = RecordStatistics.of(z)
    blocks = np.array([RecordStatistics.of(block) for block in np.split(z, BLOCKS)])
    errors = blocks.std(axis=0, ddof=1) / np.sqrt(BLOCKS)
    errors[-1] = CREST_ERROR
    names = RecordStatistics._fields
    values = {name: np.array([value]) for name, value in zip(names, whole, strict=True)}
    return values | {f"{name}_error": np.array([value]) for name, value in zip(names, errors, strict=True)}


def campaigns(folder: Path) -> None:
    """Write the saturation of the Air-Sea Interaction Tower by wind, and medians of RaDyO's slope variances in classes of wind."""
    out = SEA_OUT
    out.mkdir(exist_ok=True)
    caveat = (
        "the authors state that the method underresolves short waves and that slopes need a gain of 1.2 to 1.7 (none is applied); runs of "
        "one wind differ by factors; the two campaigns differ by eight to nineteen times below 2 cm at one wind"
    )
    path = folder / "asit_saturation.csv"
    held = columns(path)
    names = {"wind_speed_10m_m_s": "wind_speed_m_s", "wavenumber_rad_m": "wavenumber_rad_m", "saturation_omnidirectional": "saturation"}
    write(
        "asit_2019.csv",
        (path,),
        "Air-Sea Interaction Tower off Martha's Vineyard, autumn 2019, polarimetric camera and lidar: JGRO_LIU25_Data_Compiled.mat, "
        "MV09_stress_PyxisRuns_struc, of the repository unh-cassll/wind-wave-directionality-paper; method of Laxague et al. 2025, IEEE "
        "Trans. Geosci. Remote Sens., doi 10.1109/TGRS.2025.3538460",
        SEAS,
        "mean over 96 steps of equal ratio in wavenumber; the row at 2.69 m/s, with more slope variance than the next one, is kept as "
        f"measured; runs in light winds hold swell and old waves; the rows at 15.7 and 17.6 m/s begin at 2.25 rad/m; {caveat}",
        {new: held[old] for old, new in names.items()},
        out,
    )
    path = folder / "radyo_slope_variance_bands.csv"
    held = columns(path)
    bands = [(name, *(float(edge) for edge in name.split("_")[1:3])) for name in held if name.startswith("mss_")]
    rows = []
    for low_wind, high_wind in WIND_CLASSES:
        wind = held["wind_speed_10m_m_s"]
        chosen = (wind >= low_wind) & (wind < high_wind) & np.isfinite(held["mss_20_50_rad_m"])
        for name, low, high in bands:
            if low >= 20.0:  # none of the records has a longer band
                rows.append((float(wind[chosen].mean().round(2)), low, high, np.median(held[name][chosen]), chosen.sum()))
    write(
        "radyo_2008.csv",
        (path,),
        "RaDyO, Santa Barbara Channel, 2008: RaDyO_2008_omnidirectional_slope_spectra.mat and RaDyO_wind_speed_stress.mat of the "
        "repository unh-cassll/polarimetry-subpixel-variability; Laxague et al. 2025, IEEE Trans. Geosci. Remote Sens., "
        "doi 10.1109/TGRS.2025.3538460",
        SEAS,
        "median of the records in classes of wind (below 3, 4-6, 6-8 and 8-10 m/s) at the mean wind of the class; the last class is one "
        f"record; the records in light winds hold old waves; {caveat}",
        dict(zip(("wind_speed_m_s", "min_rad_m", "max_rad_m", "slope_variance", "records"), np.array(rows).T, strict=True)),
        out,
    )


def buoy_bands(x: FloatArray, y: FloatArray, z: FloatArray) -> dict[str, FloatArray]:
    """Energy, its standard error, slope variance and the direction that waves come from in :data:`SEA_BANDS`."""
    starts = np.arange(0, z.size - SEGMENT + 1, SEGMENT // 2)
    taper = np.hanning(SEGMENT)
    parts = [np.array([(series[s : s + SEGMENT] - series[s : s + SEGMENT].mean()) * taper for s in starts]) for series in (x, y, z)]
    fx, fy, fz = (np.fft.rfft(part, axis=1) for part in parts)
    frequency = np.fft.rfftfreq(SEGMENT, 1.0 / RATE)
    scale = 2.0 / (RATE * (taper**2).sum()) * (frequency[1])
    power = scale * np.abs(fz) ** 2
    # x points to magnetic north and y to magnetic west, which the buoy's own a1 and b1 confirm
    quad_north, quad_west = (scale * (fz * np.conj(other)).imag.mean(axis=0) for other in (fx, fy))
    size = np.sqrt(power.mean(axis=0) * scale * (np.abs(fx) ** 2 + np.abs(fy) ** 2).mean(axis=0))
    k = wavenumber(2.0 * np.pi * np.maximum(frequency, 1e-3))
    rows = []
    for low, high in itertools.pairwise(SEA_BANDS):
        inside = (frequency >= low) & (frequency < high)
        each = power[:, inside].sum(axis=1)
        weight = power.mean(axis=0)[inside]
        a1, b1 = (float(np.sum(weight * (q / size)[inside]) / weight.sum()) for q in (-quad_north, quad_west))
        rows.append(
            (
                *(low, high, each.mean(), each.std() / np.sqrt(0.75 * starts.size)),
                *(float(np.sum(weight * k[inside] ** 2)), (np.degrees(np.arctan2(b1, a1)) + DECLINATION_DEG) % 360.0),
                np.degrees(np.sqrt(2.0 * (1.0 - np.hypot(a1, b1)))),
            )
        )
    names = ("low_hz", "high_hz", "energy_m2", "energy_error_m2", "slope_variance", "from_deg", "spread_deg")
    return dict(zip(names, np.array(rows).T, strict=True))


def main() -> None:
    """Write every table."""
    reference = Path(sys.argv[1])
    OUT.mkdir(exist_ok=True)
    spectra(reference / "measured_air")
    modtran(reference / "measured_air")
    rrtmgp(reference / "modern_air")
    sea(reference / "measured_sea")
    campaigns(reference / "measured_sea")


if __name__ == "__main__":
    main()
