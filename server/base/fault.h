/* Places where a test may make something fail, by name.
 *
 * sheend's own fault_at() (fault.c) says no. The test build's (tests/service/faults.c) says yes as
 * its environment asks for; only what is linked with that can be made to fail. */
#ifndef SHEEN_BASE_FAULT_H
#define SHEEN_BASE_FAULT_H

#include <stdbool.h>

/* Shall the fault of this name happen here and now? Any thread. */
bool fault_at(const char *name);

#endif
