#include "client/cli/options/options.h"

#include <getopt.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/options/lights_text.h"
#include "client/cli/options/values.h"

#define FIRST_LONG 256 /* getopt's number of row 0; smaller ones are letters */
#define DEFAULT_RECONNECT_S 30

const struct range OPTION_RANGES[N_OPTION_RANGES] = {
    [OPTION_RANGE_FRAMES] = {NULL, "--frames", 1, 1000000, false, ""},
    [OPTION_RANGE_ORBIT] = {NULL, "--orbit", -360, 360, false, "degrees"},
    [OPTION_RANGE_RECONNECT] = {NULL, "--reconnect", 0, 86400, false, "seconds"},
    [OPTION_RANGE_SAMPLES] = {NULL, "--samples", 2, 4096, false, ""},
};

bool options_refuse(char *why, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why, OPTIONS_WHY_BYTES, format, arguments);
    va_end(arguments);
    return false;
}

bool options_number(const struct range *range, const char *value, double *number, char *why)
{
    char wanted[RANGE_TEXT_BYTES];
    return (value_double(value, number) && range_holds(range, *number)) ||
           options_refuse(why, "must be a number %s", range_text(range, wanted));
}

bool options_whole(const struct range *range, const char *value, uint32_t *number, char *why)
{
    char wanted[RANGE_TEXT_BYTES];
    return (value_uint32(value, number) && range_holds(range, *number)) ||
           options_refuse(why, "must be a whole number %s", range_text(range, wanted));
}

bool options_check_light(struct options *options, char *why)
{
    unsigned whole = GIVEN_LIGHT_CENTER | GIVEN_LIGHT_U | GIVEN_LIGHT_V;
    unsigned light = options->given & whole;
    if (light != 0 && light != whole)
        return options_refuse(why, "--light-center, --light-u and --light-v come together");
    options->request.lights[options->request.n_lights - 1].is_placed = light != 0;
    return true;
}

/* Checked at the end, because range and legend may be given before --show. */
static bool check_show(const struct options *options, char *why)
{
    const struct sheen_show *show = &options->request.show;
    if (options->given & GIVEN_LEGEND && show->kind == SHEEN_SHOW_LINES)
        return options_refuse(why, "--legend is for the false colour of --show; lines have none");
    char wanted[RANGE_TEXT_BYTES];
    const struct range *range =
        &RANGES[show->kind == SHEEN_SHOW_DRAFT ? RANGE_SHOW_DRAFT : RANGE_SHOW_CURVATURE];
    return show->range == 0 || range_holds(range, show->range) ||
           options_refuse(why, "--show-range '%.9g': must be a number %s for --show %s",
                          show->range, range_text(range, wanted), text_show_kind(show->kind));
}

static bool check_samples(const struct options *options, char *why)
{
    const struct sheen_request *request = &options->request;
    bool is_given_exact = options->given & GIVEN_ANTIALIAS && !request->aliased;
    return !request->unfiltered || !is_given_exact ||
           options_refuse(why,
                          "--antialias exact and --filter off exclude each other: --filter off "
                          "takes one sample for each pixel, edges included");
}

static bool check_size(const struct sheen_request *request, char *why)
{
    const struct range *range = &RANGES[RANGE_JPEG_SIDE];
    return request->format != SHEEN_FORMAT_JPEG ||
           (range_holds(range, request->width_px) && range_holds(range, request->height_px)) ||
           options_refuse(why, "--size: a JPEG file has at most %g pixels a side", range->greatest);
}

bool options_check_scene(struct options *options, char *why)
{
    const unsigned any =
        GIVEN_EYE | GIVEN_TARGET | GIVEN_UP | GIVEN_FOV | GIVEN_ORTHO | GIVEN_VIEW | GIVEN_ZOOM;
    bool has_eye = options->given & GIVEN_EYE;
    if (has_eye && !(options->given & GIVEN_TARGET))
        return options_refuse(why, "--eye needs a --target to look at");
    if (has_eye && options->given & GIVEN_VIEW)
        return options_refuse(why, "--eye and --view exclude each other: --view stands by itself");
    if (options->given & GIVEN_FOV && options->given & GIVEN_ORTHO)
        return options_refuse(why, "--fov and --ortho exclude each other");
    if (options->given & any)
        options->request.camera.projection = options->given & GIVEN_ORTHO
                                                 ? SHEEN_PROJECTION_ORTHOGRAPHIC
                                                 : SHEEN_PROJECTION_PERSPECTIVE;
    options->request.camera.auto_view = !has_eye;
    options->request.camera.has_target = options->given & GIVEN_TARGET;
    options->request.camera.auto_up = !(options->given & GIVEN_UP);
    return check_size(&options->request, why) && check_samples(options, why) &&
           check_show(options, why) && options_check_light(options, why);
}

