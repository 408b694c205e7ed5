"""A glTF 2.0 file (Khronos; ISO/IEC 12113) as JSON and numbers: the container, buffers and accessors, all checked.

Nothing is believed: every index, count and offset is held against what is there before memory is taken for it, and
all numbers together against a budget, for one accessor may be named a thousand times. Nothing is ever fetched from a
network; buffers are in the file or beside it.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from qmd_studio.arrays import FloatArray
from qmd_studio.errors import FormatError, StorageError
from qmd_studio.storage import read_bytes

Record: TypeAlias = dict[str, Any]

MAX_JSON_BYTES = 32 << 20
MAX_NUMBERS = 40_000_000
"""All numbers that a file's accessors may give, together."""
MAX_BARE_COUNT = 1_000_001
"""The most elements of an accessor without a buffer, which are zeros but for sparse ones."""

_MAGIC, _JSON_CHUNK, _BIN_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_UNREADABLE = {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"}


@dataclass(slots=True)
class Document:
    """The JSON of a file, its binary chunk, the folder where buffers may lie, and what has been read so far."""

    root: Record
    chunk: bytes | None
    folder: Path | None
    numbers: int = 0
    buffers: dict[int, bytes] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def spend(self, numbers: int, at: str) -> None:
        """Take `numbers` off the budget; raises `FormatError` where it is used up."""
        self.numbers += numbers
        if self.numbers > MAX_NUMBERS:
            raise FormatError("the file holds too many numbers", at=at, wanted=f"at most {MAX_NUMBERS}")

    def note(self, text: str) -> None:
        """Keep a note for the user, once."""
        if text not in self.notes:
            self.notes.append(text)


def open_document(data: bytes, path: Path | None) -> Document:
    """Return the document in a .glb or .gltf file; raises `FormatError` for one that is neither or needs more."""
    chunk = None
    if data[:4] == b"glTF":
        data, chunk = _chunks(data)
    if len(data) > MAX_JSON_BYTES:
        raise FormatError("the JSON is too large", wanted=f"at most {MAX_JSON_BYTES} bytes", got=str(len(data)))
    try:
        root = json.loads(data.decode("utf-8-sig"), parse_constant=_no_constant)
    except RecursionError as problem:
        raise FormatError("the JSON is nested too deeply") from problem
    except ValueError as problem:
        raise FormatError("this is no glTF: its JSON cannot be read", got=str(problem)[:120]) from problem
    if not isinstance(root, dict):
        raise FormatError("this is no glTF", wanted="a JSON object", got=type(root).__name__)
    version = record(root, "asset").get("version")
    if not isinstance(version, str) or not version.startswith("2."):
        raise FormatError("this is no glTF 2", at="asset.version", wanted="2.0", got=str(version)[:20])
    needed = _UNREADABLE.intersection(str(name) for name in listed(root, "extensionsRequired"))
    if needed:
        raise FormatError("the meshes are compressed", got=", ".join(sorted(needed)), hint="Export without it")
    return Document(root, chunk, path.parent if path else None)


def record(parent: Record, key: str) -> Record:
    """Return the object at `key`, an empty one where there is none; raises `FormatError` for anything else."""
    value = parent.get(key, {})
    if not isinstance(value, dict):
        raise FormatError("this is no object", at=key, got=type(value).__name__)
    return value


def listed(parent: Record, key: str) -> list[Any]:
    """Return the list at `key`, an empty one where there is none; raises `FormatError` for anything else."""
    value = parent.get(key, [])
    if not isinstance(value, list):
        raise FormatError("this is no list", at=key, got=type(value).__name__)
    return value


def item(document: Document, kind: str, index: Any) -> Record:
    """Return object `index` of the top list `kind`; raises `FormatError` where there is none."""
    items = listed(document.root, kind)
    found = items[whole(index, f"{kind} {str(index)[:20]}", below=len(items))]
    if not isinstance(found, dict):
        raise FormatError("this is no object", at=f"{kind} {index}", got=type(found).__name__)
    return found


def whole(value: Any, at: str, *, below: int) -> int:
    """Return `value`, an integer from 0 to below `below`; raises `FormatError` for anything else."""
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < below:
        wanted = f"a whole number from 0 to {below - 1}" if below else "none: the list is empty"
        raise FormatError("a number is out of range", at=at, wanted=wanted, got=str(value)[:40])
    return value


def numbers(value: Any, n: int, at: str) -> FloatArray:
    """Return a JSON list of `n` finite numbers as an array; raises `FormatError` for anything else."""
    good = isinstance(value, list) and len(value) == n
    if not good or not all(isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= 1e12 for x in value):
        raise FormatError("numbers are missing or cannot be used", at=at, wanted=f"{n} numbers", got=str(value)[:60])
    return np.array(value, dtype=np.float64)


def name_of(entry: Record, otherwise: str) -> str:
    """Return an object's name, or `otherwise`."""
    name = entry.get("name")
    return name[:200] if isinstance(name, str) and name else otherwise


def accessor(document: Document, index: Any, *, width: int) -> NDArray[Any]:
    """Return the elements (count, width) of an accessor; integers that are normalised become 0 to 1 or -1 to 1.

    Raises `FormatError` where it does not lie within its buffer, has another width, or holds what is no number.
    """
    at = f"accessor {str(index)[:20]}"
    entry = item(document, "accessors", index)
    kind = _type(entry, at)
    if _WIDTHS.get(str(entry.get("type"))) != width:
        raise FormatError(
            "an accessor is of another type", at=at, wanted=f"{width} numbers", got=str(entry.get("type"))
        )
    count = whole(entry.get("count"), f"{at}, count", below=2**31)
    if "bufferView" in entry:
        values = _strided(document, entry, count, kind=kind, width=width, at=at)
    else:
        whole(count, f"{at}, count", below=MAX_BARE_COUNT)
        document.spend(count * width, at)
        values = np.zeros((count, width), dtype=kind)
    if "sparse" in entry:
        values = _with_sparse(document, record(entry, "sparse"), values, at=at)
    if kind.kind == "f":
        if not np.isfinite(values).all():
            raise FormatError("a value is not a number", at=at, wanted="finite numbers")
    elif entry.get("normalized") is True:
        values = np.maximum(values / np.float32(np.iinfo(kind).max), np.float32(-1)).astype(np.float32)
    return values


def view_bytes(document: Document, index: Any, at: str) -> bytes:
    """Return the bytes of a buffer view; raises `FormatError` where it does not lie within its buffer."""
    view = item(document, "bufferViews", index)
    data = _buffer(document, view.get("buffer"))
    start = whole(view.get("byteOffset", 0), f"{at}, byteOffset", below=len(data) + 1)
    length = whole(view.get("byteLength"), f"{at}, byteLength", below=len(data) - start + 1)
    return data[start : start + length]


def uri_bytes(document: Document, uri: Any, at: str) -> bytes:
    """Return what a URI names: data within it, or a file in the document's own folder; else raises `FormatError`."""
    if not isinstance(uri, str):
        raise FormatError("a buffer is not there", at=at, wanted="data within the file or a file beside it")
    if uri.startswith("data:"):
        head, _, body = uri.partition(",")
        if not head.endswith(";base64"):
            raise FormatError("data within the file is not in base64", at=at, got=head[:40])
        try:
            return base64.b64decode(body, validate=True)
        except (binascii.Error, ValueError) as problem:
            raise FormatError("data within the file is damaged", at=at, got=str(problem)[:80]) from problem
    name = unquote(uri)
    if not name or "\x00" in name or ":" in name or "\\" in name or Path(name).name != name or name == "..":
        raise FormatError("a buffer lies outside the file's folder", at=at, wanted="a name without path", got=name[:80])
    if document.folder is None:
        raise FormatError("a buffer lies in another file", at=at, got=name[:80], hint="Open the file from its folder")
    path = document.folder / name
    try:
        if path.resolve().parent != document.folder.resolve():
            raise FormatError("a buffer lies outside the file's folder", at=at, got=name[:80])
        return read_bytes(path)
    except (StorageError, OSError) as problem:
        raise FormatError("a buffer cannot be read", at=at, got=name[:80], hint="Keep it beside the file") from problem


def _chunks(data: bytes) -> tuple[bytes, bytes | None]:
    """Return the JSON and the binary chunk of a GLB."""
    if len(data) < 20:
        raise FormatError("the file is cut short", wanted="a header of 20 bytes", got=f"{len(data)} bytes")
    _, version, length = struct.unpack_from("<III", data)
    if version != 2:
        raise FormatError("this is no glTF 2", at="byte 4", wanted="version 2", got=str(version))
    if length != len(data):
        raise FormatError(
            "the file is cut short or too long", at="byte 8", wanted=f"{length} bytes", got=f"{len(data)}"
        )
    found: dict[int, bytes] = {}
    place = 12
    while place + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, place)
        if size > len(data) - place - 8:
            raise FormatError("a chunk is cut short", at=f"byte {place}", wanted=f"{size} bytes")
        found.setdefault(kind, data[place + 8 : place + 8 + size])
        place += 8 + size
    if _JSON_CHUNK not in found:
        raise FormatError("the file has no JSON", at="byte 16")
    return found[_JSON_CHUNK], found.get(_BIN_CHUNK)


