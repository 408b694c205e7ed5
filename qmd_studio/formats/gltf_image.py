"""The pictures of a glTF file, as colours where the corners of its meshes are."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import FloatArray
from qmd_studio.formats.gltf_document import Document, Record, item, record, uri_bytes, view_bytes

MAX_PIXELS = 1 << 26


def base_colours(document: Document, material: Record, uv: FloatArray | None) -> FloatArray:
    """Return a material's base colour as linear light: (3,), or (n, 3) where a picture is read at `uv` (n, 2)."""
    surface = record(material, "pbrMetallicRoughness")
    factor = np.ones(3)
    given = surface.get("baseColorFactor")
    if isinstance(given, list) and len(given) >= 3 and all(isinstance(x, int | float) for x in given[:3]):
        factor = np.clip(np.array(given[:3], dtype=np.float64), 0.0, 1.0)
    picture = _picture(document, surface) if uv is not None and "baseColorTexture" in surface else None
    if picture is None or uv is None:
        return factor
    document.note("the picture on the skin is shown as one colour a vertex")
    height, width = picture.shape[:2]
    column = np.clip(((uv[:, 0] % 1.0) * width).astype(np.int64), 0, width - 1)
    row = np.clip(((uv[:, 1] % 1.0) * height).astype(np.int64), 0, height - 1)
    return np.asarray(linear(picture[row, column] / 255.0) * factor)


def linear(colour: FloatArray) -> FloatArray:
    """Return linear light of sRGB values 0 to 1 (IEC 61966-2-1)."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)


def _picture(document: Document, surface: Record) -> NDArray[np.uint8] | None:
    """Return the base colour's picture (height, width, 3), or None, with a warning, where it cannot be read."""
    texture = item(document, "textures", record(surface, "baseColorTexture").get("index"))
    if "source" not in texture:
        document.note("a picture of an unknown kind is not shown")
        return None
    number = texture["source"]
    image = item(document, "images", number)
    at = f"image {number}"
    if "bufferView" in image:
        data = view_bytes(document, image["bufferView"], at)
    else:
        data = uri_bytes(document, image.get("uri"), at)
    picture = _decoded(data)
    if picture is None:
        document.warnings.append(f"{at}: the picture cannot be read; the skin is shown without it")
    return picture


def _decoded(data: bytes) -> NDArray[np.uint8] | None:
    """Return the pixels (height, width, 3) of a PNG or JPEG, None for anything else or too large a picture."""
    import av

    kind = {b"\x89PNG": "png_pipe", b"\xff\xd8\xff": "jpeg_pipe"}.get(data[:4], "") or (
        "jpeg_pipe" if data[:3] == b"\xff\xd8\xff" else ""
    )
    if not kind:
        return None
    try:
        with av.open(io.BytesIO(data), mode="r", format=kind) as container:
            stream = container.streams.video[0]
            if not 0 < stream.width * stream.height <= MAX_PIXELS:
                return None
            frame = next(container.decode(stream))
            if frame.width * frame.height > MAX_PIXELS:
                return None
            return np.asarray(frame.to_ndarray(format="rgb24"), dtype=np.uint8)
    except (av.FFmpegError, StopIteration, IndexError, ValueError):
        return None
