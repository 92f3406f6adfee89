/* The libraries that libepoxy loads when it is first called: where one is missing, it ends the
 * process. So this comes before its first call. */
#ifndef SHEEN_GPU_LIBRARIES_H
#define SHEEN_GPU_LIBRARIES_H

#include <stdbool.h>

#include "server/error.h"

/* Loads them, to stay. False with ERROR_DEVICE that names the missing one and its package. Any
 * thread. */
bool libraries_load(struct error *error);

#endif
