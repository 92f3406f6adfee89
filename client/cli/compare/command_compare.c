/* sheen compare: how far two models, or the models of two folders, differ. */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "client/cli/base/failure.h"
#include "client/cli/client.h"
#include "client/cli/commands.h"
#include "client/cli/files/file.h"
#include "client/cli/options/comparison_limits.h"
#include "client/cli/output/comparison.h"
#include "client/cli/compare/report.h"
#include "protocol/model_format.h"

enum { DIFFERS = 1, MOST_PAIRS = 10000 };
static const double GLTF_LIMIT_M = 5e-5;

/* --- pairs of files */

/* All pairs, and the names that they point to. */
struct pairs {
    struct compared_pair *list;
    size_t n, room;
    char **names;
    size_t n_names;
    bool is_folders; /* of two folders */
};

static void pairs_finish(struct pairs *pairs)
{
    for (size_t i = 0; i < pairs->n_names; i++)
        free(pairs->names[i]);
    free(pairs->names);
    free(pairs->list);
}

/* Keeps a string that was malloc'd. NULL when memory is short. */
static const char *keep(struct pairs *pairs, char *name)
{
    char **grown = name ? realloc(pairs->names, (pairs->n_names + 1) * sizeof(*grown)) : NULL;
    if (!grown) {
        free(name);
        return NULL;
    }
    pairs->names = grown;
    return pairs->names[pairs->n_names++] = name;
}

static struct compared_pair *add_pair(struct pairs *pairs, const char *name)
{
    if (pairs->n == pairs->room) {
        size_t room = 2 * pairs->room + 1;
        struct compared_pair *grown = realloc(pairs->list, room * sizeof(*grown));
        if (!grown)
            return NULL;
        pairs->list = grown;
        pairs->room = room;
    }
    struct compared_pair *pair = &pairs->list[pairs->n++];
    *pair = (struct compared_pair){.name = name};
    return pair;
}

static bool is_model(const char *name)
{
    enum model_format format;
    return name[0] != '.' && model_format_of_name(name, &format);
}

static bool is_folder(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

/* Adds the models of a folder as that side of pairs. */
static enum sheen_status add_folder(struct pairs *pairs, const char *folder, int side,
                                    struct sheen_error *error)
{
    DIR *entries = opendir(folder);
    struct dirent *entry;
    enum sheen_status status = SHEEN_OK;
    if (!entries)
        return failure_set(error, SHEEN_BAD_MODEL, "%.300s: %s", folder, strerror(errno));
    while (!status && (entry = readdir(entries))) {
        char *path = NULL;
        struct compared_pair *pair = NULL;
        if (!is_model(entry->d_name))
            continue;
        for (size_t i = 0; i < pairs->n && !pair; i++)
            if (strcmp(pairs->list[i].name, entry->d_name) == 0)
                pair = &pairs->list[i];
        if (!pair && pairs->n == MOST_PAIRS) {
            status = failure_set(error, SHEEN_BAD_ARGUMENT, "%.300s has more than %d models",
                                 folder, MOST_PAIRS);
            break;
        }
        const char *name = pair ? pair->name : keep(pairs, strdup(entry->d_name));
        if (name && !pair)
            pair = add_pair(pairs, name);
        if (!pair || asprintf(&path, "%s/%s", folder, entry->d_name) < 0 ||
            !(pair->files[side] = keep(pairs, path)))
            status =
                failure_set(error, SHEEN_NO_MEMORY, "no memory for the names of %.300s", folder);
    }
    closedir(entries);
    return status;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const struct compared_pair *)a)->name, ((const struct compared_pair *)b)->name);
}

/* Two files are a pair; two folders are the pairs of equal names. */
static enum sheen_status find_pairs(struct pairs *pairs, const struct options *options,
                                    struct sheen_error *error)
{
    const char *const paths[2] = {options->model, options->argument};
    bool folders[2] = {is_folder(paths[0]), is_folder(paths[1])};
    struct stat status_of;
    for (int side = 0; side < 2; side++)
        if (folders[!side] && !folders[side] && stat(paths[side], &status_of) != 0)
            return failure_set(error, SHEEN_BAD_MODEL, "%.300s: %s", paths[side], strerror(errno));
    if (folders[0] != folders[1])
        return failure_set(error, SHEEN_BAD_ARGUMENT,
                           "OLD and NEW must be two models or two folders of models");
    if (!folders[0]) {
        const char *slash = strrchr(paths[1], '/');
        struct compared_pair *pair = add_pair(pairs, slash ? slash + 1 : paths[1]);
        if (!pair)
            return failure_set(error, SHEEN_NO_MEMORY, "no memory for a pair of models");
        pair->files[0] = paths[0];
        pair->files[1] = paths[1];
        return SHEEN_OK;
    }
    enum sheen_status status = SHEEN_OK;
    pairs->is_folders = true;
    for (int side = 0; side < 2 && !status; side++)
        status = add_folder(pairs, paths[side], side, error);
    if (!status && pairs->n == 0)
        status = failure_set(error, SHEEN_BAD_MODEL,
                             "neither folder has a model (.obj, .gltf, .glb, .usda, .bpt, "
                             ".patches)");
    if (!status)
        qsort(pairs->list, pairs->n, sizeof(*pairs->list), by_name);
    return status;
}

