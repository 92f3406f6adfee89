/* sheen lights, sheen patterns: list what exists, with ranges, defaults and an example each. */
#include <stdio.h>
#include <string.h>

#include "client/cli/commands.h"
#include "client/cli/output/json.h"
#include "client/cli/options/lights_text.h"

/* Prints name, meaning (which may have several lines) and, indented below, the example. */
static void print_rows(const char *title, const struct text_row *rows, const char *prefix)
{
    char example[TEXT_EXAMPLE_BYTES];
    printf("%s\n", title);
    for (; rows->name; rows++) {
        const char *meaning = rows->meaning;
        for (int line = 0; *meaning; line++) {
            int length = (int)strcspn(meaning, "\n");
            printf("  %-12s %.*s\n", line ? "" : rows->name, length, meaning);
            meaning += length + (meaning[length] == '\n');
        }
        text_row_example(rows, example);
        printf("  %-12s %s%s\n", "", prefix, example);
    }
    printf("\n");
}

static void json_rows(struct json *json, const char *name, const struct text_row *rows,
                      const char *example)
{
    char text[TEXT_EXAMPLE_BYTES];
    json_array_begin(json, name);
    for (; rows->name; rows++) {
        json_object_begin(json, NULL);
        json_text(json, "name", rows->name);
        json_text(json, "meaning", rows->meaning);
        text_row_example(rows, text);
        json_text(json, example, text);
        json_object_end(json);
    }
    json_array_end(json);
}

static int finish_json(struct json *json)
{
    json_object_end(json);
    return json_finish(json) ? 0 : 3;
}

static int run_lights(const struct options *options)
{
    if (options->json) {
        struct json json = {.out = stdout};
        json_object_begin(&json, NULL);
        json_rows(&json, "families", TEXT_FAMILIES, "example");
        json_rows(&json, "lights", TEXT_LIGHTS, "example");
        return finish_json(&json);
    }
    print_rows("line families (--lines FAMILY[:X,Y,Z])", TEXT_FAMILIES,
               "sheen render MODEL -o out.png ");
    print_rows("lights (--light KIND; placed by --light-center, --light-u and --light-v)",
               TEXT_LIGHTS, "sheen render MODEL -o out.png ");
    printf("Each --light after the first begins another light below the earlier ones; the options\n"
           "--light-center, --light-u, --light-v and --pattern refer to the latest light.\n"
           "Isophote, zebra and environment use only the patterns of the lights.\n");
    return 0;
}

static int run_patterns(const struct options *options)
{
    if (options->json) {
        struct json json = {.out = stdout};
        json_object_begin(&json, NULL);
        json_rows(&json, "patterns", TEXT_PATTERNS, "example");
        json_rows(&json, "parts", TEXT_PATTERN_KEYS, "range");
        return finish_json(&json);
    }
    print_rows("patterns (--pattern KIND:part=value,...)", TEXT_PATTERNS,
               "sheen render MODEL -o out.png ");
    print_rows("parts", TEXT_PATTERN_KEYS, "");
    return 0;
}

static const struct option_row *const TABLES[] = {OPTIONS_OUTPUT, NULL};

const struct command COMMAND_LIGHTS = {
    .name = "lights",
    .arguments = "[--json]",
    .summary = "Lists line families and lights, with an example of each.",
    .tables = TABLES,
    .examples = "  sheen lights\n",
    .codes = CODE_OUTPUT,
    .run = run_lights,
};

const struct command COMMAND_PATTERNS = {
    .name = "patterns",
    .arguments = "[--json]",
    .summary = "Lists the patterns that lights show and their parts, with ranges and defaults.",
    .tables = TABLES,
    .examples = "  sheen patterns\n",
    .codes = CODE_OUTPUT,
    .run = run_patterns,
};
