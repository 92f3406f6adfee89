/* Reads sheend's options. One table (options_table.h) serves the command line, the configuration
 * file, --help and the reload.
 * Thread: one at a time (getopt_long() has global state). */
#ifndef SHEEN_OPS_OPTIONS_H
#define SHEEN_OPS_OPTIONS_H

#include "server/base/error.h"
#include "server/ops/settings.h"

#define OPTIONS_CHANGED_BYTES 480

enum options_result {
    OPTIONS_SERVE,
    OPTIONS_CHECK, /* --check-config: the configuration is good; report it and exit */
    OPTIONS_DONE,  /* --help or --version: the text is printed; exit */
    OPTIONS_WRONG, /* an error, described by *error */
};

/* Fills *settings with the defaults, then with the values of the file that --config names, then
 * with those of the command line, which win over the file's. argc and argv are those of main(). May
 * be called again to read the file anew. Errors: ERROR_REQUEST names the option, or the file and
 * the line; ERROR_SERVER if a host name cannot be resolved. */
enum options_result options_read(int argc, char **argv, struct settings *settings,
                                 struct error *error);

/* Copies from *fresh to *settings the options that a reload may change. The others keep their
 * value; `kept` gets the names of those that differ in *fresh, "" if none does. */
void options_reload(struct settings *settings, const struct settings *fresh,
                    char kept[static OPTIONS_CHANGED_BYTES]);

#endif
