"""Views of a sea that scenarios of a sweep share: air, water and slopes are prepared once for all Suns over them."""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Any, Final

from seaglint.base.conventions import FloatArray
from seaglint.facet.sea_view import SeaView
from seaglint.facet.surface_spectra import SeaSurface
from seaglint.radiance.mean_radiance import SeaLines
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.atmosphere_table import FileAtmosphere
from seaglint.scenario.sun import SunPosition
from seaglint.studies.prepare import prepare

MOST_KEPT: Final = 64  #: Views kept at a time: some 5 MB each.

_SUNLESS: Final = {"band", "wind", "sea", "atmosphere", "mean", "platform"}  #: Tables that a view without its Sun depends on.

_KEPT: Final[OrderedDict[str, SharedView]] = OrderedDict()
_LOCK: Final = threading.Lock()


@dataclass(eq=False)
class SharedView:
    """View of a sea, and its lines of sight prepared so far."""

    view: SeaView  #: View with the Sun of the scenario that was the first.
    _surface: SeaSurface | None = None
    _lines: dict[Any, SeaLines] = field(default_factory=dict)

    def under(self, sun: SunPosition) -> SeaView:
        """Return the view under a Sun."""
        return prepare.under(self.view, sun)

    def lines(self, view: SeaView, elevation: FloatArray, azimuth: FloatArray) -> SeaLines:
        """Return lines of sight of :meth:`under` at elevations and azimuths [rad]."""
        key = (elevation.tobytes(), azimuth.tobytes(), view.hiding.law_bands(view.slopes))
        if key not in self._lines:
            if self._surface is None:
                self._surface = SeaSurface.create(view.atmosphere, view.water, view.sea_temperature, view.in_band.grid)
            self._lines[key] = SeaLines.prepare(view, elevation, azimuth, self._surface)
        return self._lines[key]


def forget_views() -> None:
    """Forget all views: files that they were made of may have changed since."""
    with _LOCK:
        _KEPT.clear()


def shared_view(scenario: Scenario, height: float) -> SharedView:
    """Return the view of a scenario from a height [m], from an earlier one that differs in nothing but the Sun and the picture."""
    key = _key(scenario, height)
    with _LOCK:
        if key in _KEPT:
            _KEPT.move_to_end(key)
            return _KEPT[key]
    made = SharedView(prepare.standing_view(scenario, height))
    with _LOCK:
        _KEPT[key] = made
        while len(_KEPT) > MOST_KEPT:
            _KEPT.popitem(last=False)
    return made


def _key(scenario: Scenario, height: float) -> str:
    tables = set(_SUNLESS)
    if isinstance(scenario.atmosphere, FileAtmosphere):
        tables |= {"sensor"}  # its columns are those of what is in view
    text = scenario.model_dump_json(include=tables, exclude_none=True)
    if '"sounding"' in text or '"path"' in text:  # files are read at a date and a place
        text += scenario.model_dump_json(include={"time", "place"}, exclude_none=True)
    return f"{height!r} {text}"
