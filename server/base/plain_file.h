/* Checks files that an administrator names. Only plain files may be opened: opening a pipe could
 * block, after SIGHUP even the event loop, and a folder would read like an empty file.
 * Thread: any. */
#ifndef SHEEN_BASE_PLAIN_FILE_H
#define SHEEN_BASE_PLAIN_FILE_H

#include <stdbool.h>

#include "server/base/error.h"

/* May the file be opened? If not, ERROR_REQUEST names the path and the reason. Follows symbolic
 * links. */
bool plain_file_check(const char *path, struct error *error);

#endif
