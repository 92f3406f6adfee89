#include "server/gpu/shade_programs.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "server/gpu/program.h"

static_assert(MAX_SHADE_PROGRAMS >= MAX_FRAME_PROGRAMS, "a frame does not evict its own");
static_assert(sizeof(struct shade_key) == 6, "no padding: keys are compared as bytes");

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

static GLuint compile(struct shade_key key, struct error *error)
{
#define COMMON                                                                                     \
    "view.glsl", "list.glsl", "basis.glsl", "hit.glsl", "coverage.glsl", "lines.glsl",             \
        "patterns.glsl"
    static const char *const all[] = {COMMON, "groups.glsl", "shade.comp.glsl", NULL};
    static const char *const edges[] = {COMMON,        "border.glsl",   "edges.glsl",
                                        "pieces.glsl", "rounding.glsl", "edges_shade.comp.glsl",
                                        NULL};
    static const char *const turns[] = {COMMON,        "border.glsl",           "edges.glsl",
                                        "pieces.glsl", "turns_shade.comp.glsl", NULL};
    static const char *const rounded[] = {COMMON,        "border.glsl",  "edges.glsl",
                                          "pieces.glsl", "rounded.glsl", "rounded_shade.comp.glsl",
                                          NULL};
    static const char *const planes[] = {COMMON, "groups.glsl", "shade_planes.comp.glsl", NULL};
#undef COMMON
    static const char *const *const files[SHADED_KINDS] = {all, all, edges, turns, rounded, planes};
    char defines[160];
    snprintf(defines, sizeof defines,
             "#define FAMILY %d\n#define LIGHT %d\n#define PATTERN %d\n%s%s", key.family, key.light,
             key.pattern, key.soft ? "#define SOFT\n" : "",
             key.which == SHADED_UNFILTERED ? "#define UNFILTERED\n" : "");
    return program_compute(defines, files[key.which], error);
}

/* A free place, made free if need be. */
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
    GLuint name = compile(key, error);
    if (!name)
        return NULL;
    struct shade_program *program = make_room(programs);
    *program = (struct shade_program){.key = key, .name = name, .used = programs->clock};
    return program;
}
