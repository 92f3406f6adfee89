/* The daemon's statistics: sums since its start, and figures of the last minute. All memory has a
 * fixed size.
 * Thread: the loop's. */
#ifndef SHEEN_SESSION_STATS_H
#define SHEEN_SESSION_STATS_H

#include "protocol/messages/message.h"
#include "server/base/histogram.h"
#include "server/frame/scheduler.h"

#define STATS_FRAMES 64 /* number of latest frames whose times stats_mean() averages */
/* The last minute consists of slices; the oldest slice is dropped as a whole. */
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
    END_STALLED,  /* the client stopped in the middle of a message or an upload */
    END_UNREAD,   /* the client did not read its replies in time */
    END_IDLE,
    END_DRAIN,       /* the daemon ends */
    END_CREDENTIALS, /* the client was not admitted, or is not admitted any more */
    END_COUNT,
};

struct stats_slice {
    uint64_t number; /* number of the slice since the start */
    uint64_t requests, frames;
    uint64_t sent_before; /* stats.sent_bytes when the slice began */
    struct histogram stage[STAGE_COUNT];
    struct histogram latency[N_CLASSES]; /* total_us of the frames, by class */
};

struct stats {
    uint64_t start_us;
    uint64_t frames, errors;    /* replies with FRAME; replies with ERROR */
    uint64_t disconnected;      /* clients disconnected for a limit or for breaking the protocol */
    uint64_t upload_bytes;      /* bytes of upload chunks */
    uint64_t sent_bytes;        /* all bytes sent */
    uint64_t sessions, refused; /* sessions opened; clients turned away without a session */
    uint64_t ended[END_COUNT];
    uint64_t replies[UINT8_MAX + 1]; /* by message type */
    uint64_t error_codes[_sheen_ErrorCode_ARRAYSIZE];
    struct histogram stage[STAGE_COUNT]; /* of all frames that needed the stage */
    struct stats_slice slices[STATS_SLICES];
    sheen_Times last[STATS_FRAMES];
};

/* The figures of the last minute, or of less time soon after the start. */
struct stats_recent {
    uint64_t window_us; /* length of the time that the figures cover */
    uint64_t requests, frames;
    uint64_t sent_bytes;              /* since the first reply in the window */
    sheen_Latency latency[N_CLASSES]; /* by enum request_class */
    sheen_Times p50, p95, p99;        /* for each stage separately; 0: no frame needed it */
};

void stats_init(struct stats *stats);
/* Counts a reply of this type; `code` is that of an ERROR. */
void stats_reply(struct stats *stats, uint8_t type, sheen_ErrorCode code, uint64_t now_us);
/* Counts the times of a FRAME. The FRAME itself is counted by stats_reply(). */
void stats_frame(struct stats *stats, enum request_class request_class, const sheen_Times *times,
                 uint64_t now_us);
/* The mean times of the last STATS_FRAMES frames or fewer; zeros before the first frame. */
sheen_Times stats_mean(const struct stats *stats);
/* Computes the figures of the last minute. */
void stats_recent(const struct stats *stats, uint64_t now_us, struct stats_recent *recent);

/* Names for metrics' labels and for logs. Static strings. */
const char *stats_stage_name(enum stats_stage stage);
const char *stats_end_name(enum stats_end end);
const char *stats_error_name(sheen_ErrorCode code);

#endif
