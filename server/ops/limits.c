#include "server/ops/limits.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "protocol/limits.h"
#include "protocol/number.h"
#include "server/ops/gpu_loss_log.h"

#define KIB ((uint64_t)1 << 10)
#define MIB ((uint64_t)1 << 20)
#define GIB ((uint64_t)1 << 30)
/* The lowest values that still let a client be served. Memory of one: a frame of 640 x 480 pixels in
 * colour, the bytes that it is encoded to (JPEG: at most 6 a pixel) and a small model. Budget: the
 * daemon itself, a frame of 160 x 120 pixels with what it is drawn on, and a small model. Frame: the
 * colour plane of 640 x 480 pixels. File: a small model. Output: about what a socket's buffer takes
 * at once. */
#define LEAST_MEMORY (PROTOCOL_LEAST_MEMORY_BYTES - PROTOCOL_DAEMON_BYTES)
#define LEAST_BUDGET PROTOCOL_LEAST_MEMORY_BYTES
#define LEAST_FRAME (640u * 480 * 4)
#define LEAST_FILE (64 * KIB)
#define LEAST_OUTPUT (64 * KIB)
#define MOST_BYTES PROTOCOL_MOST_MEMORY_BYTES
#define MOST_SECONDS 10000000u

#define AT(member) offsetof(struct limits, member)

const struct limits_row LIMITS[] = {
    {"memory-budget", UNIT_BYTES,
     "memory for the daemon itself, files, models, images, long messages and frames together,\n"
     "in main memory and on the device. A frame is drawn on another 100 to 200 bytes a pixel",
     LEAST_BUDGET, MOST_BYTES, 4 * GIB, AT(assets.memory_budget)},
    {"peer-memory", UNIT_BYTES,
     "memory for uploads, long messages and frames of one user (Unix socket), certificate or\n"
     "token. Stored models and images do not count: if room is needed, those of clients that\n"
     "hold more than an equal share of the budget are evicted first",
     LEAST_MEMORY, MOST_BYTES, 2 * GIB, AT(assets.peer_memory)},
    {"spare-memory", UNIT_BYTES,
     "memory of sent frames that is kept for the next frames, within the budget; what is not\n"
     "used for 5 s, or is needed for something else, is freed",
     0, MOST_BYTES, 256 * MIB, AT(spare_memory)},
    {"max-upload", UNIT_BYTES, "largest model or image file", LEAST_FILE, PROTOCOL_MAX_UPLOAD_BYTES,
     PROTOCOL_MAX_UPLOAD_BYTES, AT(session.max_upload)},
    {"max-frame", UNIT_BYTES, "largest frame: width x height x bytes of all its planes",
     LEAST_FRAME, PROTOCOL_MAX_FRAME_BYTES, GIB, AT(session.max_frame)},
    {"max-image-side", UNIT_PX, "largest width and height of a light image", 1,
     PROTOCOL_MAX_SIZE_PX, 16384, AT(assets.max_image_side)},
    {"max-connections", UNIT_COUNT, "connected clients, as far as there are descriptors", 1,
     1000000, 4096, AT(max_connections)},
    {"max-peer-connections", UNIT_COUNT,
     "connections of one user (Unix socket), certificate or token, and of all loopback TCP\n"
     "together",
     1, 1000000, 256, AT(session.connections)},
    {"max-strangers", UNIT_COUNT,
     "TLS clients that have not identified themselves yet. Beyond that the oldest one is\n"
     "disconnected, first of the address that has most",
     1, 1000000, 64, AT(session.strangers.all)},
    {"max-peer-strangers", UNIT_COUNT,
     "TLS clients of one address that have not identified themselves yet", 1, 1000000, 16,
     AT(session.strangers.of_peer)},
    {"max-penalty", UNIT_SECONDS,
     "longest time for which an address is refused whose clients connect again and again\n"
     "without credentials; 0: none is refused",
     0, 86400, 600, AT(session.strangers.penalty_s)},
    {"credits", UNIT_COUNT, "unanswered requests of one client", 1, PROTOCOL_MAX_CREDITS, 16,
     AT(session.credits)},
    {"interactive-hard", UNIT_BYTES,
     "a client is disconnected if it has more than this unsent when another interactive frame\n"
     "is ready",
     LEAST_OUTPUT, MOST_BYTES, 32 * MIB, AT(session.interactive_hard)},
    {"interactive-soft", UNIT_BYTES,
     "a client is disconnected if it has more than this unsent for interactive-seconds",
     LEAST_OUTPUT, MOST_BYTES, 8 * MIB, AT(session.interactive_soft)},
    {"interactive-seconds", UNIT_SECONDS, "time for interactive-soft", 1, MOST_SECONDS, 5,
     AT(session.interactive_s)},
    {"output-hard", UNIT_BYTES, "as interactive-hard, for stills, batches and all other replies",
     LEAST_OUTPUT, MOST_BYTES, 256 * MIB, AT(session.output_hard)},
    {"output-soft", UNIT_BYTES, "as interactive-soft, for stills, batches and all other replies",
     LEAST_OUTPUT, MOST_BYTES, 64 * MIB, AT(session.output_soft)},
    {"output-seconds", UNIT_SECONDS, "time for output-soft", 1, MOST_SECONDS, 60,
     AT(session.output_s)},
    {"handshake-timeout", UNIT_SECONDS, "time from connecting to HELLO", 1, MOST_SECONDS, 3,
     AT(session.handshake_s)},
    {"message-timeout", UNIT_SECONDS, "time from the first byte of a message to its last", 1,
     MOST_SECONDS, 30, AT(session.message_s)},
    {"stall-timeout", UNIT_SECONDS,
     "time in which a client must read part of a reply, or send part of an upload", 1, MOST_SECONDS,
     30, AT(session.stall_s)},
    {"idle-timeout", UNIT_SECONDS,
     "time without a request after which a client is disconnected; 0: never", 0, MOST_SECONDS, 900,
     AT(session.idle_s)},
    {"drain-timeout", UNIT_SECONDS,
     "time after SIGTERM to finish requests and for clients to read the replies. Then the\n"
     "rest is refused, and the daemon ends within 4 s",
     0, MOST_SECONDS, 30, AT(session.drain_s)},
    {"worker-memory", UNIT_BYTES,
     "memory of the process that reads or writes a file; less for small files, and within the\n"
     "budget",
     MIB, MOST_BYTES, 8 * GIB, AT(workers.memory_bytes)},
    {"worker-output", UNIT_BYTES, "size of the result of the process that reads or writes a file",
     MIB, MOST_BYTES, 8 * GIB, AT(workers.output_bytes)},
    {"worker-cpu", UNIT_SECONDS, "processor time of the process that reads or writes a file", 1,
     86400, 60, AT(workers.cpu_s)},
    {"worker-time", UNIT_SECONDS, "elapsed time of the process that reads or writes a file", 1,
     86400, 120, AT(workers.wall_s)},
    {"tables-cpu", UNIT_SECONDS, "processor time to build one model's tables", 1, 86400, 120,
     AT(assets.tables_cpu_s)},
    {"gpu-losses", UNIT_COUNT,
     "number of GPU losses in ten minutes after which the daemon ends with exit code 75, to be\n"
     "started again; 0: never",
     0, GPU_LOSSES_MAX, 3, AT(gpu_losses)},
};
const size_t N_LIMITS = sizeof LIMITS / sizeof *LIMITS;

