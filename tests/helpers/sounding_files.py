"""Files of soundings in the layouts of many programs, all of one ascent whose truth is known by construction."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import xarray as xr

from seaglint.air.profile.air_profile import model_levels, saturation_density
from seaglint.formats.soundings.sounding_checks import DRY_AIR, virtual_temperature

RADIUS = 6_356_766.0


@dataclass(frozen=True)
class Truth:
    """Levels of an ascent: geometric height [m], pressure [hPa], temperature [K], relative humidity [%] and dew point [K]."""

    z: np.ndarray
    p: np.ndarray
    t: np.ndarray
    u: np.ndarray
    dew: np.ndarray

    @property
    def geopotential(self):
        """Geopotential heights [m]."""
        return self.z * RADIUS / (RADIUS + self.z)

    @property
    def mixing_ratio(self):
        """Mixing ratios [g/kg]."""
        vapour = 1e-5 * saturation_density(self.t) * 461.5 * self.t * self.u / 100.0
        return 1e3 * 0.62198 * vapour / (self.p - vapour)

    @property
    def water(self):
        """Precipitable water above the lowest level [kg/m2]: the integral of vapour over height, by trapezia of a fine grid."""
        fine = np.linspace(self.z[0], self.z[-1], 200_001)
        t = np.interp(fine, self.z, self.t)
        u = np.interp(fine, self.z, self.u)
        return 1e-3 * np.trapezoid(saturation_density(t) * u / 100.0, fine)


def ascent(model="midlatitude-summer", z=None, surface=1012.0, warmer=0.0, wetter=1.0):
    """Return a hydrostatic ascent with the temperatures and humidities of a model atmosphere."""
    z = np.unique(np.r_[5.0, np.arange(100.0, 3000.0, 150.0), np.arange(3000.0, 24_001.0, 500.0)]) if z is None else np.asarray(z, float)
    _, kelvin, vapour, _ = model_levels(model, z)
    u = np.clip(wetter * 100.0 * vapour / saturation_density(kelvin), 0.5, 100.0)
    kelvin = kelvin + warmer
    fine = np.unique(np.r_[0.0, z, np.linspace(0.0, z[-1], 8001)])
    t, h = np.interp(fine, z, kelvin), np.interp(fine, z, u)
    p = np.full(fine.size, surface)
    for _ in range(4):  # moist air weighs less: the pressures of one pass are the next one's
        warm = virtual_temperature(t, p, h)
        gravity = 9.80665 * (RADIUS / (RADIUS + 0.5 * (fine[1:] + fine[:-1]))) ** 2
        p = surface * np.exp(-np.r_[0.0, np.cumsum(np.diff(fine) * gravity / (DRY_AIR * 0.5 * (warm[1:] + warm[:-1])))])
    return Truth(z, np.interp(z, fine, p), kelvin, u, dew_points(kelvin, u))


def humidity_of_dew_point(kelvin, dew):
    """Relative humidity over water [%] of a dew point [K]: the ratio of vapour pressures, in LOWTRAN7's saturation."""
    return 100.0 * saturation_density(dew) * dew / (saturation_density(kelvin) * kelvin)


def dew_points(kelvin, humidity):
    """Dew points [K], found by bisection in LOWTRAN7's saturation."""
    low, high = np.full(kelvin.size, 120.0), kelvin.copy()
    for _ in range(60):
        middle = 0.5 * (low + high)
        wet = humidity_of_dew_point(kelvin, middle) > humidity
        low, high = np.where(wet, low, middle), np.where(wet, middle, high)
    return high


def save(folder, name, text, encoding="utf-8"):
    path = folder / name
    path.write_bytes(text.encode(encoding))
    return path


def data_frame(folder, a, *, index=False):
    """siphon's data frame as pandas saves it."""
    head = ("," if index else "") + "pressure,height,temperature,dewpoint,direction,speed,u_wind,v_wind,station,time\n"
    rows = [
        f"{f'{i},' if index else ''}{p:.1f},{z:.1f},{t - 273.15:.1f},{d - 273.15:.1f},180.0,5.0,0.0,5.0,OAX,2024-07-01 00:00:00"
        for i, (p, z, t, d) in enumerate(zip(a.p, a.geopotential, a.t, a.dew, strict=True))
    ]
    return save(folder, "siphon.csv", head + "\n".join(rows) + "\n")


