#include "server/render/gl/programs/sources.h"

#include <stdio.h>
#include <string.h>

#include "server/render/gl/programs/shaders.h"

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
    for (int i = 0; files[i]; i++) {
        const char *file = i < PROGRAM_MAX_FILES ? file_text(files[i]) : NULL;
        if (!file)
            return error_set(error, ERROR_DEVICE, "shader file %s is not built in", files[i]);
        /* Errors name the number of the file in the list. */
        snprintf(text->line[i], sizeof text->line[i], "#line 1 %d\n", i);
        text->part[text->n++] = text->line[i];
        text->part[text->n++] = file;
    }
    return true;
}

struct program_source source_of_single(enum single_program program)
{
    static const char *const gather[] = {"view.glsl",   "list.glsl",        "seen.glsl",
                                         "groups.glsl", "gather.comp.glsl", NULL};
    static const char *const recheck[] = {"view.glsl",   "list.glsl",         "seen.glsl",
                                          "groups.glsl", "recheck.comp.glsl", NULL};
    static const char *const gaps[] = {"view.glsl", "list.glsl", "seen.glsl", "gaps.comp.glsl",
                                       NULL};
    static const char *const edges_find[] = {
        "view.glsl", "list.glsl",  "basis.glsl",   "hit.glsl",    "border.glsl",
        "ends.glsl", "edges.glsl", "rounded.glsl", "groups.glsl", "edges_find.comp.glsl",
        NULL};
    static const char *const edges_recheck[] = {"view.glsl",
                                                "list.glsl",
                                                "basis.glsl",
                                                "hit.glsl",
                                                "coverage.glsl",
                                                "border.glsl",
                                                "ends.glsl",
                                                "edges.glsl",
                                                "rounded.glsl",
                                                "pieces.glsl",
                                                "edges_recheck.comp.glsl",
                                                NULL};
    static const char *const vertex[] = {"view.glsl", "polygon.vert.glsl", NULL};
    static const char *const polygons[] = {"view.glsl", "basis.glsl", "polygon.glsl",
                                           "polygon.frag.glsl", NULL};
    static const char *const wireframe[] = {"view.glsl", "basis.glsl",     "polygon.glsl",
                                            "srgb.glsl", "wireframe.glsl", "wireframe.frag.glsl",
                                            NULL};
#define NO_TABLES "#define TEXTURES_FREE 0\n"
    static const struct program_source sources[SINGLE_PROGRAMS] = {
        [PROGRAM_GATHER] = {NO_TABLES, {gather, NULL}},
        [PROGRAM_RECHECK] = {NO_TABLES, {recheck, NULL}},
        [PROGRAM_GAPS] = {NO_TABLES, {gaps, NULL}},
        [PROGRAM_EDGES_FIND] = {"", {edges_find, NULL}},
        [PROGRAM_EDGES_RECHECK] = {"", {edges_recheck, NULL}},
        [PROGRAM_POLYGONS] = {"", {vertex, polygons}},
        [PROGRAM_WIREFRAME] = {"", {vertex, wireframe}},
    };
#undef NO_TABLES
    return sources[program];
}

struct program_source source_of_tables(enum table_program program,
                                       const struct table_layout *layout)
{
    static const char *const vertex[] = {"view.glsl", "tables.glsl", "surface.glsl",
                                         "visibility.vert.glsl", NULL};
    static const char *const fragment[] = {"visibility.frag.glsl", NULL};
#define STAGE_2                                                                                    \
    "view.glsl", "list.glsl", "tables.glsl", "surface.glsl", "basis.glsl", "neighbours.glsl",      \
        "border.glsl", "planes.glsl", "newton.glsl", "seen.glsl"
    static const char *const evaluate[] = {STAGE_2, "groups.glsl", "evaluate.comp.glsl", NULL};
    static const char *const unsolved[] = {STAGE_2, "walk.glsl", "unsolved.comp.glsl", NULL};
    static const char *const rounded[] = {STAGE_2, "walk.glsl", "rounded.glsl",
                                          "rounded_solve.comp.glsl", NULL};
    static const char *const ends[] = {STAGE_2, "walk.glsl", "ends.glsl", "ends_find.comp.glsl",
                                       NULL};
#undef STAGE_2
    static const char *const *const files[TABLE_PROGRAMS][2] = {
        [PROGRAM_VISIBILITY] = {vertex, fragment},
        [PROGRAM_EVALUATE] = {evaluate, NULL},
        [PROGRAM_UNSOLVED] = {unsolved, NULL},
        [PROGRAM_ROUNDED] = {rounded, NULL},
        [PROGRAM_ENDS] = {ends, NULL},
    };
    struct program_source source = {.files = {files[program][0], files[program][1]}};
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
#define LINES "view.glsl", "list.glsl", "basis.glsl", "hit.glsl", "coverage.glsl", "lines.glsl"
#define COMMON LINES, "srgb.glsl", "shown.glsl", "patterns.glsl"
    static const char *const all[] = {COMMON, "groups.glsl", "shade.comp.glsl", NULL};
    static const char *const edges[] = {
        COMMON,          "border.glsl",           "ends.glsl",
        "edges.glsl",    "pieces.glsl",           "piece_shade.glsl",
        "rounding.glsl", "edges_shade.comp.glsl", NULL};
    static const char *const high_curvature[] = {COMMON,
                                                 "border.glsl",
                                                 "ends.glsl",
                                                 "edges.glsl",
                                                 "pieces.glsl",
                                                 "piece_shade.glsl",
                                                 "high_curvature_shade.comp.glsl",
                                                 NULL};
    static const char *const rounded[] = {COMMON,
                                          "border.glsl",
                                          "ends.glsl",
                                          "edges.glsl",
                                          "pieces.glsl",
                                          "rounded.glsl",
                                          "rounded_shade.comp.glsl",
                                          NULL};
    static const char *const planes[] = {LINES, "groups.glsl", "shade_planes.comp.glsl", NULL};
    static const char *const share[] = {LINES, "groups.glsl", "share.comp.glsl", NULL};
#undef COMMON
#undef LINES
    static const char *const *const files[SHADED_KINDS] = {all,     all,    edges, high_curvature,
                                                           rounded, planes, share};
    struct program_source source = {.files = {files[key.which], NULL}};
    snprintf(source.defines, sizeof source.defines,
             "#define FAMILY %d\n#define LIGHT %d\n#define PATTERN %d\n"
             "#define IS_SOFT %s\n#define IS_FILTERED %s\n",
             key.family, key.light, key.pattern, key.soft ? "true" : "false",
             key.which == SHADED_UNFILTERED ? "false" : "true");
    return source;
}
