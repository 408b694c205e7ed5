/* Decodes one file after another: a length (u32) and so many bytes on stdin, the outcome on stdout, little endian:
 * status (u32), error_at, columns, frames, skeleton_at, skeleton_bytes, work_bytes, poses that follow (u64 each), fps (f64), poses.
 *
 * File and pose lie in memory of just their size, at odd addresses, so that a sanitiser sees whatever reaches past them.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "qmd_decoder.h"

static void put(const void *bytes, size_t size)
{
    if (fwrite(bytes, 1, size, stdout) != size)
        exit(2);
}

static void answer(const uint8_t *data, size_t size)
{
    qmd_decoder decoder, again;
    qmd_status status = qmd_open(&decoder, data, size, NULL, 0);
    void *work = NULL;
    uint64_t numbers[7];
    uint32_t code;
    size_t pose_bytes, decoded = 0;
    float *pose;
    char *poses;

    if (status == QMD_WORK) {
        size_t work_size = decoder.work_bytes;
        work = malloc(work_size);
        if (!work || qmd_open(&decoder, data, size, work, work_size - 1) != QMD_WORK)
            exit(5);
        status = qmd_open(&decoder, data, size, work, work_size);
    }
    pose_bytes = status == QMD_OK ? decoder.columns * sizeof(float) : 0;
    pose = malloc(pose_bytes);
    poses = malloc(status == QMD_OK ? decoder.frames * pose_bytes : 0);

    if (status == QMD_OK) {
        while ((status = qmd_next(&decoder, pose)) == QMD_OK)
            memcpy(poses + decoded++ * pose_bytes, pose, pose_bytes);
        again = decoder;
        qmd_rewind(&again);
        for (size_t frame = 0; frame < decoded; frame++)
            if (qmd_next(&again, pose) != QMD_OK || memcmp(pose, poses + frame * pose_bytes, pose_bytes) != 0)
                exit(3);
        if (status == QMD_END && (qmd_next(&again, pose) != QMD_END || decoded != decoder.frames))
            exit(4);
    }
    code = (uint32_t)status;
    numbers[0] = decoder.error_at;
    numbers[1] = decoder.columns;
    numbers[2] = decoder.frames;
    numbers[3] = decoder.skeleton_at;
    numbers[4] = decoder.skeleton_bytes;
    numbers[5] = decoder.work_bytes;
    numbers[6] = decoded;
    put(&code, sizeof code);
    put(numbers, sizeof numbers);
    put(&decoder.fps, sizeof decoder.fps);
    put(poses, decoded * pose_bytes);
    fflush(stdout);
    free(pose);
    free(poses);
    free(work);
}

int main(void)
{
    uint32_t size;
    while (fread(&size, sizeof size, 1, stdin) == 1) {
        uint8_t *memory = malloc((size_t)size + 1);
        if (!memory || fread(memory + 1, 1, size, stdin) != size)
            return 2;
        answer(memory + 1, size);
        free(memory);
    }
    return 0;
}
