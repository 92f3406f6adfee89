/* The table of sheend's options, for options.c and for the manual pages (deploy/manual). Plain
 * data; the first call of option_rows() fills the table, so call it on one thread first. */
#ifndef SHEEN_OPS_OPTIONS_TABLE_H
#define SHEEN_OPS_OPTIONS_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/ops/settings.h"

#define OPTION_MAX_ROWS 80

enum option_type {
    OPTION_NUMBER, /* a uint64_t from min to max */
    OPTION_LIMIT,  /* a row of limits.h */
    OPTION_TEXT,   /* char[size], not empty */
    OPTION_FLAG,   /* a bool; 'yes' or 'no' in a file */
    /* may occur several times, and set() appends; values of the command line replace all those of
     * the file */
    OPTION_LIST,
    OPTION_OTHER,  /* a value that set() parses */
    OPTION_ACTION, /* --help, --version */
};

enum option_flags {
    OPTION_IN_FILE = 1, /* allowed in the configuration file */
    OPTION_RELOADS = 2, /* a reload (SIGHUP) takes a new value over */
};

struct option_row {
    const char *name;
    const char *argument; /* name of the value in --help; NULL: no value */
    enum option_type type;
    unsigned flags;
    size_t offset, size; /* of the value in struct settings */
    uint64_t min, max;
    const char *unit;    /* unit of a number, or NULL */
    const char *initial; /* the default as text; NULL: zero, or described in `help` */
    const char *help;    /* '\n' begins a new line */
    bool (*set)(void *value, const char *text, struct error *error);
};

/* All rows: the options of this table, then the limits. */
const struct option_row *option_rows(size_t *n);

/* The limit (limits.h) that the row sets, which has the range; NULL for other rows. */
const struct limits_row *option_limit(const struct option_row *row);

/* Writes the row's help with range and default to `text`, lines separated by '\n'. Returns
 * `text`. */
#define OPTION_HELP_BYTES 1024
const char *option_help(const struct option_row *row, char text[static OPTION_HELP_BYTES]);

/* Parses `text` into the row's value in *settings. ERROR_REQUEST names the option and its range. */
bool option_set(const struct option_row *row, struct settings *settings, const char *text,
                struct error *error);

#endif
