/* Notices about a frame on standard error: warnings about the model's file, an up direction that
 * was guessed, a picture that shows no surface, a light that few rays meet.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_NOTICES_H
#define SHEEN_CLIENT_NOTICES_H

#include "client/cli/client.h"

/* Asks the daemon about the client's model. No request may be in flight. It is called after a frame
 * was received; if the daemon is lost meanwhile, info->warnings says that the rest is unknown, and
 * all counts are 0. */
void notices_ask(struct client *client, const struct options *options,
                 struct sheen_model_info *info);

/* Prints one line for each notice, none with --quiet. For several frames, call it with the
 * first. */
void notices_print(struct client *client, const struct options *options,
                   const struct sheen_frame *frame, const struct sheen_model_info *info);

/* The notices that are not about the picture: the model's warnings and the guessed up direction.
 * For frames that show a part of the picture alone. */
void notices_print_model(struct client *client, const struct options *options,
                         const struct sheen_frame *frame, const struct sheen_model_info *info);

#endif
