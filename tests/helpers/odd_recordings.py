"""Recordings with random combinations of the tags that change the meaning of their numbers; the truth is made, not read.

Each maker writes a file with the format's own library and returns what a right reader finds in it.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

Random = np.random.Generator


@dataclass
class Odd:
    """A file, and its true values (frames, rows, columns), NaN where there is none."""

    path: Path
    values: np.ndarray
    units: str | None = None
    rate: float | None = None
    how: dict[str, Any] = field(default_factory=dict)
    says: str = ""
    tolerance: float = 2e-6


def clutter(rng: Random, dtype: np.dtype[Any] | type, frames: int | None = None) -> np.ndarray:
    """Return skewed frames of an odd size."""
    shape = (int(rng.integers(2, 5)) if frames is None else frames, int(rng.integers(5, 9)), int(rng.integers(10, 14)))
    values = rng.gamma(9.0, 30.0, shape)
    kind = np.dtype(dtype)
    if kind.kind == "f":
        return values.astype(kind)
    top = np.iinfo(kind).max
    return np.clip(values * (0.3 if top < 300 else 1.0), 1, min(top, 60000) - 2).astype(kind)


def chance(rng: Random, probability: float = 0.5) -> bool:
    return bool(rng.random() < probability)


def cf_attributes(rng: Random, stored: np.ndarray) -> tuple[dict[str, Any], np.ndarray, str | None, str]:
    """Return CF attributes at random, the values that they give, units, and what a message says of a contradiction."""
    kind = stored.dtype
    about: dict[str, Any] = {}
    absent = np.zeros(stored.shape, bool)
    values = stored.astype(np.float64)
    for name in ("_FillValue", "missing_value"):
        if chance(rng, 0.4):
            number = kind.type(int(rng.integers(2, 6)) if kind.kind == "u" else -9999 if kind.itemsize > 1 else -99)
            where = rng.random(stored.shape) < 0.1
            stored[where] = number
            values = stored.astype(np.float64)
            about[name] = number
    for name in ("_FillValue", "missing_value"):
        if name in about:
            absent |= stored == about[name]
    scale, zero = 1.0, 0.0
    if chance(rng):
        scale = float(rng.choice([0.01, 0.04, -0.5, 2.0]))
        about["scale_factor"] = scale
    if chance(rng):
        zero = float(rng.choice([-273.15, 100.0, 0.5]))
        about["add_offset"] = zero
    low, high = (kind.type(np.quantile(stored, q)) for q in (0.15, 0.9))
    pick = int(rng.integers(0, 6))
    if pick == 1:
        about["valid_range"] = np.array([low, high])
        absent |= (stored < low) | (stored > high)
    if pick in (2, 4):
        about["valid_min"] = low
        absent |= stored < low
    if pick in (3, 4):
        about["valid_max"] = high
        absent |= stored > high
    values = values * scale + zero
    values[absent] = np.nan
    units = str(rng.choice(["K", "W m-2 sr-1", "counts"])) if chance(rng) else None
    if units is not None:
        about["units"] = units
    says = ""
    if chance(rng, 0.1):
        if "scale_factor" in about and chance(rng):
            about["slope"] = 2.0 * scale
            says = "contradict each other"
        elif "valid_range" in about:
            about["valid_min"] = kind.type(low + 1)
            says = "contradict each other"
    return about, values, units, says


NUMBERS = ("u1", "i2", "u2", "i4", "f4", "f8", ">i2", ">f4")


def hdf5(rng: Random, folder: Path) -> Odd:
    """HDF5: CF attributes, MATLAB's order, images whose white is zero, labels of dimensions, palettes and scales beside."""
    import h5py

    path = folder / "a.h5"
    stored = clutter(rng, rng.choice(NUMBERS))
    about, values, units, says = cf_attributes(rng, stored)
    kind = str(rng.choice(["plain", "matlab", "labels", "white", "origin"]))
    how: dict[str, Any] = {}
    rate = None
    with h5py.File(path, "w") as file:
        array = stored
        if kind == "matlab":
            # MATLAB's (rows, columns, frames), whose axes HDF5 has reversed: (frames, columns, rows).
            array = stored.transpose(0, 2, 1)
            about["MATLAB_class"] = np.bytes_("double")
        order = str(rng.permutation(list("tyx")).tobytes().decode("utf-32-le")) if kind == "labels" else "tyx"
        if kind == "labels":
            array = np.moveaxis(stored, ["tyx".index(c) for c in order], [0, 1, 2])
        if kind == "white" and not ({"scale_factor", "add_offset"} & set(about)) and stored.dtype.kind == "u":
            about |= {"CLASS": np.bytes_("IMAGE"), "IMAGE_WHITE_IS_ZERO": np.uint8(1)}
            values = float(np.iinfo(stored.dtype).max) - values
        if kind == "origin":
            about |= {"DISPLAY_ORIGIN": np.bytes_("LL")}
            values = values[:, ::-1]
        chunks = chance(rng)
        dataset = file.create_dataset("deep/frames", data=array, chunks=tuple(array.shape) if chunks else None)
        dataset.attrs.update(about)
        if kind == "labels":
            for i, letter in enumerate(order):
                dataset.dims[i].label = {"t": "time", "y": "y", "x": "x"}[letter]
        if chance(rng):
            file["palette"] = np.zeros((256, 3), np.uint8)
            file["palette"].attrs["CLASS"] = np.bytes_("PALETTE")
        if chance(rng):
            file["times"] = np.arange(len(stored))
        if chance(rng):
            rate = 50.0
            (file if chance(rng) else dataset).attrs["fps"] = rate
    return Odd(path, values, units, rate, how, says)


