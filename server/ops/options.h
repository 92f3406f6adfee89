/* What sheend can be told: one table that the command line, the configuration file, --help and a
 * reload all read. Thread: one (getopt_long() has global state). */
#ifndef SHEEN_OPS_OPTIONS_H
#define SHEEN_OPS_OPTIONS_H

#include "server/base/error.h"
#include "server/ops/settings.h"

#define OPTIONS_CHANGED_BYTES 480

enum options_result {
    OPTIONS_SERVE,
    OPTIONS_CHECK, /* only say that the configuration is good */
    OPTIONS_DONE,  /* the option (--help, --version) has done all */
    OPTIONS_WRONG, /* *error says what */
};

/* The defaults, then the file that --config names, then argv[1] and on, which replaces what the
 * file says. Takes argv as main() got it; may be called again to read the file anew. ERROR_REQUEST
 * names the option, or the file and its line; ERROR_SERVER when a host name cannot be resolved. */
enum options_result options_read(int argc, char **argv, struct settings *settings,
                                 struct error *error);

/* Moves what a reload may change from *fresh into *settings. The other options whose value is
 * another one in *fresh keep their old value and are named in `kept`, "" for none. */
void options_reload(struct settings *settings, const struct settings *fresh,
                    char kept[static OPTIONS_CHANGED_BYTES]);

#endif
