#include "server/render/gl/programs/sources.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "server/render/gl/programs/shaders.h"

static_assert(sizeof(struct shade_key) == 7, "no padding: keys are compared as bytes");

static const char *file_text(const char *name)
{
    for (const struct shader_file *file = shader_files; file->name; file++)
        if (strcmp(file->name, name) == 0)
            return file->text;
    return NULL;
}

bool shader_text_init(struct shader_text *text, const struct program_source *source, int k,
                      struct error *error)
{
    const char *const *files = source->files[k];
    text->part[0] = "#version 450 core\n";
    text->part[1] = source->defines;
    text->n = 2;
    if (!files)
        return error_set(error, ERROR_DEVICE, "a program is not in the list shaders/programs");
    for (int i = 0; files[i]; i++) {
        const char *file = i < PROGRAM_MAX_FILES ? file_text(files[i]) : NULL;
        if (!file)
            return error_set(error, ERROR_DEVICE, "shader file %s is not built in", files[i]);
        /* The compiler's messages name a file by its number in the list. */
        snprintf(text->line[i], sizeof text->line[i], "#line 1 %d\n", i);
        text->part[text->n++] = text->line[i];
        text->part[text->n++] = file;
    }
    return true;
}

/* The program's source without #define lines. files[0] is NULL if there is no program of this
 * name. */
static struct program_source source_of(const char *name)
{
    struct program_source source = {.files = {NULL, NULL}};
    for (const struct shader_program *program = shader_programs; program->name; program++)
        if (strcmp(program->name, name) == 0)
            memcpy(source.files, program->files, sizeof source.files);
    return source;
}

struct program_source source_of_single(enum single_program program)
{
#define NO_TABLES "#define TEXTURES_FREE 0\n"
    static const struct {
        const char *name, *defines;
    } singles[SINGLE_PROGRAMS] = {
        [PROGRAM_GATHER] = {"gather", NO_TABLES},
        [PROGRAM_RECHECK] = {"recheck", NO_TABLES},
        [PROGRAM_GAPS] = {"gaps", NO_TABLES},
        [PROGRAM_EDGES_FIND] = {"edges_find", ""},
        [PROGRAM_EDGES_RECHECK] = {"edges_recheck", ""},
        [PROGRAM_POLYGONS] = {"polygons", ""},
        [PROGRAM_WIREFRAME] = {"wireframe", ""},
    };
#undef NO_TABLES
    struct program_source source = source_of(singles[program].name);
    snprintf(source.defines, sizeof source.defines, "%s", singles[program].defines);
    return source;
}

struct program_source source_of_tables(enum table_program program,
                                       const struct table_layout *layout)
{
    static const char *const names[TABLE_PROGRAMS] = {
        [PROGRAM_VISIBILITY] = "visibility", [PROGRAM_EVALUATE] = "evaluate",
        [PROGRAM_UNSOLVED] = "unsolved",     [PROGRAM_ROUNDED] = "rounded_solve",
        [PROGRAM_ENDS] = "ends_find",
    };
    struct program_source source = source_of(names[program]);
    snprintf(source.defines, sizeof source.defines,
             "#define POINT_BANKS %d\n#define NODE_BANKS %d\n#define ADJACENCY_BANKS %d\n"
             "#define BANK_TEXELS %zu\n#define NODE_BANK_TEXELS %zu\n#define "
             "TEXTURES_FREE %d\n%s",
             layout->n_points, layout->n_nodes, layout->n_adjacency, layout->max_texels,
             layout->max_texels / 3 * 3, layout->n_points + layout->n_nodes + layout->n_adjacency,
             layout->ptex ? "#define PTEX\n" : "");
    return source;
}

struct program_source source_of_shading(struct shade_key key)
{
    static const char *const names[SHADED_KINDS] = {
        [SHADED_ALL] = "shade",
        [SHADED_UNFILTERED] = "shade",
        [SHADED_EDGES] = "edges_shade",
        [SHADED_HIGH_CURVATURE] = "high_curvature_shade",
        [SHADED_ROUNDED] = "rounded_shade",
        [SHADED_PLANES] = "shade_planes",
        [SHADED_SHARE] = "share",
    };
    struct program_source source = source_of(names[key.which]);
    snprintf(source.defines, sizeof source.defines,
             "#define FAMILY %d\n#define LIGHT %d\n#define PATTERN %d\n"
             "#define IS_SOFT %s\n#define IS_FILTERED %s\n",
             key.family, key.light, key.pattern, key.soft ? "true" : "false",
             key.which == SHADED_UNFILTERED ? "false" : "true");
    return source;
}

static bool is_same_layout(const struct table_layout *a, const struct table_layout *b)
{
    return a->n_points == b->n_points && a->n_nodes == b->n_nodes &&
           a->n_adjacency == b->n_adjacency && a->max_texels == b->max_texels && a->ptex == b->ptex;
}

bool program_id_is_same(const struct program_id *a, const struct program_id *b)
{
    if (a->set != b->set)
        return false;
    if (a->set == SET_SHADING)
        return memcmp(&a->shading, &b->shading, sizeof a->shading) == 0;
    return a->which == b->which && (a->set == SET_SINGLE || is_same_layout(&a->layout, &b->layout));
}

struct program_source source_of_program(const struct program_id *id)
{
    switch (id->set) {
    case SET_SINGLE:
        return source_of_single((enum single_program)id->which);
    case SET_TABLES:
        return source_of_tables((enum table_program)id->which, &id->layout);
    case SET_SHADING:
        break;
    }
    return source_of_shading(id->shading);
}
