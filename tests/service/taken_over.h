/* Acts as somebody who has taken over the daemon: tries forbidden system calls.
 * Thread: any of the daemon's. */
#ifndef SHEEN_TESTS_TAKEN_OVER_H
#define SHEEN_TESTS_TAKEN_OVER_H

#include <stdbool.h>

/* Tells on standard error each call that was not refused, then how many were. has_driver: without
 * those that drivers need. */
void taken_over(bool has_driver);

#endif
