"""Names of the ground-truth numbers of an object in a frame; a separate module, as files are read without drawing."""

from __future__ import annotations

from typing import Final

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
)
"""Ground-truth numbers of a body in a frame, in the order of table columns; unknown numbers of a body out of view are NaN."""
