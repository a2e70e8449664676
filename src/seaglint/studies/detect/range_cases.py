"""Ranges of detection in the cases of a study and at some bearings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from seaglint.files.detection_parts import Parts
from seaglint.files.detection_range import DetectionRange
from seaglint.studies.detect.range_search import detection_range
from seaglint.studies.detect.requests import RangeRequest
from seaglint.studies.detect.study import with_case
from seaglint.studies.detect.varied_cases import StudyCase


def ranges_of(
    cases: Sequence[StudyCase], request: RangeRequest, parts: Parts, *, say: Callable[[str], None] = lambda text: None
) -> list[DetectionRange]:
    """Find the range of an object in every case, at every bearing.

    Parameters
    ----------
    cases : sequence of StudyCase
        Scenarios of one object.
    request : RangeRequest
        Object, bearings, detector and limits.
    parts : Parts
        Store of what is computed.
    say : callable
        Called with lines on the progress.

    Raises
    ------
    SeaglintError
        No such object, or a scenario that cannot be computed.
    """
    searched = request.range_options([item.name for item in cases[0].scenario.objects or ()])
    options = request.scene_options()
    bearings: list[float | None] = [None] if request.bearings is None else list(request.bearings)
    found = []
    for case in cases:
        judged = with_case(options, case)
        tried = replace(searched, detectors=()) if "detector" in case.parameters else searched
        for bearing in bearings:
            one = detection_range(case.scenario, judged, tried, parts, bearing_deg=bearing, say=say)
            found.append(replace(one, parameters=case.parameters))
    return found
