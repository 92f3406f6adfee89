/* The programs that read limit tables, one set for each way the tables are spread over banks. */
#include "server/render/gl/gpu.h"

#include "server/render/gl/program.h"

static void delete_all(const struct table_programs *programs)
{
    glDeleteProgram(programs->visibility);
    glDeleteProgram(programs->evaluate);
    glDeleteProgram(programs->unsolved);
    glDeleteProgram(programs->rounded);
    glDeleteProgram(programs->silhouette);
}

/* A free place, made free if need be. */
static struct table_programs *make_room(struct gl_renderer *r)
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

static GLuint create(enum table_program program, const struct table_layout *layout,
                     struct error *error)
{
    const struct program_source source = source_of_tables(program, layout);
    return program_create(&source, error);
}

const struct table_programs *programs_for(struct gl_renderer *r, const struct gl_model *model,
                                          bool ptex, struct error *error)
{
    int point_banks = model->points.n, node_banks = model->nodes.n;
    int adjacency_banks = model->adjacency.n;
    for (int i = 0; i < r->n_programs; i++) {
        struct table_programs *p = &r->programs[i];
        if (p->point_banks == point_banks && p->node_banks == node_banks &&
            p->adjacency_banks == adjacency_banks && p->ptex == ptex) {
            p->used = ++r->programs_clock;
            return p;
        }
    }
    const struct table_layout layout = {point_banks, node_banks, adjacency_banks,
                                        r->base.info.max_texels, ptex};
    struct table_programs made = {.point_banks = point_banks,
                                  .node_banks = node_banks,
                                  .adjacency_banks = adjacency_banks,
                                  .ptex = ptex,
                                  .used = ++r->programs_clock};
    made.visibility = create(PROGRAM_VISIBILITY, &layout, error);
    made.evaluate = made.visibility ? create(PROGRAM_EVALUATE, &layout, error) : 0;
    made.unsolved = made.evaluate ? create(PROGRAM_UNSOLVED, &layout, error) : 0;
    made.rounded = made.unsolved ? create(PROGRAM_ROUNDED, &layout, error) : 0;
    made.silhouette = made.rounded ? create(PROGRAM_SILHOUETTE, &layout, error) : 0;
    if (!made.silhouette) {
        delete_all(&made);
        return NULL;
    }
    struct table_programs *p = make_room(r);
    *p = made;
    return p;
}
