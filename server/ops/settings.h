/* Every value that an option of sheend sets: what options.h reads, and main.c starts the service with.
 */
#ifndef SHEEN_OPS_SETTINGS_H
#define SHEEN_OPS_SETTINGS_H

#include <stdbool.h>

#include "server/ops/service.h"

/* Plain data: it can be copied and compared. */
struct settings {
    struct service_options service;
    char config[ACCESS_PATH_BYTES]; /* "": none */
    bool check_config;
};

#endif
