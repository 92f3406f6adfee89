/* The programs that read limit tables, one set for each way the tables are spread over banks. */
#include "server/gpu/gpu.h"

#include <stdio.h>

#include "server/gpu/program.h"

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
        const struct table_programs *p = &r->programs[i];
        if (p->point_banks == point_banks && p->node_banks == node_banks &&
            p->adjacency_banks == adjacency_banks && p->ptex == ptex)
            return p;
    }
    if (r->n_programs == MAX_PROGRAM_SETS) {
        error_set(error, ERROR_DEVICE, "models of too many different sizes at once");
        return NULL;
    }
    char defines[256];
    snprintf(defines, sizeof defines,
             "#define POINT_BANKS %d\n#define NODE_BANKS %d\n#define ADJACENCY_BANKS %d\n"
             "#define BANK_TEXELS %zu\n#define NODE_BANK_TEXELS %zu\n#define "
             "TEXTURES_FREE %d\n%s",
             point_banks, node_banks, adjacency_banks, r->info.max_texels,
             r->info.max_texels / 3 * 3, point_banks + node_banks + adjacency_banks,
             ptex ? "#define PTEX\n" : "");
    struct table_programs *p = &r->programs[r->n_programs];
    p->visibility = program_raster(defines, vertex, fragment, error);
    p->evaluate = p->visibility ? program_compute(defines, evaluate, error) : 0;
    p->unsolved = p->evaluate ? program_compute(defines, unsolved, error) : 0;
    p->rounded = p->unsolved ? program_compute(defines, rounded, error) : 0;
    if (!p->rounded) {
        glDeleteProgram(p->visibility);
        glDeleteProgram(p->evaluate);
        glDeleteProgram(p->unsolved);
        return NULL;
    }
    p->point_banks = point_banks;
    p->node_banks = node_banks;
    p->adjacency_banks = adjacency_banks;
    p->ptex = ptex;
    r->n_programs++;
    return p;
}
