/* What sheend-image does in a job's process. */
#ifndef SHEEN_SANDBOX_IMAGE_TASKS_H
#define SHEEN_SANDBOX_IMAGE_TASKS_H

#include "server/sandbox/zygote.h"

/* JOB_READ_IMAGE (the largest side, then a file), JOB_WRITE_IMAGE (a picture), JOB_DRAW_TEXT (its
 * size in pixels, then the line). */
extern const struct zygote_task image_tasks[N_JOB_KINDS];

#endif
