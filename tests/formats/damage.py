"""What every reader has to stand: files cut short, files with damage, and a watch on its time and memory.

    assert_every_prefix_ends_well(read, golden)
    @given(damaged(golden)) ... assert_ends_well(read, data)

`read` takes bytes and returns a good object or raises `FormatError` (or another `QmdStudioError`). Anything else fails.
"""

import contextlib
import re
import resource
import signal
import sys
from pathlib import Path

from hypothesis import strategies as st

from qmd_studio.errors import QmdStudioError

CPU_SECONDS = 2.0
EXTRA_BYTES = 256 << 20

NASTY_WORDS = (
    b"2147483648",
    b"-1",
    b"0",
    b"nan",
    b"inf",
    b"-1e999",
    b"1e308",
    b"9" * 400,
    b"0x10",
    b"1_0",
    b"1,5",
    b"",
    b"{",
    b"}",
    b'"',
    b"\xff\xfe",
    b"\x00",
    b"\r",
)
_WORD = re.compile(rb"[^\s,:{}\[\]\"'<>=]+")


class TookTooLong(BaseException):
    """Not an Exception, so that no reader swallows it by mistake."""


def assert_ends_well(read, data):
    """Read `data` under the watch; return the good object, or the error that the reader raised on purpose."""
    with watched():
        try:
            return read(data)
        except QmdStudioError as problem:
            return problem


def assert_every_prefix_ends_well(read, golden):
    """Check every prefix of `golden`, from nothing to all of it, and that the whole of it is good."""
    for length in range(len(golden)):
        assert_ends_well(read, golden[:length])
    assert not isinstance(assert_ends_well(read, golden), QmdStudioError)


@contextlib.contextmanager
def watched(cpu_seconds=CPU_SECONDS, extra_bytes=EXTRA_BYTES):
    """Fail what runs inside on more processor time or memory than a reader may take (a busy machine costs nothing)."""

    def ring(signum, frame):
        raise TookTooLong(f"more than {cpu_seconds} s")

    before = signal.signal(signal.SIGPROF, ring)
    limits = _limit_memory(extra_bytes)
    signal.setitimer(signal.ITIMER_PROF, cpu_seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
        if limits is not None:
            resource.setrlimit(resource.RLIMIT_AS, limits)


@st.composite
def damaged(draw, golden, most=6):
    """Return `golden` after one to `most` harms: bytes changed, cut out, doubled or moved, words replaced."""
    data = bytearray(golden)
    for _ in range(draw(st.integers(1, most))):
        harm = draw(st.sampled_from((_change, _cut, _double, _swap_word, _swap_word, _truncate)))
        data = bytearray(harm(draw, bytes(data)))
    return bytes(data)


def _limit_memory(extra_bytes):
    """Set the address space to what is in use and `extra_bytes`; return the limits to put back (None off Linux)."""
    if not sys.platform.startswith("linux"):
        return None
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limits = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + extra_bytes, limits[1]))
    return limits


def _span(draw, data, longest=64):
    start = draw(st.integers(0, max(len(data) - 1, 0)))
    return start, min(len(data), start + draw(st.integers(1, longest)))


def _change(draw, data):
    start, end = _span(draw, data, 4)
    return data[:start] + draw(st.binary(min_size=end - start, max_size=end - start)) + data[end:]


def _cut(draw, data):
    start, end = _span(draw, data)
    return data[:start] + data[end:]


def _double(draw, data):
    start, end = _span(draw, data)
    return data[:end] + data[start:end] * draw(st.integers(1, 5)) + data[end:]


def _swap_word(draw, data):
    words = list(_WORD.finditer(data))
    if not words:
        return data
    word = words[draw(st.integers(0, len(words) - 1))]
    other = draw(st.sampled_from(NASTY_WORDS) | st.sampled_from(words).map(lambda found: found.group()))
    return data[: word.start()] + other + data[word.end() :]


def _truncate(draw, data):
    return data[: draw(st.integers(0, len(data)))]
