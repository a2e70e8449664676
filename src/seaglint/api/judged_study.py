"""Results of studies of detection as records, and parts that functions of detectors share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from seaglint.api.result_record import ResultRecord

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from seaglint.studies.detect.study import Study


def numbers_of(values: float | Sequence[float] | None) -> tuple[float, ...] | None:
    """Return one number or several as a tuple."""
    import numpy as np

    return None if values is None else tuple(float(value) for value in np.atleast_1d(np.asarray(values, float)))


def judged_record(study: Study, values: Mapping[str, Any], unit: str) -> ResultRecord:
    """Return the results of a study as a record."""

    def draw() -> Figure:
        from seaglint.plot.detection_study import draw_characteristic

        first = study.good[0].done
        return draw_characteristic(first.roc, first.rows, unit)

    def html() -> str:
        from seaglint.studies.detect.performance import shown

        return shown(values, values["notes"]) if "sweep" in values else study._repr_html_()

    return ResultRecord(values, draw=draw, html=html, title="study of detection")
