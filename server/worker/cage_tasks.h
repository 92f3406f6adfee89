/* What sheend-cage does in a job's process. */
#ifndef SHEEN_WORKER_CAGE_TASKS_H
#define SHEEN_WORKER_CAGE_TASKS_H

#include "server/worker/zygote.h"

/* JOB_READ_CAGE alone. */
extern const struct zygote_task cage_tasks[N_JOB_KINDS];

#endif