def netcdf(rng: Random, folder: Path) -> Odd:
    """NetCDF 3 and 4: CF attributes, wrong signs, dimensions in any order, times in any unit."""
    import xarray as xr

    path = folder / "a.nc"
    classic = chance(rng)
    stored = clutter(rng, rng.choice(["i2", "i4", "f4", "f8"] if classic else ["u1", "i2", "u2", "i4", "f4", "f8"]))
    about, values, units, says = cf_attributes(rng, stored)
    order = ["time", "y", "x"]
    if chance(rng):
        order = [
            str(name) for name in rng.permutation(["time", str(rng.choice(["y", "lat", "row"])), str(rng.choice(["x", "lon", "col"]))])
        ]
    letters = {"time": 0, "y": 1, "lat": 1, "row": 1, "x": 2, "lon": 2, "col": 2}
    array = stored.transpose([letters[name] for name in order])
    variable = xr.Variable(
        order, array, {k: v for k, v in about.items() if k not in ("_FillValue", "missing_value", "scale_factor", "add_offset")}
    )
    packed = {k: about[k] for k in ("_FillValue", "missing_value", "scale_factor", "add_offset") if k in about}
    variable.attrs.update(packed)
    dataset = xr.Dataset({"frames": variable})
    rate = None
    if chance(rng):
        unit, each = [("s", 1.0), ("ms", 1e3), ("seconds since 2024-01-01", 1.0), ("minutes", 1.0 / 60.0)][int(rng.integers(0, 4))]
        dataset = dataset.assign_coords(time=("time", np.arange(len(stored)) * 0.25 * each, {"units": unit}))
        rate = 4.0
    dataset.to_netcdf(
        path,
        engine="scipy" if classic else "h5netcdf",
        encoding={name: {"_FillValue": None} for name in dataset.variables if name not in packed and name != "frames"},
    )
    return Odd(path, values, units, rate, {}, says)


def zarr_store(rng: Random, folder: Path) -> Odd:
    """Zarr of versions 2 and 3, groups and single arrays, with and without names: what attributes call missing is, fill values are not."""
    import zarr

    path = folder / "a.zarr"
    stored = clutter(rng, rng.choice(NUMBERS))
    about, values, units, says = cf_attributes(rng, stored)
    version = int(rng.choice([2, 3]))
    if version == 2 and ("scale_factor" in about or "add_offset" in about):
        fill: Any = None  # there xarray writes the missing value
    else:
        fill = stored.dtype.type(stored.flat[0]) if chance(rng) else stored.dtype.type(0)
        stored[0, :2] = fill
        values[0, :2] = _again(stored[0, :2], about)
    named = chance(rng)
    plain = {k: v.tolist() if hasattr(v, "tolist") else v for k, v in about.items()}
    more: dict[str, Any] = {"zarr_format": version}
    single = chance(rng, 0.3)
    names = ["time", "y", "x"] if named else None
    if version == 3 and named:
        more["dimension_names"] = names
    if single:
        array = zarr.create_array(
            store=str(path), shape=stored.shape, chunks=(1, *stored.shape[1:]), dtype=stored.dtype, fill_value=fill, **more
        )
    else:
        group = zarr.open_group(str(path), mode="w", zarr_format=version)
        more.pop("zarr_format")
        array = group.create_array("deep", shape=stored.shape, chunks=(1, *stored.shape[1:]), dtype=stored.dtype, fill_value=fill, **more)
    array[...] = stored
    if version == 2 and named:
        plain["_ARRAY_DIMENSIONS"] = names
    array.attrs.update(plain)
    return Odd(path, values, units, None, {}, says)


