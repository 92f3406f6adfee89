/* Confines the process of one job: from sandbox_enter() on it can only compute, allocate memory up
 * to a limit and write its answer. Any other system call kills it at once (SIGSYS).
 * Thread: the only one of the process. */
#ifndef SHEEN_SANDBOX_SANDBOX_H
#define SHEEN_SANDBOX_SANDBOX_H

#include "server/sandbox/job.h"

/* Sets the limits of the calling process: memory, processor time and size of the answer; no core
 * file, no new descriptor. Call it once. held_bytes is what the process holds already
 * (sandbox_held_bytes()). False with errno. */
bool sandbox_limit(const struct job_limits *limits, uint64_t held_bytes);

/* The private memory of the calling process in bytes; job_limits.memory_bytes are added to it.
 * False with errno when /proc/self/statm cannot be read. */
bool sandbox_held_bytes(uint64_t *bytes);

/* Forbids for ever: opening files and sockets, starting processes and threads, executable and
 * shared memory, writing to anything but answer_fd. Writes to standard error, which libraries do,
 * fail without effect. False with errno if the kernel refuses. */
bool sandbox_enter(int answer_fd);

#endif
