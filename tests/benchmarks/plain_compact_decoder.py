"""A yardstick for the speed of decoding: key poses, ramps and sines behind a range coder, done the plain way.

It is the design that the compact profile grew from, with models in floating point that average two rates, a Golomb
escape and one multiplication of matrices a block. It writes integers that somebody else has chosen, so that both
decoders can be given the same. `compact_decode_speed.py` times its decoder.
"""

from __future__ import annotations

import numpy as np
from numba import njit

CONTEXTS, DECISIONS, WORD, NARROW = 40, 16, (1 << 32) - 1, 1 << 24
FAST, SLOW = 0.07, 0.012


def typical(context):
    """Return the size that a context stands for."""
    return (2 ** (context / 4) - 1) / 4 + 0.02


def shift_of(context):
    """Return the low bits of a context's numbers that are written as they are."""
    return max(int(np.floor(np.log2(max(typical(context) / 2, 1)))), 0)


SHIFTS = np.array([shift_of(c) for c in range(CONTEXTS)])
LOOKUP = np.array([min(int(4 * np.log2(1 + e / 2) + 0.5), CONTEXTS - 1) for e in range(4096)])


def fresh_models():
    """Return (contexts, decisions, 2) chances of "larger": geometric ones."""
    means = np.array([typical(c) / (1 << shift_of(c)) for c in range(CONTEXTS)])
    chance = np.clip(means / (1 + means), 0.01, 0.97)
    return np.repeat(np.repeat(chance[:, None, None], DECISIONS, 1), 2, 2)


@njit(cache=True)
def learn(models, c, i, bit):
    goal = 0.998 if bit else 0.002
    models[c, i, 0] += (goal - models[c, i, 0]) * FAST
    models[c, i, 1] += (goal - models[c, i, 1]) * SLOW


@njit(cache=True)
def chance(models, c, i):
    return min(65472, max(64, int((models[c, i, 0] + models[c, i, 1]) * 32768)))


@njit(cache=True)
def put(state, out, one, bit):
    bound = (state[1] >> 16) * one
    if bit:
        state[1] = bound
    else:
        state[0] += bound
        state[1] -= bound
        at = state[2] - 1
        if state[0] > WORD:
            state[0] &= WORD
            while out[at] == 255:
                out[at] = 0
                at -= 1
            out[at] += 1
    while state[1] < NARROW:
        out[state[2]] = state[0] >> 24
        state[2] += 1
        state[0] = (state[0] << 8) & WORD
        state[1] <<= 8


@njit(cache=True)
def take(state, data, one):
    bound = (state[1] >> 16) * one
    bit = state[0] < bound
    if bit:
        state[1] = bound
    else:
        state[0] -= bound
        state[1] -= bound
    while state[1] < NARROW:
        state[1] = (state[1] << 8) & WORD
        state[0] = ((state[0] << 8) | data[state[2]]) & WORD
        state[2] += 1
    return bit


@njit(cache=True)
def write(state, out, models, c, shift, value):
    size = abs(value)
    quotient = size >> shift
    for i in range(min(quotient + 1, DECISIONS - 1)):
        put(state, out, chance(models, c, i), i < quotient)
        learn(models, c, i, i < quotient)
    if quotient >= DECISIONS - 1:
        rest, width = quotient - DECISIONS + 2, 0
        while rest >> (width + 1):
            put(state, out, 32768, True)
            width += 1
        put(state, out, 32768, False)
        for place in range(width - 1, -1, -1):
            put(state, out, 32768, (rest >> place) & 1)
    for place in range(shift - 1, -1, -1):
        put(state, out, 32768, (size >> place) & 1)
    if size:
        put(state, out, 32768, value < 0)


@njit(cache=True)
def read(state, data, models, c, shift):
    quotient = 0
    while quotient < DECISIONS - 1:
        more = take(state, data, chance(models, c, quotient))
        learn(models, c, quotient, more)
        if not more:
            break
        quotient += 1
    if quotient == DECISIONS - 1:
        width, rest = 0, 1
        while take(state, data, 32768):
            width += 1
        for _ in range(width):
            rest = 2 * rest + take(state, data, 32768)
        quotient += rest - 1
    size = quotient
    for _ in range(shift):
        size = 2 * size + take(state, data, 32768)
    return -size if size and take(state, data, 32768) else size