def _again(stored: np.ndarray, about: dict[str, Any]) -> np.ndarray:
    """Return the values of numbers that were written over others."""
    absent = np.zeros(stored.shape, bool)
    for name in ("_FillValue", "missing_value"):
        if name in about:
            absent |= stored == about[name]
    low, high = about.get("valid_range", (None, None))
    low, high = about.get("valid_min", low), about.get("valid_max", high)
    if low is not None:
        absent |= stored < low
    if high is not None:
        absent |= stored > high
    values = stored.astype(np.float64) * about.get("scale_factor", 1.0) + about.get("add_offset", 0.0)
    return np.where(absent, np.nan, values)


def fits(rng: Random, folder: Path) -> Odd:
    """FITS: scales, blanks, offsets of unsigned numbers, exposures of one name, axes of length one, compression."""
    from astropy.io import fits as astropy_fits

    ending = str(rng.choice([".fits", ".fit", ".fits.gz"]))
    path = folder / f"a{ending}"
    kind = str(rng.choice(["i2", "i4", "u1", "u2", "f4", "f8"]))
    stored = clutter(rng, kind)
    values = stored.astype(np.float64)
    header = astropy_fits.Header()
    units = "K" if chance(rng) else None
    if units:
        header["BUNIT"] = units
    rate = None
    if chance(rng):
        rate = 25.0
        header[str(rng.choice(["FRMRATE", "FPS"]))] = rate
    how: dict[str, Any] = {}
    shape = stored.shape
    if chance(rng, 0.3):
        stored = stored.reshape(shape[0], 1, *shape[1:])
    layout = str(rng.choice(["cube", "exposures", "one"]))
    scaled = kind in ("i2", "i4", "u1") and chance(rng)
    blank = None
    if kind in ("i2", "i4") and chance(rng):
        blank = -32768
        stored.flat[rng.integers(0, stored.size, 20)] = blank
        values = stored.reshape(shape).astype(np.float64)
        values[values == blank] = np.nan
    scale, zero = 1.0, 0.0
    if scaled:
        scale, zero = 0.04, -273.15
        values = values * scale + zero
    false_blank = kind in ("f4", "f8") and chance(rng)
    images = []
    count = shape[0] if layout == "exposures" else 1
    for i in range(count):
        data = stored[i].reshape(shape[1:]) if layout == "exposures" else stored
        hdu = astropy_fits.ImageHDU(data, header=header, name="SCI" if layout != "one" else None)
        if layout == "exposures" and chance(rng, 0.8):
            hdu.ver = i + 1
        images.append(hdu)
    file = astropy_fits.HDUList(
        [astropy_fits.PrimaryHDU(), *images] if layout != "one" else [astropy_fits.PrimaryHDU(stored, header=header)]
    )
    if layout == "exposures" and chance(rng):
        file.append(astropy_fits.ImageHDU(np.zeros((3, 4), np.int16), name="DQ"))
    file.writeto(path)
    if scaled or blank is not None or false_blank:
        with (
            astropy_fits.open(path, mode="update", do_not_scale_image_data=True) if not ending.endswith(".gz") else _unpacked(path) as again
        ):
            for hdu in again:
                if hdu.header.get("NAXIS", 0) >= 2 and hdu.name != "DQ":
                    if scaled:
                        hdu.header["BSCALE"], hdu.header["BZERO"] = scale, zero
                    if blank is not None:
                        hdu.header["BLANK"] = blank
                    if false_blank:
                        hdu.header["BLANK"] = 0
            if ending.endswith(".gz"):
                again.writeto(path, overwrite=True, output_verify="silentfix")
    if layout == "exposures":
        pick = str(rng.choice(["all", "first", "last"]))
        if pick == "all":
            how["variable"] = "SCI,*"
        elif pick == "last":
            how["variable"] = f"SCI,{count}"
            values = values[-1:]
        else:
            values = values[:1]
    return Odd(path, values, units, rate, how)


