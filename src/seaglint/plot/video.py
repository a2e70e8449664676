"""Videos of a sequence, MP4 or GIF, on one scale for all frames, with time and scale below (PyAV).

Each ending has a codec and the frame rates that it can store.
"""

from __future__ import annotations

from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale, eight_bit
from seaglint.base.conventions import Progress
from seaglint.base.optional import missing
from seaglint.base.schema import VARIABLES
from seaglint.formats.recording.labelled_arrays import stored_frame_rate
from seaglint.plot.scale import Kind, scale_of
from seaglint.plot.video_formats import video_format
from seaglint.store.outputs import moved_when_whole
from seaglint.store.provenance import stored_band
from seaglint.store.stored_images import Images, below_horizon, images, pictures, to_temperature

if TYPE_CHECKING:
    import xarray as xr


_SHOWN_WIDTH: Final = 1024  # small images are enlarged to about this, by whole factors, so that pixels stay pixels
_MAX_SIDE: Final = 4096  # px, the limit of H.264 decoders; wider panoramas are averaged
_SAMPLED_FRAMES: Final = 16  # number of frames that determine the scale
_CAPTION: Final = 56  # px; two lines of text
_LEAST_WIDTH: Final = 480  # px that the caption needs; narrower pictures are padded with black
_USUAL_RATE: Final = 25.0  # Hz, if the run has no frame rate
_REMEDY: Final = "make room or choose another place; nothing was written"

#: Colours of brightness: grey, dark to bright or the other way, or an even rise of lightness and hue (Matplotlib's inferno).
Colours = Literal["white-hot", "black-hot", "perceptual"]


def video_available() -> bool:
    """Return True where PyAV is installed."""
    return find_spec("av") is not None


def palette(colours: Colours) -> NDArray[np.uint8]:
    """Return red, green and blue of the 256 levels, shape (256, 3), the darkest value first."""
    if colours == "perceptual":
        from matplotlib import colormaps

        return np.asarray(colormaps["inferno"](np.arange(256), bytes=True)[:, :3], dtype=np.uint8)
    levels = np.arange(256, dtype=np.uint8) if colours == "white-hot" else np.arange(255, -1, -1, dtype=np.uint8)
    return np.repeat(levels[:, np.newaxis], 3, axis=1)


def shown_rate(dataset: xr.Dataset, variable: str, ending: str) -> float:
    """Return the frame rate of a video [Hz]: the rate of the run, within the limits of the format."""
    low, high = video_format(ending).rates
    return min(max(stored_frame_rate(dataset, dataset[variable]) or _USUAL_RATE, low), high)


