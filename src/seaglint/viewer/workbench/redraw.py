"""Redrawing of pictures a little after the last change; a newer change replaces a picture in progress."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, Final

from seaglint.base.errors import SeaglintError
from seaglint.scenario.model import Scenario
from seaglint.viewer.workbench.small_pictures import Job, Order, Overtaken, Painter, PreviewPicture

JOBS: Final[tuple[Job, ...]] = ("mean", "frame")

#: Callback that takes a picture, the reason why there is none, or None where one is begun.
Show = Callable[[Job, "PreviewPicture | str | None"], None]


class Redraw:
    """Pictures of one page.

    Parameters
    ----------
    painter : Painter
        Shared by all pages.
    show : callable
        Called with the name of a picture and what came of it.
    start : callable
        Starts a coroutine in the background.
    """

    def __init__(self, painter: Painter, show: Show, start: Callable[[Coroutine[Any, Any, None]], object]) -> None:
        self._painter, self._show, self._start = painter, show, start
        self._requested: Scenario | None = None
        self._order: Order | None = None
        self._works = self._closed = False

    def want(self, scenario: Scenario) -> None:
        """Request the pictures of a scenario, in place of earlier requests."""
        if self._closed:
            return
        self.drop()
        self._requested = scenario
        if not self._works:
            self._works = True
            self._start(self._work())

    def drop(self) -> None:
        """Cancel all requests."""
        self._requested = None
        if self._order is not None:
            self._order.drop()

    def close(self) -> None:
        """Stop, since the page is closed."""
        self._closed = True
        self.drop()

    async def _work(self) -> None:
        try:
            while self._requested is not None:
                scenario, self._requested = self._requested, None
                for job in JOBS:
                    if not await self._draw(job, scenario):
                        break
        finally:
            self._works = False

    async def _draw(self, job: Job, scenario: Scenario) -> bool:
        """Draw one picture; return False where a newer request replaced it."""
        self._order = order = Order(job, scenario)
        self._show(job, None)
        try:
            found: PreviewPicture | str = await asyncio.get_running_loop().run_in_executor(self._painter.line, self._painter.paint, order)
        except Overtaken:
            return False
        except SeaglintError as error:
            found = str(error)
        if order.dropped.is_set():
            return False
        self._show(job, found)
        return True
