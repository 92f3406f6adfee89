/* Files that an administrator names. To open a pipe could block, and after SIGHUP it would block the
 * event loop; a folder would read as if it were an empty file. So only plain files are opened.
 * Thread: any. */
#ifndef SHEEN_BASE_PLAIN_FILE_H
#define SHEEN_BASE_PLAIN_FILE_H

#include <stdbool.h>

#include "server/base/error.h"

/* May it be opened? ERROR_REQUEST with the path and why not. Symbolic links are followed. */
bool plain_file_check(const char *path, struct error *error);

#endif