/* --- comparing */

static enum sheen_status ask(struct client *client, const struct options *options,
                             struct compared_pair *pair)
{
    struct sheen_request request = options->request;
    struct sheen_compare_options compare = SHEEN_COMPARE_OPTIONS_DEFAULTS;
    enum sheen_status status = SHEEN_OK;
    compare.align = options->align;
    compare.samples = options->samples;
    for (int k = 0; k < SHEEN_N_COMPARE_MEASURES; k++)
        compare.limits[k] = pair->limits[k].value;
    do {
        pair->failed_side = -1;
        for (int k = 0; k < 2 && !status; k++)
            if ((status = client_add_model(client, pair->files[k], pair->ids[k])))
                pair->failed_side = k;
        if (status)
            continue;
        memcpy(request.model_id, pair->ids[0], SHEEN_ID_BYTES);
        memcpy(compare.new_id, pair->ids[1], SHEEN_ID_BYTES);
        status = sheen_compare(client->session, &request, &compare, &client->report,
                               &pair->comparison, &client->error);
    } while (status && client_resume(client, options, &status));
    if (!status)
        client_answered(client);
    if (status == SHEEN_LATE && request.deadline_ms)
        failure_set(
            &client->error, status,
            "%.200s was not compared within --deadline %u (milliseconds): give it more time, "
            "or ask again when the daemon has less to do",
            pair->name, request.deadline_ms);
    return status;
}

static enum sheen_status compare_pair(struct client *client, const struct options *options,
                                      struct compared_pair *pair)
{
    memcpy(pair->limits, options->compare_limits, sizeof(pair->limits));
    pair->comparison = (struct sheen_comparison)SHEEN_COMPARISON_DEFAULTS;
    if (!pair->files[0] || !pair->files[1]) {
        pair->verdict = pair->files[0] ? COMPARISON_DELETED : COMPARISON_ADDED;
        return SHEEN_OK;
    }
    struct comparison_limit *distance = &pair->limits[SHEEN_COMPARE_DISTANCE];
    pair->has_unit = model_format_ends_with(pair->files[0], ".gltf") ||
                     model_format_ends_with(pair->files[0], ".glb");
    if (pair->has_unit && !distance->is_given)
        distance->value = GLTF_LIMIT_M;
    enum sheen_status status = ask(client, options, pair);
    if (!status)
        comparison_judge(pair);
    return status;
}

/* Which side's model the daemon cannot use either when it is asked about that model alone; -1: none. */
static int find_bad_side(const struct client *client, const struct compared_pair *pair,
                         enum sheen_status status)
{
    struct sheen_error error;
    for (int k = 0; k < 2; k++) {
        struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
        if (sheen_query_model(client->session, pair->ids[k], NULL, &info, &error) == status)
            return k;
    }
    return -1;
}

/* Notes why a pair of two folders failed, so that the others can be compared. Returns the status unless that is
 * possible: without a session no pair can be compared, and options that libsheen refuses are wrong for all. What the
 * daemon refuses (SHEEN_BAD_REQUEST) may be a matter of this pair alone: its size, or the memory that it takes. */
static enum sheen_status note_failure(const struct client *client, struct pairs *pairs,
                                      struct compared_pair *pair, enum sheen_status status)
{
    static const char *const sides[] = {"", "the old file: ", "the new file: "};
    char *text = NULL;
    if (!pairs->is_folders || sheen_status_is_fatal(status) || status == SHEEN_BAD_ARGUMENT)
        return status;
    if (pair->failed_side < 0 && status == SHEEN_BAD_MODEL)
        pair->failed_side = find_bad_side(client, pair, status);
    if (asprintf(&text, "%s%s", sides[pair->failed_side + 1], client->error.text) < 0)
        return SHEEN_NO_MEMORY;
    pair->failure = keep(pairs, text);
    pair->status = status;
    pair->verdict = COMPARISON_FAILED;
    return pair->failure ? SHEEN_OK : status;
}

