"""Print the table of twilight in the guide: scattered sunlight of the sky by the Sun's depression, beside the sky's own emission.

python docs/figures/twilight_table.py        # half a minute
"""

from __future__ import annotations

import argparse

import numpy as np

from seaglint.air.scattering.scattering_laws import scattering_angle
from seaglint.air.scattering.twilight import fading
from seaglint.facet.sea_view import BandSum
from seaglint.optics.band import Band
from seaglint.studies.build.profile_air import model_air

BANDS = ((3.5, 5.0), (2.0, 2.4))
LINES = (("5° high, towards the Sun", 5.0, 0.0), ("5° high, 90° aside", 5.0, 90.0), ("30° high, opposite", 30.0, 180.0))
DEPRESSIONS = (-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0)
HEIGHT = 30.0


def rows() -> list[str]:
    """Return the rows of the table: thermal sky, then scattered sunlight for every depression [W m-2 sr-1]."""
    out = []
    for band_um in BANDS:
        table = model_air("midlatitude-summer", 7.0, band_um)
        over = BandSum.of(Band.rectangular(*band_um), table)
        air = table.scattering(over.grid)
        assert air is not None
        for name, elevation, azimuth in LINES:
            zenith, aside = np.radians([90.0 - elevation, azimuth])
            cells = [f"{float(over(table.sky_radiance(np.array([zenith]), 0.0, HEIGHT))[0]):.2g}"]
            for depression in DEPRESSIONS:
                apparent = np.radians(90.0 + depression)
                sun = air.unrefracted_zenith(float(apparent))
                phase = air.phase(scattering_angle(zenith, aside, float(air.apparent_zenith(sun, HEIGHT))))
                amplitude = air.amplitudes(HEIGHT, np.array([[zenith, aside, sun]]))[0][0]
                spectrum = fading(float(apparent)) * air.source * (phase * amplitude).sum(axis=0)
                cells.append(f"{float(spectrum @ over.weights):.2g}")
            out.append(f"| {band_um[0]:g}-{band_um[1]:g} µm, {name} | " + " | ".join(cells) + " |")
    return out


def main() -> None:
    """Command line."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    print("\n".join(rows()))


if __name__ == "__main__":
    main()
