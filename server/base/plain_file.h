/* Files that an administrator names. What is none, as a pipe, would hold whoever opens it, and on
 * SIGHUP that is the loop; a folder would read as if it were empty. Thread: any. */
#ifndef SHEEN_BASE_PLAIN_FILE_H
#define SHEEN_BASE_PLAIN_FILE_H

#include <stdbool.h>

#include "server/base/error.h"

/* May it be opened? ERROR_REQUEST with the path and why not. Symbolic links are followed. */
bool plain_file_check(const char *path, struct error *error);

#endif
