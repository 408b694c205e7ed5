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

/* Reads and checks the segment whose header is at `next`, the pose included where it is the first; sets the
 * state to it. `check` 0: it has been checked before. `*reach` grows by how far the segment can move a value. */
static qmd_status v1_enter(qmd_decoder *decoder, int check, double *reach)
{
    size_t start = decoder->state.v1.next, at = start;
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
        return fail(decoder, QMD_COUNTS, start);
    if (!first && (columns != decoder->columns || rows == 0))
        return fail(decoder, QMD_COUNTS, start);
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
    if (!take(decoder, &at, (uint32_t)1 << bits, 4, &decoder->state.v1.table))
        return fail(decoder, QMD_ENDS_EARLY, at);
    if (check && (status = check_floats(decoder, decoder->state.v1.table, (size_t)1 << bits, &largest)) != QMD_OK)
        return status;
    if (!take(decoder, &at, (uint64_t)rows * fdf, 4, &decoder->state.v1.exact))
        return fail(decoder, QMD_ENDS_EARLY, at);
    if (check && (status = check_floats(decoder, decoder->state.v1.exact, (size_t)rows * fdf, &largest)) != QMD_OK)
        return status;
    if (!take(decoder, &at, positions, bits == 8 ? 1 : 2, &decoder->state.v1.index))
        return fail(decoder, QMD_ENDS_EARLY, at);
    if (check && bits > 8 && bits < 16)
        for (i = 0; i < positions; i++)
            if (load_u16(decoder->state.v1.index + 2 * i) >> bits)
                return fail(decoder, QMD_INDEX, (size_t)(decoder->state.v1.index - decoder->data) + 2 * (size_t)i);

    *reach += (double)rows * float_of_bits(largest);
    decoder->columns = columns;
    decoder->state.v1.next = at;
    decoder->state.v1.rows = rows;
    decoder->state.v1.fdf = fdf;
    decoder->state.v1.bits = bits;
    return QMD_OK;
}

static qmd_status v1_open(qmd_decoder *decoder)
{
    double reach = 0;
    size_t rows = 0;
    int starts_empty = 0;
    qmd_status status;

    decoder->state.v1.next = HEADER_BYTES;
    do {
        starts_empty |= decoder->state.v1.next != HEADER_BYTES && rows == 0;
        if ((status = v1_enter(decoder, 1, &reach)) != QMD_OK)
            return status;
        rows += decoder->state.v1.rows; /* no more than there are bytes: a row takes one at least */
    } while (decoder->state.v1.next < decoder->end);
    if (starts_empty) /* a segment without rows stands alone */
        return fail(decoder, QMD_COUNTS, HEADER_BYTES);
    decoder->frames = rows + 1;
    decoder->watch_range = !(reach < SURELY_IN_RANGE) || rows > MOST_ROWS_UNWATCHED;
    return QMD_OK;
}

static void v1_first(qmd_decoder *decoder, float *pose)
{
    double reach = 0;
    uint32_t j;
    decoder->state.v1.next = HEADER_BYTES;
    (void)v1_enter(decoder, 0, &reach);
    for (j = 0; j < decoder->columns; j++)
        pose[j] = load_f32(decoder->data + HEADER_BYTES + SEGMENT_HEADER_BYTES + 4 * (size_t)j);
}

/* Adds the next row to the pose. Each sum is rounded to float before it is added to again: the encoder counts on it. */
static void v1_next(qmd_decoder *decoder, float *pose)
{
    const uint8_t *table, *exact, *index;
    uint32_t fdf, indexed, j;

    if (decoder->state.v1.rows == 0) {
        double reach = 0;
        (void)v1_enter(decoder, 0, &reach);
    }
    table = decoder->state.v1.table;
    exact = decoder->state.v1.exact;
    index = decoder->state.v1.index;
    fdf = decoder->state.v1.fdf;
    indexed = decoder->columns - fdf;

    for (j = 0; j < fdf; j++, exact += 4)
        pose[j] += load_f32(exact);
    pose += fdf;
    if (decoder->state.v1.bits == 8)
        for (j = 0; j < indexed; j++, index++)
            pose[j] += load_f32(table + 4 * (size_t)*index);
    else
        for (j = 0; j < indexed; j++, index += 2)
            pose[j] += load_f32(table + 4 * (size_t)load_u16(index));

    decoder->state.v1.exact = exact;
    decoder->state.v1.index = index;
    decoder->state.v1.rows--;
}

/* ---- version 2, the compact profile ---- */

#define V2_COUNTS_BYTES 13u
#define V2_VALUES_PER_BYTE 128u
#define V2_MOST_BETWEEN 60u
#define V2_CONTEXTS 24u
#define V2_LISTS 146u     /* of models: 24 contexts in each of six classes, one in each of two */
#define V2_DECISIONS 47u  /* models in a list */
#define V2_MODELS (V2_LISTS * V2_DECISIONS)
#define V2_KNOWN 16u      /* models in a list that start as the table says */
#define V2_EVEN 32768u
#define V2_LEAST 48u
#define V2_SEEN_BEFORE 24u
#define V2_READ_AHEAD 4u
#define V2_ONE 1048576    /* fractions of a step */
#define V2_LARGEST_KEY ((int32_t)1 << 30)
#define V2_LARGE 65535u   /* sizes beyond it are all the same to a context */

enum { V2_FIRST_KEY, V2_SECOND_KEY, V2_LATER_KEY, V2_ROW_0 }; /* classes; rows are of three */

#define V2_STEP_LIST 144u
#define V2_ROWS_LIST 145u

/* The chance of "larger than this bucket", in 256ths: contexts 0 to 23 of classes 0 to 5, then of classes 6 and 7 the one
 * context that they have. */
