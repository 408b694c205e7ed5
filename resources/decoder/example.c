/* Prints a QMD file as text, a line a frame: cc -std=c99 -O2 -ffp-contract=off example.c qmd_decoder.c -o qmd_print
 *
 * Copyright (c) 2026 The QMD Studio authors
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "qmd_decoder.h"

static uint8_t file[1 << 22]; /* a device would have the file in flash, or in memory already */
static float pose[1024];

int main(int argc, char **argv)
{
    qmd_decoder decoder;
    FILE *stream = argc == 2 ? fopen(argv[1], "rb") : NULL;
    size_t size = stream ? fread(file, 1, sizeof file, stream) : 0;
    qmd_status status = qmd_open(&decoder, file, size, NULL, 0);

    if (status == QMD_OK && decoder.columns <= sizeof pose / sizeof *pose) {
        printf("%lu frames, %.9g a second\n", (unsigned long)decoder.frames, decoder.fps);
        while ((status = qmd_next(&decoder, pose)) == QMD_OK)
            for (uint32_t j = 0; j < decoder.columns; j++)
                printf("%.9g%c", (double)pose[j], j + 1 < decoder.columns ? ' ' : '\n');
    }
    if (status != QMD_END)
        fprintf(stderr, "%s, at byte %lu\n", qmd_status_text(status), (unsigned long)decoder.error_at);
    return status != QMD_END;
}
