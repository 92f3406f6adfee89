#include "server/render/gl/readback.h"

#include <math.h>

#include "server/render/gl/context/check.h"
#include "server/render/gl/device_internal.h"

/* The rows of a tile inside a plane of the whole frame. */
struct rows {
    char *first;
    size_t stride, pixel;
};

static struct rows tile_rows(const struct frame *frame, int plane,
                             const struct frame_request *request, const struct tile *tile)
{
    const struct view_part part = view_part_of(request);
    size_t pixel = frame_plane_bytes((enum frame_plane)(1 << plane));
    size_t stride = pixel * frame->width_px;
    char *first =
        (char *)frame->plane[plane] + (tile->y - part.y) * stride + (tile->x - part.x) * pixel;
    return (struct rows){first, stride, pixel};
}

/* Reads a part of a texture; px of the drawn tile. */
static void read_part(GLuint texture, GLenum format, GLenum type, const struct tile *part,
                      size_t bytes, void *texels)
{
    glGetTextureSubImage(texture, 0, (GLint)part->x, (GLint)part->y, 0, (GLsizei)part->width,
                         (GLsizei)part->height, 1, format, type, (GLsizei)bytes, texels);
}

/* Reads planes that the target holds in the form in which they are returned. */
static void read_direct(GLuint texture, GLenum format, GLenum type, const struct rows *rows,
                        uint32_t frame_width, const struct tile *part)
{
    glPixelStorei(GL_PACK_ROW_LENGTH, (GLint)frame_width);
    read_part(texture, format, type, part,
              (part->height - 1) * rows->stride + part->width * rows->pixel, rows->first);
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
}

static void read_four(GLuint texture, GLenum format, GLenum type, const struct tile *part,
                      void *texels)
{
    read_part(texture, format, type, part, (size_t)part->width * part->height * 16, texels);
}

/* The point at each pixel's depth on the ray of its centre: world coordinates, computed in double
 * precision. */
static void pack_position(const float *depth, const struct view *view, const struct rows *rows,
                          const struct tile *tile)
{
    for (uint32_t y = 0; y < tile->height; y++) {
        float(*out)[3] = (float(*)[3])(void *)(rows->first + y * rows->stride);
        for (uint32_t x = 0; x < tile->width; x++, depth++) {
            if (*depth > 0)
                view_position(view, tile->x + x, tile->y + y, (double)*depth, out[x]);
            else
                out[x][0] = out[x][1] = out[x][2] = NAN;
        }
    }
}

/* A normal of 0 marks a place without one (a cone's tip). */
static bool has_normal(const float n[4])
{
    return n[0] != 0 || n[1] != 0 || n[2] != 0;
}

static void pack_normal(const float (*texels)[4], const float *depth, const struct rows *rows,
                        const struct tile *tile)
{
    for (uint32_t y = 0; y < tile->height; y++) {
        float(*out)[3] = (float(*)[3])(void *)(rows->first + y * rows->stride);
        for (uint32_t x = 0; x < tile->width; x++, texels++, depth++)
            for (int k = 0; k < 3; k++)
                out[x][k] = *depth > 0 && has_normal(*texels) ? (*texels)[k] : NAN;
    }
}

static void pack_ptex(const uint32_t (*texels)[4], const struct rows *rows, const struct tile *tile)
{
    for (uint32_t y = 0; y < tile->height; y++) {
        uint32_t(*out)[3] = (uint32_t(*)[3])(void *)(rows->first + y * rows->stride);
        for (uint32_t x = 0; x < tile->width; x++, texels++)
            for (int k = 0; k < 3; k++)
                out[x][k] = (*texels)[k];
    }
}

static bool read_packed(struct gl_renderer *r, const struct frame_request *request,
                        const struct view *view, const struct tile *part, const struct tile *tile,
                        struct frame *frame, struct error *error)
{
    enum { NEED_DEPTH = PLANE_POSITION | PLANE_NORMAL };
    if (!(request->planes & (NEED_DEPTH | PLANE_PTEX)))
        return true;
    size_t pixels = (size_t)tile->width * tile->height, bytes = pixels * 20;
    struct block_cache *block_cache = r->base.options.block_cache;
    float *depth = block_cache_take(block_cache, pixels * 4);
    void *other = block_cache_take(block_cache, pixels * 16);
    bool ok = depth && other;
    if (ok && request->planes & NEED_DEPTH)
        read_part(r->target.hit_depth, GL_RED, GL_FLOAT, part, pixels * 4, depth);
    if (ok && request->planes & PLANE_POSITION) {
        struct rows rows = tile_rows(frame, 1, request, tile);
        pack_position(depth, view, &rows, tile);
    }
    if (ok && request->planes & PLANE_NORMAL) {
        struct rows rows = tile_rows(frame, 2, request, tile);
        read_four(r->target.normal, GL_RGBA, GL_FLOAT, part, other);
        pack_normal(other, depth, &rows, tile);
    }
    if (ok && request->planes & PLANE_PTEX) {
        struct rows rows = tile_rows(frame, 3, request, tile);
        read_four(r->target.ptex, GL_RGBA_INTEGER, GL_UNSIGNED_INT, part, other);
        pack_ptex(other, &rows, tile);
    }
    block_cache_give(block_cache, depth);
    block_cache_give(block_cache, other);
    return ok || error_set(error, ERROR_SERVER,
                           "out of memory: reading a tile back needs %zu bytes", bytes);
}

bool readback(struct gl_renderer *r, const struct frame_request *request, const struct view *view,
              const struct tile *drawn, const struct tile *tile, struct frame *frame,
              struct error *error)
{
    const struct tile part = {tile->x - drawn->x, tile->y - drawn->y, tile->width, tile->height};
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    const struct {
        int plane;
        GLuint texture;
        GLenum format, type;
    } direct[] = {
        {0, r->target.colour, GL_RGBA, GL_UNSIGNED_BYTE},
        {4, r->target.light, GL_RG, GL_FLOAT},
        {5, r->target.curvature, GL_RG, GL_FLOAT},
        {6, r->target.light_change, GL_RGBA, GL_FLOAT},
        {7, r->target.coverage, GL_RED, GL_FLOAT},
    };
    for (size_t i = 0; i < sizeof direct / sizeof direct[0]; i++) {
        if (!(request->planes & 1u << direct[i].plane))
            continue;
        struct rows rows = tile_rows(frame, direct[i].plane, request, tile);
        read_direct(direct[i].texture, direct[i].format, direct[i].type, &rows, frame->width_px,
                    &part);
    }
    return read_packed(r, request, view, &part, tile, frame, error) &&
           gpu_check("reading a frame back", error);
}
