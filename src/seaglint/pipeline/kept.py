"""What scenes rendered one after the other share: everything that seed and objects do not change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from seaglint.io.provenance import provenance
from seaglint.pipeline.scene_objects import SceneObjects, bodies_of
from seaglint.scenario.model import Scenario
from seaglint.threads import single_threaded_algebra

if TYPE_CHECKING:
    from seaglint.pipeline.render import Sequence


@dataclass(eq=False)
class Kept:
    """The latest scene that was made ready; memory does not grow with the number of scenes.

    Notes
    -----
    The bytes of a scene do not depend on what was kept.
    """

    _latest: tuple[str, Sequence] | None = field(default=None, repr=False)

    def sequence(self, scenario: Scenario, settings: str, prepare: Callable[[], Sequence]) -> Sequence:
        """The scene of a scenario, from the latest one where only seed and objects differ.

        Parameters
        ----------
        scenario : Scenario
            What is drawn.
        settings : str
            What else it depends on.
        prepare : callable
            Makes it from nothing.
        """
        if scenario.platform is not None and scenario.platform.floats:
            return prepare()  # its way depends on the sea
        key = settings + scenario.model_copy(update={"seed": 0, "objects": None}).model_dump_json()
        if self._latest is not None and self._latest[0] == key:
            return _varied(self._latest[1], scenario)
        self._latest = None  # two at a time would be twice the memory
        made = prepare()
        self._latest = (key, made)
        return made


@single_threaded_algebra()
def _varied(made: Sequence, scenario: Scenario) -> Sequence:
    """The same sea, air, Sun and sensor with another scenario's seed and objects."""
    found = replace(made, objects=None).reseeded(scenario.seed)
    objects = SceneObjects.of(bodies_of(scenario), found.scene.waves, shadows=scenario.render.object_shadows)
    told = found.layout.attributes
    attributes = {**told, **provenance(told["title"], scenario.model_dump_json(exclude_none=True), scenario.seed)}
    layout = replace(found.layout, truth=None if objects is None else objects.layout(), attributes=attributes)
    return replace(found, objects=objects, layout=layout)