size_t options_rows(const struct command *command,
                    const struct option_row *rows[static OPTIONS_MAX_ROWS])
{
    size_t n = 0;
    for (const struct option_row *const *table = command->tables; *table; table++)
        for (const struct option_row *row = *table; row->name && n < OPTIONS_MAX_ROWS; row++)
            rows[n++] = row;
    return n;
}

static const struct option_row *row_of(int chosen, const struct option_row *const *rows, size_t n)
{
    if (chosen >= FIRST_LONG)
        return rows[chosen - FIRST_LONG];
    for (size_t i = 0; i < n; i++)
        if (rows[i]->letter == chosen)
            return rows[i];
    return NULL;
}

/* Fills in getopt's tables from ours. */
static void describe(const struct option_row *const *rows, size_t n, struct option *longs,
                     char *shorts)
{
    *shorts++ = ':'; /* makes getopt distinguish a missing value from an unknown option */
    for (size_t i = 0; i < n; i++) {
        longs[i] = (struct option){.name = rows[i]->name,
                                   .has_arg = rows[i]->argument ? required_argument : no_argument,
                                   .val = FIRST_LONG + (int)i};
        if (!rows[i]->letter)
            continue;
        *shorts++ = rows[i]->letter;
        if (rows[i]->argument)
            *shorts++ = ':';
    }
    *shorts = 0;
    longs[n] = (struct option){0};
}

static enum options_result wrong(char *why, const char *format, const char *what)
{
    options_refuse(why, format, what);
    return OPTIONS_WRONG;
}

#define NAME_LETTERS 32 /* letters of a given name that are compared */

/* The number of letters to insert, remove or replace that make `name` of the first n letters of
 * `given`; n is at most NAME_LETTERS. */
static size_t distance(const char *given, size_t n, const char *name)
{
    size_t row[NAME_LETTERS + 1];
    for (size_t i = 0; i <= n; i++)
        row[i] = i;
    for (; *name; name++) {
        size_t diagonal = row[0]++;
        for (size_t i = 1; i <= n; i++) {
            size_t replaced = diagonal + (given[i - 1] != *name);
            size_t moved = 1 + (row[i] < row[i - 1] ? row[i] : row[i - 1]);
            diagonal = row[i];
            row[i] = replaced < moved ? replaced : moved;
        }
    }
    return row[n];
}

/* The option whose name is nearest to `given`, which has the form --NAME or --NAME=VALUE. NULL: no
 * name continues the given one or differs from it in few letters. */
static const struct option_row *nearest(const char *given, const struct option_row *const *rows,
                                        size_t n)
{
    const struct option_row *found = NULL;
    size_t least = SIZE_MAX;
    if (strncmp(given, "--", 2) != 0)
        return NULL;
    given += 2;
    size_t length = strcspn(given, "=");
    if (length == 0 || length > NAME_LETTERS)
        return NULL;
    for (size_t i = 0; i < n; i++) {
        size_t letters = distance(given, length, rows[i]->name);
        bool is_like = strncmp(given, rows[i]->name, length) == 0 || letters <= (length + 1) / 3;
        if (is_like && letters < least) {
            least = letters;
            found = rows[i];
        }
    }
    return found;
}

/* Refuses the first letters of several options. False if `given` is not that. */
static bool is_ambiguous(const char *given, const struct option_row *const *rows, size_t n,
                         char *why)
{
    char names[OPTIONS_WHY_BYTES / 2] = "";
    size_t used = 0, n_names = 0, length = strcspn(given, "=");
    if (strncmp(given, "--", 2) != 0 || length < 3)
        return false;
    for (size_t i = 0; i < n; i++) {
        if (strncmp(given + 2, rows[i]->name, length - 2) != 0)
            continue;
        n_names++;
        int written = snprintf(names + used, sizeof(names) - used, " --%s", rows[i]->name);
        if (written > 0 && (size_t)written < sizeof(names) - used)
            used += (size_t)written;
        else
            names[used] = 0;
    }
    if (n_names > 1)
        options_refuse(why, "%.*s may be%s: write more of it", (int)(length < 60 ? length : 60),
                       given, names);
    return n_names > 1;
}