def _unpacked(path: Path) -> Any:
    from astropy.io import fits as astropy_fits

    return astropy_fits.open(path, do_not_scale_image_data=True, memmap=False)


def tiff(rng: Random, folder: Path) -> Odd:
    """TIFF: GDAL's tags, rates, reduced pages and masks, white that is zero, packed bits, compression, turned pictures, ImageJ and OME."""
    import tifffile

    path = folder / "a.tif"
    form = str(rng.choice(["pages", "gdal", "white", "packed", "turned", "imagej", "ome", "bands"]))
    stored = clutter(rng, rng.choice(["u1", "u2"] if form in ("white", "imagej") else ["u1", "u2", "f4"]))
    values = stored.astype(np.float64)
    compression = rng.choice(np.array([None, "lzw", "zlib", "packbits"], dtype=object)) if form not in ("imagej", "packed") else None
    predictor = bool(compression in ("lzw", "zlib") and chance(rng))
    more: dict[str, Any] = {"photometric": "minisblack", "compression": compression, "predictor": predictor or None}
    extra: list[tuple[Any, ...]] = []
    units, rate, how, says = None, None, {}, ""
    if chance(rng, 0.3) and form in ("pages", "gdal", "white"):
        rate = 30.0
        extra.append((51044, 10, 1, (30, 1), False))
    if form == "gdal":
        if chance(rng):
            number = int(stored.flat[7])
            extra.append((42113, "s", 0, str(number), False))
            values[stored == number] = np.nan
        if chance(rng):
            units = "degC" if chance(rng) else None
            unit = f'<Item name="UNITTYPE" sample="0" role="unittype">{units}</Item>' if units else ""
            text = (
                f'<GDALMetadata><Item name="OFFSET" sample="0" role="offset">-273.15</Item>'
                f'<Item name="SCALE" sample="0" role="scale">0.04</Item>{unit}</GDALMetadata>'
            )
            extra.append((42112, "s", 0, text, False))
            values = values * 0.04 - 273.15
    if form == "white":
        more["photometric"] = "miniswhite"
        values = np.iinfo(stored.dtype).max - values
    if form == "packed":
        bits = int(rng.choice([2, 4, 12]))
        stored = (stored.astype(np.int64) % 2**bits).astype(np.uint8 if bits < 8 else np.uint16)
        values = stored.astype(np.float64)
        with path.open("wb") as file:
            file.write(packed_tiff(stored, bits))
        return Odd(path, values)
    if form == "turned":
        turn = int(rng.integers(2, 9))
        extra.append((274, 3, 1, turn, True))
        rows_first = {2: values[:, :, ::-1], 3: values[:, ::-1, ::-1], 4: values[:, ::-1], 5: values.transpose(0, 2, 1)}
        rows_first[6] = values.transpose(0, 2, 1)[:, :, ::-1]
        rows_first[7] = values[:, ::-1, ::-1].transpose(0, 2, 1)
        rows_first[8] = values.transpose(0, 2, 1)[:, ::-1]
        values = rows_first[turn]
    if form in ("imagej", "ome"):
        channels = int(rng.choice([1, 2]))
        other = stored[:, ::-1]
        stack = np.stack([stored, other][:channels], axis=1)
        chosen = int(rng.integers(0, channels))
        values = stack[:, chosen].astype(np.float64)
        how = {"channel": str(chosen + 1)} if channels > 1 else {}
        rate = 25.0
        if form == "imagej":
            if chance(rng):
                step = {"finterval": 40.0, "tunit": "ms"} if chance(rng) else {"finterval": 0.04, "tunit": "sec"}
                about = {"axes": "TCYX", "fps": 7.0, **step}
                tifffile.imwrite(path, stack, imagej=True, metadata=about)
            else:
                line = {"Info": "", "finterval": 0.04, "axes": "TCYX", "cf": 0, "c0": 5.0, "c1": 0.5, "vunit": "K"}
                tifffile.imwrite(path, stack, imagej=True, metadata=line)
                values, units = values * 0.5 + 5.0, "K"
        else:
            unit, step = ("ms", 40.0) if chance(rng) else ("s", 0.04)
            tifffile.imwrite(
                path, stack, ome=True, compression=compression, metadata={"axes": "TCYX", "TimeIncrement": step, "TimeIncrementUnit": unit}
            )
        if channels > 1 and chance(rng, 0.2):
            how, says = {}, "has 2 channels"
        return Odd(path, values, units, rate, how, says)
    if form == "bands":
        both = np.stack([stored[0], stored[1]], axis=0 if chance(rng) else -1)
        planar = "separate" if both.shape[0] == 2 else "contig"
        tifffile.imwrite(path, both, photometric="minisblack", planarconfig=planar, compression=compression)
        if chance(rng):
            return Odd(path, values[1:2], how={"channel": "2"})
        return Odd(path, values[:1], says="has 2 channels")
    with tifffile.TiffWriter(path) as file:
        if chance(rng):
            file.write((stored[0, ::2, ::2]).copy(), contiguous=False, subfiletype=1, **more)
        for frame in stored:
            file.write(frame, contiguous=False, extratags=extra, metadata=None, **more)
        if chance(rng):
            file.write((stored[0, ::2, ::2]).copy(), contiguous=False, subfiletype=1, **more)
        if chance(rng):
            file.write(np.ones(stored.shape[1:], bool), contiguous=False, subfiletype=4, photometric="mask")
    return Odd(path, values, units, rate, how, says)


