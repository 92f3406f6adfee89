/* Landlock, a second wall behind the list of system calls: the calling thread, and all processes that
 * it starts, can reach no file by its path for ever, nor TCP, nor processes outside. Descriptors that
 * are open stay usable. Thread: the only one of the process that shall be confined. */
#ifndef SHEEN_SANDBOX_LANDLOCK_H
#define SHEEN_SANDBOX_LANDLOCK_H

#include <stdbool.h>

/* Takes away what the kernel's version of Landlock can take away. False if the kernel has no Landlock,
 * or the service manager forbids it: then nothing has changed. */
bool landlock_enter(void);

#endif
