"""Files of LOWTRAN7 and MODTRAN in their exact layouts, made of given spectra: what the readers' tests read."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

NU = np.arange(2400.0, 2431.0, 5.0)


@dataclass(frozen=True)
class Made:
    """A case: geometry as MODTRAN has it, and what it gives in W cm-2 (sr-1) per cm-1."""

    mode: int
    kind: int
    h1_km: float
    angle: float
    depth: np.ndarray
    thermal: np.ndarray
    scattered: np.ndarray
    azimuth: float = 0.0
    solar: float = 76.0
    sun_outside: np.ndarray | None = None

    @property
    def transmittance(self):
        return np.exp(-self.depth)

    @property
    def toa(self):
        return np.linspace(1.40e-6, 1.45e-6, NU.size)

    @property
    def total(self):
        return self.thermal + (self.scattered if self.mode == 2 else 0.0)


def case(mode, kind, h1_km, angle, azimuth=0.0, *, solar=76.0):
    """A smooth spectrum that differs from case to case: longer ways absorb and emit more, the aureole is brightest."""
    mass = 1.0 / (abs(np.cos(np.radians(angle))) + 0.05)
    depth = (0.08 + 0.05 * mass) * np.linspace(1.3, 0.8, NU.size)
    thermal = -np.expm1(-depth) * np.linspace(1.3e-7, 1.1e-7, NU.size)
    return Made(mode, kind, h1_km, angle, depth, thermal, 3e-9 * mass * np.exp(-azimuth / 40.0) * np.ones(NU.size), azimuth, solar)


def all_cases(h1_km=0.03, *, azimuths=(0.0, 60.0, 180.0)):
    """Enough for a file: paths, sky from the sea and the sensor, Sun."""
    lit = [(2, 2, h1_km, a) for a in (180.0, 120.0, 95.0, 91.0)] + [(2, 3, h, a) for h in (0.0, h1_km) for a in (0.0, 60.0, 85.0, 90.0)]
    return [case(*c, azimuth) for c in lit for azimuth in azimuths] + [case(3, 3, 0.0, a) for a in (0.0, 60.0, 85.0, 90.0)]


def fortran_e(value, width, digits):
    """1PEw.d as Fortran prints it: exponents of three digits lose their E."""
    mantissa, power = f"{value:.{digits}E}".split("E")
    e = int(power)
    return f"{mantissa}{'E' if abs(e) < 100 else ''}{'-' if e < 0 else '+'}{abs(e):02d}".rjust(width)


def cards(c, lowtran):
    """The cards above the column names; what was not read is -99."""
    none = f"{-99.0:10.3f}"
    card1 = f"    2{c.kind:5d}{c.mode:5d}" + f"{0:5d}" * 10 + "   0.001   0.00"
    lines = [card1 if lowtran else "TM" + card1[2:]]
    lines += [] if lowtran else [" F   2   0   365.000         0         0 F F F F"]
    lines += ["    3    1    1    3    0    0    41.472     7.000     7.000     0.000     0.000", none * 3 + "       -99", none * 3]
    lines += ["   33MIDLATITUDE SUMMER  ", f"{c.h1_km:10.3f}{0.0:10.3f}{c.angle:10.3f}{1.73:10.3f}{0.016:10.3f}{0.0:10.3f}{0:5d}"]
    if c.mode == 2:
        lines += [f"{2:5d}{2:5d}{93:5d}{0:5d}", f"{c.azimuth:10.3f}{c.solar:10.3f}" + f"{0.0:10.3f}" * 6]
    else:
        lines += ["  -99  -99  -99  -99", none * 8]
    return [*lines, f"{NU[0]:10.3f}{NU[-1]:10.3f}{5.0:10.3f}", "    0"]


def lowtran7(cases):
    """tape7 of LOWTRAN7: FORMATs 917, 927 and 937."""
    out = []
    for c in cases:
        out += cards(c, True)
        out.append(
            "  FREQ   TRANS     SOL TR  SOLAR    "
            if c.mode == 3
            else "  FREQ   TRANS     ATMOS   PATH     SINGLE   GROUND DIRECT   TOTAL RAD"
        )
        for i, v in enumerate(NU):
            line = f"{v:6.0f}.{c.transmittance[i]:8.4f}"
            if c.mode == 3:
                line += fortran_e(c.toa[i] * c.transmittance[i], 9, 2) + fortran_e(c.toa[i], 9, 2)
            else:
                line += fortran_e(c.thermal[i], 9, 2)
            if c.mode == 2:
                parts = (c.scattered[i], c.scattered[i], 0.0, 0.0, c.total[i])
                line += "".join(fortran_e(x, 9, 2) for x in parts) + f"{0.04:8.4f}{0.0546:8.4f}"
            out.append(line.ljust(95) + fortran_e(c.depth[i], 10, 3))
        out.append(" -9999.")
    return "\n".join(out) + "\n"


FOUR = "  TOT TRANS  PTH THRML  THRML SCT  SURF EMIS   SOL SCAT  SING SCAT  GRND RFLT  DRCT RFLT  TOTAL RAD  REF SOL  SOL@OBS   DEPTH"


def modtran(cases, version=4):
    """.tp7 of MODTRAN 4 or 5: ``F8.2,F11.8,1P,E11.4,11X,6E11.4,2E9.2,0P,F8.3`` (DISORT leaves THRML SCT blank) and three columns more."""
    out = []
    for c in cases:
        out += cards(c, False)
        more = " DIR_EM    TOA_SUN BBODY_T[K]" if version == 5 else ""
        names = FOUR if version == 4 else FOUR.replace(" TRANS", "_TRANS").replace("PTH ", "PTH_").replace("L SCT", "L_SCT")
        out.append("    FREQ   TRANS     SOL TR  SOLAR" if c.mode == 3 else "    FREQ" + names + more)
        for i, v in enumerate(NU):
            tau, e = c.transmittance[i], fortran_e
            if c.mode == 3:
                out.append((f"{v:8.2f}{tau:8.4f}" + e(c.toa[i] * tau, 9, 2) + e(c.toa[i], 9, 2)).ljust(95) + e(c.depth[i], 10, 3))
                continue
            if c.mode == 1:
                # F8.2,1P,E11.4,2(E11.4,11X),2(11X,E11.4),18X,0P,F8.3
                gap, zero = " " * 11, e(0.0, 11, 4)
                row = f"{v:8.2f}" + e(tau, 11, 4) + e(c.thermal[i], 11, 4) + gap + zero + gap + gap + zero + gap + e(c.total[i], 11, 4)
                out.append(row + " " * 18 + f"{c.depth[i]:8.3f}")
                continue
            parts = (0.0, c.scattered[i], c.scattered[i], 0.0, 0.0, c.total[i])
            row = f"{v:8.2f}{tau:11.8f}" + e(c.thermal[i], 11, 4) + " " * 11 + "".join(e(x, 11, 4) for x in parts)
            row += e(c.toa[i] * 0.6, 9, 2) + e(c.toa[i] * 0.7, 9, 2) + f"{c.depth[i]:8.3f}"
            out.append(row + (f"{1.0:7.3f}{e(c.toa[i], 11, 4)}{287.123:11.3f}" if version == 5 else ""))
        out.append(" -9999.")
    return "\n".join(out) + "\n"


def scanned(cases, unit="MCRN"):
    """.7sc of radiance modes over wavelength: micrometres and W cm-2 sr-1 um-1, or nanometres and uW cm-2 sr-1 nm-1."""
    out = []
    for c in cases:
        out += cards(c, False)
        out.append((" WAVLEN MCRN  TRANS" if unit == "MCRN" else "  WAVLEN(NM)   TRAN") + FOUR[11:])
        for i in range(NU.size)[::-1]:
            um = 1e4 / NU[i]
            per = NU[i] ** 2 / 1e4 * (1.0 if unit == "MCRN" else 1e3)
            parts = (0.0, c.scattered[i], c.scattered[i], 0.0, 0.0, c.total[i])
            row = (
                (f"{um:12.6f}" if unit == "MCRN" else f"{1e3 * um:12.3f}")
                + f"{c.transmittance[i]:7.4f}"
                + fortran_e(c.thermal[i] * per, 11, 4)
            )
            row += " " * 11 + "".join(fortran_e(x * per, 11, 4) for x in parts) + fortran_e(0.0, 9, 2) * 2 + f"{c.depth[i]:9.4f}"
            out.append(row)
        out.append(" -9999.")
    return "\n".join(out) + "\n"


JSON_NAMES = (
    "TOT_TRANS",
    "THRML_EM",
    "THRML_SCT",
    "SURF_EMIS",
    "MULT_SCAT",
    "SING_SCAT",
    "GRND_RFLT",
    "DRCT_RFLT",
    "TOTAL_RAD",
    "SOL_AT_OBS",
)
CSV_NAMES = (
    "total transmittance,path emission,path thermal scat,surface emission,path multiple scat,path single scat,"
    "ground reflect,direct reflect,total radiance,irradiance at observer"
)


def columns(c):
    """Columns of MODTRAN 6 in the order of their names."""
    zero = np.zeros(NU.size)
    sun = c.toa * c.transmittance if c.mode == 3 else zero
    scattered = c.scattered if c.mode == 2 else zero
    return (c.transmittance, c.thermal, zero, zero, scattered, scattered, zero, zero, c.thermal + scattered, sun)


def modtran6_csv(cases):
    """CSV of MODTRAN 6, with the frame that it writes around its tables."""
    out = []
    for k, c in enumerate(cases):
        out += [f"case index {k} = {{", f"num freq, {NU.size}", f"freq,{CSV_NAMES}"]
        out += [",".join(f"{x:.6g}" for x in row) for row in zip(NU, *columns(c), strict=True)]
        out.append("}")
    return "\n".join(out) + "\n"


def modtran6_json(cases):
    """JSON of MODTRAN 6 with its input."""
    names = ("RT_TRANSMITTANCE", "RT_THERMAL_ONLY", "RT_SOLAR_AND_THERMAL", "RT_SOLAR_IRRADIANCE")
    out = []
    for c in cases:
        geometry = {"ITYPE": c.kind, "H1ALT": c.h1_km, "H2ALT": 0.0, "OBSZEN": c.angle, "IPARM": 2, "PARM1": c.azimuth, "PARM2": c.solar}
        given = {
            "RTOPTIONS": {"IEMSCT": names[c.mode]},
            "GEOMETRY": geometry,
            "SPECTRAL": {"V1": NU[0], "V2": NU[-1], "DV": 5.0, "FLAGS": "W"},
        }
        spectra = {name: values.tolist() for name, values in zip(JSON_NAMES, columns(c), strict=True)}
        out.append({"MODTRANINPUT": given, "MODTRANOUTPUT": {"SPECTRA": {"RADIANCE": spectra}}})
    return json.dumps({"MODTRAN": out})
