/* Decoder of QMD motion files: see qmd_decoder.h.
 *
 * Copyright (c) 2026 The QMD Studio authors
 * SPDX-License-Identifier: MIT
 */
#include "qmd_decoder.h"

#define HEADER_BYTES 64u
#define SEGMENT_HEADER_BYTES 13u
#define CHECKSUM_AT 8u
#define FRAME_RATE_AT 24u
#define FLOAT_INFINITY 0x7F800000u /* the bits of infinity: all finite floats have less, the sign left aside */

/* Sums that stay below this by count of rows and largest steps are not watched one by one. */
#define SURELY_IN_RANGE 1e30
#define MOST_ROWS_UNWATCHED ((uint32_t)1 << 24)

/* The format's numbers are IEEE 754: where the machine's are not, this does not compile. */
typedef char qmd_needs_ieee_754[sizeof(float) == 4 && sizeof(double) == 8 ? 1 : -1];

/* ---- numbers in the file: little endian, at any address ---- */

static uint32_t load_u16(const uint8_t *at) { return at[0] | (uint32_t)at[1] << 8; }

static uint32_t load_u32(const uint8_t *at)
{
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static uint64_t load_u64(const uint8_t *at) { return load_u32(at) | (uint64_t)load_u32(at + 4) << 32; }

static float load_f32(const uint8_t *at)
{
    union { uint32_t bits; float value; } number;
    number.bits = load_u32(at);
    return number.value;
}

static double load_f64(const uint8_t *at)
{
    union { uint64_t bits; double value; } number;
    number.bits = load_u64(at);
    return number.value;
}

static int is_finite(float value)
{
    union { float value; uint32_t bits; } number;
    number.value = value;
    return (number.bits & 0x7FFFFFFFu) < FLOAT_INFINITY;
}

/* ---- checks ---- */

static qmd_status fail(qmd_decoder *decoder, qmd_status status, size_t at)
{
    decoder->error_at = at;
    return status;
}

/* CRC-32 as in zip and PNG, four bits at a time: a table of 64 bytes. */
static uint32_t checksum(uint32_t sum, const uint8_t *data, size_t size)
{
    static const uint32_t step[16] = {
        0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u, 0x4DB26158u, 0x5005713Cu,
        0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu, 0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu,
    };
    size_t i;
    sum = ~sum;
    for (i = 0; i < size; i++) {
        sum ^= data[i];
        sum = sum >> 4 ^ step[sum & 15u];
        sum = sum >> 4 ^ step[sum & 15u];
    }
    return ~sum;
}

/* Takes `count` parts of `width` bytes at `*at`: sets `*part` to them and moves `*at` past them, if they are there. */
static int take(const qmd_decoder *decoder, size_t *at, uint64_t count, uint32_t width, const uint8_t **part)
{
    if (count > (decoder->end - *at) / width)
        return 0;
    *part = decoder->data + *at;
    *at += (size_t)count * width;
    return 1;
}

/* Checks `count` floats; `*largest` becomes the bits of the largest size among them, if that is larger. */
static qmd_status check_floats(qmd_decoder *decoder, const uint8_t *part, size_t count, uint32_t *largest)
{
    size_t i;
    for (i = 0; i < count; i++) {
        uint32_t size = load_u32(part + 4 * i) & 0x7FFFFFFFu;
        if (size >= FLOAT_INFINITY)
            return fail(decoder, QMD_NOT_A_NUMBER, (size_t)(part - decoder->data) + 4 * i);
        if (size > *largest)
            *largest = size;
    }
    return QMD_OK;
}

static double float_of_bits(uint32_t bits)
{
    union { uint32_t bits; float value; } number;
    number.bits = bits;
    return (double)number.value;
}

/* ---- version 1 ---- */

/* Reads and checks the segment whose header is at `segment.next`, the pose included where it is the first; sets `segment`
 * to it. `check` 0: it has been checked before. `*reach` grows by how far the segment can move a value. */
static qmd_status v1_enter(qmd_decoder *decoder, int check, double *reach)
{
    size_t start = decoder->segment.next, at = start;
    const uint8_t *header, *pose = NULL;
    uint32_t rows, columns, fdf, bits, largest = 0;
    uint64_t positions, i;
    qmd_status status;
    int first = start == HEADER_BYTES;

    if (!take(decoder, &at, 1, SEGMENT_HEADER_BYTES, &header))
        return fail(decoder, QMD_ENDS_EARLY, start);
    rows = load_u32(header);
    columns = load_u32(header + 4);
    fdf = load_u32(header + 8);
    bits = header[12];
    if (rows > INT32_MAX || columns < 1 || columns > INT32_MAX || fdf > columns || bits < 8 || bits > 16)
        return fail(decoder, QMD_SEGMENT, start);
    if (!first && (columns != decoder->columns || rows == 0))
        return fail(decoder, QMD_SEGMENT, start);
    positions = (uint64_t)rows * (columns - fdf);

    /* Part after part, each checked as soon as it is known to be there: so errors come in the order of the file. */
    if (first) {
        size_t here = at;
        if (!take(decoder, &at, columns, 4, &pose))
            return fail(decoder, QMD_ENDS_EARLY, here);
        if (check && (status = check_floats(decoder, pose, columns, &largest)) != QMD_OK)
            return status;
        *reach += float_of_bits(largest);
        largest = 0;
    }
    if (!take(decoder, &at, (uint32_t)1 << bits, 4, &decoder->segment.table))
        return fail(decoder, QMD_ENDS_EARLY, at);
    if (check && (status = check_floats(decoder, decoder->segment.table, (size_t)1 << bits, &largest)) != QMD_OK)
        return status;
    if (!take(decoder, &at, (uint64_t)rows * fdf, 4, &decoder->segment.exact))
        return fail(decoder, QMD_ENDS_EARLY, at);
    if (check && (status = check_floats(decoder, decoder->segment.exact, (size_t)rows * fdf, &largest)) != QMD_OK)
        return status;
    if (!take(decoder, &at, positions, bits == 8 ? 1 : 2, &decoder->segment.index))
        return fail(decoder, QMD_ENDS_EARLY, at);
    if (check && bits > 8 && bits < 16)
        for (i = 0; i < positions; i++)
            if (load_u16(decoder->segment.index + 2 * i) >> bits)
                return fail(decoder, QMD_INDEX, (size_t)(decoder->segment.index - decoder->data) + 2 * (size_t)i);

    *reach += (double)rows * float_of_bits(largest);
    decoder->columns = columns;
    decoder->segment.next = at;
    decoder->segment.rows = rows;
    decoder->segment.fdf = fdf;
    decoder->segment.bits = bits;
    return QMD_OK;
}

static qmd_status v1_open(qmd_decoder *decoder)
{
    double reach = 0;
    size_t rows = 0;
    int starts_empty = 0;
    qmd_status status;

    decoder->segment.next = HEADER_BYTES;
    do {
        starts_empty |= decoder->segment.next != HEADER_BYTES && rows == 0;
        if ((status = v1_enter(decoder, 1, &reach)) != QMD_OK)
            return status;
        rows += decoder->segment.rows; /* no more than there are bytes: a row takes one at least */
    } while (decoder->segment.next < decoder->end);
    if (starts_empty) /* a segment without rows stands alone */
        return fail(decoder, QMD_SEGMENT, HEADER_BYTES);
    decoder->frames = rows + 1;
    decoder->watch_range = !(reach < SURELY_IN_RANGE) || rows > MOST_ROWS_UNWATCHED;
    return QMD_OK;
}

static void v1_first(qmd_decoder *decoder, float *pose)
{
    double reach = 0;
    uint32_t j;
    decoder->segment.next = HEADER_BYTES;
    (void)v1_enter(decoder, 0, &reach);
    for (j = 0; j < decoder->columns; j++)
        pose[j] = load_f32(decoder->data + HEADER_BYTES + SEGMENT_HEADER_BYTES + 4 * (size_t)j);
}

/* Adds the next row to the pose. Each sum is rounded to float before it is added to again: the encoder counts on it. */
static void v1_next(qmd_decoder *decoder, float *pose)
{
    const uint8_t *table, *exact, *index;
    uint32_t fdf, indexed, j;

    if (decoder->segment.rows == 0) {
        double reach = 0;
        (void)v1_enter(decoder, 0, &reach);
    }
    table = decoder->segment.table;
    exact = decoder->segment.exact;
    index = decoder->segment.index;
    fdf = decoder->segment.fdf;
    indexed = decoder->columns - fdf;

    for (j = 0; j < fdf; j++, exact += 4)
        pose[j] += load_f32(exact);
    pose += fdf;
    if (decoder->segment.bits == 8)
        for (j = 0; j < indexed; j++, index++)
            pose[j] += load_f32(table + 4 * (size_t)*index);
    else
        for (j = 0; j < indexed; j++, index += 2)
            pose[j] += load_f32(table + 4 * (size_t)load_u16(index));

    decoder->segment.exact = exact;
    decoder->segment.index = index;
    decoder->segment.rows--;
}

/* ---- all versions ---- */

/* Checks what stands around the payload. */
static qmd_status open_container(qmd_decoder *decoder, const uint8_t *data, size_t size)
{
    static const uint8_t magic[4] = {'Q', 'M', 'D', 0x1A};
    uint64_t payload_bytes;
    uint32_t sum;
    size_t i;

    for (i = 0; i < 4; i++)
        if (i >= size || data[i] != magic[i])
            return fail(decoder, QMD_NOT_QMD, 0);
    if (size < HEADER_BYTES)
        return fail(decoder, QMD_LENGTH, size);
    decoder->data = data;
    decoder->version = load_u16(data + 4);
    if (decoder->version != 1 || load_u16(data + 6) != HEADER_BYTES)
        return fail(decoder, QMD_VERSION, 4);
    payload_bytes = load_u64(data + 12);
    decoder->skeleton_bytes = load_u32(data + 20);
    if (payload_bytes > size - HEADER_BYTES || decoder->skeleton_bytes != size - HEADER_BYTES - payload_bytes)
        return fail(decoder, QMD_LENGTH, 12);
    sum = checksum(0, data, CHECKSUM_AT);
    if (checksum(sum, data + CHECKSUM_AT + 4, size - CHECKSUM_AT - 4) != load_u32(data + CHECKSUM_AT))
        return fail(decoder, QMD_CHECKSUM, CHECKSUM_AT);
    decoder->fps = load_f64(data + FRAME_RATE_AT);
    if (!(decoder->fps >= 1e-3 && decoder->fps <= 1e5)) /* not a number fails this too */
        return fail(decoder, QMD_FRAME_RATE, FRAME_RATE_AT);
    decoder->end = HEADER_BYTES + (size_t)payload_bytes;
    decoder->skeleton_at = decoder->end;
    return QMD_OK;
}

qmd_status qmd_open(qmd_decoder *decoder, const uint8_t *data, size_t size, void *work, size_t work_size)
{
    static const qmd_decoder blank;
    qmd_status status;

    (void)work; /* version 1 decodes into the pose alone */
    (void)work_size;
    *decoder = blank;
    status = open_container(decoder, data, size);
    if (status == QMD_OK)
        status = v1_open(decoder);
    return status;
}

qmd_status qmd_next(qmd_decoder *decoder, float *pose)
{
    uint32_t j;

    if (decoder->frame >= decoder->frames)
        return QMD_END;
    if (decoder->frame == 0)
        v1_first(decoder, pose);
    else
        v1_next(decoder, pose);
    decoder->frame++;
    if (decoder->watch_range)
        for (j = 0; j < decoder->columns; j++)
            if (!is_finite(pose[j])) {
                decoder->frame = decoder->frames; /* a sum that has left the range never comes back */
                return fail(decoder, QMD_RANGE, decoder->end);
            }
    return QMD_OK;
}

void qmd_rewind(qmd_decoder *decoder) { decoder->frame = 0; }

const char *qmd_status_text(qmd_status status)
{
    switch (status) {
    case QMD_OK: return "no error";
    case QMD_END: return "no frame is left";
    case QMD_NOT_QMD: return "this is not a QMD file";
    case QMD_VERSION: return "this version of the QMD format is not known";
    case QMD_LENGTH: return "the file is not as long as its header says";
    case QMD_CHECKSUM: return "the checksum does not fit: the file is damaged";
    case QMD_FRAME_RATE: return "nothing plays at this frame rate";
    case QMD_SEGMENT: return "a segment's header is out of range";
    case QMD_ENDS_EARLY: return "a part ends early";
    case QMD_NOT_A_NUMBER: return "a value is not a number";
    case QMD_INDEX: return "an index points past its table";
    case QMD_RANGE: return "the motion leaves the range of float";
    case QMD_WORK: return "the work memory is too small or not aligned";
    }
    return "unknown status";
}
