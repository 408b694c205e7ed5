"""A decoder of version 2 written from resources/help/qmd-compact.md alone, with nothing but the standard library."""

import math
import re
import struct
import zlib
from pathlib import Path

PAGE = Path(__file__).parents[2] / "resources" / "help" / "qmd-compact.md"
EIGHTHS = struct.unpack(">8f", bytes.fromhex("3F8000003F8B95C23F9837F03FA5FED73FB504F33FC5672A3FD744FD3FEAC0C7"))


def decode(data):
    """Return (fps, poses as lists in file units)."""
    assert data[:4] == bytes.fromhex("514d441a")
    version, header_bytes, checksum = struct.unpack_from("<HHI", data, 4)
    assert (version, header_bytes, data[32]) == (2, 64, 6)
    assert zlib.crc32(data[:8] + data[12:]) == checksum
    payload_bytes, block_bytes, fps = struct.unpack_from("<QId", data, 12)
    assert len(data) == 64 + payload_bytes + block_bytes
    payload = data[64 : 64 + payload_bytes]
    frames, m, in_segment, apart = struct.unpack_from("<IIIB", payload)
    assert frames * m <= 128 * payload_bytes
    streams = cut(payload, 13, 1 + (-(-frames // in_segment) if in_segment else 1))
    table = prior()

    prelude = Stream(streams[0], table)
    codes, code = [], 128
    for _ in range(m):
        code += prelude.number(6, 0)
        codes.append(code)
    reference, _ = key(prelude, 0, [0] * m, None)

    poses = []
    for number, stream in enumerate(streams[1:]):
        n = min(in_segment or frames, frames - len(poses))
        sums = segment(Stream(stream, table), n, apart, reference, number == 0)
        poses += [[value(total, code) for total, code in zip(row, codes, strict=True)] for row in sums]
    return fps, poses


def cut(payload, at, count):
    lengths = []
    for _ in range(count):
        length = shift = 0
        while True:
            byte = payload[at]
            at += 1
            length |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        lengths.append(length)
    streams = []
    for length in lengths:
        streams.append(payload[at : at + length])
        at += length
    assert not any(payload[at:])
    return streams


def segment(stream, n, apart, reference, first):
    """Return the sums of a segment's frames."""
    m = len(reference)
    blocks = max(1, (2 * (n - 1) + apart) // (2 * apart)) if n > 1 else 0
    start = reference if first else key(stream, 0, reference, None)[0]
    sums = [[524288 * u for u in start]]
    before, steps, had_rows = [], [0] * m, 0
    for i in range(blocks):
        length = (n - 1) * (i + 1) // blocks - (n - 1) * i // blocks
        known = [(steps[j], cell(before, 0, j), cell(before, 1, j)) for j in range(m)] if i else None
        end, steps = key(stream, 2 if i else 1, start, known)
        rows = []
        if length > 1:
            had_rows += stream.number(7, 0)
            for f in range(had_rows):
                rows.append([])
                for j in range(m):
                    e = expected(rows, before, i > 0, abs(steps[j]), f, j)
                    rows[f].append(stream.number(3 + min(f, 2), context(e)))
            before = rows
        for t in range(1, length + 1):
            w = (1048576 * t + length) // (2 * length)
            sines = [sine(f + 1, t, length) for f in range(len(rows))]
            sums.append([
                524288 * start[j] + (end[j] - start[j]) * w + sum(r[j] * s for r, s in zip(rows, sines, strict=True))
                for j in range(m)
            ])  # fmt: skip
        start = end
    return sums


def key(stream, kind, last, known):
    """Return a key pose and its steps from the one before."""
    left = left2 = 16
    steps = []
    for j in range(len(last)):
        if kind == 0:
            e = 34 * left + 20 * left2
        elif kind == 1:
            e = 124 * left + 32 * left2
        else:
            d, p0, p1 = (abs(number) for number in known[j])
            e = 4 * left + 56 * d + 58 * p0 + 24 * p1
        steps.append(stream.number(kind, context(e)))
        left, left2 = abs(steps[j]), left
    return [a + b for a, b in zip(last, steps, strict=True)], steps


def expected(rows, before, later, d, f, j):
    a, b = cell(rows, f - 1, j), cell(rows, f - 2, j)
    left, left2 = cell(rows, f, j - 1), cell(rows, f, j - 2)
    here, above, below = cell(before, f, j), cell(before, f + 1, j), cell(before, f - 1, j)
    if not later:
        if f == 0:
            return 30 * left + 8 * left2 + 109 * d
        if f == 1:
            return 243 * a + 40 * left + 63 * left2 + 83 * d
        return 139 * a + 48 * b + 8 * left2
    if f == 0:
        return 58 * d + 75 * here + 162 * above
    if f == 1:
        return 171 * a + 24 * left + 9 * left2 + 53 * d + 281 * here + 480 * above + 17 * below
    return 108 * a + 36 * b + 27 * here + 25 * above + 9 * below


def cell(rows, f, j):
    return abs(rows[f][j]) if 0 <= f < len(rows) and 0 <= j < len(rows[f]) else 0


def context(e):
    x = e // 16
    if x < 2:
        return x
    k = x.bit_length() - 1
    return min(2 * k + (x >> (k - 1) & 1), 23)


class Stream:
    def __init__(self, data, table):
        self.data, self.table, self.models = data, table, {}
        self.at, self.range, self.code = 0, 2**32 - 1, 0
        for _ in range(4):
            self.take()

    def take(self):
        assert self.at < len(self.data) + 4
        byte = self.data[self.at] if self.at < len(self.data) else 0
        self.at += 1
        self.code = (self.code * 256 + byte) % 2**32

    def decision(self, p):
        bound = self.range // 65536 * p
        one = self.code < bound
        if one:
            self.range = bound
        else:
            self.code -= bound
            self.range -= bound
        while self.range < 2**24:
            self.range *= 256
            self.take()
        return int(one)

    def number(self, kind, where):
        bucket = 0
        while bucket < 47:
            name = (kind, where, bucket)
            p, s = self.models.get(name) or (256 * self.table[kind][where][bucket] if bucket < 16 else 32768, 24)
            one = self.decision(min(max(p, 48), 65488))
            r = 327680 // (5 * s + 8)
            p = p + (65536 - p) * r // 65536 if one else p - p * r // 65536
            self.models[name] = (p, min(s + 1, 255))
            if not one:
                break
            bucket += 1
        size = bucket
        if bucket >= 4:
            k, h = divmod(bucket, 2)
            size = 2 + h
            for _ in range(k - 1):
                size = 2 * size + self.decision(32768)
        return -size if size and self.decision(32768) else size


def sine(g, t, length):
    return round(math.sqrt(2 / length) * math.sin(math.pi * g * t / length) * 1048576)


def value(total, code):
    return as_f32(as_f32(total) * (EIGHTHS[code % 8] * 2.0 ** (code // 8 - 24) / 1048576))


def as_f32(number):
    return struct.unpack("<f", struct.pack("<f", number))[0]


def prior():
    lines = re.findall(r"^[0-9a-f]{32}$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(lines) == 8 * 24
    return [[list(bytes.fromhex(line)) for line in lines[24 * kind : 24 * kind + 24]] for kind in range(8)]
