/* The command line. One table for each command drives parsing, --help, the manual pages and the
 * shells' completions.
 *
 * Strings in struct options point into argv.
 * Thread: one at a time (getopt_long() has global state). */
#ifndef SHEEN_CLIENT_OPTIONS_H
#define SHEEN_CLIENT_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "client/cli/options/frame_names.h"
#include "client/cli/options/comparison_items.h"
#include "client/lib/sheen.h"
#include "protocol/ranges.h"

#define OPTIONS_WHY_BYTES 240

/* Bits: which options were given on the command line, as far as the commands need to know. */
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
    GIVEN_SAMPLES = 1 << 17,
};

struct options {
    const char *model;            /* the model's file; NULL for commands without one */
    const char *argument;         /* what follows the model; NULL: nothing */
    const char *server;           /* --server, else SHEEN_SERVER, else NULL: a private daemon */
    const char *device;           /* NULL: auto */
    const char *native_isa;       /* NULL: auto */
    uint32_t native_threads;      /* 0: auto */
    uint64_t memory_budget_bytes; /* of the private daemon; 0: libsheen's default */
    const char *ca, *cert, *key;  /* for a TLS server; NULL: none */
    bool share;                   /* other clients may use the uploads */
    bool weld;                    /* join the model's vertices at equal positions */
    const char *token_file;       /* --token-file, else SHEEN_TOKEN_FILE, else NULL */
    bool json, quiet;
    unsigned given; /* enum options_given */
    struct sheen_request request;
    /* FILE of --pattern image:FILE for each light; else NULL. */
    const char *image_path[SHEEN_MAX_LIGHTS];
    const char *output;             /* file of the picture; stream: NULL: no file */
    struct frame_names frame_names; /* stream: `output` parsed */
    uint32_t aov_planes;            /* render: planes in addition to colour */
    uint32_t frames;                /* stream: 1 to 1000000 */
    /* Time to reconnect after a loss, 0 to 86400; 0: never. */
    uint32_t reconnect_s;
    double orbit_deg;                       /* stream: degrees for each frame */
    bool light_only;                        /* stream: the light moves, not the camera */
    bool has_section;                       /* pick: `at` is a line, else a pixel */
    double at[4];                           /* pick: px */
    uint32_t samples;                       /* pick: of a section, 2 to 4096 */
    struct sheen_break_limits break_limits; /* breaks */
    const char *junit;                      /* file of a JUnit report; NULL: none */
    const char *markdown;                   /* compare: file of a summary; NULL: none */
    const char *report;                     /* compare: folder; NULL: none */
    const char *html;                       /* compare: file of the report; NULL: none */
    const char *views;                      /* compare: file of the report's views; NULL: none */
    struct comparison_limit compare_limits[COMPARISON_ITEMS];
    bool align;                               /* compare */
    struct sheen_curve_options curve_options; /* lines; its `at` is not set */
    double places[SHEEN_MAX_CURVE_PLACES];    /* lines: curve_options.n_at of them */
    bool visible_only;                        /* lines */
};

/* One option. `apply` gets the value (NULL for a flag) and returns false with the reason in `why`.
 * Tables end with a row without a name. */
struct option_row {
    const char *name;
    char letter;          /* short form, 0: none */
    const char *argument; /* name of the value in --help; NULL: a flag */
    /* Meaning, range, unit and default. '\n' begins a new line; {} stands for the next range of
     * RANGES or OPTION_RANGES that belongs to this option, {client} for the next one of
     * OPTION_RANGES, where an option of a request has the same name. */
    const char *help;
    bool (*apply)(struct options *options, const char *value, char *why);
    const char *words; /* values for completion, separated by blanks; NULL: none, or files */
};

/* Exit codes in addition to 0 and 2, which every command has, and to 1 (struct command). */
enum command_codes {
    CODE_OUTPUT = 1 << 0, /* 3: standard output cannot be written */
    /* 3: also for a bad model or image, and an output file that cannot be written. */
    CODE_FILES = 1 << 1,
    CODE_SERVER = 1 << 2, /* 4 and 5 */
    CODE_LATE = 1 << 3,   /* 4: also when --deadline passes */
};

