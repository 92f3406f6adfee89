#include "server/sandbox/image_tasks.h"

#include <stdlib.h>

#include "server/sandbox/image_code.h"

static void read_image(struct source *input, struct sink *answer)
{
    const uint32_t max_px = source_u32(input);
    const char *name;
    size_t size;
    const void *file = job_take_file(input, &name, &size);
    struct error error = {0};
    struct image image = {0};
    if (!file)
        error_set(&error, ERROR_SERVER, "there is no file in this job");
    if (!file || !image_decode(&image, file, size, name, max_px, &error)) {
        answer_write_error(answer, &error);
        return;
    }
    answer_write_ok(answer);
    image_write(answer, &image);
    image_finish(&image);
}

static void measure_image(struct source *input, struct sink *answer)
{
    const uint32_t max_px = source_u32(input);
    const char *name;
    size_t size;
    const void *file = job_take_file(input, &name, &size);
    struct error error = {0};
    struct image image;
    if (!file)
        error_set(&error, ERROR_SERVER, "there is no file in this job");
    if (!file || !image_measure(&image, file, size, name, max_px, &error)) {
        answer_write_error(answer, &error);
        return;
    }
    answer_write_ok(answer);
    image_size_write(answer, &image);
}

static void write_image(struct source *input, struct sink *answer)
{
    struct picture picture;
    struct error error = {0};
    uint8_t *file = NULL;
    size_t size;
    bool is_picture = picture_take(input, &picture);
    if (!is_picture)
        error_set(&error, ERROR_SERVER, "there is no picture in this job");
    if (!is_picture || !image_encode(picture.format, picture.width_px, picture.height_px,
                                     picture.channels, picture.n_channels, picture.attributes,
                                     picture.n_attributes, &file, &size, &error)) {
        answer_write_error(answer, &error);
        return;
    }
    answer_write_ok(answer);
    sink_bytes(answer, file, size);
    free(file);
}

const struct zygote_task image_tasks[N_JOB_KINDS] = {
    [JOB_MEASURE_IMAGE] = {measure_image},
    [JOB_READ_IMAGE] = {read_image},
    [JOB_WRITE_IMAGE] = {write_image},
};
