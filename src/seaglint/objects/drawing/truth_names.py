"""Names of the ground-truth numbers of an object in a frame; a separate module, as files are read without drawing."""

from __future__ import annotations

from typing import Final

#: Ground-truth numbers of a body in a frame, in the order of table columns; unknown numbers of a body out of view are NaN.
NUMBERS: Final = (
    "column_px",
    "row_px",
    "range_m",
    "solid_angle_sr",
    "visible_share",
    "occluded_share",
    "truncated_share",
    "contrast_W_m2_sr",
    "bearing_deg",
    "elevation_deg",
    "bbox_left_px",
    "bbox_top_px",
    "bbox_width_px",
    "bbox_height_px",
    "temperature_difference_K",
    "signal_to_clutter",
    "pixels",
    "irradiance_W_m2",
    "signal_column_px",
    "signal_row_px",
    "velocity_column_px_s",
    "velocity_row_px_s",
    "motion_px",
    "streak_begin_column_px",
    "streak_begin_row_px",
    "streak_end_column_px",
    "streak_end_row_px",
    "blur_px",
    "size_class",
    "counts_column_px",
    "counts_row_px",
    "counts_peak",
    "counts_snr",
)

#: Classes of size by their number: of a solid angle of less than a pixel, of at most :data:`MOST_SMALL` pixels, and larger.
SIZES: Final = ("point", "small", "extended")

MOST_SMALL: Final = 81  #: Greatest size of a small target [pixels]: 9 x 9, the definition of SPIE (0.12 % of 256 x 256).