static bool refuse_unknown(const char *given, const struct option_row *const *rows, size_t n,
                           char *why)
{
    if (is_ambiguous(given, rows, n, why))
        return false;
    const struct option_row *meant = nearest(given, rows, n);
    return meant ? options_refuse(why, "%.100s is no option here (did you mean --%s?)", given,
                                  meant->name)
                 : options_refuse(why, "%.150s is no option here", given);
}

/* The row that getopt chose. NULL with the reason in `why` if it chose none, or if the value has a
 * fault of form. */
static const struct option_row *
chosen_row(int chosen, const char *given, const struct option_row *const *rows, size_t n, char *why)
{
    bool has_no_value = chosen == ':', is_unknown = chosen == '?';
    const struct option_row *row =
        row_of(is_unknown && optopt >= FIRST_LONG ? optopt : chosen, rows, n);
    if (has_no_value)
        options_refuse(why, "%.150s needs a value", given);
    else if (!row)
        refuse_unknown(given, rows, n, why);
    else if (is_unknown)
        options_refuse(why, "--%s takes no value", row->name);
    else if (chosen < FIRST_LONG && optarg && *optarg == '=' && optarg != given)
        options_refuse(why, "-%c takes its value without '=': -%c %.100s", chosen, chosen,
                       optarg + 1);
    else
        return row;
    return NULL;
}

static enum options_result parse_options(int argc, char **argv,
                                         const struct option_row *const *rows, size_t n,
                                         struct options *options, char *why)
{
    struct option longs[OPTIONS_MAX_ROWS + 1];
    char shorts[2 * OPTIONS_MAX_ROWS + 2];
    describe(rows, n, longs, shorts);
    opterr = 0;
    optind = 0; /* restarts getopt */
    for (;;) {
        int chosen = getopt_long(argc, argv, shorts, longs, NULL);
        if (chosen == -1)
            return OPTIONS_RUN;
        const struct option_row *row = chosen_row(chosen, argv[optind - 1], rows, n, why);
        if (!row)
            return OPTIONS_WRONG;
        if (strcmp(row->name, "help") == 0)
            return OPTIONS_HELP;
        char reason[OPTIONS_WHY_BYTES];
        if (!row->apply(options, optarg, reason)) {
            options_refuse(why, "--%s '%.60s': %.150s", row->name, optarg ? optarg : "", reason);
            return OPTIONS_WRONG;
        }
    }
}

enum options_result options_parse(const struct command *command, int argc, char **argv,
                                  struct options *options, char why[static OPTIONS_WHY_BYTES])
{
    const struct option_row *rows[OPTIONS_MAX_ROWS];
    size_t n = options_rows(command, rows);
    *options = (struct options){.request = SHEEN_REQUEST_DEFAULTS,
                                .break_limits = SHEEN_BREAK_LIMITS_DEFAULTS,
                                .curve_options = SHEEN_CURVE_OPTIONS_DEFAULTS,
                                .reconnect_s = DEFAULT_RECONNECT_S,
                                .orbit_deg = 1};
    enum options_result result = parse_options(argc, argv, rows, n, options, why);
    if (result != OPTIONS_RUN)
        return result;
    if (command->takes_model) {
        if (optind >= argc)
            return wrong(why, "%s", "a MODEL file is missing");
        options->model = argv[optind++];
    }
    if (command->takes_argument && optind < argc)
        options->argument = argv[optind++];
    if (optind < argc)
        return wrong(why, "'%.150s' is one argument too many", argv[optind]);
    const char *server = getenv("SHEEN_SERVER");
    if (!options->server && server && *server)
        options->server = server;
    const char *token_file = getenv("SHEEN_TOKEN_FILE");
    if (!options->token_file && token_file && *token_file)
        options->token_file = token_file;
    if (!options->cert != !options->key)
        return wrong(why, "%s", "--cert and --key come together");
    if (options->server && options->device)
        return wrong(why, "--device is for a private daemon; the one at %.120s has its own",
                     options->server);
    if (options->server && (options->native_isa || options->native_threads))
        return wrong(why,
                     "--native-isa and --native-threads are for a private daemon; the one at "
                     "%.120s has its own",
                     options->server);
    if (options->server && options->memory_budget_bytes)
        return wrong(
            why,
            "--memory-budget is for a private daemon; the one at %.120s has its own, which "
            "its operator gives to sheend",
            options->server);
    return !command->check || command->check(options, why) ? OPTIONS_RUN : OPTIONS_WRONG;
}
