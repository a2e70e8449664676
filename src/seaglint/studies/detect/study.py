"""Detection studies over many scenarios: cases of a detector's performance, and ranges of detection.

Cases are run one after the other within a budget of time and stored as soon as they are complete; a case that fails leaves the others.
"""

from __future__ import annotations

import hashlib
import pickle
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, DomainError, ScenarioError, SeaglintError
from seaglint.base.free_form import JsonObject, TableRow
from seaglint.base.representation import card, notes, table
from seaglint.cluster import Job, Workers
from seaglint.cluster.job import record_of
from seaglint.clutter.filters import named as named_filter
from seaglint.detection.interface import Detector
from seaglint.scenario.model import Scenario
from seaglint.store.detection_results import DetectionCase, DetectionRange, DetectorResult, StudyParts
from seaglint.studies.detect.detection_requests import CasesRequest, RangeRequest, SceneRequest
from seaglint.studies.detect.performance import DetectionOptions, require_detector
from seaglint.studies.detect.range_search import detection_range
from seaglint.studies.detect.rendered_seas import Clock, run_scene
from seaglint.studies.detect.scene_frames import bare, frames_key
from seaglint.studies.detect.unknown_sea import with_unknown_sea
from seaglint.studies.detect.varied_cases import StudyCase, flattened

Options = TypeVar("Options", bound=DetectionOptions | CasesRequest)


@dataclass(frozen=True)
class Study:
    """Results of all cases."""

    cases: list[DetectionCase]  #: Parameters of each case with its result, or the reason why it failed.
    stopped: str | None  #: Reason why some cases were not begun.
    unfinished: bool  #: Whether a resumed study has more to compute.

    @property
    def errors(self) -> list[str]:
        """Messages of the cases that failed."""
        return [case.error for case in self.cases if case.error is not None]

    @property
    def good(self) -> list[DetectionCase]:
        """Cases with a result."""
        return [case for case in self.cases if case.error is None]

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows: varied parameters and results."""
        rows = self.rows()
        varied = dict.fromkeys(key for case in self.cases for key in case.parameters)
        names = [*varied, *(name for name in ("contrast", "p_d", "p_fa", "error") if any(row.get(name) is not None for row in rows))]
        remarks = [] if self.stopped is None else [self.stopped]
        return card(f"Study of {len(self.cases)} cases", table(names, [[row.get(name) for name in names] for row in rows]) + notes(remarks))

    def rows(self) -> list[TableRow]:
        """Return a tidy table: a row for each contrast and case, with varied parameters first, then results, then the whole scenario."""
        out = []
        for number, case in enumerate(self.cases):
            contrasts: list[TableRow] = [{}] if case.judged is None else case.judged.rows or [{}]
            for result in contrasts:
                row = {"case": number, **case.parameters, **result, "stopped": case.stopped, "error": case.error}
                row |= {key: value for key, value in case.scenario.items() if key not in row}
                out.append(row)
        # Columns of results are placed before the scenario, also where the first case has no result.
        full = next((row for row in out if row["error"] is None), {})
        order = list(dict.fromkeys([*full, *(name for row in out for name in row)]))
        return [{name: row.get(name) for name in order} for row in out]

    def characteristic(self) -> dict[str, list[float]]:
        """Return the columns of all operating characteristics."""
        names = ("contrast", "threshold_sigma", "p_fa", "p_fa_low", "p_fa_high", "p_d", "p_d_low", "p_d_high")
        numbered = [(k, case.judged.roc) for k, case in enumerate(self.cases) if case.judged is not None]
        out: dict[str, list[float]] = {"case": [float(k) for k, roc in numbered for _ in roc["contrast"]]}
        return out | {name: [v for _, roc in numbered for v in roc[name]] for name in names}

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; of a single case its keys at the top as well."""
        results = [
            {"parameters": case.parameters, **({"error": case.error} if case.judged is None else case.judged.result)} for case in self.cases
        ]
        whole: JsonObject = dict(results[0]) if len(results) == 1 else {}
        return whole | {"cases": results, "study_stopped": self.stopped}


def with_settings(options: Options, settings: Mapping[str, Any]) -> Options:
    """Return options, or a request, with the detector, filter and threshold of a case.

    Raises
    ------
    DataError
        A threshold that is no number, or an unknown filter.
    """
    changes: dict[str, Any] = {}
    if settings.get("detector") is not None:
        changes["detector"] = settings["detector"] if isinstance(settings["detector"], Detector) else str(settings["detector"])
    if "filter" in settings:
        changes["filter"] = named_filter(str(settings["filter"]))
    if "threshold" in settings:
        try:
            changes["threshold"] = float(settings["threshold"])
        except (TypeError, ValueError):
            raise DataError(f"threshold = {settings['threshold']} is no number; give e.g. 4") from None
    return replace(options, **changes)


