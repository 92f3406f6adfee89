/* The programs that read limit tables, one set for each way the tables are spread over banks. */
#include "server/gpu/gpu.h"

#include <stdio.h>

#include "server/gpu/program.h"

static void delete_all(const struct table_programs *programs)
{
    glDeleteProgram(programs->visibility);
    glDeleteProgram(programs->evaluate);
    glDeleteProgram(programs->unsolved);
    glDeleteProgram(programs->rounded);
}

/* A free place, made free if need be. */
static struct table_programs *make_room(struct renderer *r)
{
    if (r->n_programs < MAX_PROGRAM_SETS)
        return &r->programs[r->n_programs++];
    struct table_programs *oldest = &r->programs[0];
    for (int i = 1; i < r->n_programs; i++)
        if (r->programs[i].used < oldest->used)
            oldest = &r->programs[i];
    delete_all(oldest);
    return oldest;
}

const struct table_programs *programs_for(struct renderer *r, const struct renderer_model *model,
                                          bool ptex, struct error *error)
{
    int point_banks = model->points.n, node_banks = model->nodes.n;
    int adjacency_banks = model->adjacency.n;
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
#undef STAGE_2
    for (int i = 0; i < r->n_programs; i++) {
        struct table_programs *p = &r->programs[i];
        if (p->point_banks == point_banks && p->node_banks == node_banks &&
            p->adjacency_banks == adjacency_banks && p->ptex == ptex) {
            p->used = ++r->programs_clock;
            return p;
        }
    }
    char defines[256];
    snprintf(defines, sizeof defines,
             "#define POINT_BANKS %d\n#define NODE_BANKS %d\n#define ADJACENCY_BANKS %d\n"
             "#define BANK_TEXELS %zu\n#define NODE_BANK_TEXELS %zu\n#define "
             "TEXTURES_FREE %d\n%s",
             point_banks, node_banks, adjacency_banks, r->info.max_texels,
             r->info.max_texels / 3 * 3, point_banks + node_banks + adjacency_banks,
             ptex ? "#define PTEX\n" : "");
    struct table_programs made = {.point_banks = point_banks,
                                  .node_banks = node_banks,
                                  .adjacency_banks = adjacency_banks,
                                  .ptex = ptex,
                                  .used = ++r->programs_clock};
    made.visibility = program_raster(defines, vertex, fragment, error);
    made.evaluate = made.visibility ? program_compute(defines, evaluate, error) : 0;
    made.unsolved = made.evaluate ? program_compute(defines, unsolved, error) : 0;
    made.rounded = made.unsolved ? program_compute(defines, rounded, error) : 0;
    if (!made.rounded) {
        delete_all(&made);
        return NULL;
    }
    struct table_programs *p = make_room(r);
    *p = made;
    return p;
}
