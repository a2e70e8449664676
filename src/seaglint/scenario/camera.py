"""A camera from the few numbers of its data sheet: tables of a scenario from text such as ``pitch_um=17,pixels=640x512``.

Every key of ``[sensor]`` and of its tables is taken by its last name, in the unit at the end of that name or in another one of the same
kind: ``focal_length_mm``, ``netd_mk``. ``band_um=7.5-13.5`` is both edges of the band.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import DataError, ScenarioError
from seaglint.base.free_form import TomlTables
from seaglint.scenario.keys import key_at, table_keys
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import TABLES
from seaglint.scenario.records.quantities import convert
from seaglint.scenario.records.sensor_table import PhotonDetector, ThermalDetector

#: Camera in the words of a data sheet, for help texts and messages.
EXAMPLE: Final = "pitch_um=17,pixels=640x512,focal_length_mm=35,f_number=1.1,netd_mk=50,band_um=7.5-13.5"

ABOVE: Final = 0.0625  #: Share of the picture's height that lies above the horizontal: the horizon is in view, near its upper edge.

UNCOOLED_FROM_UM: Final = 6.0  #: Band edge from which a camera of which only an NETD is known is taken for a microbolometer [um].

#: Keys on which the answers of a camera depend, by table.
_ASSUMED: Final[Mapping[str, tuple[str, ...]]] = {
    "sensor": ("height_m", "azimuth_deg", "elevation_deg", "projection", "fov_deg", "frame_rate_hz", "frames"),
    "band": ("min_um", "max_um"),
    "sensor.optics": (
        *("f_number", "aperture_m", "focal_length_m", "transmission", "obscuration", "wavefront_error_waves", "defocus_waves"),
        *("jitter_urad", "emissivity", "temperature_k"),
    ),
    "sensor.detector": (
        *("kind", "fill_factor", "quantum_efficiency", "absorptance", "integration_time_s", "time_constant_s", "well_capacity_e"),
        *("read_noise_e", "dark_current_e_s", "netd_f_number", "netd_temperature_k", "full_scale_k", "bit_depth"),
    ),
    "sun": ("zenith_deg", "azimuth_deg"),
    "time": ("utc",),
    "place": ("latitude_deg", "longitude_deg"),
    "wind": ("speed_m_s", "from_deg"),
    "sea": ("temperature_k",),
    "atmosphere": ("source", "model"),
}

#: Meaning of keys that have no value.
_UNSET_MEANINGS: Final[Mapping[str, str]] = {"integration_time_s": "a whole frame", "well_capacity_e": "without limit"}

_ONLY_PHOTON: Final = frozenset(PhotonDetector.model_fields) - frozenset(ThermalDetector.model_fields)
_ONLY_THERMAL: Final = frozenset(ThermalDetector.model_fields) - frozenset(PhotonDetector.model_fields)
#: Units whose letters are not those at the end of a key; every other unit is written as there.
_UNITS: Final = {"mk": "mK", "k": "K", "hz": "Hz", "khz": "kHz", "urad": "urad", "mrad": "mrad"}


@dataclass(frozen=True)
class CameraTables:
    """Tables of a scenario that describe a camera."""

    tables: TomlTables  #: Content of ``[sensor]`` and ``[band]``.
    assumed: tuple[str, ...] = ()  #: Assumptions beyond the data sheet, a sentence each.


def read_camera(given: str) -> CameraTables:
    """Read a camera from text such as ``EXAMPLE``, or from a TOML file of the same keys.

    Raises
    ------
    ScenarioError
        Naming the key that no camera has, or the value that cannot be read.
    DataError
        The file cannot be read.
    """
    if given.endswith(".toml"):
        return camera(_from_file(Path(given)))
    values: dict[str, Any] = {}
    for part in given.split(","):
        name, equals, value = (text.strip() for text in part.partition("="))
        if not equals or not name or not value:
            raise ScenarioError(f"camera: '{part.strip()}' is no key=value; write e.g. {EXAMPLE}")
        if name in values:
            raise ScenarioError(f"camera: {name} is given twice; leave one out")
        values[name] = _plain(value)
    return camera(values)


def camera(values: Mapping[str, Any]) -> CameraTables:
    """Sort a data sheet's numbers into the tables of a scenario and list the assumptions.

    Raises
    ------
    ScenarioError
        Naming the key that no camera has, or the value that cannot be read.
    """
    sensor: dict[str, Any] = {}
    band: dict[str, Any] = {}
    for name, value in values.items():
        if name.startswith("band"):
            band |= _band(name, value)
            continue
        place, read = _key_and_value(name, value)
        *above, key = place[1:]
        table = sensor.setdefault(above[0], {}) if above else sensor
        if key in table:
            raise ScenarioError(f"camera: {'.'.join(place)} is given twice (here as {name}); leave one out")
        table[key] = read
    # A camera needs a picture, a pitch and an aperture; everything else has a default or follows.
    needs = {"pixels": "pixels=640x512", "pitch_um": "pitch_um=17", "f_number or aperture_m": "f_number=1.1"}
    missing = [
        needs[key]
        for key, there in {
            "pixels": "pixels" in sensor,
            "pitch_um": "pitch_um" in sensor.get("detector", {}),
            "f_number or aperture_m": not {"f_number", "aperture_m"}.isdisjoint(sensor.get("optics", {})),
        }.items()
        if not there
    ]
    if missing:
        raise ScenarioError(f"camera: misses {', '.join(missing)}; write e.g. {EXAMPLE}")
    assumed = [*_kind(sensor["detector"], band, values), *_assume_netd_lens(sensor)]
    if not band:
        assumed.append("band of 3.5 to 5 um, as none is given; add band_um=3.5-5")
    return CameraTables({"sensor": sensor, **({"band": band} if band else {})}, tuple(assumed))


def with_camera(raw: Mapping[str, Any], chosen: CameraTables) -> TomlTables:
    """Return a scenario's raw tables with a camera in place of its sensor's pixels, optics, detector, scan, noise and band.

    A camera without a direction looks up until a sixteenth of its picture is above the horizontal.
    """
    own, new = raw.get("sensor", {}), dict(chosen.tables["sensor"])
    remaining = {key: value for key, value in own.items() if key not in (*TABLES, "fov_deg", "pixels")}
    bands = {"band": dict(chosen.tables["band"])} if "band" in chosen.tables else {}
    # what the optics see is known to the model alone
    # The height of the view may follow from pixels and focal length, so a level camera is validated to read it.
    level = parse_scenario({**bands, "sensor": {**remaining, "elevation_deg": 0.0, **new}}, name="camera").sensor
    direction = {} if "elevation_deg" in new else {"elevation_deg": round(-(0.5 - ABOVE) * level.fov_deg[1], 3)}
    return {**raw, **bands, "sensor": {**remaining, **direction, **new}}


def assumed_values(scenario: Scenario, chosen: CameraTables) -> list[str]:
    """Return the values of a camera's scenario that the data sheet does not state, a line of keys and values for each subject.

    Parameters
    ----------
    scenario : Scenario
        With the camera in it.
    chosen : CameraTables
        The camera as given.

    Examples
    --------
    >>> chosen = read_camera("pitch_um=15,pixels=640x512,aperture_m=0.05,f_number=2")
    >>> assumed_values(parse_scenario(with_camera({}, chosen)), chosen)[1]
    '[band] min_um = 3.5, max_um = 5'
    """
    lines = []
    for table, keys in _ASSUMED.items():
        values = [f"{key} = {value}" for key in keys if (value := _assumed(scenario, chosen.tables, f"{table}.{key}")) is not None]
        if values:
            lines.append(f"[{table}] {', '.join(values)}")
    if "noise" not in chosen.tables["sensor"]:
        lines.append("[sensor.noise] all 0: no fixed pattern, 1/f noise, or noise of rows and columns")
    return lines


def _assumed(scenario: Scenario, given: Mapping[str, Any], key: str) -> str | None:
    """Return the value of a key that is not given, as text; None where it is given, or does not count."""
    value: Any = scenario
    stated: Any = given
    for part in key.split("."):
        stated = stated.get(part) if isinstance(stated, Mapping) else None
        if value is None or not hasattr(value, part):
            return None
        value = getattr(value, part)
    name, sensor = key.rpartition(".")[2], scenario.sensor
    states_netd = sensor.detector is not None and sensor.detector.netd_k is not None
    # The NETD's conditions matter only with a stated NETD.
    if stated is not None or (name.startswith("netd_") and not states_netd):
        return None
    if value is None:
        lens = {
            "f_number": sensor.focal_length_m / sensor.aperture_m,
            "aperture_m": sensor.aperture_m,
            "focal_length_m": sensor.focal_length_m,
        }
        if name in lens:
            return f"{lens[name]:.4g}"
        return "what the NETD needs" if name == "integration_time_s" and states_netd else _UNSET_MEANINGS.get(name)
    if isinstance(value, tuple):
        return f"[{', '.join(f'{one:.4g}' for one in value)}]"
    return f"{value:g}" if isinstance(value, int | float) else f'"{value}"' if isinstance(value, str) else f"{value}"


def _from_file(path: Path) -> dict[str, Any]:
    """Return the keys of a camera's file: plain keys, or the keys of [sensor] and [band] of a scenario."""
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; write the camera's keys into it, a line each, e.g. pitch_um = 17") from None
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path}: cannot be read: {error}") from error
    except tomllib.TOMLDecodeError as error:
        raise DataError(f"{path}: is not valid TOML: {error}; is text such as '640x512' in quotes?") from None
    values: dict[str, Any] = {}
    for name, value in raw.items():
        if name == "sensor" and isinstance(value, dict):
            for inner, content in value.items():
                values |= {f"{inner}.{key}": one for key, one in content.items()} if isinstance(content, dict) else {inner: content}
        elif name == "band" and isinstance(value, dict):
            values |= {f"band.{key}": one for key, one in value.items()}
        elif isinstance(value, dict) and "sensor" not in raw:
            raise ScenarioError(f"{path}: [{name}] is no table of a camera; it has [sensor], its tables and [band], or plain keys")
        elif "sensor" not in raw:  # of a whole scenario the camera alone is taken
            values[name] = _plain(value) if isinstance(value, str) else value
    return values


