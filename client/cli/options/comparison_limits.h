/* How a limit of `sheen compare` is written on the command line. Pure, any thread. */
#ifndef SHEEN_CLIENT_COMPARISON_LIMITS_H
#define SHEEN_CLIENT_COMPARISON_LIMITS_H

#include "client/cli/options/comparison_items.h"

/* Reads KEY=VALUE, KEY=VALUE@PERCENT% or KEY=off into limits. False with the reason in `why` (OPTIONS_WHY_BYTES). */
bool comparison_limit_read(struct comparison_limit limits[static COMPARISON_ITEMS],
                           const char *text, char *why);

#endif
