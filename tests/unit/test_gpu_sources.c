/* Every shader that the renderer assembles is checked by GLSL's reference compiler, because drivers
 * differ in what they accept. No device is needed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "server/render/gl/buffer_textures.h"
#include "server/render/gl/programs/shaders.h"
#include "server/render/gl/programs/sources.h"
#include "server/scene/frame_request.h"

enum {
    MAX_SHADERS = 4096,
    MAX_FILES = 100,
    SHADERS_A_PROCESS = 400,
    FOLDER_BYTES = 64,
    PATH_BYTES = 128
};

/* The shaders assembled so far, as files of one folder; and whether any of them contains
 * shader_files[k] and shader_programs[k]. */
static char folder[FOLDER_BYTES], paths[MAX_SHADERS][PATH_BYTES];
static int n_paths;
static bool uses[MAX_FILES], uses_program[MAX_FILES];

static void note_uses(const char *const *files)
{
    for (int i = 0; files[i]; i++)
        for (int k = 0; shader_files[k].name; k++)
            uses[k] = uses[k] || strcmp(files[i], shader_files[k].name) == 0;
    for (int k = 0; shader_programs[k].name; k++)
        uses_program[k] = uses_program[k] || files == shader_programs[k].files[0];
}

static void write_shader(const struct program_source *source, int k, const char *ending,
                         const char *name)
{
    struct error error = {0};
    struct shader_text text;
    assert_true(n_paths < MAX_SHADERS);
    if (!shader_text_init(&text, source, k, &error))
        fail_msg("%s", error.text);
    char *path = paths[n_paths++];
    snprintf(path, PATH_BYTES, "%s/%s.%s", folder, name, ending);
    FILE *file = fopen(path, "wx"); /* each file name once */
    assert_non_null(file);
    for (int i = 0; i < text.n; i++)
        assert_true(fputs(text.part[i], file) >= 0);
    assert_int_equal(fclose(file), 0);
    note_uses(source->files[k]);
}

static void write_program(const struct program_source *source, const char *name)
{
    bool is_raster = source->files[1];
    write_shader(source, 0, is_raster ? "vert" : "comp", name);
    if (is_raster)
        write_shader(source, 1, "frag", name);
}

/* Checks the paths from `first` to `last` by one process. */
static void validate(const char *options, int first, int last)
{
    static char command[SHADERS_A_PROCESS * PATH_BYTES + 200];
    int at = snprintf(command, sizeof command, "glslangValidator %s", options);
    for (int i = first; i < last; i++)
        at += snprintf(command + at, sizeof command - (size_t)at, " %s", paths[i]);
    snprintf(command + at, sizeof command - (size_t)at, " >%s/said 2>&1", folder);
    int code = system(command);
    if (code == 0)
        return;
    char said[4000] = "";
    snprintf(command, sizeof command, "grep -B 3 -A 6 -E 'ERROR|not found' %s/said | head -n 30",
             folder);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    said[fread(said, 1, sizeof said - 1, pipe)] = 0;
    pclose(pipe);
    fail_msg("glslangValidator (Debian's glslang-tools) ends with status %d:\n%s", code, said);
}

static void validate_all(void)
{
    for (int i = 0; i < n_paths; i += SHADERS_A_PROCESS)
        validate("-t", i, i + SHADERS_A_PROCESS < n_paths ? i + SHADERS_A_PROCESS : n_paths);
}