def case_key(case: StudyCase, request: CasesRequest) -> str:
    """Return the short name of a case: a digest of all on which its result depends."""
    content = pickle.dumps((case.parameters, case.scenario.model_dump_json(), request.settings), protocol=5)
    return f"{frames_key(case.scenario, 0)}-{hashlib.sha256(content).hexdigest()[:16]}"


def run_study(
    cases: Sequence[StudyCase],
    request: SceneRequest,
    parts: StudyParts,
    *,
    progress: Progress | None = None,
    report: Callable[[str], None] = lambda text: None,
    workers: Workers | None = None,
) -> Study:
    """Run all cases; stored results of cases are used unchanged.

    Parameters
    ----------
    cases : sequence of StudyCase
        Scenarios.
    request : SceneRequest
        Detector, objects, precision, and the time for all cases, which the remaining ones share evenly.
    parts : StudyParts
        Store of frames and finished cases.
    progress : callable, optional
        Called with (seas done, seas at most, over all cases).
    report : callable
        Called with a line for every case that ends.
    workers : Workers, optional
        Workers that render the seas of each case; this process by default. Results do not depend on it.

    Raises
    ------
    SeaglintError
        An error that stops every case.
    """
    budget = request.time_budget
    begin, unfinished, stopped = time.monotonic(), False, None
    out: list[DetectionCase] = []
    last_use = {frames_key(case.scenario, 0): number for number, case in enumerate(cases)}
    for number, case in enumerate(cases):
        begun = current = DetectionCase(case.parameters, flattened(bare(case.scenario)))
        left = None if budget is None else budget - (time.monotonic() - begin)
        try:
            own = with_settings(request, case.study)
            key = case_key(case, own)
            stored = parts.case(key)
            evaluations = 1 + (own.sea_draws or 0)
            name = begun.named or f"case {number}"
            # The rest of the budget is shared evenly by what is left: the seas of this case, and the cases after it.
            share = None if left is None else max(left, 0.0) / (len(cases) - number) / evaluations
            clock = partial(Clock, share)
            shown = partial(_shown, progress, number, request.seas, len(cases), evaluations)
            if stored is not None:
                current = DetectionCase.of(stored)
            else:
                if left is not None and left <= 0 and out:
                    stopped = f"stopped after {number} of {len(cases)} cases: the time budget of {budget:g} s is reached"
                    unfinished = True
                    break
                judged = run_scene(case.scenario, own, parts, clock=clock(), name=name, progress=shown(0), workers=workers)
                current = replace(current, judged=judged)
                # A case that ran out of time is computed further by a resumed study.
                if judged.stopped == "time budget":
                    unfinished = True
                else:
                    parts.keep_case(key, current.as_dict())

            def in_sea(sea_number: int, sea: Scenario, same: SceneRequest) -> DetectorResult:
                """Evaluate the detector in a drawn sea; a stored result is used unchanged."""
                drawn = replace(case, scenario=sea)  # noqa: B023 - called within this turn of the loop
                sea_key, sea_name = case_key(drawn, same), f"{name}, sea {sea_number}"  # noqa: B023
                if (stored := parts.case(sea_key)) is not None:
                    return DetectionCase.of(stored).done
                result = run_scene(sea, same, parts, clock=clock(), name=sea_name, progress=shown(1 + sea_number), workers=workers)  # noqa: B023
                if result.stopped != "time budget":
                    parts.keep_case(sea_key, replace(begun, judged=result).as_dict())  # noqa: B023
                for length in {1, int(result.result["frames_needed"])}:
                    parts.forget_frames(frames_key(sea, length))
                return result

            current = replace(current, judged=with_unknown_sea(case.scenario, own, current.done, in_sea))
        except SeaglintError as error:
            if len(cases) == 1:
                raise
            current = begun.with_error(f"case {number}: {error}")
            unfinished = True
        out.append(current)
        report(_line(number, len(cases), current))
        # Frames are removed after their last use, of a single frame and of as many as the detector needs.
        if last_use[frames_key(case.scenario, 0)] == number and current.stopped != "time budget" and current.error is None:
            for length in {1, int(current.done.result["frames_needed"])}:
                parts.forget_frames(frames_key(case.scenario, length))
    if out and all(case.error for case in out):
        raise DataError("\n".join(str(case.error) for case in out))
    return Study(out, stopped, unfinished)


def _shown(progress: Progress | None, number: int, seas: int, cases: int, evaluations: int, evaluation: int) -> Progress | None:
    """Return the progress of one evaluation of a case: that of the scenario's sea, or that of a drawn one."""
    if progress is None:
        return None
    return lambda done, _: progress((number * evaluations + evaluation) * seas + done, cases * evaluations * seas)


