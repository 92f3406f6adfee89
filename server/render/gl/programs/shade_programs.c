#include "server/render/gl/programs/shade_programs.h"

#include <assert.h>
#include <string.h>

#include "server/render/gl/programs/program.h"

static_assert(MAX_SHADE_PROGRAMS >= MAX_FRAME_PROGRAMS, "a frame does not evict its own");
static_assert(sizeof(struct shade_key) == 7, "no padding: keys are compared as bytes");

void shade_programs_begin(struct shade_programs *programs)
{
    programs->clock++;
}

struct shade_program *shade_programs_find(struct shade_programs *programs, struct shade_key key)
{
    for (int i = 0; i < programs->n; i++) {
        struct shade_program *program = &programs->kept[i];
        if (memcmp(&program->key, &key, sizeof key) == 0) {
            program->used = programs->clock;
            return program;
        }
    }
    return NULL;
}

/* Returns a free place; evicts a program if there is none. */
static struct shade_program *make_room(struct shade_programs *programs)
{
    if (programs->n < MAX_SHADE_PROGRAMS)
        return &programs->kept[programs->n++];
    struct shade_program *oldest = &programs->kept[0];
    for (int i = 1; i < programs->n; i++)
        if (programs->kept[i].used < oldest->used)
            oldest = &programs->kept[i];
    assert(oldest->used < programs->clock);
    glDeleteProgram(oldest->name);
    return oldest;
}

struct shade_program *shade_programs_compile(struct shade_programs *programs, struct shade_key key,
                                             struct error *error)
{
    const struct program_source source = source_of_shading(key);
    GLuint name = program_create(&source, error);
    if (!name)
        return NULL;
    struct shade_program *program = make_room(programs);
    *program = (struct shade_program){.key = key, .name = name, .used = programs->clock};
    return program;
}
