/* Messages between the daemon and its workers. The first byte chooses: a job, the end of a job, or
 * an answer of one kind, as a worker could write it after an attacker took it over. */
#include <stdlib.h>

#include "server/sandbox/cage_code.h"
#include "server/sandbox/image_code.h"
#include "server/sandbox/job.h"
#include "tests/fuzz/fuzz.h"

#define MAX_PX 4096
#define FOUR_NUMBERS (4 * sizeof(uint32_t)) /* bytes before the pixels */

static void try_job(const uint8_t *bytes, size_t size)
{
    struct job job;
    struct job_end end;
    if (job_decode(&job, bytes, size))
        MUST(job.kind < N_JOB_KINDS && job.input_bytes > 0);
    if (job_end_decode(&end, bytes, size))
        MUST(end.how < N_JOB_HOWS);
}

static void try_cage(struct source *source)
{
    struct error error = {0};
    struct cage cage;
    if (!cage_take(source, &cage, "fuzz", &error)) {
        MUST(error.kind == ERROR_MODEL || (error.kind == ERROR_SERVER && fuzz_memory_failed()));
        return;
    }
    MUST(cage_check(&cage, "fuzz", &error) || fuzz_memory_failed());
    cage_finish(&cage);
}

static void try_image_size(struct source source)
{
    struct error error = {0};
    struct image size;
    if (image_size_take(&source, &size, "fuzz", MAX_PX, &error))
        MUST(size.width_px > 0 && size.width_px <= MAX_PX && size.height_px > 0 &&
             size.height_px <= MAX_PX && image_bytes(&size) <= IMAGE_MAX_BYTES);
    else
        MUST(error.kind == ERROR_IMAGE);
}

static void try_image(struct source *source)
{
    struct error error = {0};
    try_image_size(*source);
    struct image image;
    const size_t had = source->left;
    if (image_take(source, &image, "fuzz", MAX_PX, &error)) {
        MUST(image.width_px <= MAX_PX && image.height_px <= MAX_PX);
        MUST(had == FOUR_NUMBERS + image_bytes(&image));
        image_finish(&image);
    } else {
        MUST(error.kind == ERROR_IMAGE || (error.kind == ERROR_SERVER && fuzz_memory_failed()));
    }
}

static volatile unsigned sum; /* the result is used, so that the compiler keeps the reads */

/* Reads every sample of every channel, which must all lie within the input. */
static void try_picture(struct source *source)
{
    struct picture picture;
    if (!picture_take(source, &picture) || picture.width_px > 64 || picture.height_px > 64)
        return;
    for (size_t i = 0; i < picture.n_channels; i++) {
        const struct image_channel *channel = &picture.channels[i];
        const size_t sample_bytes = channel->type == IMAGE_UINT8 ? 1 : 4;
        for (uint32_t y = 0; y < picture.height_px; y++)
            for (uint32_t x = 0; x < picture.width_px; x++)
                for (size_t k = 0; k < sample_bytes; k++)
                    sum += ((const uint8_t *)channel->data)[y * channel->row_stride_bytes +
                                                            x * channel->pixel_stride_bytes + k];
    }
}

void fuzz_one(const uint8_t *bytes, size_t size)
{
    static void (*const takers[])(struct source *) = {try_cage, try_image, try_picture};
    const size_t n = sizeof takers / sizeof *takers;
    if (size < 1)
        return;
    const unsigned choice = bytes[0] % (n + 1);
    struct source source = {bytes + 1, size - 1, true};
    struct error error = {0};
    if (choice == n)
        try_job(bytes + 1, size - 1);
    else if (answer_read_status(&source, &error) == ANSWER_OK)
        takers[choice](&source);
}
