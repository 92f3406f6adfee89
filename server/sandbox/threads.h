/* Threads that libraries have started by being loaded: a process that forks must not do so while
 * one of them holds a lock, which the child would wait for in vain. */
#ifndef SHEEN_SANDBOX_THREADS_H
#define SHEEN_SANDBOX_THREADS_H

#include <stdbool.h>

/* Waits until every thread but the calling one sleeps, as idle ones do; they stay so as long as
 * nobody gives them work. False with errno when they do not within ten seconds. */
bool threads_wait_idle(void);

#endif
