/* Every limit that a client or an administrator can meet, in one table: the options of the
 * command line, --help and the configuration file read it. Each room declares the numbers that it
 * needs; here they are put together. What the protocol fixes for both sides is in
 * protocol/limits.h.
 *
 * Plain data. Thread: any; a reload changes times, on the loop's thread, and nothing else. */
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
    uint64_t spare_memory; /* bytes: of frames that have gone, kept for the next
                              (server/base/block_cache.h) */
    uint64_t max_connections;
    uint64_t gpu_losses; /* in ten minutes (gpu_loss_log.h) end the daemon; 0: none do */
};

enum limits_unit { UNIT_COUNT, UNIT_BYTES, UNIT_PX, UNIT_SECONDS };

struct limits_row {
    const char *name; /* of the option and in the configuration file */
    enum limits_unit unit;
    const char *help; /* what it limits; '\n' begins a new line */
    uint64_t low, high, fallback;
    size_t offset; /* in struct limits, of a uint64_t */
};

extern const struct limits_row LIMITS[];
extern const size_t N_LIMITS;

/* Sets all limits to their defaults. */
void limits_init(struct limits *limits);

/* A value as people write it. ERROR_REQUEST names the row, the value and the range. */
bool limits_set(struct limits *limits, const struct limits_row *row, const char *value,
                struct error *error);
uint64_t limits_get(const struct limits *limits, const struct limits_row *row);

/* What --help calls a value of this unit: "BYTES". */
const char *limits_argument(const struct limits_row *row);
/* A number of bytes with the largest suffix that keeps it whole ("4G"); other units as they are. */
enum { LIMITS_TEXT_BYTES = 24 };
void limits_format(const struct limits_row *row, uint64_t value, char text[LIMITS_TEXT_BYTES]);
/* The values that the row takes, so written: "64K to 1G", or "1M or more" without a limit but the
 * type's. */
enum { LIMITS_RANGE_BYTES = 2 * LIMITS_TEXT_BYTES + 8 };
void limits_range(const struct limits_row *row, char text[LIMITS_RANGE_BYTES]);

#endif
