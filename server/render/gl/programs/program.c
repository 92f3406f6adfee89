#include "server/render/gl/programs/program.h"

/* Compiles the source's k-th shader. */
static GLuint compile(GLenum type, const struct program_source *source, int k, struct error *error)
{
    struct shader_text text;
    if (!shader_text_init(&text, source, k, error))
        return 0;
    GLuint shader = glCreateShader(type);
    glShaderSource(shader, text.n, text.part, NULL);
    glCompileShader(shader);
    GLint ok = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok)
        return shader;
    char log[300] = "";
    glGetShaderInfoLog(shader, sizeof log, NULL, log);
    error_set(error, ERROR_DEVICE, "the driver cannot compile %s: %s", source->files[k][0], log);
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

GLuint program_create(const struct program_source *source, struct error *error)
{
    bool is_raster = source->files[1];
    GLuint shaders[2];
    shaders[0] = compile(is_raster ? GL_VERTEX_SHADER : GL_COMPUTE_SHADER, source, 0, error);
    if (!shaders[0])
        return 0;
    if (!is_raster)
        return link_program(shaders, 1, error);
    shaders[1] = compile(GL_FRAGMENT_SHADER, source, 1, error);
    if (!shaders[1]) {
        glDeleteShader(shaders[0]);
        return 0;
    }
    return link_program(shaders, 2, error);
}

GLuint program_create_single(enum single_program program, struct error *error)
{
    const struct program_source source = source_of_single(program);
    return program_create(&source, error);
}