def sharppy(folder, a):
    rows = [
        f" {p:8.2f},  {z:8.2f},  {t - 273.15:8.2f},  {d - 273.15:8.2f},  180.00,   10.00"
        for p, z, t, d in zip(a.p, a.geopotential, a.t, a.dew, strict=True)
    ]
    rows.insert(0, " 1020.00,   -60.00,  -9999.00,  -9999.00,  -9999.00,  -9999.00")
    head = "%TITLE%\n OAX   140616/1900 \n\n   LEVEL       HGHT       TEMP       DWPT       WDIR       WSPD\n" + "-" * 67 + "\n%RAW%\n"
    return save(folder, "oax.txt", head + "\n".join(rows) + "\n%END%\n")


def bufkit_block(a, hour, warmer=0.0, heights=True):
    names = ["PRES", "TMPC", "TMWC", "DWPC", "THTE", "DRCT", "SKNT", "OMEG"] + (["HGHT"] if heights else [])
    out = [
        f"STID = OAX STNM = 725530 TIME = 140616/{hour:02d}00 ",
        f"SLAT = 41.32 SLON = -96.37 SELV = {a.z[0]:.1f} ",
        f"STIM = {hour}",
        "",
    ]
    out += ["SHOW = 4.11 LIFT = 3.20 SWET = -9999.00 KINX = 11.44 ", "BRCH = 0.00 ", "", " ".join(names[:8]), " ".join(names[8:])]
    for p, z, t, d in zip(a.p, a.geopotential, a.t, a.dew, strict=True):
        out.append(f"{p:.2f} {t + warmer - 273.15:.2f} {t - 274.15:.2f} {d - 273.15:.2f} 330.00 180.00 10.00 -0.10")
        if heights:
            out.append(f"{z:.2f}")
    return out


def bufkit(folder, a, *, heights=True):
    names = "SNPARM = PRES;TMPC;TMWC;DWPC;THTE;DRCT;SKNT;OMEG" + (";HGHT" if heights else "")
    out = [names, "STNPRM = SHOW;LIFT;SWET;KINX;BRCH", ""]
    for i, hour in enumerate((18, 19, 20)):
        out += [*bufkit_block(a, hour, float(i), heights), ""]
    out += ["STN YYMMDD/HHMM PMSL PRES SKTC STC1", "725530 140616/1800 1012.10 980.20 24.5 -9999.00"]
    return save(folder, "oax.buf", "\r\n".join(out) + "\r\n")


def edt(folder, a, *, tabs=False):
    """Vaisala's EDT list: Latin-1, lines of a header, names of two words, units, strokes for missing values."""
    joint = "\t" if tabs else "   "
    names = ["Elapsed time", "HeightMSL", "Pc", "Temp", "RH", "Dewp", "Speed", "Dir"]
    units = ["s", "m", "hPa", "\xb0C", "%", "\xb0C", "m/s", "\xb0"]
    rows = [
        joint.join((f"{i}", f"{z:.0f}", f"{p:.2f}", f"{t - 273.15:.2f}", f"{u:.1f}", f"{d - 273.15:.2f}", "/////", "/////"))
        for i, (z, p, t, u, d) in enumerate(zip(a.geopotential, a.p, a.t, a.u, a.dew, strict=True))
    ]
    rows.insert(4, joint.join(("3", "/////", "/////", "/////", "/////", "/////", "5.1", "180")))
    head = [
        "Sounding data",
        "Station name: S\xfcd",
        "Balloon release date and time   2024-07-01T11:30:00",
        "",
        joint.join(names),
        joint.join(units),
    ]
    return save(folder, "edt.txt", "\r\n".join(head + rows) + "\r\n", "latin-1")