static const uint8_t v2_prior[V2_LISTS][V2_KNOWN] = {
    {79, 178, 218, 233, 224, 229, 223, 227, 220, 221, 224, 209, 211, 214, 201, 207},
    {126, 167, 198, 220, 215, 224, 218, 232, 214, 213, 210, 210, 212, 193, 169, 146},
    {156, 164, 194, 207, 182, 210, 187, 188, 186, 202, 196, 195, 207, 202, 188, 203},
    {173, 170, 195, 189, 181, 225, 209, 214, 216, 219, 209, 206, 193, 191, 190, 202},
    {182, 172, 193, 218, 186, 202, 185, 196, 199, 209, 183, 196, 174, 192, 158, 123},
    {181, 189, 203, 217, 209, 193, 168, 208, 183, 196, 182, 195, 197, 173, 133, 157},
    {193, 192, 209, 225, 200, 215, 187, 196, 165, 164, 178, 233, 164, 154, 165, 160},
    {196, 205, 221, 226, 205, 221, 192, 196, 167, 172, 149, 185, 154, 146, 154, 160},
    {205, 211, 223, 226, 213, 220, 197, 203, 173, 198, 180, 172, 136, 209, 175, 166},
    {204, 215, 227, 232, 219, 229, 208, 216, 189, 195, 162, 195, 135, 181, 128, 128},
    {217, 222, 230, 236, 229, 232, 209, 211, 204, 209, 176, 176, 178, 183, 158, 189},
    {224, 232, 240, 244, 236, 240, 233, 234, 227, 225, 218, 226, 211, 221, 220, 224},
    {223, 231, 239, 242, 234, 233, 226, 226, 217, 212, 204, 202, 173, 171, 150, 204},
    {221, 236, 239, 241, 236, 239, 231, 231, 213, 212, 204, 202, 179, 194, 135, 138},
    {228, 238, 242, 244, 237, 240, 227, 232, 217, 224, 207, 217, 186, 213, 164, 189},
    {228, 241, 247, 249, 244, 243, 230, 234, 224, 232, 212, 214, 199, 207, 174, 202},
    {235, 242, 246, 245, 246, 240, 230, 236, 223, 231, 212, 224, 201, 223, 190, 210},
    {236, 242, 246, 251, 242, 250, 241, 244, 227, 227, 216, 233, 214, 218, 201, 187},
    {236, 247, 248, 250, 247, 247, 245, 240, 233, 239, 221, 231, 208, 222, 191, 217},
    {245, 251, 249, 252, 247, 250, 238, 243, 231, 239, 218, 227, 217, 229, 204, 219},
    {238, 247, 251, 250, 251, 251, 247, 249, 244, 248, 233, 238, 220, 239, 212, 214},
    {244, 253, 253, 253, 248, 251, 252, 251, 243, 239, 233, 241, 228, 227, 204, 221},
    {239, 250, 254, 252, 252, 253, 250, 249, 248, 249, 245, 243, 230, 240, 212, 232},
    {252, 252, 255, 255, 254, 255, 253, 253, 250, 248, 245, 246, 238, 241, 230, 237},
    {82, 147, 199, 220, 207, 216, 209, 218, 205, 218, 201, 200, 181, 198, 199, 203},
    {72, 72, 72, 72, 21, 21, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1},
    {122, 144, 196, 208, 197, 201, 206, 217, 198, 182, 184, 218, 192, 180, 145, 159},
    {121, 121, 121, 121, 57, 57, 13, 13, 1, 1, 1, 1, 1, 1, 1, 1},
    {123, 157, 208, 183, 181, 214, 185, 173, 208, 214, 159, 163, 157, 171, 110, 128},
    {153, 142, 174, 208, 174, 188, 176, 206, 176, 202, 158, 185, 137, 154, 128, 107},
    {155, 159, 190, 212, 187, 214, 182, 195, 190, 197, 196, 187, 174, 182, 149, 117},
    {181, 168, 199, 217, 190, 200, 187, 193, 175, 176, 161, 199, 136, 159, 151, 147},
    {183, 179, 189, 216, 192, 214, 186, 211, 188, 207, 189, 198, 149, 189, 121, 163},
    {189, 183, 205, 215, 190, 207, 173, 183, 181, 191, 165, 207, 179, 160, 107, 147},
    {200, 197, 217, 220, 193, 218, 182, 206, 181, 189, 162, 200, 171, 202, 171, 181},
    {210, 202, 213, 222, 200, 216, 195, 204, 187, 209, 176, 180, 179, 160, 148, 178},
    {214, 213, 222, 226, 213, 218, 198, 205, 193, 205, 188, 175, 148, 172, 183, 165},
    {212, 219, 233, 231, 216, 226, 206, 210, 184, 203, 174, 202, 186, 175, 134, 159},
    {226, 232, 237, 242, 232, 233, 219, 229, 207, 220, 210, 218, 202, 211, 196, 210},
    {224, 231, 238, 240, 231, 227, 211, 229, 205, 207, 191, 199, 180, 183, 144, 177},
    {226, 233, 243, 243, 235, 237, 217, 226, 211, 218, 197, 198, 188, 198, 186, 164},
    {233, 236, 241, 242, 234, 238, 231, 226, 205, 222, 204, 197, 188, 196, 164, 186},
    {233, 240, 245, 249, 245, 236, 233, 239, 212, 223, 218, 212, 206, 203, 164, 202},
    {236, 245, 246, 250, 239, 244, 233, 235, 229, 221, 207, 228, 198, 191, 183, 202},
    {241, 244, 248, 249, 245, 250, 237, 238, 233, 233, 213, 207, 216, 219, 192, 191},
    {243, 242, 251, 252, 254, 242, 236, 246, 231, 232, 226, 219, 209, 232, 205, 201},
    {240, 250, 250, 248, 249, 247, 244, 247, 236, 237, 232, 233, 211, 205, 201, 218},
    {250, 247, 251, 253, 251, 249, 250, 247, 249, 244, 239, 239, 232, 228, 208, 219},
    {43, 56, 100, 142, 96, 134, 116, 151, 95, 128, 93, 97, 1, 1, 1, 1},
    {93, 111, 138, 170, 125, 154, 110, 101, 86, 86, 1, 1, 1, 1, 1, 1},
    {84, 111, 162, 164, 115, 184, 112, 122, 86, 97, 1, 1, 1, 1, 1, 1},
    {136, 74, 110, 142, 103, 128, 134, 133, 114, 90, 93, 129, 65, 43, 52, 52},
    {162, 119, 139, 159, 122, 143, 111, 178, 124, 121, 77, 103, 33, 52, 1, 1},
    {177, 123, 136, 159, 121, 155, 117, 147, 102, 154, 137, 121, 20, 52, 52, 52},
    {196, 154, 161, 172, 133, 146, 108, 149, 104, 157, 139, 141, 103, 150, 24, 52},
    {211, 178, 182, 186, 142, 167, 120, 140, 110, 157, 139, 144, 104, 120, 24, 52},
    {220, 199, 199, 199, 163, 174, 134, 154, 116, 156, 118, 156, 85, 192, 47, 65},
    {231, 215, 215, 213, 181, 184, 143, 159, 113, 140, 99, 172, 120, 176, 69, 140},
    {237, 227, 227, 228, 199, 197, 161, 170, 134, 147, 110, 140, 128, 168, 112, 183},
    {244, 234, 236, 234, 214, 214, 178, 182, 144, 155, 112, 146, 115, 145, 123, 171},
    {248, 240, 241, 241, 229, 226, 198, 195, 160, 168, 134, 143, 104, 137, 123, 149},
    {250, 246, 246, 246, 235, 235, 215, 214, 179, 185, 142, 151, 113, 137, 128, 157},
    {251, 248, 248, 248, 242, 242, 229, 227, 199, 198, 161, 166, 131, 142, 115, 139},
    {252, 250, 251, 251, 246, 247, 237, 235, 213, 212, 178, 187, 140, 151, 110, 143},
    {253, 252, 253, 252, 249, 249, 243, 242, 226, 227, 200, 200, 157, 163, 123, 147},
    {254, 253, 253, 253, 251, 251, 246, 248, 238, 235, 217, 210, 169, 181, 141, 150},
    {254, 254, 254, 254, 252, 253, 250, 249, 243, 241, 228, 224, 201, 202, 153, 160},
    {255, 254, 255, 254, 253, 254, 251, 250, 247, 245, 237, 234, 213, 212, 169, 177},
    {255, 255, 255, 255, 254, 254, 253, 252, 249, 250, 243, 243, 229, 223, 199, 202},
    {255, 255, 255, 255, 254, 255, 254, 254, 251, 250, 246, 246, 232, 238, 213, 211},
    {255, 255, 255, 255, 254, 255, 253, 254, 252, 252, 248, 249, 242, 242, 224, 228},
    {255, 255, 255, 255, 255, 255, 254, 254, 253, 253, 251, 251, 248, 248, 242, 243},
    {11, 70, 85, 110, 110, 117, 103, 110, 77, 74, 86, 43, 52, 52, 1, 1},
    {40, 106, 105, 124, 108, 85, 38, 53, 52, 1, 1, 1, 1, 1, 1, 1},
    {44, 97, 116, 105, 46, 83, 5, 6, 1, 1, 1, 1, 1, 1, 1, 1},
    {59, 63, 94, 122, 107, 117, 77, 106, 103, 97, 74, 86, 86, 86, 86, 86},
    {135, 42, 95, 128, 70, 111, 91, 66, 44, 53, 1, 1, 1, 1, 1, 1},
    {98, 87, 111, 111, 141, 127, 113, 95, 120, 28, 1, 1, 1, 1, 1, 1},
    {136, 93, 114, 122, 99, 128, 99, 130, 59, 56, 43, 52, 1, 1, 1, 1},
    {163, 124, 127, 140, 105, 125, 91, 125, 80, 95, 98, 38, 52, 52, 52, 52},
    {180, 149, 143, 160, 105, 142, 98, 108, 65, 143, 70, 100, 110, 74, 86, 86},
    {198, 171, 160, 165, 123, 139, 102, 130, 104, 114, 74, 112, 65, 1, 1, 1},
    {210, 191, 185, 184, 134, 152, 111, 126, 99, 106, 87, 123, 100, 88, 74, 43},
    {222, 206, 204, 200, 157, 165, 115, 131, 105, 112, 40, 112, 123, 74, 44, 52},
    {230, 222, 215, 215, 178, 178, 130, 150, 103, 127, 109, 124, 90, 148, 138, 44},
    {233, 234, 226, 227, 197, 199, 153, 162, 106, 129, 93, 114, 55, 81, 84, 55},
    {242, 238, 235, 234, 215, 213, 173, 175, 129, 140, 106, 132, 93, 106, 93, 138},
    {246, 242, 242, 239, 225, 224, 196, 193, 150, 155, 110, 135, 95, 117, 52, 72},
    {248, 246, 245, 246, 234, 233, 210, 213, 175, 179, 131, 136, 102, 146, 81, 77},
    {250, 249, 249, 248, 241, 239, 225, 221, 195, 193, 151, 155, 112, 132, 81, 131},
    {252, 250, 250, 250, 242, 245, 232, 231, 210, 211, 174, 179, 126, 137, 95, 130},
    {253, 252, 252, 252, 248, 248, 239, 240, 223, 220, 196, 197, 144, 152, 103, 131},
    {254, 252, 252, 253, 249, 248, 241, 243, 231, 231, 209, 205, 173, 173, 126, 136},
    {254, 253, 254, 253, 251, 252, 249, 247, 238, 239, 225, 222, 194, 195, 146, 145},
    {254, 254, 254, 253, 252, 251, 248, 247, 240, 241, 231, 231, 207, 206, 170, 170},
    {255, 255, 255, 254, 254, 253, 252, 251, 247, 247, 240, 240, 230, 229, 208, 210},
    {1, 70, 55, 48, 3, 4, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3, 58, 19, 72, 21, 21, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1},
    {6, 72, 78, 57, 39, 39, 6, 6, 1, 1, 1, 1, 1, 1, 1, 1},
    {2, 63, 69, 124, 81, 46, 13, 13, 1, 1, 1, 1, 1, 1, 1, 1},
    {8, 49, 27, 91, 73, 73, 21, 21, 2, 2, 1, 1, 1, 1, 1, 1},
    {9, 54, 37, 128, 79, 99, 38, 38, 6, 6, 1, 1, 1, 1, 1, 1},
    {11, 63, 66, 90, 81, 146, 44, 55, 12, 12, 1, 1, 1, 1, 1, 1},
    {18, 48, 80, 101, 97, 121, 119, 119, 22, 28, 3, 3, 1, 1, 1, 1},
    {27, 60, 78, 100, 77, 154, 54, 108, 45, 45, 8, 8, 1, 1, 1, 1},
    {43, 68, 71, 110, 81, 119, 102, 163, 61, 77, 23, 23, 2, 2, 1, 1},
    {67, 75, 83, 83, 85, 63, 100, 129, 101, 101, 40, 40, 6, 6, 1, 1},
    {96, 82, 96, 117, 72, 105, 80, 125, 109, 136, 72, 72, 20, 20, 2, 2},
    {121, 105, 108, 125, 79, 100, 75, 104, 156, 164, 65, 98, 37, 37, 5, 5},
    {147, 127, 126, 132, 80, 117, 80, 91, 62, 185, 134, 134, 70, 70, 19, 19},
    {170, 157, 145, 154, 103, 116, 65, 107, 86, 81, 125, 157, 96, 96, 36, 36},
    {194, 183, 166, 169, 117, 132, 76, 120, 77, 109, 99, 199, 157, 106, 69, 69},
    {208, 195, 189, 188, 144, 140, 99, 122, 69, 100, 124, 81, 125, 156, 95, 95},
    {220, 212, 204, 207, 160, 161, 117, 127, 84, 124, 127, 102, 90, 198, 157, 106},
    {229, 221, 215, 216, 186, 188, 137, 148, 99, 108, 73, 81, 112, 114, 156, 156},
    {235, 232, 229, 228, 201, 199, 161, 158, 112, 124, 88, 121, 104, 117, 105, 184},
    {237, 237, 234, 237, 216, 218, 182, 180, 130, 150, 97, 105, 56, 128, 73, 199},
    {245, 243, 240, 240, 224, 227, 199, 193, 163, 169, 108, 124, 83, 102, 113, 182},
    {245, 244, 245, 243, 232, 233, 218, 216, 185, 186, 125, 150, 96, 114, 87, 123},
    {251, 248, 250, 250, 244, 244, 233, 236, 218, 220, 193, 203, 168, 188, 164, 192},
    {1, 125, 55, 117, 88, 89, 76, 51, 1, 1, 1, 1, 1, 1, 1, 1},
    {34, 68, 77, 82, 57, 68, 29, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {25, 56, 67, 89, 60, 81, 34, 4, 1, 1, 1, 1, 1, 1, 1, 1},
    {54, 72, 75, 102, 53, 56, 4, 13, 1, 1, 1, 1, 1, 1, 1, 1},
    {54, 84, 70, 98, 67, 79, 21, 57, 1, 2, 1, 1, 1, 1, 1, 1},
    {75, 76, 83, 101, 67, 90, 46, 51, 46, 56, 1, 1, 1, 1, 1, 1},
    {98, 72, 92, 107, 68, 111, 58, 93, 3, 12, 1, 1, 1, 1, 1, 1},
    {123, 95, 109, 109, 78, 93, 59, 67, 39, 61, 2, 3, 1, 1, 1, 1},
    {147, 121, 116, 130, 86, 104, 56, 84, 24, 23, 8, 8, 1, 1, 1, 1},
    {164, 149, 138, 146, 98, 110, 68, 104, 35, 93, 39, 70, 2, 2, 1, 1},
    {181, 171, 164, 162, 113, 122, 80, 83, 61, 50, 28, 83, 5, 6, 1, 1},
    {198, 190, 181, 184, 133, 139, 89, 105, 58, 89, 49, 80, 14, 20, 2, 2},
    {210, 203, 199, 201, 155, 155, 103, 115, 70, 92, 31, 88, 51, 81, 4, 5},
    {221, 214, 211, 213, 177, 175, 122, 126, 74, 91, 69, 75, 61, 47, 19, 19},
    {228, 224, 219, 221, 193, 192, 147, 144, 97, 107, 65, 93, 53, 105, 57, 80},
    {229, 233, 226, 231, 203, 206, 169, 163, 118, 131, 77, 96, 57, 113, 87, 46},
    {234, 237, 233, 237, 214, 216, 187, 188, 139, 142, 98, 114, 74, 83, 57, 164},
    {233, 243, 239, 238, 221, 226, 197, 205, 159, 156, 116, 134, 105, 109, 37, 130},
    {237, 244, 244, 241, 231, 228, 210, 214, 185, 186, 143, 156, 109, 109, 76, 50},
    {237, 249, 246, 245, 236, 235, 217, 222, 198, 209, 167, 163, 123, 128, 120, 103},
    {239, 252, 248, 249, 242, 242, 229, 225, 212, 218, 193, 192, 150, 176, 125, 136},
    {237, 250, 252, 252, 248, 248, 237, 238, 220, 230, 209, 214, 174, 176, 135, 140},
    {232, 252, 254, 253, 250, 250, 245, 247, 236, 234, 223, 231, 211, 205, 164, 184},
    {211, 251, 252, 252, 252, 253, 251, 252, 251, 253, 249, 250, 247, 247, 242, 242},
    {210, 229, 232, 234, 213, 210, 171, 135, 93, 109, 1, 1, 1, 1, 1, 1},
    {157, 173, 213, 223, 207, 205, 164, 157, 4, 1, 1, 1, 1, 1, 1, 1}
};

static uint32_t size_of(int32_t value) { return value < 0 ? 0u - (uint32_t)value : (uint32_t)value; }

static uint32_t felt(int32_t value)
{
    uint32_t size = size_of(value);
    return size < V2_LARGE ? size : V2_LARGE;
}

static void v2_take_byte(qmd_decoder *decoder)
{
    uint32_t byte = 0;
    if (decoder->state.v2.next < decoder->state.v2.stream_end)
        byte = *decoder->state.v2.next++;
    else if (decoder->state.v2.past <= V2_READ_AHEAD)
        decoder->state.v2.past++;
    decoder->state.v2.code = decoder->state.v2.code << 8 | byte;
}

/* Whether more has been read than an encoder can have written. */
static int v2_overrun(const qmd_decoder *decoder) { return decoder->state.v2.past > V2_READ_AHEAD; }

static uint32_t v2_decision(qmd_decoder *decoder, uint32_t one)
{
    uint32_t bound = (decoder->state.v2.range >> 16) * one, decided = decoder->state.v2.code < bound;
    if (decided) {
        decoder->state.v2.range = bound;
    } else {
        decoder->state.v2.code -= bound;
        decoder->state.v2.range -= bound;
    }
    while (decoder->state.v2.range < (uint32_t)1 << 24) {
        decoder->state.v2.range <<= 8;
        v2_take_byte(decoder);
    }
    return decided;
}

static int32_t v2_number(qmd_decoder *decoder, uint32_t list)
{
    uint16_t *chance = decoder->state.v2.chance + list * V2_DECISIONS;
    uint8_t *seen = decoder->state.v2.seen + list * V2_DECISIONS;
    uint32_t bucket, size, left;

    for (bucket = 0; bucket < V2_DECISIONS; bucket++) {
        uint32_t p = chance[bucket], rate = 327680u / (5u * seen[bucket] + 8u);
        uint32_t larger = v2_decision(decoder, p < V2_LEAST ? V2_LEAST : p > 65536u - V2_LEAST ? 65536u - V2_LEAST : p);
        chance[bucket] = (uint16_t)(larger ? p + ((65536u - p) * rate >> 16) : p - (p * rate >> 16));
        if (seen[bucket] < 255u)
            seen[bucket]++;
        if (!larger)
            break;
    }
    size = bucket;
    if (bucket >= 4) {
        size = 2u + (bucket & 1u);
        for (left = bucket / 2 - 1; left > 0; left--)
            size = 2u * size + v2_decision(decoder, V2_EVEN);
    }
    return size && v2_decision(decoder, V2_EVEN) ? -(int32_t)size : (int32_t)size;
}

/* The list of models for a class and an expectation in 64ths. */
static uint32_t v2_list(uint32_t kind, uint32_t expected)
{
    uint32_t x = expected >> 4, context = x, k = 1;
    if (x >= 2) {
        while (x >> (k + 1))
            k++;
        context = 2u * k + (x >> (k - 1) & 1u);
    }
    return kind * V2_CONTEXTS + (context < V2_CONTEXTS ? context : V2_CONTEXTS - 1u);
}

static void v2_start_stream(qmd_decoder *decoder, size_t at, size_t size)
{
    uint32_t list, t, i = 0;
    for (list = 0; list < V2_LISTS; list++)
        for (t = 0; t < V2_DECISIONS; t++, i++) {
            decoder->state.v2.chance[i] = t < V2_KNOWN ? (uint16_t)(v2_prior[list][t] << 8) : (uint16_t)V2_EVEN;
            decoder->state.v2.seen[i] = V2_SEEN_BEFORE;
        }
    decoder->state.v2.next = decoder->data + at;
    decoder->state.v2.stream_end = decoder->state.v2.next + size;
    decoder->state.v2.past = 0;
    decoder->state.v2.range = 0xFFFFFFFFu;
    for (i = 0; i < 4; i++)
        v2_take_byte(decoder);
}

/* Reads into `key` the key pose that follows `last`, which may be NULL for zeros, and its steps into `step`. */
static qmd_status v2_key(qmd_decoder *decoder, uint32_t kind, const int32_t *last, int32_t *key)
{
    const int32_t *row = decoder->state.v2.row;
    int32_t *step = decoder->state.v2.step;
    uint32_t m = decoder->columns, rows = decoder->state.v2.rows, left = 16, left2 = 16, expected, j;

    for (j = 0; j < m; j++) {
        if (kind == V2_FIRST_KEY)
            expected = 34u * left + 20u * left2;
        else if (kind == V2_SECOND_KEY)
            expected = 124u * left + 32u * left2;
        else
            expected = 4u * left + 56u * felt(step[j]) + 58u * (rows > 0 ? felt(row[j]) : 0)
                     + 24u * (rows > 1 ? felt(row[m + j]) : 0);
        step[j] = v2_number(decoder, v2_list(kind, expected));
        key[j] = (last ? last[j] : 0) + step[j];
        if (key[j] > V2_LARGEST_KEY || key[j] < -V2_LARGEST_KEY)
            return QMD_RANGE;
        if (v2_overrun(decoder))
            return QMD_ENDS_EARLY;
        left2 = left;
        left = felt(step[j]);
    }
    return QMD_OK;
}

/* Reads row `f` of a block; of the block before there are `rows_before` rows, and none in a segment's first. */
static void v2_row(qmd_decoder *decoder, uint32_t f, uint32_t rows_before)
{
    uint32_t m = decoder->columns, left = 0, left2 = 0, j;
    int32_t *row = decoder->state.v2.row + (size_t)f * m;
    const int32_t *old = decoder->state.v2.row_before + (size_t)f * m, *step = decoder->state.v2.step;

    for (j = 0; j < m; j++) {
        uint32_t a = f > 0 ? felt(*(row + j - m)) : 0, b = f > 1 ? felt(*(row + j - 2 * (size_t)m)) : 0;
        uint32_t d = felt(step[j]), here = f < rows_before ? felt(old[j]) : 0;
        uint32_t above = f + 1 < rows_before ? felt(old[m + j]) : 0;
        uint32_t below = f > 0 && f - 1 < rows_before ? felt(*(old + j - m)) : 0;
        uint32_t expected;
        if (decoder->state.v2.block == 1)
            expected = f == 0   ? 30u * left + 8u * left2 + 109u * d
                       : f == 1 ? 243u * a + 40u * left + 63u * left2 + 83u * d
                                : 139u * a + 48u * b + 8u * left2;
        else
            expected = f == 0   ? 58u * d + 75u * here + 162u * above
                       : f == 1 ? 171u * a + 24u * left + 9u * left2 + 53u * d + 281u * here + 480u * above + 17u * below
                                : 108u * a + 36u * b + 27u * here + 25u * above + 9u * below;
        row[j] = v2_number(decoder, v2_list(V2_ROW_0 + (f < 2 ? f : 2), expected));
        left2 = left;
        left = felt(row[j]);
    }
}

/* Fills in the half wave of sines for blocks of `length` frames: any sine good to ten digits gives these integers. */
static void v2_sines(qmd_decoder *decoder, uint32_t length)
{
    double half = 2.0 / length, root = 1.0, x, term, sum;
    uint32_t k, i;

    if (decoder->state.v2.sine_length == length)
        return;
    decoder->state.v2.sine_length = length;
    for (i = 0; i < 12; i++)
        root = 0.5 * (root + half / root);
    for (k = 0; k <= length / 2; k++) {
        x = 3.14159265358979323846 * k / length;
        term = sum = x;
        for (i = 2; i < 24; i += 2) {
            term *= -x * x / (i * (i + 1));
            sum += term;
        }
        decoder->state.v2.sine[k] = decoder->state.v2.sine[length - k] = (int32_t)(V2_ONE * root * sum + 0.5);
    }
}

/* How many blocks a segment of `frames` has, and where key pose `number` of it is. */
static uint32_t v2_blocks(uint32_t frames, uint32_t between)
{
    uint64_t blocks = (2 * (uint64_t)(frames - 1) + between) / (2 * (uint64_t)between);
    return frames < 2 ? 0 : blocks ? (uint32_t)blocks : 1;
}

static uint32_t v2_key_frame(const qmd_decoder *decoder, uint32_t number)
{
    return (uint32_t)((uint64_t)(decoder->state.v2.frames - 1) * number / decoder->state.v2.blocks);
}

/* Reads the next block: its last key pose and its rows. */
static qmd_status v2_block(qmd_decoder *decoder)
{
    uint32_t number = ++decoder->state.v2.block, rows_before = decoder->state.v2.rows, length, f;
    int32_t rows, *other;
    qmd_status status;

    decoder->state.v2.start = decoder->state.v2.end;
    decoder->state.v2.end = v2_key_frame(decoder, number);
    length = decoder->state.v2.end - decoder->state.v2.start;
    if (number > 1) {
        other = decoder->state.v2.from;
        decoder->state.v2.from = decoder->state.v2.to;
        decoder->state.v2.to = other;
    }
    status = v2_key(decoder, number > 1 ? V2_LATER_KEY : V2_SECOND_KEY, decoder->state.v2.from, decoder->state.v2.to);
    if (status != QMD_OK || length < 2)
        return status;
    rows = (int32_t)rows_before + v2_number(decoder, V2_ROWS_LIST);
    if (rows < 0 || (uint32_t)rows >= length)
        return QMD_RANGE;
    other = decoder->state.v2.row;
    decoder->state.v2.row = decoder->state.v2.row_before;
    decoder->state.v2.row_before = other;
    decoder->state.v2.rows = (uint32_t)rows;
    for (f = 0; f < decoder->state.v2.rows; f++) {
        v2_row(decoder, f, rows_before);
        if (v2_overrun(decoder))
            return QMD_ENDS_EARLY;
    }
    v2_sines(decoder, length);
    return QMD_OK;
}

/* Reads the length of a stream at `*at` and moves past it. */
static int v2_length(const qmd_decoder *decoder, size_t *at, uint64_t *length)
{
    uint32_t place;
    *length = 0;
    for (place = 0; place < 5 && decoder->end - *at > place; place++) {
        uint8_t byte = decoder->data[*at + place];
        *length |= (uint64_t)(byte & 127u) << 7 * place;
        if (byte < 128) {
            *at += place + 1;
            return 1;
        }
    }
    return 0;
}

/* Stands before the first frame of the next segment. */
static qmd_status v2_enter(qmd_decoder *decoder)
{
    uint64_t size;
    size_t left = decoder->frames - decoder->frame;
    int first = decoder->frame == 0;
    uint32_t j;

    (void)v2_length(decoder, &decoder->state.v2.length_at, &size);
    v2_start_stream(decoder, decoder->state.v2.stream_at, (size_t)size);
    decoder->state.v2.stream_at += (size_t)size;
    decoder->state.v2.frames = left < decoder->state.v2.segment ? (uint32_t)left : decoder->state.v2.segment;
    decoder->state.v2.blocks = v2_blocks(decoder->state.v2.frames, decoder->state.v2.between);
    decoder->state.v2.frame = decoder->state.v2.block = decoder->state.v2.end = decoder->state.v2.rows = 0;
    if (!first)
        return v2_key(decoder, V2_FIRST_KEY, decoder->state.v2.reference, decoder->state.v2.from);
    for (j = 0; j < decoder->columns; j++)
        decoder->state.v2.from[j] = decoder->state.v2.reference[j];
    return QMD_OK;
}

/* The frame at `t` of its block; t = 0 is the key pose before it. */
static void v2_pose(const qmd_decoder *decoder, uint32_t t, float *pose)
{
    static const uint32_t eighth[8] = {0x3F800000u, 0x3F8B95C2u, 0x3F9837F0u, 0x3FA5FED7u,
                                       0x3FB504F3u, 0x3FC5672Au, 0x3FD744FDu, 0x3FEAC0C7u};
    uint32_t m = decoder->columns, length = decoder->state.v2.end - decoder->state.v2.start, f, k, j;
    uint32_t rows = t > 0 && length > 1 ? decoder->state.v2.rows : 0;
    int64_t along = t > 0 ? (int64_t)((V2_ONE * (uint64_t)t + length) / (2 * (uint64_t)length)) : 0;
    const int32_t *from = decoder->state.v2.from, *to = decoder->state.v2.to, *sine = decoder->state.v2.sine;

    for (j = 0; j < m; j++) {
        uint32_t code = decoder->state.v2.step_code[j];
        union { uint32_t bits; float value; } scale;
        const int32_t *row = decoder->state.v2.row + j;
        int64_t sum = (int64_t)from[j] * (V2_ONE / 2);
        float rounded;
        if (t > 0)
            sum += ((int64_t)to[j] - from[j]) * along;
        for (f = 0, k = t; f < rows; f++, row += m) {
            if (*row != 0)
                sum += (int64_t)*row * (k <= length ? sine[k] : -sine[k - length]);
            k += t;
            if (k >= 2 * length)
                k -= 2 * length;
        }
        scale.bits = eighth[code & 7u] + ((code >> 3) << 23) - ((uint32_t)44 << 23); /* a step over V2_ONE */
        rounded = (float)sum;
        pose[j] = rounded * scale.value;
    }
}

static qmd_status v2_next(qmd_decoder *decoder, float *pose)
{
    size_t stream = decoder->state.v2.stream_at;
    qmd_status status = QMD_OK;

    if (decoder->frame == 0 || decoder->state.v2.frame == decoder->state.v2.frames)
        status = v2_enter(decoder);
    else
        stream = (size_t)(decoder->state.v2.stream_end - decoder->data);
    if (status == QMD_OK && decoder->state.v2.frame > decoder->state.v2.end)
        status = v2_block(decoder);
    if (status != QMD_OK)
        return fail(decoder, status, stream);
    v2_pose(decoder, decoder->state.v2.frame == 0 ? 0 : decoder->state.v2.frame - decoder->state.v2.start, pose);
    decoder->state.v2.frame++;
    return QMD_OK;
}

/* Reads step codes and reference pose from the prelude. */
static qmd_status v2_prelude(qmd_decoder *decoder)
{
    size_t at = HEADER_BYTES + V2_COUNTS_BYTES;
    uint64_t size;
    int32_t code = 128;
    uint32_t j;

    (void)v2_length(decoder, &at, &size);
    v2_start_stream(decoder, decoder->state.v2.stream_at, (size_t)size);
    decoder->state.v2.length_at = at;
    decoder->state.v2.stream_at += (size_t)size;
    for (j = 0; j < decoder->columns; j++) {
        code += v2_number(decoder, V2_STEP_LIST);
        if (code < 0 || code > 255)
            return QMD_RANGE;
        if (v2_overrun(decoder))
            return QMD_ENDS_EARLY;
        decoder->state.v2.step_code[j] = (uint8_t)code;
    }
    return v2_key(decoder, V2_FIRST_KEY, NULL, decoder->state.v2.reference);
}

static uint64_t v2_longest_block(uint32_t frames, uint32_t between)
{
    uint64_t blocks = v2_blocks(frames, between);
    return blocks ? (frames - 1 + blocks - 1) / blocks : 0;
}

/* Lays the work memory out: what is widest first. */
static qmd_status v2_use_work(qmd_decoder *decoder, void *work, size_t work_size)
{
    uint32_t last = (uint32_t)((decoder->frames - 1) % decoder->state.v2.segment + 1);
    uint64_t longest = v2_longest_block(decoder->state.v2.segment, decoder->state.v2.between);
    uint64_t of_last = v2_longest_block(last, decoder->state.v2.between), m = decoder->columns, numbers, bytes;
    int32_t *at = (int32_t *)work;

    longest = of_last > longest ? of_last : longest;
    numbers = 4 * m + longest + 1 + 2 * (longest > 1 ? longest - 1 : 0) * m;
    bytes = numbers * sizeof(int32_t) + V2_MODELS * (sizeof(uint16_t) + 1) + m;
    decoder->work_bytes = bytes > (size_t)-1 ? (size_t)-1 : (size_t)bytes;
    if (work == NULL || work_size < bytes || (uintptr_t)work % sizeof(int32_t) != 0)
        return fail(decoder, QMD_WORK, HEADER_BYTES);
    decoder->state.v2.reference = at;
    decoder->state.v2.from = at += m;
    decoder->state.v2.to = at += m;
    decoder->state.v2.step = at += m;
    decoder->state.v2.sine = at += m;
    decoder->state.v2.row = at += longest + 1;
    decoder->state.v2.row_before = at += (longest > 1 ? longest - 1 : 0) * m;
    decoder->state.v2.chance = (uint16_t *)((int32_t *)work + numbers);
    decoder->state.v2.seen = (uint8_t *)(decoder->state.v2.chance + V2_MODELS);
    decoder->state.v2.step_code = decoder->state.v2.seen + V2_MODELS;
    return QMD_OK;
}

/* Checks that all streams are there and nothing but zeros follows them; sets `stream_at` to the first. */
static qmd_status v2_check_streams(qmd_decoder *decoder)
{
    size_t at = HEADER_BYTES + V2_COUNTS_BYTES, lengths = at, segments, i;
    uint64_t size;

    segments = (decoder->frames - 1) / decoder->state.v2.segment + 1;
    for (i = 0; i <= segments; i++)
        if (!v2_length(decoder, &at, &size))
            return fail(decoder, QMD_ENDS_EARLY, at);
    decoder->state.v2.stream_at = at;
    for (i = 0; i <= segments; i++) {
        (void)v2_length(decoder, &lengths, &size);
        if (size > decoder->end - at)
            return fail(decoder, QMD_ENDS_EARLY, at);
        at += (size_t)size;
    }
    for (i = at; i < decoder->end; i++)
        if (decoder->data[i] != 0)
            return fail(decoder, QMD_LENGTH, at);
    return QMD_OK;
}

static qmd_status v2_open(qmd_decoder *decoder, void *work, size_t work_size)
{
    const uint8_t *counts = decoder->data + HEADER_BYTES;
    uint64_t payload_bytes = decoder->end - HEADER_BYTES;
    uint32_t frames, segment, between;
    size_t stream;
    qmd_status status;

    if (payload_bytes < V2_COUNTS_BYTES)
        return fail(decoder, QMD_ENDS_EARLY, HEADER_BYTES);
    frames = load_u32(counts);
    decoder->columns = load_u32(counts + 4);
    segment = load_u32(counts + 8);
    between = counts[12];
    if (!frames || !decoder->columns || segment > frames || between < 1 || between > V2_MOST_BETWEEN
        || (uint64_t)frames * decoder->columns > V2_VALUES_PER_BYTE * payload_bytes)
        return fail(decoder, QMD_COUNTS, HEADER_BYTES);
    decoder->frames = frames;
    decoder->state.v2.segment = segment ? segment : frames;
    decoder->state.v2.between = between;
    if ((status = v2_check_streams(decoder)) != QMD_OK || (status = v2_use_work(decoder, work, work_size)) != QMD_OK)
        return status;
    stream = decoder->state.v2.stream_at;
    if ((status = v2_prelude(decoder)) != QMD_OK)
        return fail(decoder, status, stream);
    return QMD_OK;
}

static void v2_rewind(qmd_decoder *decoder)
{
    uint64_t size;
    decoder->state.v2.length_at = HEADER_BYTES + V2_COUNTS_BYTES;
    (void)v2_check_streams(decoder);
    (void)v2_length(decoder, &decoder->state.v2.length_at, &size);
    decoder->state.v2.stream_at += (size_t)size;
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
    if (decoder->version < 1 || decoder->version > 2 || load_u16(data + 6) != HEADER_BYTES)
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

    *decoder = blank;
    if ((status = open_container(decoder, data, size)) != QMD_OK)
        return status;
    return decoder->version == 1 ? v1_open(decoder) : v2_open(decoder, work, work_size);
}

qmd_status qmd_next(qmd_decoder *decoder, float *pose)
{
    qmd_status status = QMD_OK;
    uint32_t j;

    if (decoder->frame >= decoder->frames)
        return QMD_END;
    if (decoder->version == 2)
        status = v2_next(decoder, pose);
    else if (decoder->frame == 0)
        v1_first(decoder, pose);
    else
        v1_next(decoder, pose);
    decoder->frame = status == QMD_OK ? decoder->frame + 1 : decoder->frames; /* what is wrong stays wrong */
    if (status != QMD_OK)
        return status;
    if (decoder->watch_range)
        for (j = 0; j < decoder->columns; j++)
            if (!is_finite(pose[j])) {
                decoder->frame = decoder->frames; /* a sum that has left the range never comes back */
                return fail(decoder, QMD_RANGE, decoder->end);
            }
    return QMD_OK;
}

void qmd_rewind(qmd_decoder *decoder)
{
    decoder->frame = 0;
    if (decoder->version == 2)
        v2_rewind(decoder);
}

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
    case QMD_COUNTS: return "a count is out of range";
    case QMD_ENDS_EARLY: return "a part ends early";
    case QMD_NOT_A_NUMBER: return "a value is not a number";
    case QMD_INDEX: return "an index points past its table";
    case QMD_RANGE: return "the motion leaves the range of its numbers";
    case QMD_WORK: return "the work memory is too small or not aligned";
    }
    return "unknown status";
}
