#include "server/render/gl/programs/table_programs.h"

#include "server/render/gl/programs/program.h"

static void delete_all(const struct table_programs *programs)
{
    glDeleteProgram(programs->visibility);
    glDeleteProgram(programs->evaluate);
    glDeleteProgram(programs->unsolved);
    glDeleteProgram(programs->rounded);
    glDeleteProgram(programs->ends);
}

/* Returns a free place; evicts a set of programs if there is none. */
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

static bool is_same(const struct table_layout *a, const struct table_layout *b)
{
    return a->n_points == b->n_points && a->n_nodes == b->n_nodes &&
           a->n_adjacency == b->n_adjacency && a->max_texels == b->max_texels && a->ptex == b->ptex;
}

const struct table_programs *programs_for(struct program_sets *sets,
                                          const struct table_layout *layout, struct error *error)
{
    for (int i = 0; i < sets->n; i++) {
        struct table_programs *p = &sets->set[i];
        if (is_same(&p->layout, layout)) {
            p->used = ++sets->clock;
            return p;
        }
    }
    struct table_programs made = {.layout = *layout, .used = ++sets->clock};
    made.visibility = create(PROGRAM_VISIBILITY, layout, error);
    made.evaluate = made.visibility ? create(PROGRAM_EVALUATE, layout, error) : 0;
    made.unsolved = made.evaluate ? create(PROGRAM_UNSOLVED, layout, error) : 0;
    made.rounded = made.unsolved ? create(PROGRAM_ROUNDED, layout, error) : 0;
    made.ends = made.rounded ? create(PROGRAM_ENDS, layout, error) : 0;
    if (!made.ends) {
        delete_all(&made);
        return NULL;
    }
    struct table_programs *p = make_room(sets);
    *p = made;
    return p;
}