def packed_tiff(stored: np.ndarray, bits: int) -> bytes:
    """Return a TIFF whose numbers of a few bits follow each other without gaps; rows begin at bytes (TIFF 6.0, p. 29)."""
    frames, rows, columns = stored.shape
    out = bytearray(b"II*\0" + struct.pack("<I", 8))
    for i, frame in enumerate(stored):
        lines = ((frame[..., None] >> np.arange(bits - 1, -1, -1)) & 1).reshape(rows, -1).astype(np.uint8)
        strip = np.packbits(lines, axis=1).tobytes()
        entries = [
            (256, 4, columns),
            (257, 4, rows),
            (258, 3, bits),
            (259, 3, 1),
            (262, 3, 1),
            (273, 4, 0),
            (277, 3, 1),
            (278, 4, rows),
            (279, 4, len(strip)),
        ]
        size = 2 + 12 * len(entries) + 4
        at = len(out)
        entries[5] = (273, 4, at + size)
        out += struct.pack("<H", len(entries))
        for code, kind, value in entries:
            out += struct.pack("<HHII", code, kind, 1, value)
        after = at + size + len(strip)
        after += after % 2
        out += struct.pack("<I", after if i + 1 < frames else 0) + strip
        out += b"\0" * (after - len(out))
    return bytes(out)


