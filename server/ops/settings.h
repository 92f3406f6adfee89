/* The values of all options of sheend: options.h fills them in, and main.c starts the service with
 * them. */
#ifndef SHEEN_OPS_SETTINGS_H
#define SHEEN_OPS_SETTINGS_H

#include <stdbool.h>

#include "server/ops/service.h"

/* Plain data: may be copied and compared byte by byte. */
struct settings {
    struct service_options service;
    char config[ACCESS_PATH_BYTES]; /* "": none */
    bool check_config;
};

#endif
