/* The files of shaders/, and the programs of shaders/programs that the GL device runs, embedded at
 * build time (shaders/embed.py). Constant data, any thread. */
#ifndef SHEEN_RENDER_GL_PROGRAMS_SHADERS_H
#define SHEEN_RENDER_GL_PROGRAMS_SHADERS_H

struct shader_file {
    const char *name; /* as in shaders/, e.g. "view.glsl" */
    const char *text;
};

extern const struct shader_file shader_files[]; /* ends with a NULL name */

/* The files of a compute shader, or of a vertex and a fragment shader: names that end with NULL.
 * files[1] is NULL for a compute shader. */
struct shader_program {
    const char *name; /* as in the list */
    const char *const *files[2];
};

extern const struct shader_program shader_programs[]; /* ends with a NULL name */

#endif
