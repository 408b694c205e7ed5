/* The decoder under whatever bytes a fuzzer makes: as they are, and with lengths and checksum set right, since hardly any
 * damaged file would otherwise come past its header. LLVMFuzzerTestOneInput is the entry that libFuzzer and AFL++ call;
 * with -DQMD_OWN_MUTATOR there is a main that makes the damage itself, from the files it is given.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "qmd_decoder.h"

#define HEADER_BYTES 64u
#define MOST_WORK ((size_t)1 << 24)

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static unsigned long taken;

/* One bit at a time, to be no twin of the decoder's own. */
static uint32_t crc32_of(uint32_t sum, const uint8_t *data, size_t size)
{
    for (sum = ~sum; size > 0; size--) {
        sum ^= *data++;
        for (int bit = 0; bit < 8; bit++)
            sum = sum >> 1 ^ (sum & 1u ? 0xEDB88320u : 0);
    }
    return ~sum;
}

static void store(uint8_t *at, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

static void repair(uint8_t *data, size_t size)
{
    size_t block = data[20] % 16u < size - HEADER_BYTES ? data[20] % 16u : 0;
    memcpy(data, data[4] == 2 ? "QMD\x1a\x02\x00\x40\x00" : "QMD\x1a\x01\x00\x40\x00", 8);
    store(data + 12, size - HEADER_BYTES - block, 8);
    store(data + 20, block, 4);
    memcpy(data + 24, "\0\0\0\0\0\0\x3e\x40", 8); /* 30 frames a second */
    store(data + 8, crc32_of(crc32_of(0, data, 8), data + 12, size - 12), 4);
}

static void expect(int holds)
{
    if (!holds)
        abort();
}

static void play(const uint8_t *data, size_t size)
{
    qmd_decoder decoder;
    qmd_status status = qmd_open(&decoder, data, size, NULL, 0);
    size_t decoded = 0;
    float *pose;
    void *work = NULL;

    if (status == QMD_WORK) {
        size_t work_size = decoder.work_bytes;
        if (work_size > MOST_WORK)
            return;
        work = malloc(work_size);
        status = qmd_open(&decoder, data, size, work, work_size);
    }
    if (status != QMD_OK) {
        expect(status != QMD_END && status != QMD_WORK && decoder.error_at <= size);
        free(work);
        return;
    }
    taken++;
    expect(decoder.columns >= 1 && decoder.frames >= 1 && decoder.frames <= 128 * size);
    expect(decoder.skeleton_at + decoder.skeleton_bytes == size);
    pose = malloc(decoder.columns * sizeof *pose);
    while ((status = qmd_next(&decoder, pose)) == QMD_OK) {
        decoded++;
        for (uint32_t j = 0; j < decoder.columns; j++)
            expect(pose[j] - pose[j] == 0.0f);
    }
    expect(status == QMD_RANGE || (decoder.version == 2 && status == QMD_ENDS_EARLY)
           || (status == QMD_END && decoded == decoder.frames));
    free(pose);
    free(work);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    play(data, size);
    if (size >= HEADER_BYTES) {
        uint8_t *repaired = malloc(size);
        memcpy(repaired, data, size);
        repair(repaired, size);
        play(repaired, size);
        free(repaired);
    }
    return 0;
}

#ifdef QMD_OWN_MUTATOR

#define MOST_SEEDS 64
#define LONGEST 16384

static uint64_t state;

static uint32_t below(uint32_t limit)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return limit ? (uint32_t)((state >> 16) % limit) : 0;
}

/* Where harm tells: the payload's first bytes hold the counts, so half of all harm goes there. */
static size_t somewhere(size_t size)
{
    uint32_t limit = (uint32_t)size;
    if (below(2) && size > HEADER_BYTES)
        return HEADER_BYTES + below(limit - HEADER_BYTES < 40 ? limit - HEADER_BYTES : 40);
    return below(limit);
}

static size_t harm(uint8_t *data, size_t size)
{
    static const uint32_t nasty[] = {0, 1, 2, 7, 8, 9, 16, 17, 255, 256, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7F800000,
                                     0x7F7FFFFF, 0xFF7FFFFF, 0x7FC00000, 0x10000, 0x40000000};
    size_t at = somewhere(size), length = 1 + below(64), from;
    switch (size ? below(7) : 6) {
    case 0: data[at] ^= (uint8_t)(1u << below(8)); break;
    case 1: data[at] = (uint8_t)below(256); break;
    case 2:
    case 3:
        if (at + 4 <= size)
            store(data + at, nasty[below(sizeof nasty / sizeof *nasty)], 4);
        break;
    case 4: /* cut out */
        length = length < size - at ? length : size - at;
        memmove(data + at, data + at + length, size - at - length);
        return size - length;
    case 5: /* double */
        from = below((uint32_t)size);
        length = length < size - from ? length : size - from;
        if (size + length <= LONGEST) {
            memmove(data + at + length, data + at, size - at);
            memmove(data + at, data + (from < at ? from : 0), length);
            return size + length;
        }
        break;
    default: return below((uint32_t)size + 1);
    }
    return size;
}

int main(int argc, char **argv)
{
    static uint8_t seeds[MOST_SEEDS][LONGEST], data[LONGEST];
    static size_t sizes[MOST_SEEDS];
    unsigned long inputs, i;
    int n_seeds = 0;

    if (argc < 4)
        return fprintf(stderr, "fuzz_decoder INPUTS SEED FILE…\n"), 2;
    inputs = strtoul(argv[1], NULL, 10);
    state = strtoul(argv[2], NULL, 10) * 2 + 88172645463325252u;
    for (int file = 3; file < argc && n_seeds < MOST_SEEDS; file++) {
        FILE *stream = fopen(argv[file], "rb");
        if (!stream)
            return fprintf(stderr, "%s cannot be read\n", argv[file]), 2;
        sizes[n_seeds] = fread(seeds[n_seeds], 1, LONGEST, stream);
        n_seeds += sizes[n_seeds] > 0;
        fclose(stream);
    }
    for (i = 0; i < inputs; i++) {
        uint32_t seed = below((uint32_t)n_seeds);
        size_t size = sizes[seed];
        uint8_t *exact;
        memcpy(data, seeds[seed], size);
        for (uint32_t harms = 1 + below(1 + below(6)); harms > 0; harms--)
            size = harm(data, size);
        exact = malloc(size);
        memcpy(exact, data, size);
        LLVMFuzzerTestOneInput(exact, size);
        free(exact);
    }
    printf("%lu inputs, each as it is and repaired; %lu were taken and played, nothing went wrong\n", inputs, taken);
    return 0;
}
#endif
