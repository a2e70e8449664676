"""Laws of shadowing written as functions of arrays, against which the models are tested."""

from __future__ import annotations

import numpy as np

from seaglint.sea.shadowing.nested import BANDS, nested_ratio_kernel, ratio_table
from seaglint.sea.shadowing.seen_and_lit import coupling_table, lit_exponent_kernel
from seaglint.sea.shadowing.smith import _clipping, leg_passage_kernel, smith_lambda, smith_nu, visible_area


def saunders(view_zenith, mss_along):
    """Share of facets turned to the viewer that is visible, ``1/(1 + Lambda)`` (Saunders 1967, Eq. 9; Eq. 8 of the source article)."""
    return np.asarray(1.0 / (1.0 + smith_lambda(smith_nu(view_zenith, mss_along))))


@np.vectorize
def bistatic(lambda_view, lambda_sun, relative_azimuth):
    """Share of facets seen and lit, for Smith's Lambda of both legs and the azimuth between them [rad]."""
    small, large = min(lambda_view, lambda_sun), max(lambda_view, lambda_sun)
    return 0.0 if np.isinf(large) else 1.0 / (1.0 + large + leg_passage_kernel(float(relative_azimuth)) * small)


def slope_lambda(view_zenith, view_azimuth, slopes):
    """Smith's Lambda over any slope density, ``A+/cos(theta) - 1``; infinite at and past the horizon."""
    zenith, azimuth = np.broadcast_arrays(np.asarray(view_zenith, float), np.asarray(view_azimuth, float))
    if slopes.is_gaussian:
        return smith_lambda(smith_nu(zenith, slopes.mss_along(azimuth)))
    cosine, area = np.cos(zenith), visible_area(zenith, azimuth, slopes)
    return np.where(cosine > 0.0, area / np.where(cosine > 0.0, cosine, 1.0) - 1.0, np.inf)


def lit_of_seen(slope, view, sun, bands=BANDS, deviation=0.165):
    """Share of the seen facets that is lit too, over that of Smith's law in one band: the Sun's leg alone, and the coupling of both,
    for a sea of an rms slope of ``deviation`` along one direction."""
    tilt = float(np.clip(slope, -sun, view))
    alone = nested_ratio_kernel(-tilt, sun, 1.0, ratio_table(bands))
    return alone * np.exp(lit_exponent_kernel(tilt, view, sun, coupling_table(bands, deviation)))


def clipped_mass(slopes):
    """Mass that a slope density gains by setting negative values of its series to 0 [1]."""
    return 0.0 if slopes.is_gaussian else _clipping(slopes.coefficients)[0]