static int begin(void **state)
{
    (void)state;
    n_paths = 0;
    strcpy(folder, "/tmp/sheen-test-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int end(void **state)
{
    (void)state;
    char path[PATH_BYTES];
    for (int i = 0; i < n_paths; i++)
        unlink(paths[i]);
    snprintf(path, sizeof path, "%s/said", folder);
    unlink(path);
    return rmdir(folder);
}

/* Vertex and fragment shaders of each program also link. */
static void test_single(void **state)
{
    (void)state;
    for (int p = 0; p < SINGLE_PROGRAMS; p++) {
        char name[PATH_BYTES / 2];
        const struct program_source source = source_of_single((enum single_program)p);
        int first = n_paths;
        snprintf(name, sizeof name, "single-%d", p);
        write_program(&source, name);
        validate("-l", first, n_paths);
    }
}

/* Whether a frame may ask for a program: planes and shares know no pattern, and rainbows and images have no soft
 * edges. */
static bool is_asked_for(const struct shade_key *key)
{
    if (key->light > 0 && family_is_at_infinity((enum line_family)key->family))
        return false;
    if (key->which == SHADED_PLANES || key->which == SHADED_SHARE)
        return key->pattern == 0 && !key->soft;
    return !key->soft || (key->pattern != PATTERN_RAINBOW && key->pattern != PATTERN_IMAGE);
}

/* All families, with the lights that each uses, all patterns, edges, and ways to shade. */
static void test_shading(void **state)
{
    (void)state;
    for (int i = 0; i < (LINES_ENVIRONMENT + 1) * (LIGHT_SPHERE + 1) * (PATTERN_DISTANCE + 1) * 2 *
                            SHADED_KINDS;
         i++) {
        int at = i;
        struct shade_key key = {0};
        key.which = (uint8_t)(at % SHADED_KINDS), at /= SHADED_KINDS;
        key.soft = (uint8_t)(at % 2), at /= 2;
        key.pattern = (uint8_t)(at % (PATTERN_DISTANCE + 1)), at /= PATTERN_DISTANCE + 1;
        key.light = (uint8_t)(at % (LIGHT_SPHERE + 1)), at /= LIGHT_SPHERE + 1;
        key.family = (uint8_t)at;
        if (!is_asked_for(&key))
            continue;
        char name[PATH_BYTES / 2];
        snprintf(name, sizeof name, "shade-%d-%d-%d-%d-%d", key.family, key.light, key.pattern,
                 key.soft, key.which);
        const struct program_source source = source_of_shading(key);
        write_program(&source, name);
    }
    assert_int_equal(n_paths, (2 * 4 + 3) * ((2 * 7 - 2) * (SHADED_KINDS - 2) + 2));
    validate_all();
}

/* All combinations of numbers of buffer textures, with and without PTEX, for devices that hold as
 * few texels as OpenGL allows, and for devices that hold many. */
static void test_tables(void **state)
{
    (void)state;
    int n_layouts = 0;
    for (int points = 1; points <= MAX_POINT_TEXTURES; points++) {
        for (int nodes = 1; nodes <= MAX_NODE_TEXTURES; nodes++) {
            int adjacency = 1 + (points + nodes) % MAX_ADJACENCY_TEXTURES;
            bool ptex = (points / 2 + nodes) % 2;
            const struct table_layout layout = {
                points, nodes, adjacency, (points + nodes) % 3 ? 65536 : (size_t)1 << 27, ptex};
            n_layouts++;
            for (int p = 0; p < TABLE_PROGRAMS; p++) {
                char name[PATH_BYTES / 2];
                const struct program_source source =
                    source_of_tables((enum table_program)p, &layout);
                int first = n_paths;
                snprintf(name, sizeof name, "tables-%d-%d-%d", points, nodes, p);
                write_program(&source, name);
                if (p == PROGRAM_VISIBILITY && n_layouts == 1)
                    validate("-l", first, n_paths);
            }
        }
    }
    validate_all();
}

/* A file that no program contains, or a program that no test assembles, has not been checked. Runs
 * last. */
static void test_all_are_used(void **state)
{
    (void)state;
    for (int k = 0; shader_files[k].name; k++)
        if (!uses[k])
            fail_msg("no program is assembled from %s", shader_files[k].name);
    for (int k = 0; shader_programs[k].name; k++)
        if (!uses_program[k])
            fail_msg("nobody asks for the program %s", shader_programs[k].name);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_single, begin, end),
        cmocka_unit_test_setup_teardown(test_shading, begin, end),
        cmocka_unit_test_setup_teardown(test_tables, begin, end),
        cmocka_unit_test(test_all_are_used),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
