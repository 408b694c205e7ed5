"""One NumPy array as the bytes of an .npy file, read without trusting its header and without pickle.

The layout is NumPy's format description (NEP 1): magic, version, length of the header, a Python literal, raw values.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qmd_studio.errors import FormatError

_MAGIC = b"\x93NUMPY"
_HEADER = re.compile(
    r"\{'descr': '([<|][fbu][0-9])', 'fortran_order': (True|False), 'shape': \(((?:[0-9]{1,12},? ?){0,4})\), \}\s*"
)
_TYPES = {"<f8": np.float64, "<f4": np.float32, "|u1": np.uint8, "|b1": np.bool_}
_LONGEST_HEADER = 4096


def parse_npy(data: bytes, name: str) -> NDArray[Any]:
    """Return the array that `data` holds: floats of 4 or 8 bytes, bytes or booleans, in up to four dimensions.

    `name` is the array's, for messages. Raises `FormatError` for other types and where the bytes do not fit the shape.
    """
    if not data.startswith(_MAGIC) or len(data) < 12:
        raise _wrong(name, "the array does not begin as one", "an .npy header", repr(data[:6]))
    width = 2 if data[6] == 1 else 4
    start = 8 + width
    length = int.from_bytes(data[8:start], "little")
    if length > min(_LONGEST_HEADER, len(data) - start):
        raise _wrong(name, "the array's header is too long", "a short header", f"{length} bytes")
    found = _HEADER.fullmatch(data[start : start + length].decode("latin-1"))
    if found is None or found.group(1) not in _TYPES:
        raise _wrong(name, "the array is of a kind that is not read", ", ".join(_TYPES), "another header")
    shape = tuple(int(size) for size in re.findall(r"[0-9]+", found.group(3)))
    dtype = np.dtype(_TYPES[found.group(1)])
    body = memoryview(data)[start + length :]
    count = 1
    for size in shape:
        count *= size
    if count * dtype.itemsize != len(body) or max(shape, default=0) > len(data):
        raise _wrong(name, "the array's bytes do not fit its shape", f"{count * dtype.itemsize} bytes", str(len(body)))
    values = np.frombuffer(body, dtype=dtype)
    return values.reshape(shape, order="F" if found.group(2) == "True" else "C")


def _wrong(name: str, message: str, wanted: str, got: str) -> FormatError:
    return FormatError(message, at=f"array {name!r}", wanted=wanted, got=got)
