/* The command line: one table per command that drives parsing, --help, the manual pages and the
 * shells' completions alike.
 *
 * Strings in struct options point into argv. Thread: one (getopt_long() has global state). */
#ifndef SHEEN_CLIENT_OPTIONS_H
#define SHEEN_CLIENT_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "client/cli/options/frame_names.h"
#include "client/lib/sheen.h"
#include "protocol/ranges.h"

#define OPTIONS_WHY_BYTES 240

/* Which options were on the command line, where the commands must know. */
enum options_given {
    GIVEN_EYE = 1 << 0,
    GIVEN_TARGET = 1 << 1,
    GIVEN_UP = 1 << 2,
    GIVEN_FOV = 1 << 3,
    GIVEN_ORTHO = 1 << 4,
    GIVEN_LIGHT_CENTER = 1 << 5,
    GIVEN_LIGHT_U = 1 << 6,
    GIVEN_LIGHT_V = 1 << 7,
    GIVEN_FRAMES = 1 << 8,
    GIVEN_LIGHT = 1 << 9,
    GIVEN_SIZE = 1 << 10,
    GIVEN_CLASS = 1 << 11,
    GIVEN_JPEG = 1 << 12,
    GIVEN_VIEW = 1 << 13,
    GIVEN_ZOOM = 1 << 14,
    GIVEN_LEGEND = 1 << 15,
    GIVEN_ANTIALIAS = 1 << 16,
};

struct options {
    const char *model;            /* the file, NULL for commands without */
    const char *server;           /* --server, else SHEEN_SERVER, else NULL: a private daemon */
    const char *device;           /* NULL: auto */
    const char *native_isa;       /* NULL: auto */
    uint32_t native_threads;      /* 0: auto */
    uint64_t memory_budget_bytes; /* of the private daemon; 0: as libsheen has it */
    const char *ca, *cert, *key;  /* of a tls: server; NULL: none */
    bool share;                   /* what is uploaded */
    bool weld;                    /* equal positions of the model */
    const char *token_file;       /* --token-file, else SHEEN_TOKEN_FILE, else NULL */
    bool json, quiet;
    unsigned given; /* enum options_given */
    struct sheen_request request;
    const char *image_path[SHEEN_MAX_LIGHTS]; /* --pattern image:FILE of a light, else NULL */
    const char *output;                       /* where the picture goes; stream: NULL, nowhere */
    struct frame_names frame_names;           /* stream: of `output` */
    uint32_t aov_planes;                      /* render: planes beside colour */
    uint32_t frames;                          /* stream: 1 to 1000000 */
    uint32_t reconnect_s;                     /* after a loss; 0 to 86400, 0: not at all */
    double orbit_deg;                         /* stream: per frame */
    bool light_only;                          /* stream: the light moves, not the camera */
};

/* One option. `apply` takes the value (NULL for a flag) and returns false with the reason in `why`.
 * Tables end with a row without a name. */
struct option_row {
    const char *name;
    char letter;          /* short form, 0: none */
    const char *argument; /* what --help calls the value; NULL: a flag */
    /* Meaning, range, unit, default. '\n' begins a new line; {} stands for the next range of
     * RANGES and OPTION_RANGES that names the option. */
    const char *help;
    bool (*apply)(struct options *options, const char *value, char *why);
    const char *words; /* values to complete, with blanks between; NULL: none, or files */
};

/* Exit codes besides 0 and 2, which every command has. */
enum command_codes {
    CODE_OUTPUT = 1 << 0, /* 3: standard output cannot be written */
    CODE_FILES = 1 << 1,  /* 3: a model, an image or the file that is written, too */
    CODE_SERVER = 1 << 2, /* 4 and 5 */
};

struct command {
    const char *name;
    const char *old_name;  /* which still works; NULL: none */
    const char *arguments; /* for the usage line */
    const char *summary;
    const struct option_row *const *tables; /* ends with NULL */
    const char *examples;
    bool takes_model;
    unsigned codes; /* enum command_codes */
    /* What no single option can know; false with the reason in `why`. NULL: nothing. */
    bool (*check)(struct options *options, char *why);
    int (*run)(const struct options *options); /* returns the exit code */
};

/* Ranges of what is not in a request. */
enum option_range_name { OPTION_RANGE_FRAMES, OPTION_RANGE_ORBIT, OPTION_RANGE_RECONNECT };
#define N_OPTION_RANGES 3
extern const struct range OPTION_RANGES[N_OPTION_RANGES];

enum options_result { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_WRONG };

extern const struct option_row OPTIONS_MODEL[];     /* weld: of commands that take a model */
extern const struct option_row OPTIONS_COMMON[];    /* server, device, quiet */
extern const struct option_row OPTIONS_RECONNECT[]; /* of commands that call client_resume() */
extern const struct option_row OPTIONS_OUTPUT[];    /* json, help: of every command */
extern const struct option_row OPTIONS_SIZE[];      /* of commands with no default of their own */
extern const struct option_row OPTIONS_SCENE[];     /* camera, light, pattern, colours */
extern const struct option_row OPTIONS_SURFACE[];   /* surface, show, show-range */
extern const struct option_row OPTIONS_SCHEDULE[];  /* class, deadline */
extern const struct option_row OPTIONS_JPEG[];      /* jpeg-quality, jpeg-subsampling */

/* Parses argv, whose [0] is the command's name. OPTIONS_WRONG leaves one line in `why` that names
 * the option, OPTIONS_HELP asks for options_help(). */
enum options_result options_parse(const struct command *command, int argc, char **argv,
                                  struct options *options, char why[static OPTIONS_WHY_BYTES]);

void options_help(const struct command *command, FILE *out);

/* What options_help() and the manual pages say. */

/* All rows of a command; returns how many. */
#define OPTIONS_MAX_ROWS 64
size_t options_rows(const struct command *command,
                    const struct option_row *rows[static OPTIONS_MAX_ROWS]);

/* The row's help with its ranges in place, lines with '\n' between. */
#define OPTIONS_HELP_BYTES 1024
void options_row_help(const struct option_row *row, char help[static OPTIONS_HELP_BYTES]);

/* The command's exit codes in ascending order; returns how many. */
struct exit_code {
    int code;
    const char *meaning;
};
#define OPTIONS_MAX_CODES 5
size_t options_codes(const struct command *command,
                     struct exit_code codes[static OPTIONS_MAX_CODES]);

/* What MODEL is, of commands that take one. */
#define OPTIONS_MODEL_TEXT                                                                         \
    "MODEL is a file, or server:NAME for one below the folder that the daemon at --server gives\n" \
    "with --models."

/* Of an option_row: --size. */
bool options_apply_size(struct options *options, const char *value, char *why);

/* The check of commands that take OPTIONS_SCENE: camera and light are given whole or not at all. */
bool options_check_scene(struct options *options, char *why);

/* The check of commands that take OPTIONS_JPEG: they belong to JPEG files. */
bool options_check_jpeg(const struct options *options, char *why);

/* Ends the options of one light: its place is given whole or not at all. */
bool options_check_light(struct options *options, char *why);

/* Reads a number of this range, or a whole one; false says in `why` what it must be. */
bool options_number(const struct range *range, const char *value, double *number, char *why);
bool options_whole(const struct range *range, const char *value, uint32_t *number, char *why);

/* Writes one formatted reason and returns false. */
bool options_refuse(char *why, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
