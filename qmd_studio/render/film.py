"""Films and animated pictures from single ones: MP4 and GIF, whole in memory."""

from __future__ import annotations

import io
from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qmd_studio.errors import FormatError

Picture = NDArray[np.uint8]
MAX_GIF_FPS = 50.0
"""A GIF tells its frames' times in hundredths of a second, and viewers show nothing quicker than two of them."""


def mp4(pictures: Iterable[Picture], size: tuple[int, int], fps: float) -> tuple[bytes, str]:
    """Return an MP4 file of (height, width, 3) pictures, all of `size` (width, height), and its codec's name.

    H.264 where PyAV has an encoder of it, else MPEG-4 part 2. Raises `FormatError` for an odd width or height.
    """
    if size[0] % 2 or size[1] % 2:
        raise FormatError("an MP4's sides are even", wanted="even numbers", got=f"{size[0]} × {size[1]}")
    codec, options = _codec()
    file = io.BytesIO()
    import av

    with av.open(file, "w", format="mp4") as container:
        stream: Any = container.add_stream(codec, rate=_rate(fps), options=options)
        stream.width, stream.height, stream.pix_fmt = size[0], size[1], "yuv420p"
        if codec == "mpeg4":
            stream.bit_rate = int(0.25 * size[0] * size[1] * fps)
        for picture in pictures:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")))
        container.mux(stream.encode(None))
    return file.getvalue(), codec


def gif(pictures: Iterable[Picture], size: tuple[int, int], fps: float) -> bytes:
    """Return an endless GIF of (height, width, 3) pictures, all of `size`, in colours chosen for all of them together.

    Raises `FormatError` above `MAX_GIF_FPS`.
    """
    if fps > MAX_GIF_FPS:
        raise FormatError("a GIF cannot be so quick", wanted=f"at most {MAX_GIF_FPS:g} frames a second", got=f"{fps:g}")
    file = io.BytesIO()
    import av

    with av.open(file, "w", format="gif", options={"loop": "0"}) as container:
        stream: Any = container.add_stream("gif", rate=_rate(fps))
        stream.width, stream.height, stream.pix_fmt = size[0], size[1], "pal8"
        for frame in _in_few_colours(pictures, size, fps):
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return file.getvalue()


def _in_few_colours(pictures: Iterable[Picture], size: tuple[int, int], fps: float) -> Iterable[Any]:
    """Yield the pictures in the 256 colours that suit all of them, as frames with times."""
    import av
    import av.filter

    rate = _rate(fps)
    graph = av.filter.Graph()
    source = graph.add_buffer(width=size[0], height=size[1], format=av.VideoFormat("rgb24"), time_base=1 / rate)
    split, palette = graph.add("split"), graph.add("palettegen", "stats_mode=full")
    use, sink = graph.add("paletteuse", "dither=sierra2_4a"), graph.add("buffersink")
    source.link_to(split)
    split.link_to(palette, 0, 0)
    split.link_to(use, 1, 0)
    palette.link_to(use, 0, 1)
    use.link_to(sink)
    graph.configure()
    for number, picture in enumerate(pictures):
        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
        frame.pts, frame.time_base = number, 1 / rate
        source.push(frame)
    source.push(None)
    while True:
        try:
            yield sink.pull()
        except (av.error.BlockingIOError, av.error.EOFError):
            return


def _codec() -> tuple[str, dict[str, str]]:
    import av

    for name, options in (("libx264", {"crf": "18", "preset": "medium"}), ("libopenh264", {}), ("h264", {})):
        try:
            av.codec.Codec(name, "w")
        except (av.error.FFmpegError, ValueError):
            continue
        return name, options
    return "mpeg4", {}


def _rate(fps: float) -> Fraction:
    return Fraction(fps).limit_denominator(1001)
