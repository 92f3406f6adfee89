/* The files of shaders/, embedded at build time (shaders/embed.sh). */
#ifndef SHEEN_RENDER_GL_PROGRAMS_SHADERS_H
#define SHEEN_RENDER_GL_PROGRAMS_SHADERS_H

struct shader_file {
    const char *name; /* as in shaders/, e.g. "view.glsl" */
    const char *text;
};

extern const struct shader_file shader_files[]; /* ends with a NULL name */

#endif
