/* What the daemon counts about itself. Thread: the loop's. */
#ifndef SHEEN_SERVICE_STATS_H
#define SHEEN_SERVICE_STATS_H

#include "protocol/message.h"

#define STATS_FRAMES 64 /* that the mean times are of */

struct stats {
    uint64_t start_us;
    uint64_t frames, errors;              /* answered with FRAME, with ERROR */
    uint64_t superseded, cancelled, late; /* answered so: ERRORs but for the first */
    uint64_t disconnected;                /* clients: over a limit, or broke the protocol */
    uint64_t upload_bytes;                /* of chunks */
    uint64_t sent_bytes;                  /* all that went out */
    sheen_Times last[STATS_FRAMES];
};

void stats_init(struct stats *stats);
void stats_frame(struct stats *stats, const sheen_Times *times);
/* Mean over the last frames, at most STATS_FRAMES; zeros before the first. */
sheen_Times stats_mean(const struct stats *stats);

#endif