static void put(struct limits *limits, const struct limits_row *row, uint64_t value)
{
    memcpy((char *)limits + row->offset, &value, sizeof value);
}

uint64_t limits_get(const struct limits *limits, const struct limits_row *row)
{
    uint64_t value;
    memcpy(&value, (const char *)limits + row->offset, sizeof value);
    return value;
}

void limits_init(struct limits *limits)
{
    for (size_t i = 0; i < N_LIMITS; i++)
        put(limits, &LIMITS[i], LIMITS[i].fallback);
}

bool limits_set(struct limits *limits, const struct limits_row *row, const char *value,
                struct error *error)
{
    uint64_t number = 0;
    if (number_parse(value, row->low, row->high, row->unit == UNIT_BYTES, &number)) {
        put(limits, row, number);
        return true;
    }
    if (row->unit == UNIT_BYTES) {
        char range[LIMITS_RANGE_BYTES];
        limits_range(row, range);
        return error_set(error, ERROR_REQUEST,
                         "%s is '%s'; it must be %s: bytes, as 4000000000, 800M or 4G", row->name,
                         value, range);
    }
    return error_set(error, ERROR_REQUEST,
                     "%s is '%s'; it must be a whole number from %" PRIu64 " to %" PRIu64,
                     row->name, value, row->low, row->high);
}

const char *limits_argument(const struct limits_row *row)
{
    static const char *const names[] = {
        [UNIT_COUNT] = "N",
        [UNIT_BYTES] = "BYTES",
        [UNIT_PX] = "PX",
        [UNIT_SECONDS] = "SECONDS",
    };
    return names[row->unit];
}

void limits_format(const struct limits_row *row, uint64_t value, char text[LIMITS_TEXT_BYTES])
{
    static const char suffixes[] = "KMGT";
    unsigned n = 0;
    while (row->unit == UNIT_BYTES && n < 4 && value >= KIB && value % KIB == 0) {
        value /= KIB;
        n++;
    }
    snprintf(text, LIMITS_TEXT_BYTES, n ? "%" PRIu64 "%c" : "%" PRIu64, value,
             n ? suffixes[n - 1] : 0);
}

void limits_range(const struct limits_row *row, char text[LIMITS_RANGE_BYTES])
{
    char low[LIMITS_TEXT_BYTES], high[LIMITS_TEXT_BYTES];
    limits_format(row, row->low, low);
    limits_format(row, row->high, high);
    if (row->high == MOST_BYTES)
        snprintf(text, LIMITS_RANGE_BYTES, "%s or more", low);
    else
        snprintf(text, LIMITS_RANGE_BYTES, "%s to %s", low, high);
}
