/* What the daemon counts about itself: sums since its start, and the last minute. All memory is
 * fixed. Thread: the loop's. */
#ifndef SHEEN_SESSION_STATS_H
#define SHEEN_SESSION_STATS_H

#include "protocol/message.h"
#include "server/base/histogram.h"
#include "server/frame/scheduler.h"

#define STATS_FRAMES 64 /* that the mean times are of */
/* The last minute is kept in slices, of which the oldest is forgotten as a whole. */
#define STATS_SLICES 6
#define STATS_SLICE_US 10000000u

enum stats_stage {
    STAGE_TABLES,
    STAGE_VISIBILITY,
    STAGE_EVALUATE,
    STAGE_SHADE,
    STAGE_READBACK,
    STAGE_ENCODE,
    STAGE_TOTAL,
    STAGE_COUNT,
};

/* Why a session ended. */
enum stats_end {
    END_CLIENT,   /* the client closed */
    END_LOST,     /* the connection broke */
    END_PROTOCOL, /* the client broke the protocol */
    END_HELLO,    /* no HELLO in time */
    END_STALLED,  /* it stopped in the middle of a message */
    END_UNREAD,   /* it did not read what it asked for */
    END_IDLE,
    END_DRAIN,       /* the daemon shuts down */
    END_CREDENTIALS, /* it may not come in, or not any more */
    END_COUNT,
};

struct stats_slice {
    uint64_t number; /* of the slice since the start */
    uint64_t requests, frames;
    uint64_t sent_before; /* stats.sent_bytes when the slice began */
    struct histogram stage[STAGE_COUNT];
    struct histogram latency[N_CLASSES]; /* total_us of the frames of a class */
};

struct stats {
    uint64_t start_us;
    uint64_t frames, errors;    /* answered with FRAME, with ERROR */
    uint64_t disconnected;      /* clients: over a limit, or broke the protocol */
    uint64_t upload_bytes;      /* of chunks */
    uint64_t sent_bytes;        /* all that went out */
    uint64_t sessions, refused; /* ever opened; turned away before they were */
    uint64_t ended[END_COUNT];
    uint64_t replies[UINT8_MAX + 1]; /* by message type */
    uint64_t error_codes[_sheen_ErrorCode_ARRAYSIZE];
    struct histogram stage[STAGE_COUNT]; /* of all frames; a stage that was not needed has none */
    struct stats_slice slices[STATS_SLICES];
    sheen_Times last[STATS_FRAMES];
};

/* The last minute, or less soon after the start. */
struct stats_recent {
    uint64_t window_us; /* what it is of */
    uint64_t requests, frames;
    uint64_t sent_bytes;              /* since the first of its answers */
    sheen_Latency latency[N_CLASSES]; /* by enum request_class */
    sheen_Times p50, p95, p99;        /* of each stage by itself; 0: no frame needed it */
};

void stats_init(struct stats *stats);
/* An answer of this type is ready; `code` is that of an ERROR. */
void stats_reply(struct stats *stats, uint8_t type, sheen_ErrorCode code, uint64_t now_us);
/* The times of a FRAME, which stats_reply() counts. */
void stats_frame(struct stats *stats, enum request_class request_class, const sheen_Times *times,
                 uint64_t now_us);
/* Mean over the last frames, at most STATS_FRAMES; zeros before the first. */
sheen_Times stats_mean(const struct stats *stats);
void stats_recent(const struct stats *stats, uint64_t now_us, struct stats_recent *recent);

/* Names for labels and logs. */
const char *stats_stage_name(enum stats_stage stage);
const char *stats_end_name(enum stats_end end);
const char *stats_error_name(sheen_ErrorCode code);

#endif
