/* Waits until the threads that libraries have started are idle. A process must not fork while one
 * of them holds a lock: the child would wait for that lock for ever. */
#ifndef SHEEN_SANDBOX_THREADS_H
#define SHEEN_SANDBOX_THREADS_H

#include <stdbool.h>

/* Waits until all threads but the calling one sleep. They sleep as long as nobody gives them work.
 * False with errno if that does not happen within ten seconds. */
bool threads_wait_idle(void);

#endif
