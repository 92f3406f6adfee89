#include "tests/bench/osd_drawing.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <stdexcept>

#include <epoxy/gl.h>

#include <opensubdiv/osd/glPatchTable.h>
#include <opensubdiv/osd/glslPatchShaderSource.h>
#include <opensubdiv/version.h>

#include "tests/bench/bench.h"
#include "tests/bench/osd_patches.h"

namespace Far = OpenSubdiv::Far;
namespace Osd = OpenSubdiv::Osd;

namespace
{

/* llvmpipe (Mesa 22.3) restarts the numbering of a draw call's patches after this many indices, but
 * libosd's shaders use the number to find their patch. */
const int llvmpipe_indices = 1024;

/* The functions that libosd's shaders expect from their user. In eye space the camera looks along
 * -z. */
const char *const user_source = R"(
layout(std140, binding = 0) uniform View {
    mat4 model_view, projection;
    vec4 light_centre, light_u, light_v, light_normal; // u, v over their squared lengths
    vec4 foreground, background, miss;
    float count, duty, tess_level;
};
uniform int first_primitive;
mat4 OsdModelViewMatrix() { return model_view; }
mat4 OsdProjectionMatrix() { return projection; }
mat4 OsdModelViewProjectionMatrix() { return projection * model_view; }
float OsdTessLevel() { return tess_level; }
int OsdGregoryQuadOffsetBase() { return 0; }
int OsdPrimitiveIdBase() { return first_primitive; }
int OsdBaseVertex() { return 0; }
)";

const char *const fragment_source = R"(
in block { OutputVertex v; } inpt;
layout(location = 0) out vec4 colour;
layout(location = 1) out vec4 normal;
void main()
{
    vec3 x = inpt.v.position.xyz, n = normalize(inpt.v.normal), r = reflect(normalize(x), n);
    float t = dot(light_centre.xyz - x, light_normal.xyz) / dot(r, light_normal.xyz);
    vec3 y = x + t * r - light_centre.xyz;
    vec2 at = 0.5 + vec2(dot(y, light_u.xyz), dot(y, light_v.xyz));
    bool met = t > 0 && all(greaterThanEqual(at, vec2(0))) && all(lessThanEqual(at, vec2(1)));
    colour = !met ? miss : fract(at.x * count) < duty ? foreground : background;
    normal = vec4(n, 1);
}
)";

/* In the layout of user_source. */
struct view_block {
    float model_view[16], projection[16];
    float light_centre[4], light_u[4], light_v[4], light_normal[4];
    float foreground[4], background[4], miss[4];
    float count, duty, tess_level;
};

vec3 from(const double a[3])
{
    return {a[0], a[1], a[2]};
}

/* The camera's axes. */
struct frame_axes {
    vec3 eye, right, up, back;

    explicit frame_axes(const camera &camera)
    {
        if (camera.kind != CAMERA_PERSPECTIVE)
            throw std::runtime_error("the OpenSubdiv peer draws perspective cameras only");
        eye = from(camera.eye);
        back = normalized(eye - from(camera.target));
        right = normalized(cross(from(camera.up), back));
        up = cross(back, right);
    }
    vec3 turned(vec3 a) const
    {
        return {dot(right, a), dot(up, a), dot(back, a)};
    }
    vec3 turned_back(vec3 a) const
    {
        return a.x * right + a.y * up + a.z * back;
    }
};

void put(float to[4], vec3 a)
{
    to[0] = (float)a.x;
    to[1] = (float)a.y;
    to[2] = (float)a.z;
}

view_block fill(const frame_request &request, double edge_px)
{
    const light &light = request.lights[0];
    if (light.kind != LIGHT_RECTANGLE || light.pattern.kind != PATTERN_STRIPES)
        throw std::runtime_error("the OpenSubdiv peer knows stripes on a rectangle only");
    frame_axes axes(request.camera);
    view_block block = {};
    const vec3 rows[3] = {axes.right, axes.up, axes.back};
    for (int i = 0; i < 3; i++) {
        const double row[4] = {rows[i].x, rows[i].y, rows[i].z, -dot(rows[i], axes.eye)};
        for (int j = 0; j < 4; j++)
            block.model_view[4 * j + i] = (float)row[j];
    }
    block.model_view[15] = 1;
    /* Depth is 1 at `near` and 0 at infinity. */
    double focal = 1 / std::tan(request.camera.fov_deg * M_PI / 360);
    double near = 1e-3 * length(axes.eye - from(request.camera.target));
    block.projection[0] = (float)(focal * request.height_px / request.width_px);
    block.projection[5] = (float)focal;
    block.projection[14] = (float)near;
    block.projection[11] = -1;
    vec3 u = axes.turned(from(light.u)), v = axes.turned(from(light.v));
    put(block.light_centre, axes.turned(from(light.centre) - axes.eye));
    put(block.light_u, 1 / dot(u, u) * u);
    put(block.light_v, 1 / dot(v, v) * v);
    put(block.light_normal, normalized(cross(u, v)));
    for (int i = 0; i < 4; i++) {
        block.foreground[i] = light.pattern.foreground[i];
        block.background[i] = light.pattern.background[i];
        block.miss[i] = request.miss[i];
    }
    block.count = (float)light.pattern.count;
    block.duty = (float)light.pattern.duty;
    block.tess_level =
        (float)(request.height_px / (2 * edge_px)); /* libosd counts in half pictures */
    return block;
}

