#include "server/gpu/program.h"

#include <stdio.h>
#include <string.h>

#include "server/gpu/shaders.h"

enum { MAX_PARTS = 32 };

static const char *shader_text(const char *name)
{
    for (const struct shader_file *file = shader_files; file->name; file++)
        if (strcmp(file->name, name) == 0)
            return file->text;
    return NULL;
}

static GLuint compile(GLenum type, const char *defines, const char *const *files,
                      struct error *error)
{
    /* #line N F gives errors the number of the file in the list. */
    const char *parts[MAX_PARTS] = {"#version 450 core\n", defines};
    int n = 2;
    char lines[MAX_PARTS][32];
    for (int i = 0; files[i]; i++) {
        const char *text = shader_text(files[i]);
        if (!text || n + 2 > MAX_PARTS) {
            error_set(error, ERROR_DEVICE, "shader file %s is not built in", files[i]);
            return 0;
        }
        snprintf(lines[i], sizeof lines[i], "#line 1 %d\n", i);
        parts[n++] = lines[i];
        parts[n++] = text;
    }
    GLuint shader = glCreateShader(type);
    glShaderSource(shader, n, parts, NULL);
    glCompileShader(shader);
    GLint ok = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok)
        return shader;
    char log[300] = "";
    glGetShaderInfoLog(shader, sizeof log, NULL, log);
    error_set(error, ERROR_DEVICE, "the driver cannot compile %s: %s", files[0], log);
    glDeleteShader(shader);
    return 0;
}

static GLuint link_program(const GLuint *shaders, int n, struct error *error)
{
    GLuint program = glCreateProgram();
    for (int i = 0; i < n; i++)
        glAttachShader(program, shaders[i]);
    glLinkProgram(program);
    for (int i = 0; i < n; i++)
        glDeleteShader(shaders[i]);
    GLint ok = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    if (ok)
        return program;
    char log[300] = "";
    glGetProgramInfoLog(program, sizeof log, NULL, log);
    error_set(error, ERROR_DEVICE, "the driver cannot link a program: %s", log);
    glDeleteProgram(program);
    return 0;
}

GLuint program_compute(const char *defines, const char *const *files, struct error *error)
{
    GLuint shader = compile(GL_COMPUTE_SHADER, defines, files, error);
    return shader ? link_program(&shader, 1, error) : 0;
}

GLuint program_raster(const char *defines, const char *const *vertex_files,
                      const char *const *fragment_files, struct error *error)
{
    GLuint shaders[2];
    shaders[0] = compile(GL_VERTEX_SHADER, defines, vertex_files, error);
    if (!shaders[0])
        return 0;
    shaders[1] = compile(GL_FRAGMENT_SHADER, defines, fragment_files, error);
    if (!shaders[1]) {
        glDeleteShader(shaders[0]);
        return 0;
    }
    return link_program(shaders, 2, error);
}
