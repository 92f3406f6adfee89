#include "server/render/gl/table_programs.h"

#include "server/render/gl/device_internal.h"
#include "server/render/gl/model.h"
#include "server/render/gl/programs/program.h"

static void delete_all(const struct table_programs *programs)
{
    glDeleteProgram(programs->visibility);
    glDeleteProgram(programs->evaluate);
    glDeleteProgram(programs->unsolved);
    glDeleteProgram(programs->rounded);
    glDeleteProgram(programs->silhouette);
}

/* A free place, made free if need be. */
static struct table_programs *make_room(struct program_sets *sets)
{
    if (sets->n < MAX_PROGRAM_SETS)
        return &sets->set[sets->n++];
    struct table_programs *oldest = &sets->set[0];
    for (int i = 1; i < sets->n; i++)
        if (sets->set[i].used < oldest->used)
            oldest = &sets->set[i];
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
    struct program_sets *sets = &r->programs;
    int n_points = model->points.n, n_nodes = model->nodes.n, n_adjacency = model->adjacency.n;
    for (int i = 0; i < sets->n; i++) {
        struct table_programs *p = &sets->set[i];
        if (p->n_points == n_points && p->n_nodes == n_nodes && p->n_adjacency == n_adjacency &&
            p->ptex == ptex) {
            p->used = ++sets->clock;
            return p;
        }
    }
    const struct table_layout layout = {n_points, n_nodes, n_adjacency, r->max_texels, ptex};
    struct table_programs made = {.n_points = n_points,
                                  .n_nodes = n_nodes,
                                  .n_adjacency = n_adjacency,
                                  .ptex = ptex,
                                  .used = ++sets->clock};
    made.visibility = create(PROGRAM_VISIBILITY, &layout, error);
    made.evaluate = made.visibility ? create(PROGRAM_EVALUATE, &layout, error) : 0;
    made.unsolved = made.evaluate ? create(PROGRAM_UNSOLVED, &layout, error) : 0;
    made.rounded = made.unsolved ? create(PROGRAM_ROUNDED, &layout, error) : 0;
    made.silhouette = made.rounded ? create(PROGRAM_SILHOUETTE, &layout, error) : 0;
    if (!made.silhouette) {
        delete_all(&made);
        return NULL;
    }
    struct table_programs *p = make_room(sets);
    *p = made;
    return p;
}