GLuint compile(GLenum stage, const std::string &source)
{
    std::string text = "#version 450\n#define OSD_ENABLE_SCREENSPACE_TESSELLATION\n" +
                       Osd::GLSLPatchShaderSource::GetCommonShaderSource() + user_source + source;
    const char *start = text.c_str();
    GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &start, nullptr);
    glCompileShader(shader);
    GLint ok;
    char log[2000] = "";
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    if (!ok)
        throw std::runtime_error(std::string("libosd's shader does not compile: ") + log);
    return shader;
}

GLuint link(Far::PatchDescriptor::Type type)
{
    using source = Osd::GLSLPatchShaderSource;
    const GLuint shaders[4] = {
        compile(GL_VERTEX_SHADER, source::GetVertexShaderSource(type)),
        compile(GL_TESS_CONTROL_SHADER, source::GetTessControlShaderSource(type)),
        compile(GL_TESS_EVALUATION_SHADER, source::GetTessEvalShaderSource(type)),
        compile(GL_FRAGMENT_SHADER, fragment_source)};
    GLuint program = glCreateProgram();
    for (GLuint shader : shaders) {
        glAttachShader(program, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    GLint ok;
    char log[2000] = "";
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    glGetProgramInfoLog(program, sizeof log, nullptr, log);
    if (!ok)
        throw std::runtime_error(std::string("libosd's shaders do not link: ") + log);
    glProgramUniform1i(program, glGetUniformLocation(program, "OsdPatchParamBuffer"), 0);
    return program;
}

} // namespace

struct osd_drawing::implementation {
    double edge_px;
    int most_indices; /* of a draw call */
    std::unique_ptr<Osd::GLPatchTable> patches;
    std::vector<GLuint> programs; /* of each patch array */
    GLuint array = 0, points = 0, view = 0, framebuffer = 0, query = 0;
    GLuint colour = 0, depth = 0, normal = 0;
    uint32_t width = 0, height = 0;

    void reserve(uint32_t new_width, uint32_t new_height);
    void draw(const frame_request &request, bool with_normals);
};

void osd_drawing::implementation::reserve(uint32_t new_width, uint32_t new_height)
{
    if (width == new_width && height == new_height)
        return;
    width = new_width;
    height = new_height;
    const struct {
        GLuint *texture;
        GLenum format, attachment;
    } planes[] = {{&colour, GL_RGBA8, GL_COLOR_ATTACHMENT0},
                  {&normal, GL_RGBA32F, GL_COLOR_ATTACHMENT1},
                  {&depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT}};
    for (const auto &plane : planes) {
        glDeleteTextures(1, plane.texture);
        glCreateTextures(GL_TEXTURE_2D, 1, plane.texture);
        glTextureStorage2D(*plane.texture, 1, plane.format, (GLsizei)width, (GLsizei)height);
        glNamedFramebufferTexture(framebuffer, plane.attachment, *plane.texture, 0);
    }
}

void osd_drawing::implementation::draw(const frame_request &request, bool with_normals)
{
    static const GLenum planes[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    view_block block = fill(request, edge_px);
    reserve(request.width_px, request.height_px);
    glNamedBufferSubData(view, 0, sizeof block, &block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, view);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glNamedFramebufferDrawBuffers(framebuffer, with_normals ? 2 : 1, planes);
    glViewport(0, 0, (GLsizei)width, (GLsizei)height);
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    const GLfloat zero = 0, none[4] = {NAN, NAN, NAN, 0};
    glClearBufferfv(GL_COLOR, 0, request.empty);
    if (with_normals)
        glClearBufferfv(GL_COLOR, 1, none);
    glClearBufferfv(GL_DEPTH, 0, &zero);
    glBindVertexArray(array);
    glBindTextureUnit(0, patches->GetPatchParamTextureBuffer());
    for (size_t i = 0; i < programs.size(); i++) {
        const Osd::PatchArray &patch = patches->GetPatchArrays()[i];
        int vertices = patch.GetDescriptor().GetNumControlVertices();
        glUseProgram(programs[i]);
        glPatchParameteri(GL_PATCH_VERTICES, vertices);
        GLint first_primitive = glGetUniformLocation(programs[i], "first_primitive");
        int most = most_indices / vertices, n;
        for (int first = 0; first < patch.GetNumPatches(); first += n) {
            n = std::min(most, patch.GetNumPatches() - first);
            glUniform1i(first_primitive, patch.GetPrimitiveIdBase() + first);
            size_t index = (size_t)patch.GetIndexBase() + (size_t)first * (size_t)vertices;
            glDrawElements(GL_PATCHES, n * vertices, GL_UNSIGNED_INT,
                           (const void *)(index * sizeof(GLuint)));
        }
    }
}

osd_drawing::osd_drawing(const cage &cage, int level, double edge_px, bool software)
    : m(new implementation)
{
    osd_patches host(cage, level);
    m->edge_px = edge_px;
    m->most_indices = software ? llvmpipe_indices : INT_MAX;
    m->patches.reset(Osd::GLPatchTable::Create(host.table.get()));
    if (!m->patches)
        throw std::runtime_error("libosd makes no GL patch table");
    std::vector<float> points;
    for (const control_point &point : host.points)
        points.insert(points.end(), {(float)point.p.x, (float)point.p.y, (float)point.p.z});
    glCreateBuffers(1, &m->points);
    glNamedBufferStorage(m->points, (GLsizeiptr)(points.size() * sizeof(float)), points.data(), 0);
    glCreateBuffers(1, &m->view);
    glNamedBufferStorage(m->view, sizeof(view_block), nullptr, GL_DYNAMIC_STORAGE_BIT);
    glCreateVertexArrays(1, &m->array);
    glVertexArrayVertexBuffer(m->array, 0, m->points, 0, 3 * sizeof(float));
    glVertexArrayElementBuffer(m->array, m->patches->GetPatchIndexBuffer());
    glEnableVertexArrayAttrib(m->array, 0);
    glVertexArrayAttribFormat(m->array, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(m->array, 0, 0);
    glCreateFramebuffers(1, &m->framebuffer);
    glCreateQueries(GL_TIME_ELAPSED, 1, &m->query);
    for (const Osd::PatchArray &patch : m->patches->GetPatchArrays())
        m->programs.push_back(link(patch.GetDescriptor().GetType()));
}

osd_drawing::~osd_drawing()
{
    for (GLuint program : m->programs)
        glDeleteProgram(program);
    const GLuint buffers[2] = {m->points, m->view};
    const GLuint textures[3] = {m->colour, m->depth, m->normal};
    glDeleteBuffers(2, buffers);
    glDeleteTextures(3, textures);
    glDeleteVertexArrays(1, &m->array);
    glDeleteFramebuffers(1, &m->framebuffer);
    glDeleteQueries(1, &m->query);
}

double osd_drawing::draw_ms(const frame_request &request, bool by_device)
{
    GLuint64 ns = 0;
    double clock = time_ms([&] {
        glBeginQuery(GL_TIME_ELAPSED, m->query);
        m->draw(request, false);
        glEndQuery(GL_TIME_ELAPSED);
        glFinish();
    });
    glGetQueryObjectui64v(m->query, GL_QUERY_RESULT, &ns);
    if (glGetError() != GL_NO_ERROR)
        throw std::runtime_error("OpenSubdiv's drawing ends in a GL error");
    return by_device ? (double)ns / 1e6 : clock;
}

std::vector<float> osd_drawing::normals(const frame_request &request)
{
    size_t width = request.width_px, height = request.height_px;
    std::vector<float> rows(4 * width * height), normals(3 * width * height);
    m->draw(request, true);
    glGetTextureImage(m->normal, 0, GL_RGBA, GL_FLOAT, (GLsizei)(rows.size() * sizeof(float)),
                      rows.data());
    frame_axes axes(request.camera);
    for (size_t i = 0; i < width * height; i++) {
        const float *n = &rows[4 * ((height - 1 - i / width) * width + i % width)];
        vec3 world = axes.turned_back({n[0], n[1], n[2]});
        normals[3 * i] = (float)world.x;
        normals[3 * i + 1] = (float)world.y;
        normals[3 * i + 2] = (float)world.z;
    }
    return normals;
}

std::string osd_drawing::version()
{
    return "OpenSubdiv " + std::to_string(OPENSUBDIV_VERSION_MAJOR) + "." +
           std::to_string(OPENSUBDIV_VERSION_MINOR) + "." +
           std::to_string(OPENSUBDIV_VERSION_PATCH);
}