def _plain(text: str) -> Any:
    """Return a whole number, a number, a pair such as 640x512, true or false, or the text itself."""
    # Data sheets write pairs with x, the sign ×, or an asterisk.
    if (pair := re.fullmatch(r"([0-9.]+)\s*[x×*]\s*([0-9.]+)", text)) is not None:
        return [_plain(pair[1]), _plain(pair[2])]
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text.strip("'\"")


@cache
def _keys() -> dict[str, tuple[str, ...]]:
    """Return the places of all keys of a camera by their last name, and keys of inner tables also by both names."""
    tables: dict[tuple[str, ...], Iterable[str]] = {(): table_keys(("sensor",))}
    tables |= {(name,): table_keys(("sensor", name)) for name in ("detector", "optics", "noise", "scan")}
    out: dict[str, tuple[str, ...]] = {}
    for table, names in tables.items():
        for name in names:
            if name in TABLES:
                continue
            # A bare name belongs to the first table that has it; other tables need both names, as in optics.temperature_k.
            out.setdefault(name, ("sensor", *table, name))
            if table:
                out[f"{table[0]}.{name}"] = ("sensor", *table, name)
    return out


def _key_and_value(name: str, value: Any) -> tuple[tuple[str, ...], Any]:
    """Return the place of a key and its value in the unit of that place."""
    known = _keys()
    if name in known:
        return known[name], value
    # A key with another unit has the stem of the scenario's key and a different ending: focal_length_mm.
    stem, _, ending = name.rpartition("_")
    candidates = [other for other in known if other.rpartition("_")[0] == stem and stem]
    for other in candidates:
        # The endings of scenario keys are units, so the first key whose unit the ending converts to is meant.
        key = key_at(known[other])
        assert key is not None
        unit = next((quantity.unit for quantity in key.quantities if quantity.unit), "")
        if not unit or isinstance(value, bool) or not isinstance(value, int | float | list):
            continue
        try:
            # 17 significant digits pass the number through text without rounding.
            each = value if isinstance(value, list) else [value]
            read = [convert(f"{float(one):.17g} {_UNITS.get(ending, ending)}", unit) for one in each]
        except ValueError:
            continue
        exact = [float(f"{one:.12g}") for one in read]  # 35 mm are 0.035 m, whatever the factor's last bit
        return known[other], exact if isinstance(value, list) else exact[0]
    if bare := [other for other in known if other.rpartition("_")[0] == name]:
        raise ScenarioError(f"camera: {name}={_text(value)} has no unit; write {bare[0]}={_text(value)}")
    near = difflib.get_close_matches(name, [*known, "band_um"], n=1, cutoff=0.6)
    hint = f"did you mean {near[0]}?" if near else f"write e.g. {EXAMPLE}; 'seaglint init' writes all keys of [sensor] and its tables"
    raise ScenarioError(f"camera: {name} is an unknown key; {hint}")


