/* The rows of the options' table: for options.c, and for the manual pages (deploy/manual). */
#ifndef SHEEN_OPS_OPTIONS_TABLE_H
#define SHEEN_OPS_OPTIONS_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/ops/settings.h"

#define OPTION_MAX_ROWS 80

enum option_type {
    OPTION_NUMBER, /* uint64_t from min to max */
    OPTION_LIMIT,  /* a row of limits.h */
    OPTION_TEXT,   /* char[size], not empty */
    OPTION_FLAG,   /* bool; in a file 'yes' or 'no' */
    OPTION_LIST,   /* given several times; set() adds. What the command line says replaces all that
                      the file says */
    OPTION_OTHER,  /* set() reads the value */
    OPTION_ACTION, /* --help, --version; set() acts */
};

enum option_flags {
    OPTION_IN_FILE = 1, /* the configuration file may have it */
    OPTION_RELOADS = 2, /* SIGHUP takes a new value */
};

struct option_row {
    const char *name;
    const char *argument; /* what --help calls the value; NULL: it takes none */
    enum option_type type;
    unsigned flags;
    size_t offset, size; /* of the value in struct settings */
    uint64_t min, max;
    const char *unit;    /* of a number, or NULL */
    const char *initial; /* the default as one would write it, or NULL: zero, or said in `help` */
    const char *help;    /* '\n' begins a new line */
    bool (*set)(void *value, const char *text, struct error *error);
};

/* All rows: those of this table, then the limits. */
const struct option_row *option_rows(size_t *n);

/* The row's limit, which says what values it takes; NULL when it is none. */
const struct limits_row *option_limit(const struct option_row *row);

/* The row's help with its range and its default, lines with '\n' between. Returns `text`. */
#define OPTION_HELP_BYTES 1024
const char *option_help(const struct option_row *row, char text[static OPTION_HELP_BYTES]);

/* Reads `text` into the row's value. ERROR_REQUEST names the option and its range. */
bool option_set(const struct option_row *row, struct settings *settings, const char *text,
                struct error *error);

#endif
