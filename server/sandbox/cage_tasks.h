/* The jobs that the worker program sheend-cage runs. */
#ifndef SHEEN_SANDBOX_CAGE_TASKS_H
#define SHEEN_SANDBOX_CAGE_TASKS_H

#include "server/sandbox/zygote.h"

/* Only JOB_READ_CAGE. */
extern const struct zygote_task cage_tasks[N_JOB_KINDS];

#endif
