"""Function of measured spectra: ``sg.compare``, which :func:`compare_spectrum` names in full."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from seaglint.api.inputs import SceneInput
    from seaglint.studies.measured.compare_spectrum import SpectrumComparison


def compare_spectrum(
    spectrum: str | Path | Mapping[str, ArrayLike],
    scenario: SceneInput,
    *,
    resolution_cm: float | None = None,
    zenith_deg: float | None = None,
    depression_deg: float | None = None,
    spectroscopy: Literal["lblrtm", "lowtran7"] | None = None,
) -> SpectrumComparison:
    """Compare a measured spectrum with that of a scenario.

    Parameters
    ----------
    spectrum : path or mapping
        CSV file, or its columns: ``wavenumber_cm`` or ``wavelength_um``, and one of ``radiance_w_m2_sr_cm``, ``radiance_mw_m2_sr_cm``,
        ``radiance_w_cm2_sr_cm`` (per cm-1), the same with ``_um`` (per um), ``brightness_temperature_k``; ``resolution_cm`` if it is known.
    scenario : Scenario, path or mapping
        See :func:`load`; its band is left aside.
    resolution_cm : float, optional
        Full width at half maximum of the spectrum [cm-1]; by default that of the file, else the spacing of its samples.
    zenith_deg, depression_deg : float, optional
        Direction looked at: the sky at a zenith angle, or the sea at an angle below the horizontal [deg]; by default the camera's axis.
    spectroscopy : str, optional
        Absorption of the air, ``lblrtm`` or ``lowtran7``; by default that of the scenario.

    Returns
    -------
    SpectrumComparison
        Both spectra [W m-2 sr-1 per cm-1, (n,)] at one resolution, temperatures by band [K], and notes of what was averaged or left out.

    Raises
    ------
    SeaglintError
        A spectrum without a unit, with negative or missing numbers, or outside 0.7-14.7 um; a direction or resolution that cannot be.

    Examples
    --------
    >>> import seaglint as sg
    >>> sky = {"wavelength_um": [8.5, 8.7, 8.9, 9.1], "brightness_temperature_k": [262, 259, 257, 254], "resolution_cm": 20.0}
    >>> result = sg.compare_spectrum(sky, sg.load({"sensor": {"height_m": 20}}), zenith_deg=30.0)
    >>> result.resolution_cm, len(result.bands)
    (20.0, 1)
    """
    from seaglint.api.inputs import scenario_of
    from seaglint.studies.measured.compare_spectrum import compare_spectrum as compared

    return compared(
        spectrum,
        scenario_of(scenario),
        resolution_cm=resolution_cm,
        zenith_deg=zenith_deg,
        depression_deg=depression_deg,
        spectroscopy=spectroscopy,
    )


compare = compare_spectrum