/* Compares all pairs. */
static enum sheen_status compare_all(struct client *client, const struct options *options,
                                     struct pairs *pairs)
{
    enum sheen_status status = SHEEN_OK;
    for (size_t i = 0; i < pairs->n && !status; i++) {
        status = compare_pair(client, options, &pairs->list[i]);
        if (status)
            status = note_failure(client, pairs, &pairs->list[i], status);
    }
    return status;
}

/* The status of the failed pair with the highest exit code, the first of them, with the number of all that failed in
 * client->error. SHEEN_OK if none failed. */
static enum sheen_status worst_failure(struct client *client, const struct pairs *pairs)
{
    const struct compared_pair *worst = NULL;
    for (size_t i = 0; i < pairs->n; i++) {
        const struct compared_pair *pair = &pairs->list[i];
        if (pair->verdict == COMPARISON_FAILED &&
            (!worst ||
             sheen_status_exit_code(pair->status) > sheen_status_exit_code(worst->status)))
            worst = pair;
    }
    if (!worst)
        return SHEEN_OK;
    return failure_set(&client->error, worst->status,
                       "%zu of %zu pairs failed, such as %.100s: %.400s",
                       comparison_count(pairs->list, pairs->n, COMPARISON_FAILED), pairs->n,
                       worst->name, worst->failure);
}

/* --- the answer */

static enum sheen_status write_text(struct client *client, const char *path, char *text,
                                    size_t n_bytes)
{
    enum sheen_status status =
        text ? file_write(path, (const uint8_t *)text, n_bytes, &client->error)
             : failure_set(&client->error, SHEEN_NO_MEMORY, "no memory for %.300s", path);
    free(text);
    return status;
}

static enum sheen_status print(struct client *client, const struct options *options,
                               const struct views *views, const struct pairs *pairs)
{
    enum sheen_status status = SHEEN_OK;
    size_t n_bytes = 0;
    progress_clear(&client->progress);
    if (options->junit) {
        char *text = comparison_junit(pairs->list, pairs->n, (int64_t)time(NULL), &n_bytes);
        status = write_text(client, options->junit, text, n_bytes);
    }
    if (!status && options->markdown) {
        char *text = comparison_markdown(pairs->list, pairs->n, &n_bytes);
        status = write_text(client, options->markdown, text, n_bytes);
    }
    if (!status && options->report)
        status = report_write_folder(client, options, views, pairs->list, pairs->n);
    if (!status && options->html)
        status = report_write_file(client, options, views, pairs->list, pairs->n);
    progress_clear(&client->progress);
    if (!status && options->json) {
        struct json json = {.out = stdout};
        comparison_write_json(&json, pairs->list, pairs->n);
        status = client_finish_json(client, &json);
    } else if (!status) {
        comparison_print(pairs->list, pairs->n);
    }
    return status;
}

static int run(const struct options *given)
{
    struct options own = *given;
    const struct options *options = &own;
    struct client client = {.session = NULL};
    struct pairs pairs = {.list = NULL};
    struct views views;
    const char *const files[] = {options->junit, options->markdown, options->html};
    enum sheen_status status = find_pairs(&pairs, options, &client.error);
    for (size_t i = 0; i < sizeof(files) / sizeof(*files) && !status; i++)
        if (files[i])
            status = file_check_writable(files[i], &client.error);
    if (!status)
        status = views_read(options->views, &views, &client.error);
    if (pairs.is_folders)
        own.model = NULL; /* a bad first model must not keep the session from others */
    if (!status)
        status = client_init(&client, options);
    if (!status)
        status = compare_all(&client, options, &pairs);
    if (!status)
        status = print(&client, options, &views, &pairs);
    if (!status)
        status = worst_failure(&client, &pairs);
    bool differs = comparison_count(pairs.list, pairs.n, COMPARISON_SAME) < pairs.n;
    pairs_finish(&pairs);
    int code = client_finish(&client, status);
    return code == 0 && differs ? DIFFERS : code;
}

/* --- options */

static bool apply_limit(struct options *options, const char *value, char *why)
{
    return comparison_limit_read(options->compare_limits, value, why);
}

static bool apply_align(struct options *options, const char *value, char *why)
{
    (void)value;
    (void)why;
    return options->align = true;
}

static bool apply_samples(struct options *options, const char *value, char *why)
{
    return options_whole(&RANGES[RANGE_COMPARE_SAMPLES], value, &options->samples, why);
}

static bool apply_junit(struct options *options, const char *value, char *why)
{
    options->junit = value;
    return *value || options_refuse(why, "must be a file");
}

