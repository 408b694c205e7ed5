/* Opens a QMD file and plays it to its end, for a counter of instructions to watch; prints how large a decoder is. */
#include <stdio.h>
#include <stdlib.h>

#include "qmd_decoder.h"

static uint8_t file[1 << 24];
static int32_t work[1 << 20];

int main(int argc, char **argv)
{
    qmd_decoder decoder;
    FILE *stream = argc == 2 ? fopen(argv[1], "rb") : NULL;
    size_t size = stream ? fread(file, 1, sizeof file, stream) : 0;
    qmd_status status = qmd_open(&decoder, file, size, work, sizeof work);
    float *pose = status == QMD_OK ? malloc(decoder.columns * sizeof *pose) : NULL;

    while (pose && (status = qmd_next(&decoder, pose)) == QMD_OK)
        ;
    printf("%lu\n", (unsigned long)sizeof decoder);
    return status != QMD_END;
}
