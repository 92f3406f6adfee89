/* What people are told of a frame beside the picture: the warnings about the model's file, the up
 * that was guessed, a picture without surface, a light that little of what is seen meets.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_NOTICES_H
#define SHEEN_CLIENT_NOTICES_H

#include "client/cli/client.h"

/* Asks for what there is to say about the client's model; no request may be in flight. It is asked
 * for after a frame, which outlives a daemon that is lost meanwhile: the warnings then say that the
 * rest is unknown, and the counts are 0. */
void notices_ask(struct client *client, const struct options *options,
                 struct sheen_model_info *info);

/* A line each on standard error, none with --quiet. Of several frames this is called with the
 * first. */
void notices_print(struct client *client, const struct options *options,
                   const struct sheen_frame *frame, const struct sheen_model_info *info);

#endif
