#include "client/cli/compare/views.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "client/cli/base/failure.h"
#include "client/cli/options/options.h"

enum { MOST_WORDS = 20 };

static const char *const CAMERA[] = {"eye", "target", "view", "zoom", "up", "fov", "ortho"};
enum { CAMERA_ROWS = sizeof(CAMERA) / sizeof(*CAMERA) };

/* The rows of a camera's options, and the end of the table. */
static void find_rows(struct option_row rows[static CAMERA_ROWS + 1])
{
    size_t n = 0;
    for (const struct option_row *row = OPTIONS_SCENE; row->name; row++)
        for (size_t k = 0; k < CAMERA_ROWS; k++)
            if (strcmp(row->name, CAMERA[k]) == 0)
                rows[n++] = *row;
    rows[n] = (struct option_row){0};
}

/* Parses the words of a line, which is cut into words. False with the reason in `why`. */
static bool read_camera(char *line, struct sheen_camera *camera, char why[static OPTIONS_WHY_BYTES])
{
    struct option_row rows[CAMERA_ROWS + 1];
    const struct option_row *const tables[] = {rows, NULL};
    const struct command command = {.tables = tables, .check = options_check_scene};
    static char name[] = "view";
    char *words[MOST_WORDS + 1] = {name}, *rest = NULL;
    struct options options;
    int n = 1;
    find_rows(rows);
    for (char *word = strtok_r(line, " \t", &rest); word; word = strtok_r(NULL, " \t", &rest)) {
        if (n == MOST_WORDS)
            return options_refuse(why, "has more than %d words", MOST_WORDS - 1);
        words[n++] = word;
    }
    if (options_parse(&command, n, words, &options, why) != OPTIONS_RUN)
        return false;
    *camera = options.request.camera;
    return true;
}

/* Adds the view of a line, unless it is empty or a comment. */
static enum sheen_status add_line(struct views *views, const char *path, size_t number, char *line,
                                  struct sheen_error *error)
{
    char why[OPTIONS_WHY_BYTES];
    line += strspn(line, " \t");
    line[strcspn(line, "\r\n")] = 0;
    if (!*line || *line == '#')
        return SHEEN_OK;
    if (views->n == MOST_VIEWS)
        return failure_set(error, SHEEN_BAD_ARGUMENT, "%.200s has more than %d views", path,
                           MOST_VIEWS);
    snprintf(views->list[views->n].text, VIEW_BYTES, "%s", line);
    if (!read_camera(line, &views->list[views->n].camera, why))
        return failure_set(error, SHEEN_BAD_ARGUMENT, "%.200s, line %zu: %s", path, number, why);
    views->n++;
    return SHEEN_OK;
}

enum sheen_status views_read(const char *path, struct views *views, struct sheen_error *error)
{
    char line[VIEW_BYTES + 2]; /* with the end of the line, \r\n */
    enum sheen_status status = SHEEN_OK;
    views->n = 0;
    if (!path)
        return SHEEN_OK;
    FILE *file = fopen(path, "r");
    if (!file)
        return failure_set(error, SHEEN_BAD_ARGUMENT, "--views %.200s: %s", path, strerror(errno));
    for (size_t number = 1; !status && fgets(line, sizeof(line), file); number++) {
        if (strcspn(line, "\r\n") >= VIEW_BYTES)
            status = failure_set(error, SHEEN_BAD_ARGUMENT, "%.200s, line %zu: is too long", path,
                                 number);
        else
            status = add_line(views, path, number, line, error);
    }
    if (!status && ferror(file))
        status =
            failure_set(error, SHEEN_BAD_ARGUMENT, "--views %.200s: %s", path, strerror(errno));
    fclose(file);
    if (!status && views->n == 0)
        status = failure_set(error, SHEEN_BAD_ARGUMENT, "%.200s has no view", path);
    return status;
}