@njit(cache=True)
def expected(Q, f, j):
    if f == 0:
        if j == 0:
            return 60.0
        return (60 + 2.0 * abs(Q[0, j - 1]) + (abs(Q[0, j - 2]) if j > 1 else 60)) / 4
    a = abs(Q[f - 1, j])
    if f == 1:
        return 0.25 * a + 1 if a < 80 else 20.0
    b = abs(Q[f - 2, j])
    g = abs(Q[f - 3, j]) if f > 2 else b
    left = abs(Q[f, j - 1]) if j > 0 else 0
    left2 = abs(Q[f, j - 2]) if j > 1 else left
    right = abs(Q[f - 1, j + 1]) if j + 1 < Q.shape[1] else 0
    return 0.34 * a + 0.24 * b + 0.12 * g + 0.1 * left + 0.06 * left2 + 0.04 * right


@njit(cache=True)
def write_block(state, out, Q, models, lookup, shifts):
    for f in range(Q.shape[0]):
        for j in range(Q.shape[1]):
            c = lookup[min(int(expected(Q, f, j) * 8 + 0.5), 4095)]
            write(state, out, models, c, shifts[c], Q[f, j])


@njit(cache=True)
def read_block(state, data, Q, models, lookup, shifts):
    for f in range(Q.shape[0]):
        for j in range(Q.shape[1]):
            c = lookup[min(int(expected(Q, f, j) * 8 + 0.5), 4095)]
            Q[f, j] = read(state, data, models, c, shifts[c])


@njit(cache=True)
def write_key(state, out, steps, models, lookup, shifts, size):
    for j in range(len(steps)):
        c = lookup[min(int(size * 8 + 0.5), 4095)]
        write(state, out, models, c, shifts[c], steps[j])
        size = 0.6 * size + 0.4 * abs(steps[j])


@njit(cache=True)
def read_key(state, data, steps, models, lookup, shifts, size):
    for j in range(len(steps)):
        c = lookup[min(int(size * 8 + 0.5), 4095)]
        steps[j] = read(state, data, models, c, shifts[c])
        size = 0.6 * size + 0.4 * abs(steps[j])


def encode(segments):
    """Return the streams of segments: of each the frames of its keys, the keys (k, m) and all blocks' rows."""
    streams = []
    for at, keys, rows in segments:
        out, state = np.zeros(16 * (keys.size + rows.size) + 4096, np.uint8), np.array([0, WORD, 0])
        of_rows, of_keys = fresh_models(), fresh_models()
        write_key(state, out, keys[0], of_keys, LOOKUP, SHIFTS, 60.0)
        for i in range(1, len(at)):
            write_key(state, out, keys[i] - keys[i - 1], of_keys, LOOKUP, SHIFTS, 8.0)
            write_block(state, out, rows[at[i - 1] - i + 1 : at[i] - i], of_rows, LOOKUP, SHIFTS)
        for place in (24, 16, 8, 0):
            out[state[2]] = (state[0] >> place) & 255
            state[2] += 1
        streams.append(out[: state[2] + 8].copy())
    return streams


def decode(streams, ats, step, key_step):
    """Return (n_frames, m) what the streams hold, whose segments have their keys `ats`."""
    m, sines, parts = len(step), {}, []
    for at, data in zip(ats, streams, strict=True):
        X = np.empty((int(at[-1]) + 1, m))
        state = np.array([int.from_bytes(bytes(data[:4]), "big"), WORD, 4])
        of_rows, of_keys, last = fresh_models(), fresh_models(), np.zeros(m, np.int64)
        for i, t in enumerate(at):
            steps = np.zeros(m, np.int64)
            read_key(state, data, steps, of_keys, LOOKUP, SHIFTS, 8.0 if i else 60.0)
            last = last + steps
            X[t] = last * key_step
            n = t - at[i - 1] - 1 if i else 0
            if n < 1:
                continue
            if n not in sines:
                number = np.arange(1, n + 1)
                sines[n] = np.sqrt(2 / (n + 1)) * np.sin(np.pi * np.outer(number, number) / (n + 1))
            Q = np.zeros((n, m), np.int64)
            read_block(state, data, Q, of_rows, LOOKUP, SHIFTS)
            along = (np.arange(1, n + 1) / (n + 1))[:, None]
            used = int(np.flatnonzero(Q.any(axis=1)).max(initial=-1)) + 1
            ramp = X[t - n - 1] * (1 - along) + X[t] * along
            X[t - n : t] = ramp + sines[n][:, :used] @ (Q[:used] * step)
        parts.append(X)
    return np.concatenate(parts)