def iem(folder, a):
    def level(p, z, t, d):
        return {"pres": round(p, 1), "hght": round(z, 1), "tmpc": round(t - 273.15, 1), "dwpc": d, "drct": 180, "sknt": 10}

    dew = [round(float(d) - 273.15, 1) for d in a.dew]
    whole = [level(p, z, t, d) for p, z, t, d in zip(a.p, a.geopotential, a.t, dew, strict=True)]
    whole.insert(0, {"pres": 1020.0, "hght": None, "tmpc": None, "dwpc": None, "drct": None, "sknt": None})
    later = [level(p, z, t + 2.0, d) for p, z, t, d in zip(a.p, a.geopotential, a.t, dew, strict=True)]
    profiles = [
        {"station": "KOAX", "valid": "2024-07-01T00:00:00Z", "profile": whole},
        {"station": "KOAX", "valid": "2024-07-01T12:00:00Z", "profile": later},
    ]
    return save(folder, "iem.json", json.dumps({"profiles": profiles}))


def avaps_eol(folder, a):
    """A drop in EOL's sounding format: from the aircraft down."""
    head = [
        "Data Type/Direction:                       AVAPS SOUNDING DATA, Channel 1/Descending",
        "File Format/Version:                       EOL Sounding Format/1.1",
        "Project Name/Platform:                     TEST, 1/NOAA P3",
        "Launch Location (lon,lat,alt):             -75 30.00'W -75.5, 25 10.00'N 25.1, 24000.00",
        "UTC Launch Time (y,m,d,h,m,s):             2024, 07, 01, 11:30:00",
        "/",
        "  Time   -- UTC  --   Press    Temp   Dewpt    RH     Uwind   Vwind   Wspd     Dir     dZ "
        "   GeoPoAlt     Lon         Lat      GPSAlt ",
        "   sec   hh mm   ss     mb      C       C       %      m/s     m/s     m/s     deg     m/s "
        "      m        deg         deg         m   ",
        "-------- -- -- ----- ------- ------- ------- ------- ------- ------- ------- ------- ------- "
        "-------- ----------- ----------- --------",
    ]
    rows = ["   -1.00 11 29 59.00" + " -999.00" * 9 + " -999.00 -999.000000 -999.000000 -999.00"]
    down = zip(a.p[::-1], a.geopotential[::-1], a.t[::-1], a.u[::-1], a.dew[::-1], strict=True)
    for i, (p, z, t, u, d) in enumerate(down):
        rows.append(
            f"{i:8.2f} 11 30 {i % 60:05.2f} {p:7.2f} {t - 273.15:7.2f} {d - 273.15:7.2f} {u:7.2f} -999.00 -999.00 -999.00 -999.00  -11.00 "
            f"{z:8.2f} {-75.5:11.6f} {25.1:11.6f} {z:8.2f}"
        )
    return save(folder, "D20240701_113000.eol", "\n".join(head + rows) + "\n")


def avaps_record(folder, a):
    """The receiver's record: samples of the aircraft and of the sonde, 9999, 99 and 999 missing."""
    sonde = "AVAPS-D01 S00 132855101 240701"
    rest = "8 999.00 999.00 8 99.00"
    rows = ["AVAPS-T01 COM  Sonde Date Time Press", "AVAPS-D01 A00 132855101 240701 112959.00  150.00  20.00 999.00" + " 999.00" * 6]
    for i, (p, z, t, u) in enumerate(zip(a.p[::-1], a.geopotential[::-1], a.t[::-1], a.u[::-1], strict=True)):
        air = f"{p:8.2f} {t - 273.15:6.2f} {u:6.2f}"
        rows.append(f"{sonde} {113000 + i % 60:06d}.00 {air} 999.00 999.00 -11.00 -75.500000 25.100000 {z:8.2f} {rest} {z:8.2f}")
    nothing = "9999.00  99.00 999.00 999.00 999.00 99.00 999.000000 99.000000 99999.00"
    rows.insert(8, f"{sonde} 113006.50  {nothing} {rest} 99999.00")
    return save(folder, "D20240701_113000.1", "\n".join(rows) + "\n")