def grey(image: NDArray[np.floating], low: float, high: float) -> NDArray[np.uint8]:
    """Return an eight-bit picture with even sides; NaN is black."""
    scaled = np.nan_to_num(np.clip((image - low) / (high - low), 0.0, 1.0), nan=0.0)
    shrink = -(-max(image.shape) // _MAX_SIDE)
    if shrink > 1:
        # A side with fewer pixels than the factor is averaged to one pixel.
        down, across = (min(shrink, size) for size in image.shape)
        rows, columns = image.shape[0] // down, image.shape[1] // across
        scaled = scaled[: rows * down, : columns * across].reshape(rows, down, columns, across).mean(axis=(1, 3))
    grow = max(1, _SHOWN_WIDTH // max(scaled.shape))
    enlarged = np.repeat(np.repeat(scaled, grow, axis=0), grow, axis=1)
    # H.264 with halved colour resolution takes even sides only.
    return eight_bit(np.pad(enlarged, [(0, size % 2) for size in enlarged.shape], mode="edge"))


def captioned(picture: NDArray[np.uint8], scale: Scale, ends: str, time: float | None) -> NDArray[np.uint8]:
    """Return a picture with a strip below it: the time, a bar from the darkest to the brightest grey, and the values at its ends."""
    from matplotlib import get_data_path
    from PIL import Image, ImageDraw, ImageFont

    width = max(picture.shape[1], _LEAST_WIDTH)
    strip = Image.new("L", (width, _CAPTION), 0)
    pen = ImageDraw.Draw(strip)
    # Matplotlib brings a font with raised figures; Pillow's own has none.
    font = ImageFont.truetype(str(Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"), 14)
    pen.text((8, 6), "" if time is None else f"t = {time:.2f} s", fill=255, font=font)
    left, right = 120, width - 8
    ramp = np.rint(255.0 * np.linspace(0.0, 1.0, right - left)).astype(np.uint8)
    strip.paste(Image.fromarray(np.repeat(ramp[np.newaxis], 16, axis=0)), (left, 7))
    pen.rectangle((left - 1, 6, right, 23), outline=128)
    pen.text((8, 32), ends + (", logarithmic" if scale.logarithmic else ""), fill=255, font=font)
    return np.concatenate([np.pad(picture, [(0, 0), (0, width - picture.shape[1])]), np.asarray(strip, dtype=np.uint8)])


def write_video(
    dataset: xr.Dataset,
    output: str | Path,
    scale: Kind = "auto",
    *,
    variable: str | None = None,
    colours: Colours = "white-hot",
    limits: tuple[float, float] | None = None,
    rate: float | None = None,
    remedy: str = _REMEDY,
    progress: Progress | None = None,
) -> Path:
    """Write an MP4 or a GIF, by the ending.

    Parameters
    ----------
    dataset : xarray.Dataset
        A sequence or map.
    output : path
        File to write.
    scale : {"auto", "linear", "log"}
        As in ``seaglint.plot.scale.scale_of``, one for all frames.
    variable : str, optional
        Displayed variable; radiance by default, computed from counts where only counts are stored.
    colours : {"white-hot", "black-hot", "perceptual"}
        Colours of brightness.
    limits : (float, float), optional
        Ends of a linear scale, used instead of ``scale`` [units of the variable].
    rate : float, optional
        Frames per second [Hz]; ``shown_rate`` by default.
    remedy : str
        End of the error's text where the disk is full: what to do.
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    BackendError
        PyAV is not installed.
    StorageError
        No room or no rights; nothing is left behind.
    """
    if not video_available():
        raise missing("a video", "av")
    import av

    output = Path(output)
    ending = output.suffix.lower()
    form = video_format(ending)
    frames, stored = images(dataset, variable), pictures(dataset) if variable is None else dataset[variable]
    count = len(frames)
    shown_scale = Scale(*limits) if limits is not None else _scale(dataset, frames, scale, sky=variable is None)
    ends = _ends(dataset, variable or "radiance", shown_scale)
    times = dataset["time"].to_numpy().astype(np.float64)[frames.indices] if "time" in stored.dims else None
    # Containers store the rate as a ratio of whole numbers; denominators up to 1000 keep rates as 29.97 Hz.
    hertz = Fraction(rate or shown_rate(dataset, str(stored.name), ending)).limit_denominator(1000)
    levels = palette(colours)
    if progress is not None:
        progress(0, count)
    with moved_when_whole(output, remedy) as partial, av.open(str(partial), mode="w", format=ending[1:]) as container:
        stream: Any = container.add_stream(form.codec, rate=hertz, options=dict(form.options))
        stream.pix_fmt = form.pixels
        for index in range(count):
            shown = grey(shown_scale.share(frames[index]), 0.0, 1.0)
            picture = captioned(shown, shown_scale, ends, None if times is None else float(times[index]))
            # The caption may widen a picture: the size is known with the first one.
            if index == 0:
                stream.height, stream.width = picture.shape
            for packet in stream.encode(_coloured(picture, levels, form.pixels)):
                container.mux(packet)
            if progress is not None:
                progress(index + 1, count)
        # Encoders hold frames back; None makes them write the rest.
        for packet in stream.encode(None):
            container.mux(packet)
    return output


def _scale(dataset: xr.Dataset, frames: Images, kind: Kind, *, sky: bool) -> Scale:
    """Return the scale from some of the frames; ``sky`` marks radiances, where the sky may exceed the scale."""
    count = len(frames)
    # Some frames, evenly spaced: all would have to be read twice.
    places = np.unique(np.linspace(0, count - 1, min(count, _SAMPLED_FRAMES)).astype(int))
    sampled = np.stack([frames[i] for i in places])
    below = [below_horizon(dataset, int(frames.indices[i])) if sky else None for i in places]
    known = [depression for depression in below if depression is not None]
    # Where the horizon of one frame is not known, the sky counts in all.
    return scale_of(sampled, kind, np.stack(known) if len(known) == len(below) else None)


def _ends(dataset: xr.Dataset, variable: str, scale: Scale) -> str:
    """Return the ends of the scale as text, for radiance also as apparent temperatures."""
    known = VARIABLES.get(variable)
    unit = str((known.symbol or known.units) if known else dataset[variable].attrs.get("units", "")).strip()
    text = f"{scale.low:.4g} … {scale.high:.4g} {unit}".rstrip()
    if variable != "radiance" or "band_response" not in dataset.attrs:
        return text
    kelvin = to_temperature(np.maximum([scale.low, scale.high], 0.0), stored_band(dataset.attrs))
    return f"{text} ({kelvin[0]:.1f} … {kelvin[1]:.1f} K)"


def _coloured(picture: NDArray[np.uint8], levels: NDArray[np.uint8], pixels: str) -> Any:
    """Return a frame of a video from levels."""
    import av

    if pixels != "pal8":
        return av.VideoFrame.from_ndarray(levels[picture], format="rgb24")
    # Opacity, red, green, blue.
    table = np.concatenate([np.full((256, 1), 255, np.uint8), levels], axis=1)
    indexed: Any = (picture, table)
    return av.VideoFrame.from_ndarray(indexed, format="pal8")
