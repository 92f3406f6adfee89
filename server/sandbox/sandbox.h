/* What the process of one job may do, and no more: compute, take memory up to a limit, and write
 * its answer. Every other system call ends it at once (SIGSYS). */
#ifndef SHEEN_SANDBOX_SANDBOX_H
#define SHEEN_SANDBOX_SANDBOX_H

#include "server/sandbox/job.h"

/* Memory, processor time, size of the answer, no core file, no further descriptor. For the process
 * of a job, once; `held_bytes` is what it holds before it begins, as sandbox_held_bytes() says.
 * False with errno. */
bool sandbox_limit(const struct job_limits *limits, uint64_t held_bytes);

/* Private memory of the calling process, in bytes: what job_limits.memory_bytes comes on top of.
 * False with errno when the kernel's account of it cannot be read. */
bool sandbox_held_bytes(uint64_t *bytes);

/* Forbids everything else for good: opening a file or a socket, starting a process or a thread,
 * memory that is executable or shared, writing to anything but answer_fd (what libraries say on
 * standard error goes nowhere). False with errno, when the kernel refuses. */
bool sandbox_enter(int answer_fd);

#endif
