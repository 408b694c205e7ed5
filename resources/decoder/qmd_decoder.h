/* Decoder of QMD motion files. One header and one source file of C99, no library, no allocation.
 *
 *     qmd_decoder decoder;
 *     float pose[62];
 *     if (qmd_open(&decoder, file, size, NULL, 0) == QMD_OK && decoder.columns <= 62)
 *         while (qmd_next(&decoder, pose) == QMD_OK)
 *             play(pose, decoder.columns);
 *
 * Angles come out in radians and lengths in units of 0.0254 / 0.45 m. Compile with -ffp-contract=off; README.md says why
 * and how. Written from resources/help/qmd-format.md of QMD Studio.
 *
 * Copyright (c) 2026 The QMD Studio authors
 * SPDX-License-Identifier: MIT
 */
#ifndef QMD_DECODER_H
#define QMD_DECODER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a call came to. All but the first two leave the place in `error_at`: the byte of the file at which it shows. */
typedef enum qmd_status {
    QMD_OK = 0,
    QMD_END,           /* no frame is left */
    QMD_NOT_QMD,       /* the file does not start as a QMD file does */
    QMD_VERSION,       /* a version that this decoder does not know */
    QMD_LENGTH,        /* shorter or longer than its header says */
    QMD_CHECKSUM,      /* damaged: the checksum does not fit */
    QMD_FRAME_RATE,    /* not within 0.001 to 100,000 frames a second */
    QMD_COUNTS,        /* a count is out of range, or does not fit another */
    QMD_ENDS_EARLY,    /* the payload or a stream ends inside a part */
    QMD_NOT_A_NUMBER,  /* a value is infinite or not a number */
    QMD_INDEX,         /* a position lies past the table */
    QMD_RANGE,         /* the motion leaves the range of its numbers */
    QMD_WORK           /* the work memory is smaller than `work_bytes`, or not aligned for int32_t */
} qmd_status;

/* A decoder. Read the first group of members; the second is its own. To come back to a place, copy it together with the
 * pose and with what the work memory holds. */
typedef struct qmd_decoder {
    double fps;            /* frames a second */
    uint32_t version;      /* of the format */
    uint32_t columns;      /* floats in a pose */
    size_t frames;         /* poses in the file */
    size_t frame;          /* poses given out so far */
    size_t skeleton_at;    /* the skeleton block: the host's to read, as zlib and JSON; 0 bytes where there is none */
    size_t skeleton_bytes;
    size_t work_bytes;     /* what this file needs; 0 for version 1 */
    size_t error_at;       /* byte of the file */

    const uint8_t *data;
    size_t end;            /* where the payload ends */
    int watch_range;       /* whether sums could leave the range of float */
    union {
        struct {
            size_t next;   /* the next segment's header */
            size_t rows;   /* left in this segment */
            uint32_t fdf;
            uint32_t bits;
            const uint8_t *table;
            const uint8_t *exact;
            const uint8_t *index;
        } v1;
        struct {
            size_t length_at, stream_at;    /* of the next segment's stream */
            uint32_t segment, between;      /* frames in a segment, and from key pose to key pose */
            uint32_t frames, frame;         /* in this segment, and given out of them */
            uint32_t blocks, block;         /* in this segment, and read of them */
            uint32_t start, end;            /* the key poses around the next frame */
            uint32_t rows;                  /* in this block */
            uint32_t sine_length;           /* of the blocks that `sine` is for */
            uint32_t range, code, past;     /* the range coder; bytes it has taken past its stream's end */
            const uint8_t *next, *stream_end;
            int32_t *reference, *from, *to, *step, *sine, *row, *row_before;
            uint16_t *chance;
            uint8_t *seen, *step_code;
        } v2;
    } state;
} qmd_decoder;

/* Checks the whole file, its checksum included, and stands before the first frame. `data` has to stay where it is, and
 * as it is, for as long as frames are decoded; it needs no alignment.
 *
 * `work` is memory that version 2, the compact profile, decodes into, aligned for int32_t; NULL and 0 will do for version
 * 1. Too little of it gives QMD_WORK, and `work_bytes` then says what the file needs: so a first call without any asks.
 *
 * Of version 2 the streams themselves are read as they are played. What is wrong in them, under a checksum that fits,
 * comes out of qmd_next. On failure nothing but `error_at` and `work_bytes` means anything. */
qmd_status qmd_open(qmd_decoder *decoder, const uint8_t *data, size_t size, void *work, size_t work_size);

/* Makes `pose` (`columns` floats) the next pose, or says why there is none. A pose is the one before and what has changed: hand over the same array
 * each time, as the last call left it. The first call fills it in. QMD_END after the last frame, and the pose stays. */
qmd_status qmd_next(qmd_decoder *decoder, float *pose);

/* Goes back to before the first frame, without checking the file anew. */
void qmd_rewind(qmd_decoder *decoder);

/* The same in words, in English. */
const char *qmd_status_text(qmd_status status);

#ifdef __cplusplus
}
#endif
#endif