def png_chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def picture(rng: Random, folder: Path) -> Odd:
    """PNG of 1 to 16 bits with chunks, animations, PGM of any largest number, BMP, and folders of them."""
    from PIL import Image

    form = str(rng.choice(["png", "apng", "gif", "pgm", "bmp", "folder", "plain-pgm"]))
    if form == "png":
        depth = int(rng.choice([1, 2, 4, 8, 16]))
        stored = (clutter(rng, "u2", 1).astype(np.int64) % 2**depth).astype(np.uint16)
        values = stored.astype(np.float64)
        chunks, units = b"", None
        if chance(rng):
            number = int(stored.flat[3])
            chunks += png_chunk(b"tRNS", struct.pack(">H", number))
            values[stored == number] = np.nan
        if chance(rng):
            units = "K"
            full = 2**depth - 1
            chunks = (
                png_chunk(b"pCAL", b"temperature\0" + struct.pack(">iiBB", 0, full, 0, 2) + f"{units}\0".encode() + b"200.5\0" + b"80")
                + chunks
            )
            values = 200.5 + 80.0 * values / full
        path = folder / "a.png"
        rows, columns = stored.shape[1:]
        bits = ((stored[0][..., None] >> np.arange(depth - 1, -1, -1)) & 1).reshape(rows, -1).astype(np.uint8)
        lines = b"".join(b"\0" + line.tobytes() for line in np.packbits(bits, axis=1))
        head = png_chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, depth, 0, 0, 0, 0))
        path.write_bytes(b"\x89PNG\r\n\x1a\n" + head + chunks + png_chunk(b"IDAT", zlib.compress(lines)) + png_chunk(b"IEND", b""))
        return Odd(path, values, units)
    stored = clutter(rng, "u1")
    pictures = [Image.fromarray(frame) for frame in stored]
    if form in ("apng", "gif"):
        path = folder / ("a.png" if form == "apng" else "a.gif")
        # A still first picture would be merged with its copy by the writers.
        pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=40, loop=0)
        return Odd(path, stored.astype(np.float64), None, 25.0)
    if form in ("pgm", "plain-pgm"):
        maximum = int(rng.choice([200, 255, 1023, 4095, 65535]))
        frame = (clutter(rng, "u2", 1).astype(np.int64) % (maximum + 1)).astype(">u2" if maximum > 255 else "u1")
        path = folder / "a.pgm"
        _, rows, columns = frame.shape
        if form == "pgm":
            path.write_bytes(f"P5\n# a comment\n{columns} {rows}\n{maximum}\n".encode() + frame.tobytes())
        else:
            path.write_text(f"P2\n{columns} {rows}\n{maximum}\n" + "\n".join(" ".join(map(str, line)) for line in frame[0].tolist()) + "\n")
        return Odd(path, frame.astype(np.float64))
    if form == "bmp":
        pictures[0].save(folder / "a.bmp")
        return Odd(folder / "a.bmp", stored[:1].astype(np.float64))
    ending = str(rng.choice(["png", "bmp", "pgm", "gif", "tif"]))
    for i, one in enumerate(pictures):
        one.save(folder / f"frame{8 + i}.{ending}")
    return Odd(folder, stored.astype(np.float64))


def array(rng: Random, folder: Path) -> Odd:
    """NumPy and MATLAB 5: axes of length one, channels, orders stated and not."""
    stored = clutter(rng, rng.choice(NUMBERS))
    values = stored.astype(np.float64)
    form = str(rng.choice(["npy", "npz", "matlab", "channels", "ordered", "missing"]))
    path = folder / "a.npy"
    if form == "npy":
        options = [stored, stored[:, None], stored[None], stored[..., None], stored[None, :, None]]
        np.save(path, options[int(rng.integers(0, len(options)))])
        return Odd(path, values)
    if form == "npz":
        np.savez(folder / "a.npz", frames=stored, times=np.arange(len(stored)), fps=12.5)
        return Odd(folder / "a.npz", values, None, 12.5)
    if form == "matlab":
        from scipy.io import savemat

        savemat(folder / "a.mat", {"clip": stored.transpose(1, 2, 0), "fps": 20.0, "name": "a camera"}, do_compression=chance(rng))
        return Odd(folder / "a.mat", values, None, 20.0)
    if form == "channels":
        other = stored[:, ::-1]
        last = chance(rng)
        np.save(path, np.stack([stored, other], axis=-1 if last else 1))
        axes = {"axes": "tyxc" if last else "tcyx"} if chance(rng) else {}
        if chance(rng, 0.2):
            return Odd(path, values, how=axes, says="has 2 channels")
        return Odd(path, values, how={**axes, "channel": "1"})
    if form == "ordered":
        order = "".join(rng.permutation(list("tyx")).tolist())
        np.save(path, np.moveaxis(stored, ["tyx".index(c) for c in order], [0, 1, 2]))
        return Odd(path, values, how={"axes": order})
    number = float(stored.flat[5])
    np.save(path, stored)
    values[stored == stored.flat[5]] = np.nan
    return Odd(path, values, how={"missing": (number,)})


MAKERS: dict[str, Callable[[Random, Path], Odd]] = {
    "hdf5": hdf5, "netcdf": netcdf, "zarr": zarr_store, "fits": fits, "tiff": tiff, "picture": picture, "array": array,
}  # fmt: skip