def _line(number: int, cases: int, case: DetectionCase) -> str:
    if case.error is not None:
        return case.error
    named, result = case.named, case.done.result
    first = result["sweep"][0]
    rate = "none" if first["p_d"] is None else f"{first['p_d']:.3g}"
    seas = result["seas"]
    drawn = f" and {result['sea_draws']} between the campaigns" if "sea_draws" in result else ""
    return f"case {number + 1} of {cases}{': ' + named if named else ''}: {seas} seas{drawn}, P_d {rate} at contrast {first['contrast']:g}"


def ranges_of(
    cases: Sequence[StudyCase],
    request: RangeRequest,
    parts: StudyParts,
    *,
    progress: Progress | None = None,
    report: Callable[[str], None] = lambda text: None,
    workers: Workers | None = None,
) -> list[DetectionRange]:
    """Return the range of an object in every case, at every bearing; stored ranges are used unchanged.

    Parameters
    ----------
    cases : sequence of StudyCase
        Scenarios of one object.
    request : RangeRequest
        Object, bearings, detector and limits.
    parts : StudyParts
        Store of frames and of P_d at each range; each range that is searched has a folder in it.
    progress : callable, optional
        Called with (ranges done, ranges in all).
    report : callable
        Called with lines on the progress.
    workers : Workers, optional
        Workers that search the ranges, or render the seas of a single one; this process by default. Results do not depend on them.

    Raises
    ------
    SeaglintError
        No such object, or a scenario that cannot be computed.
    """
    request = request.of_objects([item.name for item in cases[0].scenario.objects or ()])
    request.require_valid()
    searches = [(case, bearing) for case in cases for bearing in (request.bearings if request.bearings is not None else (None,))]
    settings = (request, parts)
    found: dict[int, DetectionRange] = {}
    shown = progress or (lambda done, total: None)
    if workers is None or len(searches) == 1:
        search = range_searcher(settings, workers, report)
        for number, one in enumerate(searches):
            found[number] = search(RangeUnit(number, *one))
            shown(len(found), len(searches))
    else:
        units = [RangeUnit(number, *one) for number, one in enumerate(searches)]
        with workers.map(Job(search_worker, settings), units) as outcomes:
            for outcome in outcomes:
                result, lines = record_of(outcome)
                for line in lines:
                    report(line)
                if isinstance(result, SeaglintError):
                    raise result
                found[outcome.unit.number] = result
                shown(len(found), len(searches))
    return [found[number] for number in range(len(searches))]


@dataclass(frozen=True)
class RangeUnit:
    """One search of a range."""

    number: int  #: Number of the search.
    case: StudyCase  #: Case of the study.
    bearing_deg: float | None  #: Bearing from the Sun [deg].

    def __repr__(self) -> str:
        """Return a few words, which errors of workers contain."""
        bearing = "" if self.bearing_deg is None else f", {self.bearing_deg:g} deg from the Sun"
        return f"search {self.number}{bearing}"


RangeSettings = tuple[RangeRequest, StudyParts]  #: Request, whose object is named, and store of a search.


def range_searcher(
    settings: RangeSettings, workers: Workers | None = None, report: Callable[[str], None] = lambda text: None
) -> Callable[[RangeUnit], DetectionRange]:
    """Return a function that searches a range; a stored range is returned unchanged."""
    request, parts = settings

    def search(unit: RangeUnit) -> DetectionRange:
        case, bearing = unit.case, unit.bearing_deg
        own, inner = with_settings(request, case.study), parts.within(f"range-{unit.number:04d}")
        content = pickle.dumps((case.scenario.model_dump_json(), bearing, own.settings, own.object, own.limits, own.share), protocol=5)
        key = f"found-{hashlib.sha256(content).hexdigest()[:16]}"
        if (stored := inner.case(key)) is not None:
            return replace(DetectionRange.of(stored), parameters=case.parameters)
        require_detector(own.detector, own.time_limit)
        result = detection_range(case.scenario, own, inner, bearing_deg=bearing, report=report, workers=workers)
        inner.keep_case(key, result.as_dict())
        return replace(result, parameters=case.parameters)

    return search


def search_worker(settings: RangeSettings) -> Callable[[RangeUnit], tuple[DetectionRange | SeaglintError, list[str]]]:
    """Return a function of a worker that returns a range, or the error that the user's input raises, with the reported lines.

    Such an error is final: the unit is not tried again elsewhere.
    """

    def search(unit: RangeUnit) -> tuple[DetectionRange | SeaglintError, list[str]]:
        lines: list[str] = []
        try:
            return range_searcher(settings, report=lines.append)(unit), lines
        except (DataError, DomainError, ScenarioError) as error:
            return error, lines

    return search
