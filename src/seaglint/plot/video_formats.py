"""Formats of videos: their endings, codecs, and the frame rates that they hold. Help pages list them: nothing heavy is imported here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final


@dataclass(frozen=True)
class VideoFormat:
    """Format of a video: ending, codec, pixels and frame rates."""

    ending: str  #: Ending of the files; without the dot it is the format's name in PyAV.
    codec: str  #: Codec of PyAV.
    pixels: str  #: Type of pixels of PyAV.
    rates: tuple[float, float]  #: Least and greatest number of frames per second [Hz].
    options: Mapping[str, str] = field(default_factory=dict)  #: Options of the codec.


#: All formats of videos, from which help texts, lists in errors and the choice of a codec are derived.
VIDEOS: Final = (
    VideoFormat(".mp4", "libx264", "yuv420p", (0.01, 1000.0), {"crf": "18", "preset": "veryfast"}),
    # players show GIFs of shorter delays than 20 ms at a tenth of their speed
    VideoFormat(".gif", "gif", "pal8", (0.01, 50.0)),
)

VIDEO_ENDINGS: Final = tuple(form.ending for form in VIDEOS)


def video_format(ending: str) -> VideoFormat:
    """Return the format of an ending, which one of the formats has.

    >>> video_format(".gif").codec
    'gif'
    """
    return next(form for form in VIDEOS if form.ending == ending)
