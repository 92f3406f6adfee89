/* What sheend-cage does in a job's process. */
#ifndef SHEEN_SANDBOX_CAGE_TASKS_H
#define SHEEN_SANDBOX_CAGE_TASKS_H

#include "server/sandbox/zygote.h"

/* JOB_READ_CAGE alone. */
extern const struct zygote_task cage_tasks[N_JOB_KINDS];

#endif
