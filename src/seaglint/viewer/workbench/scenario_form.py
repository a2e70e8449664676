"""Form of the workbench: a field for every key, from the JSON Schema, with its mistakes below it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from nicegui import ui

from seaglint.base.errors import Mistake
from seaglint.base.free_form import TomlTables
from seaglint.viewer.workbench.scenario_draft import Draft, Field, Group, Keys, dotted, form, keys_of, text_of

_OPEN = ("sun", "sensor", "wind")  #: Groups that are open at first.


class Form:
    """Form with the fields of a draft.

    Parameters
    ----------
    draft : Draft
        Draft that the fields change.
    changed : callable
        Called after every change.
    """

    def __init__(self, draft: Draft, changed: Callable[[], None]) -> None:
        self._draft, self._changed = draft, changed
        self._notes: dict[Keys, tuple[ui.label, str]] = {}
        self._widgets: dict[Keys, Any] = {}
        self._typed: dict[Keys, str] = {}
        self._heads: dict[str, ui.badge] = {}
        self._marked: list[Keys] = []
        self._quiet = False
        draft.forget(())

    def build(self) -> None:
        """Build the form in the current slot."""
        whole = form()
        self._section(Group("general", whole.hint, {"": tuple(e for e in whole.entries() if isinstance(e, Field))}), ())
        for entry in whole.entries():
            if isinstance(entry, Group):
                self._section(entry, (entry.name,))

    def _section(self, group: Group, keys: Keys) -> None:
        """Build a group that opens and closes; its fields are made when it is first opened."""
        with ui.expansion(value=group.name in _OPEN).classes("group").props(f'dense data-group="{group.name}"') as section:
            with section.add_slot("header"), ui.row().classes("head"):
                ui.label(group.name).classes("name")
                ui.label(group.hint).classes("faint grow")
                self._heads[group.name] = ui.badge("", color="negative").classes("count")
                self._heads[group.name].set_visibility(False)
            inside = ui.column().classes("fields")

        def fill() -> None:
            if section.value and not inside.default_slot.children:
                with inside:
                    self._group(group, keys, named=False)

        section.on_value_change(fill)
        fill()

    def _group(self, group: Group, keys: Keys, *, named: bool = True) -> None:
        """Build the fields of a table, which are rebuilt when its kind changes."""
        with ui.column().classes("table" if named else "fields") as box:
            self._fill(group, keys, box, named)

    def _fill(self, group: Group, keys: Keys, box: ui.column, named: bool) -> None:
        def again() -> None:
            box.clear()
            # Typed texts belong to fields that no longer exist; positions in lists may have changed.
            self._typed = {known: text for known, text in self._typed.items() if known[: len(keys)] != keys}
            self._draft.forget(keys)
            with box:
                self._fill(group, keys, box, named)
            self._changed()

        if named:
            with ui.row().classes("head"):
                ui.label(group.name).classes("name")
                ui.label(group.hint).classes("faint grow")
        self._note(keys, "")
        if group.many:
            self._items(group, keys, again)
            return
        if group.optional and not self._toggle(group, keys, again):
            return
        self._entries(group, keys, again)

    def _toggle(self, group: Group, keys: Keys, again: Callable[[], None]) -> bool:
        """Build the switch of an optional table; return true where its fields are shown."""
        # Without time and place the Sun needs its angles: a switch would only make the scenario invalid.
        needless = group.name == "sun" and self._draft.get(("time",)) is None and self._draft.get(("place",)) is None
        there = self._draft.get(keys) is not None

        def turn(on: bool) -> None:
            self._draft.put(keys, {} if on else None)
            again()

        if not needless:
            ui.switch(f"[{dotted(keys)}]", value=there, on_change=lambda e: turn(bool(e.value))).props(f'dense data-key="{dotted(keys)}"')
        return there or needless

    def _entries(self, group: Group, keys: Keys, again: Callable[[], None]) -> None:
        tag = str(self._draft.get((*keys, group.tag)) or group.default_tag) if group.tag else ""
        if group.tag:

            def choose(word: str) -> None:
                table = self._draft.get(keys)
                previous = table if isinstance(table, dict) else {}
                names = {entry.name for entry in group.entries(word)}
                # Keys that both kinds have keep their values.
                self._draft.put(keys, {group.tag: word} | {key: value for key, value in previous.items() if key in names})
                again()

            chosen = tag if tag in group.variants else None
            ui.select(list(group.variants), value=chosen, label=group.tag, on_change=lambda e: choose(str(e.value))).props(
                f'dense outlined options-dense data-key="{dotted((*keys, group.tag))}"'
            ).classes("wide")
            self._note((*keys, group.tag), group.hints.get(tag, ""))
        for entry in group.entries(tag):
            if isinstance(entry, Group):
                self._group(entry, (*keys, entry.name))
            else:
                self._field(entry, (*keys, entry.name))

    def _items(self, group: Group, keys: Keys, again: Callable[[], None]) -> None:
        """Build a list of tables, each with its fields, and buttons that add and remove tables."""
        items = self._draft.get(keys)
        items = items if isinstance(items, list) else []
        for place, item in enumerate(items):
            name = item.get("name", "") if isinstance(item, dict) else ""
            with ui.expansion(f"{place + 1}  {name}").classes("item").props("dense") as section:
                inside = ui.column().classes("fields")

            def fill(section: ui.expansion = section, inside: ui.column = inside, place: int = place) -> None:
                if section.value and not inside.default_slot.children:
                    with inside:
                        self._note((*keys, place), "")
                        self._entries(group, (*keys, place), again)
                        ui.button("remove", icon="delete", on_click=lambda: remove(place)).props("flat dense no-caps")

            section.on_value_change(fill)

        def remove(place: int) -> None:
            self._draft.put((*keys, place), None)
            if not self._draft.get(keys):
                self._draft.put(keys, None)
            again()

        def add() -> None:
            new_table = (
                {"name": f"object {len(items) + 1}", "preset": "buoy", "east_m": 0, "north_m": -1000} if group.name == "objects" else {}
            )
            self._draft.put(keys, [*items, new_table])
            again()

        ui.button("add", icon="add", on_click=add).props(f'flat dense no-caps data-add="{dotted(keys)}"')

    def _field(self, entry: Field, keys: Keys) -> None:
        value, name = self._draft.get(keys), dotted(keys)

        def typed(text: str | None) -> None:
            if not self._quiet:
                self._take(entry, keys, text or "")

        def picked(chosen: Any) -> None:
            if not self._quiet:
                # A value equal to the default is not written to the file.
                self._draft.put(keys, None if chosen == entry.default else chosen)
                self._changed()

        mark = f'dense outlined data-key="{name}"'
        widget: Any
        match entry.kind:
            case "switch":
                shown = bool(entry.default if value is None else value)
                widget = ui.switch(entry.name, value=shown, on_change=lambda e: picked(e.value)).props(f'dense data-key="{name}"')
            case "choice":
                options = {choice: str(choice) for choice in entry.choices} | ({None: "not given"} if entry.default is None else {})
                shown = entry.default if value is None or value not in options else value
                widget = ui.select(options, label=entry.name, value=shown, on_change=lambda e: picked(e.value)).props(
                    f"{mark} options-dense"
                )
            case "tables":
                widget = ui.textarea(entry.name, value=text_of(value), on_change=lambda e: typed(e.value)).props(f"{mark} autogrow")
            case _:
                widget = ui.input(entry.name, value=self._typed.get(keys, text_of(value)), on_change=lambda e: typed(e.value)).props(
                    f"{mark} stack-label"
                )
                widget.props["placeholder"] = entry.placeholder
                widget.props["suffix"] = self._celsius(entry, keys)
        widget.classes("wide")
        self._widgets[keys] = widget
        self._note(keys, entry.hint + (f"; of {', '.join(map(str, entry.choices))}" if entry.kind == "list" and entry.choices else ""))

    def _take(self, entry: Field, keys: Keys, text: str) -> None:
        self._typed[keys] = text
        self._draft.take(entry, keys, text)
        self._widgets[keys].props["suffix"] = self._celsius(entry, keys)
        self._changed()

    def _celsius(self, entry: Field, keys: Keys) -> str:
        """Return the temperature of a field in degrees Celsius; nothing for other fields, and for a temperature with a unit of its own."""
        value = entry.default if self._draft.get(keys) is None else self._draft.get(keys)
        if not entry.name.endswith("temperature_k") or not isinstance(value, int | float):
            return ""
        return f"= {value - 273.15:.2f} °C".replace("-", "\u2212")

    def _note(self, keys: Keys, hint: str) -> None:
        label = ui.label(hint).classes("note").props(f'data-note="{dotted(keys)}"')
        label.set_visibility(bool(hint))
        self._notes[keys] = (label, hint)

    def _show_mistake(self, keys: Keys, text: str) -> None:
        label, _ = self._notes[keys]
        label.set_text(text)
        label.classes(add="wrong")
        label.set_visibility(True)
        self._marked.append(keys)

    def sync(self, keys: Keys) -> None:
        """Show the present value of the draft in a field, since something else changed it."""
        widget = self._widgets.get(keys)
        if widget is None or widget.is_deleted:
            return
        self._typed.pop(keys, None)
        # Setting a widget triggers its handler, which must not take the value as typed.
        self._quiet = True
        try:
            widget.set_value(text_of(self._draft.get(keys)))
        finally:
            self._quiet = False

    def show_mistakes(self, mistakes: Iterable[Mistake], raw: TomlTables) -> None:
        """Show mistakes below their fields, or below the table that holds them, and remove the old texts."""
        for keys in self._marked:
            label, hint = self._notes[keys]
            if not label.is_deleted:
                label.set_text(hint)
                label.classes(remove="wrong")
                label.set_visibility(bool(hint))
        self._marked = []
        counts = dict.fromkeys(self._heads, 0)
        for mistake in mistakes:
            keys = keys_of(mistake, raw)
            head = str(keys[0]) if len(keys) > 1 or (keys and keys[0] in counts) else "general"
            counts[head if head in counts else "general"] += 1
            # The deepest place that has a field at present; groups that were never opened have none.
            place = next(
                (keys[:n] for n in range(len(keys), 0, -1) if keys[:n] in self._notes and not self._notes[keys[:n]][0].is_deleted), None
            )
            if place is not None:
                self._show_mistake(place, mistake.text)
        for name, badge in self._heads.items():
            badge.set_text(str(counts[name]))
            badge.set_visibility(counts[name] > 0)
