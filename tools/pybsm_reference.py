"""Numbers of pyBSM for the tests of the sensor: transfer functions and electrons of a mid-wave camera.

pyBSM pins versions of Numba and NumPy, so it is not installed beside seaglint: run this in an environment of its own
(``pip install pybsm``), ``python tools/pybsm_reference.py tests/instrument/data/pybsm.csv``.
"""

from __future__ import annotations

import csv
import sys
import warnings

import numpy as np

APERTURE, FOCAL, OBSCURATION = 0.08, 0.2, 0.3
PITCH, WAVELENGTH, WAVEFRONT, JITTER = 15e-6, 4.0e-6, 0.07, 20e-6
BAND, TIME, EFFICIENCY, TRANSMISSION = (3.5e-6, 5.0e-6), 2e-3, 0.7, 0.8


def main(path: str) -> None:
    """Write the table."""
    warnings.simplefilter("ignore")
    import pybsm
    from pybsm.otf import functional as otf
    from pybsm.radiance import functional as radiance

    cutoff = APERTURE / WAVELENGTH
    u = np.linspace(0.0, 1.0, 21)[None, :] * cutoff
    zero = np.zeros_like(u)
    columns = {
        "diffraction": otf.circular_aperture_OTF(u=u, v=zero, lambda0=WAVELENGTH, D=APERTURE, eta=OBSCURATION),
        "clear": otf.circular_aperture_OTF(u=u, v=zero, lambda0=WAVELENGTH, D=APERTURE, eta=0.0),
        "wavefront": otf.wavefront_OTF_2(u=u, v=zero, cutoff=cutoff, w_rms=WAVEFRONT),
        "detector": otf.detector_OTF(u=u, v=zero, w_x=PITCH, w_y=PITCH, f=FOCAL),
        "jitter": otf.jitter_OTF(u=u, v=zero, s_x=JITTER, s_y=JITTER),
    }
    with open(path, "w", newline="", encoding="utf-8") as file:
        file.write(f"# pyBSM {pybsm.__version__}, tools/pybsm_reference.py: aperture {APERTURE} m, focal length {FOCAL} m, obscuration ")
        file.write(f"{OBSCURATION}, pitch {PITCH} m, {WAVELENGTH} m, wavefront {WAVEFRONT} waves rms, jitter {JITTER} rad rms\n")
        for temperature in (280.0, 300.0, 301.0, 320.0):
            wavelengths = np.linspace(*BAND, 1501)
            spectrum = radiance.blackbody_radiance(lambda0=wavelengths, T=temperature) * TRANSMISSION * (1.0 - OBSCURATION**2)
            irradiance = radiance.at_focal_plane_irradiance(D=APERTURE, f=FOCAL, L=spectrum)
            rate = radiance.photon_detection_rate(
                E=irradiance, w_x=PITCH, w_y=PITCH, wavelengths=wavelengths, qe=np.full(wavelengths.size, EFFICIENCY)
            )
            file.write(f"# electrons of a blackbody at {temperature:g} K: {TIME * np.trapezoid(rate, wavelengths):.8g}\n")
        table = csv.writer(file)
        table.writerow(["cycles_per_rad", *columns])
        for i in range(u.size):
            table.writerow([f"{u[0, i]:.8g}", *(f"{values[0, i]:.8g}" for values in columns.values())])


if __name__ == "__main__":
    main(sys.argv[1])