struct command {
    const char *name;
    const char *old_name;  /* an old name that still works; NULL: none */
    const char *arguments; /* for the line "usage:" */
    const char *summary;
    const struct option_row *const *tables; /* ends with NULL */
    const char *examples;
    bool takes_model;
    bool takes_argument; /* one more argument may follow MODEL; check() refuses a missing one */
    unsigned codes;      /* enum command_codes */
    const char *no;      /* meaning of exit code 1; NULL: the command has none */
    /* Checks the options together; false with the reason in `why`. NULL: no check. */
    bool (*check)(struct options *options, char *why);
    int (*run)(const struct options *options); /* returns the exit code */
};

/* Ranges of options that are not part of a request. */
enum option_range_name {
    OPTION_RANGE_FRAMES,
    OPTION_RANGE_ORBIT,
    OPTION_RANGE_RECONNECT,
    OPTION_RANGE_SAMPLES,
};
#define N_OPTION_RANGES 4
extern const struct range OPTION_RANGES[N_OPTION_RANGES];

enum options_result { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_WRONG };

extern const struct option_row OPTIONS_MODEL[];     /* weld: for commands with a model */
extern const struct option_row OPTIONS_COMMON[];    /* server, device, quiet */
extern const struct option_row OPTIONS_RECONNECT[]; /* for commands that call client_resume() */
extern const struct option_row OPTIONS_OUTPUT[];    /* json, help: for every command */
/* For commands without a default size of their own. */
extern const struct option_row OPTIONS_SIZE[];
extern const struct option_row OPTIONS_SCENE[];    /* camera, light, pattern */
extern const struct option_row OPTIONS_COLOURS[];  /* colours, antialias, filter */
extern const struct option_row OPTIONS_SURFACE[];  /* surface, show, show-range */
extern const struct option_row OPTIONS_SCHEDULE[]; /* class, deadline */
extern const struct option_row OPTIONS_DEADLINE[]; /* of one computation */
extern const struct option_row OPTIONS_JPEG[];     /* jpeg-quality, jpeg-subsampling */

/* The tables of commands that render a model's frames, after a command's own rows. */
#define OPTIONS_OF_FRAMES                                                                          \
    OPTIONS_JPEG, OPTIONS_SIZE, OPTIONS_SCENE, OPTIONS_COLOURS, OPTIONS_SURFACE, OPTIONS_SCHEDULE, \
        OPTIONS_MODEL, OPTIONS_COMMON, OPTIONS_RECONNECT, OPTIONS_OUTPUT

/* Parses argv; argv[0] is the command's name. OPTIONS_WRONG: `why` has one line that names the
 * option. OPTIONS_HELP: call options_help(). */
enum options_result options_parse(const struct command *command, int argc, char **argv,
                                  struct options *options, char why[static OPTIONS_WHY_BYTES]);

void options_help(const struct command *command, FILE *out);

/* The parts that options_help() and the manual pages share. */

/* Gets all rows of a command. Returns their number. */
#define OPTIONS_MAX_ROWS 64
size_t options_rows(const struct command *command,
                    const struct option_row *rows[static OPTIONS_MAX_ROWS]);

/* Writes the row's help with its ranges inserted; lines are separated by '\n'. */
#define OPTIONS_HELP_BYTES 1024
void options_row_help(const struct option_row *row, char help[static OPTIONS_HELP_BYTES]);

/* Gets the command's exit codes in ascending order. Returns their number. */
struct exit_code {
    int code;
    const char *meaning;
};
#define OPTIONS_MAX_CODES 6
size_t options_codes(const struct command *command,
                     struct exit_code codes[static OPTIONS_MAX_CODES]);

/* Explains MODEL, for commands that take one. */
#define OPTIONS_MODEL_TEXT                                                                         \
    "MODEL is a file, or server:NAME for a file in the folder --models of the daemon at --server."

/* The `apply` function of --size. */
bool options_apply_size(struct options *options, const char *value, char *why);

/* The check of commands with OPTIONS_SCENE: camera and light must be given completely or not at
 * all. */
bool options_check_scene(struct options *options, char *why);

/* The check of commands with OPTIONS_JPEG: these options need a JPEG file. */
bool options_check_jpeg(const struct options *options, char *why);

/* Checks the options of the latest light: its place must be given completely or not at all. */
bool options_check_light(struct options *options, char *why);

/* Parse a number, or a whole number, within a range; false with the reason in `why`. */
bool options_number(const struct range *range, const char *value, double *number, char *why);
bool options_whole(const struct range *range, const char *value, uint32_t *number, char *why);

/* Writes a formatted reason to `why` and returns false. */
bool options_refuse(char *why, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
