/* The jobs that the worker program sheend-image runs. Constant data, any thread. */
#ifndef SHEEN_SANDBOX_IMAGE_TASKS_H
#define SHEEN_SANDBOX_IMAGE_TASKS_H

#include "server/sandbox/zygote.h"

/* The input of each job:
 *
 * JOB_MEASURE_IMAGE, JOB_READ_IMAGE  the largest side allowed (px), then a file
 * JOB_WRITE_IMAGE                    a picture */
extern const struct zygote_task image_tasks[N_JOB_KINDS];

#endif