def _band(name: str, value: Any) -> dict[str, Any]:
    """Return the edges of the band from ``band_um=7.5-13.5``, or the key of the table [band]."""
    if name.startswith("band."):
        key = name.removeprefix("band.")
        if key not in table_keys(("band",)):
            raise ScenarioError(f"camera: {name} is an unknown key; allowed: {', '.join(table_keys(('band',)))}")
        return {key: value}
    if name == "band":
        raise ScenarioError(f"camera: band={_text(value)} has no unit; write band_um={_text(value)}")
    edges = value if isinstance(value, list) else re.fullmatch(r"([0-9.]+)\s*(?:-|–|to|\.\.)\s*([0-9.]+)", str(value))
    unit = name.removeprefix("band_")
    try:
        low, high = (convert(f"{float(one):.17g} {unit}", "um") for one in (edges if isinstance(edges, list) else edges.groups()))  # type: ignore[union-attr]
    except (ValueError, AttributeError, TypeError):
        raise ScenarioError(f"camera: {name}={_text(value)} is no band; write both edges, e.g. band_um=7.5-13.5") from None
    return {"min_um": float(f"{low:.12g}"), "max_um": float(f"{high:.12g}")}


def _kind(detector: dict[str, Any], band: Mapping[str, Any], values: Mapping[str, Any]) -> list[str]:
    """Choose the detector's kind if the data sheet does not state it, and return the reason."""
    if "kind" in detector:
        return []
    photon, thermal = _ONLY_PHOTON & set(detector), _ONLY_THERMAL & set(detector)
    if photon or thermal or "netd_k" not in detector:
        detector["kind"] = "photon" if photon or not thermal else "thermal"
        return []
    uncooled = band.get("min_um", 0.0) >= UNCOOLED_FROM_UM
    detector["kind"] = "thermal" if uncooled else "photon"
    taken, other = ("a microbolometer", "photon") if uncooled else ("a cooled photon detector", "thermal")
    return [f"{taken}, from band and NETD; kind={other} makes it the other"]


def _assume_netd_lens(sensor: dict[str, Any]) -> list[str]:
    """Take a microbolometer's NETD as stated for its lens if the data sheet has no other f-number, and return this assumption."""
    detector, lens = sensor["detector"], sensor.get("optics", {}).get("f_number")
    if detector["kind"] != "thermal" or lens is None or "netd_f_number" in detector:
        return []
    detector["netd_f_number"] = lens
    return [f"NETD as stated for this lens, F/{lens:g}; netd_f_number=1 where the data sheet states it at F/1"]


def _text(value: Any) -> str:
    return "x".join(f"{one}" for one in value) if isinstance(value, list) else f"{value}"
