/* The table of all limits that a client or an administrator can meet. The command line, --help and
 * the configuration file are made from it. Each folder of the server declares the limits that it
 * needs; `struct limits` collects them. Limits that are part of the protocol are in
 * protocol/limits.h.
 *
 * Plain data, any thread. A reload of the configuration changes only times, on the loop's
 * thread. */
#ifndef SHEEN_OPS_LIMITS_H
#define SHEEN_OPS_LIMITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/assets/store.h"
#include "server/base/error.h"
#include "server/session/session.h"
#include "server/threads/workers.h"

struct limits {
    struct asset_limits assets;
    struct workers_limits workers;
    struct session_limits session;
    /* bytes of freed memory kept for the next frames (server/base/block_cache.h) */
    uint64_t spare_memory;
    uint64_t max_connections;
    /* so many losses in ten minutes end the daemon (gpu_loss_log.h); 0: never */
    uint64_t gpu_losses;
};

enum limits_unit { UNIT_COUNT, UNIT_BYTES, UNIT_PX, UNIT_SECONDS };

struct limits_row {
    const char *name; /* the name of the option, and in the configuration file */
    enum limits_unit unit;
    const char *help; /* what it limits; '\n' begins a new line */
    uint64_t low, high, fallback;
    size_t offset; /* of the uint64_t in struct limits */
};

extern const struct limits_row LIMITS[];
extern const size_t N_LIMITS;

/* Sets all limits to their defaults. */
void limits_init(struct limits *limits);

/* Sets a limit from text: a number, for bytes also with a suffix K, M, G or T. On failure *limits
 * is unchanged and ERROR_REQUEST names the option, the value and the range. */
bool limits_set(struct limits *limits, const struct limits_row *row, const char *value,
                struct error *error);
uint64_t limits_get(const struct limits *limits, const struct limits_row *row);

/* The name of the row's value in --help, such as "BYTES". */
const char *limits_argument(const struct limits_row *row);
/* Writes a value as text: bytes with the largest suffix that needs no fraction ("4G"), other units
 * as a plain number. */
enum { LIMITS_TEXT_BYTES = 24 };
void limits_format(const struct limits_row *row, uint64_t value, char text[LIMITS_TEXT_BYTES]);
/* Writes the row's range in the same form: "64K to 1G", or "1M or more" if the only upper limit is
 * that of uint64_t. */
enum { LIMITS_RANGE_BYTES = 2 * LIMITS_TEXT_BYTES + 8 };
void limits_range(const struct limits_row *row, char text[LIMITS_RANGE_BYTES]);

#endif