def _no_constant(text: str) -> float:
    raise ValueError(f"{text} is no number")


def _type(entry: Record, at: str) -> np.dtype[Any]:
    code = entry.get("componentType")
    if not isinstance(code, int) or code not in _TYPES:
        raise FormatError("an accessor holds no known numbers", at=at, got=str(code)[:20])
    return np.dtype(_TYPES[code])


def _buffer(document: Document, index: Any) -> bytes:
    entry = item(document, "buffers", index)
    number = int(index)
    if number not in document.buffers:
        at = f"buffer {number}"
        if "uri" in entry or document.chunk is None or number:
            data = uri_bytes(document, entry.get("uri"), at)
        else:
            data = document.chunk
        length = whole(entry.get("byteLength"), f"{at}, byteLength", below=len(data) + 1)
        document.buffers[number] = data[:length]
    return document.buffers[number]


def _strided(
    document: Document, entry: Record, count: int, *, kind: np.dtype[Any], width: int, at: str
) -> NDArray[Any]:
    """Return elements (count, width) of a buffer view, which may lie apart by a stride."""
    data = view_bytes(document, entry.get("bufferView"), at)
    view = item(document, "bufferViews", entry.get("bufferView"))
    size = kind.itemsize * width
    stride = whole(view.get("byteStride", size), f"{at}, byteStride", below=256) or size
    start = whole(entry.get("byteOffset", 0), f"{at}, byteOffset", below=len(data) + 1)
    if stride < size or (count and start + stride * (count - 1) + size > len(data)):
        wanted = f"{count} × {size} bytes from byte {start}"
        raise FormatError("an accessor reaches beyond its buffer", at=at, wanted=wanted, got=f"{len(data)} bytes")
    document.spend(count * width, at)
    if not count:
        return np.zeros((0, width), dtype=kind)
    raw = np.lib.stride_tricks.as_strided(
        np.frombuffer(data, dtype=np.uint8, offset=start), (count, size), (stride, 1), writeable=False
    )
    return np.ascontiguousarray(raw).view(kind).reshape(count, width)


def _with_sparse(document: Document, sparse: Record, values: NDArray[Any], *, at: str) -> NDArray[Any]:
    """Return `values` with those that a sparse accessor replaces."""
    count = whole(sparse.get("count"), f"{at}, sparse", below=len(values) + 1)
    places, others = record(sparse, "indices"), record(sparse, "values")
    index_type = _type(places, at)
    if index_type.kind != "u":
        raise FormatError("sparse indices are no whole numbers", at=at)
    width = values.shape[1]
    index = _strided(document, places, count, kind=index_type, width=1, at=at)[:, 0].astype(np.int64)
    if count and not index.max() < len(values):
        raise FormatError("a sparse index is out of range", at=at, wanted=f"below {len(values)}", got=str(index.max()))
    result = values.copy()
    result[index] = _strided(document, others, count, kind=values.dtype, width=width, at=at)
    return result