def arm(folder, a, engine="scipy"):
    def field(values, **attributes):
        return "time", np.asarray(values, np.float32), attributes

    hole = np.arange(a.z.size) == 7
    data = xr.Dataset(
        {
            "base_time": ((), np.int32(1_719_792_000), {"units": "seconds since 1970-1-1 0:00:00 0:00"}),
            "time_offset": ("time", np.arange(a.z.size, dtype=float), {"units": "seconds since 2024-07-01 00:00:00 0:00"}),
            "pres": field(a.p, long_name="Pressure", units="hPa"),
            "tdry": field(a.t - 273.15, long_name="Dry Bulb Temperature", units="C", missing_value=np.float32(-9999.0)),
            "dp": field(np.where(hole, -9999.0, a.dew - 273.15), long_name="Dewpoint Temperature", units="C"),
            "rh": field(np.where(hole, -9999.0, a.u), long_name="Relative Humidity", units="%"),
            "alt": field(a.z, long_name="Altitude", units="m"),
            "wspd": field(np.full(a.z.size, -9999.0), units="m/s"),
        },
        attrs={"dod_version": "sondewnpn-b1-6.1"},
    )
    path = folder / "sgpsondewnpnC1.b1.20240701.113000.cdf"
    data.to_netcdf(path, engine=engine, format="NETCDF3_CLASSIC" if engine == "scipy" else None)
    return path


def avaps_netcdf(folder, a):
    down = slice(None, None, -1)
    names = {"pres": (a.p, "hPa"), "tdry": (a.t - 273.15, "degC"), "dp": (a.dew - 273.15, "degC"), "rh": (a.u, "%"), "gpsalt": (a.z, "m")}
    data = xr.Dataset(
        {name: ("time", values[down].astype(np.float32), {"units": unit}) for name, (values, unit) in names.items()},
        attrs={"SoundingDescription": "AVAPS SOUNDING DATA, Channel 1/Descending"},
    )
    path = folder / "D20240701_113000QC.nc"
    data.to_netcdf(path, engine="scipy", format="NETCDF3_CLASSIC")
    return path


def decimal_commas(folder, a, separator=";"):
    rows = [separator.join(f"{v:.2f}".replace(".", ",") for v in row) for row in zip(a.z, a.p, a.t - 273.15, a.u, strict=True)]
    names = separator.join(("height_m", "pressure_hpa", "temperature_c", "relative_humidity_percent"))
    return save(folder, "komma.csv", names + "\n" + "\n".join(rows) + "\n")


def american(folder, a):
    """Fahrenheit and feet, named as such."""
    rows = [
        f"{z / 0.3048:.0f},{p:.1f},{1.8 * (t - 273.15) + 32:.1f},{1.8 * (d - 273.15) + 32:.1f}"
        for z, p, t, d in zip(a.z, a.p, a.t, a.dew, strict=True)
    ]
    return save(folder, "us.csv", "Altitude (ft),Pressure (mb),Temperature (F),Dew Point (F)\n" + "\n".join(rows) + "\n")


def depression(folder, a):
    rows = [f"{p:.1f},{z:.0f},{t - 273.15:.1f},{t - d:.1f}" for z, p, t, d in zip(a.z, a.p, a.t, a.dew, strict=True)]
    return save(folder, "dpd.csv", "pressure_hpa,height_m,temperature_c,dew_point_depression_c\n" + "\n".join(rows) + "\n")


LAYOUTS = {
    "data frame": data_frame,
    "data frame with index": lambda f, a: data_frame(f, a, index=True),
    "SHARPpy": sharppy,
    "bufkit": bufkit,
    "bufkit without heights": lambda f, a: bufkit(f, a, heights=False),
    "EDT": edt,
    "EDT with tabs": lambda f, a: edt(f, a, tabs=True),
    "IEM": iem,
    "AVAPS in EOL's format": avaps_eol,
    "AVAPS record": avaps_record,
    "AVAPS NetCDF": avaps_netcdf,
    "ARM NetCDF 3": arm,
    "ARM NetCDF 4": lambda f, a: arm(f, a, "h5netcdf"),
    "decimal commas": decimal_commas,
    "decimal commas and tabs": lambda f, a: decimal_commas(f, a, "\t"),
    "Fahrenheit and feet": american,
    "dew-point depression": depression,
}
"""Writers of files by layout, of a folder and an ascent."""