static bool apply_markdown(struct options *options, const char *value, char *why)
{
    options->markdown = value;
    return *value || options_refuse(why, "must be a file");
}

static bool apply_report(struct options *options, const char *value, char *why)
{
    options->report = value;
    return *value || options_refuse(why, "must be a folder");
}

static bool apply_html(struct options *options, const char *value, char *why)
{
    options->html = value;
    return *value || options_refuse(why, "must be a file");
}

static bool apply_views(struct options *options, const char *value, char *why)
{
    options->views = value;
    return *value || options_refuse(why, "must be a file");
}

static bool apply_deadline(struct options *options, const char *value, char *why)
{
    return options_whole(&RANGES[RANGE_DEADLINE], value, &options->request.deadline_ms, why);
}

static bool check(struct options *options, char *why)
{
    if (!options->argument)
        return options_refuse(why, "a second model or folder, NEW, is missing");
    if (options->views && !options->report && !options->html)
        return options_refuse(why, "--views are those of --report or --html");
    return options_check_scene(options, why);
}

static const struct option_row ROWS[] = {
    {"limit", 0, "LIMIT",
     "MEASURE=VALUE, MEASURE=VALUE@PERCENT% (this share of the area may\n"
     "exceed it) or MEASURE=off; may be given for each measure. Without a share,\n"
     "one place decides. Measures and defaults:\n"
     "distance        units of the model (0.05 mm for glTF; else 1e-5 of the\n"
     "                diagonal of the old model's box); the worst one is\n"
     "printed with its sign: positive where NEW lies on the side of OLD's normals\n"
     "normal_deg      degrees between the normals (0.05)\n"
     "lines           shift of the lights' lines, spacings (0.1)\n"
     "line_length     the same on the surface, units (no limit)\n"
     "curvature       change of the larger curvature, 0.1 for 10 % (not compared)\n"
     "uncovered_area  missing on one side, square units (0)\n"
     "rotation_deg    with --align, of its rotation (1)",
     apply_limit, NULL},
    {"align", 0, NULL, "move NEW onto OLD first, by a rotation and a shift, which are printed",
     apply_align, NULL},
    {"samples", 0, "N", "places of both surfaces together, {}\n(default: 1000000)", apply_samples,
     NULL},
    {"junit", 0, "FILE", "write a JUnit report: a suite for each pair, a case for each measure",
     apply_junit, NULL},
    {"markdown", 0, "FILE", "write a table in markdown, as for the summary of a job",
     apply_markdown, NULL},
    {"report", 0, "FOLDER",
     "write pages with pictures of both models in four views and maps of\n"
     "their differences, which a browser shows without scripts; with scripts\n"
     "all pictures of a view are zoomed together",
     apply_report, NULL},
    {"html", 0, "FILE", "write the same as one file, which needs no other", apply_html, NULL},
    {"views", 0, "FILE",
     "the views of --report and --html: on each line the options of a camera\n"
     "as of this command, --eye, --target, --view, --zoom, --up, --fov, --ortho;\n"
     "# begins a comment (default: four around the model)",
     apply_views, NULL},
    {"deadline", 0, "MS",
     "give up a pair after this time, {}\n(default: none). It is checked between steps of "
     "some\nmilliseconds: what is computed within the first of them is answered",
     apply_deadline, NULL},
    {0},
};

static const struct option_row *const TABLES[] = {
    ROWS, OPTIONS_SCENE, OPTIONS_COMMON, OPTIONS_RECONNECT, OPTIONS_OUTPUT, NULL};

const struct command COMMAND_COMPARE = {
    .name = "compare",
    .arguments = "OLD NEW [option]...",
    .summary =
        "Compares two models, or the models of two folders by their names: how far the surfaces\n"
        "are apart, and how normals, reflection lines and, if asked, curvature differ, computed\n"
        "on the surfaces themselves and in both directions. Ends with 1 if a limit is exceeded,\n"
        "or if a folder lacks a model of the other one. A pair of two folders that cannot be\n"
        "compared is reported as failed, the others are compared, and the highest exit code of\n"
        "such pairs comes at the end.",
    .tables = TABLES,
    .examples =
        "  sheen compare old/hood.obj new/hood.obj\n"
        "  sheen compare old.obj new.obj --limit distance=0.02 --limit normal_deg=0.05@0.1%\n"
        "  sheen compare old new --junit junit.xml --markdown summary.md --report report\n"
        "  sheen compare scan.obj hood.obj --align --limit lines=off --json\n",
    .takes_model = true,
    .takes_argument = true,
    .check = check,
    .codes = CODE_FILES | CODE_SERVER | CODE_LATE,
    .no = "the models differ",
    .run = run,
};
