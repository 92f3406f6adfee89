/* What sheen stream prints. */
#ifndef SHEEN_CLI_STREAM_REPORT_H
#define SHEEN_CLI_STREAM_REPORT_H

#include "client/cli/stream/frames.h"

/* Moves the records of drawn frames to the front; keeps their order. The other functions need it. */
void stream_keep_drawn(struct stream *stream, uint32_t n_frames);
/* Prints the table of times. sorted[] is scratch memory for n_frames values. */
void stream_print_table(const struct stream *stream, uint32_t n_frames, uint64_t *sorted,
                        const struct options *options);
/* The same as a JSON object, with the times of each frame. */
void stream_print_json(struct json *json, const struct stream *stream, uint32_t n_frames,
                       const struct client *client, const struct options *options);

#endif
