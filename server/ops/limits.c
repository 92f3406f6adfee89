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
/* The lowest values that still let a client be served. Memory: a frame of 640 x 480 pixels in
 * colour, the bytes that it is encoded to (JPEG: at most 6 a pixel) and a small model. Frame: the
 * colour plane of 640 x 480 pixels. File: a small model. Output: about what a socket's buffer takes
 * at once. */
#define LEAST_MEMORY PROTOCOL_LEAST_MEMORY_BYTES
#define LEAST_FRAME (640u * 480 * 4)
#define LEAST_FILE (64 * KIB)
#define LEAST_OUTPUT (64 * KIB)
#define MOST_BYTES PROTOCOL_MOST_MEMORY_BYTES
#define MOST_SECONDS 10000000u

#define AT(member) offsetof(struct limits, member)

const struct limits_row LIMITS[] = {
    {"memory-budget", UNIT_BYTES,
     "most that files, models, images, long messages under way and frames may take\ntogether, in "
     "main memory and on the device",
     LEAST_MEMORY, MOST_BYTES, 4 * GIB, AT(assets.memory_budget)},
    {"peer-memory", UNIT_BYTES,
     "most that uploads, long messages under way and frames of one user (Unix "
     "socket),\ncertificate "
     "or token may take; models and images that are stored are not in it: whoever holds more\nthan "
     "an equal "
     "share of the budget makes room first",
     LEAST_MEMORY, MOST_BYTES, 2 * GIB, AT(assets.peer_memory)},
    {"spare-memory", UNIT_BYTES,
     "memory of sent frames that is kept for the next ones, at most, beside the budget;\n"
     "what is not used for 5 s is given back",
     0, MOST_BYTES, 256 * MIB, AT(spare_memory)},
    {"max-upload", UNIT_BYTES, "largest model or image file", LEAST_FILE, PROTOCOL_MAX_UPLOAD_BYTES,
     PROTOCOL_MAX_UPLOAD_BYTES, AT(session.max_upload)},
    {"max-frame", UNIT_BYTES, "largest frame: width x height x bytes of all its planes",
     LEAST_FRAME, PROTOCOL_MAX_FRAME_BYTES, GIB, AT(session.max_frame)},
    {"max-image-side", UNIT_PX, "largest width and height of a light image", 1,
     PROTOCOL_MAX_SIZE_PX, 16384, AT(assets.max_image_side)},
    {"max-connections", UNIT_COUNT, "clients at the same time", 1, 1000000, 4096,
     AT(max_connections)},
    {"max-peer-connections", UNIT_COUNT,
     "of one user (Unix socket), certificate or token, and all of loopback TCP together", 1,
     1000000, 256, AT(session.connections)},
    {"max-strangers", UNIT_COUNT,
     "clients over TLS that have not shown who they are, at the same time: the oldest leaves\nfor "
     "the "
     "next, first of the address that has most",
     1, 1000000, 64, AT(session.strangers.all)},
    {"max-peer-strangers", UNIT_COUNT, "of one address", 1, 1000000, 16,
     AT(session.strangers.of_peer)},
    {"max-penalty", UNIT_SECONDS,
     "an address whose clients come without credentials again and again is turned away for\nso "
     "long "
     "at most; 0: never",
     0, 86400, 600, AT(session.strangers.penalty_s)},
    {"credits", UNIT_COUNT, "requests of one client that wait for their answers", 1,
     PROTOCOL_MAX_CREDITS, 16, AT(session.credits)},
    {"interactive-hard", UNIT_BYTES,
     "a client with more than this unsent when another interactive frame comes is\n"
     "disconnected",
     LEAST_OUTPUT, MOST_BYTES, 32 * MIB, AT(session.interactive_hard)},
    {"interactive-soft", UNIT_BYTES, "and so is one with more than this unsent for", LEAST_OUTPUT,
     MOST_BYTES, 8 * MIB, AT(session.interactive_soft)},
    {"interactive-seconds", UNIT_SECONDS, "so long", 1, MOST_SECONDS, 5, AT(session.interactive_s)},
    {"output-hard", UNIT_BYTES, "the same for stills, batches and all else", LEAST_OUTPUT,
     MOST_BYTES, 256 * MIB, AT(session.output_hard)},
    {"output-soft", UNIT_BYTES, "the same for stills, batches and all else", LEAST_OUTPUT,
     MOST_BYTES, 64 * MIB, AT(session.output_soft)},
    {"output-seconds", UNIT_SECONDS, "the same for stills, batches and all else", 1, MOST_SECONDS,
     60, AT(session.output_s)},
    {"handshake-timeout", UNIT_SECONDS, "from connecting to HELLO", 1, MOST_SECONDS, 3,
     AT(session.handshake_s)},
    {"message-timeout", UNIT_SECONDS, "from the first byte of a message to its last", 1,
     MOST_SECONDS, 30, AT(session.message_s)},
    {"stall-timeout", UNIT_SECONDS, "without a byte read of an answer, or sent of an upload", 1,
     MOST_SECONDS, 30, AT(session.stall_s)},
    {"idle-timeout", UNIT_SECONDS, "without a request; 0: for ever", 0, MOST_SECONDS, 900,
     AT(session.idle_s)},
    {"drain-timeout", UNIT_SECONDS,
     "after SIGTERM, to finish what has been asked and for clients to read it; the rest is\nthen "
     "refused, and the daemon ends within 4 s more",
     0, MOST_SECONDS, 30, AT(session.drain_s)},
    {"worker-memory", UNIT_BYTES,
     "most memory of the process that reads or writes a file; less for small files and\nwithin the "
     "budget",
     MIB, MOST_BYTES, 8 * GIB, AT(workers.memory_bytes)},
    {"worker-output", UNIT_BYTES, "most that comes out of it", MIB, MOST_BYTES, 8 * GIB,
     AT(workers.output_bytes)},
    {"worker-cpu", UNIT_SECONDS, "of a processor, for one file", 1, 86400, 60, AT(workers.cpu_s)},
    {"worker-time", UNIT_SECONDS, "for one file", 1, 86400, 120, AT(workers.wall_s)},
    {"tables-cpu", UNIT_SECONDS, "of processors, to build one model's tables", 1, 86400, 120,
     AT(assets.tables_cpu_s)},
    {"gpu-losses", UNIT_COUNT,
     "so often may the GPU be lost in ten minutes; then the daemon ends with exit code\n75, to be "
     "started anew; 0: as often as it likes",
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
    if (row->unit == UNIT_BYTES)
        return error_set(error, ERROR_REQUEST,
                         "%s is '%s'; it must be bytes from %" PRIu64 " to %" PRIu64
                         ", as 4000000000, 800M or 4G",
                         row->name, value, row->low, row->high);
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
