/* Fault injection: named places in the code where a test can make something fail.
 *
 * fault_at() of sheend itself (fault.c) always returns false. That of the test build
 * (tests/service/faults.c) returns true for the faults that its environment names. */
#ifndef SHEEN_BASE_FAULT_H
#define SHEEN_BASE_FAULT_H

#include <stdbool.h>

/* True if the fault of this name is to happen now. Any thread. */
bool fault_at(const char *name);

#endif
