#include "server/render/native/polygons/planes.h"

#include <string.h>

/* Runs a program whose workgroups take 64 pixels of a row (shaders/lanes/polygon_at.glsl). */
static void run(const struct native_drawing *d, native_program *program, struct native_bindings b,
                const struct view *view, const struct mesh *mesh)
{
    enum { ROW_PX = 64, VERTEX_TEXELS = sizeof(struct mesh_vertex) / (4 * sizeof(float)) };
    const struct native_target *t = d->target;
    struct native_array corners = {mesh->index, (uint32_t)mesh->n_indices};
    double centre[3];
    view_transform(view, mesh->centre, centre);
    for (int k = 0; k < 3; k++)
        b.centre[k] = (float)centre[k];
    b.vertices = (struct native_texels){(const uint32_t *)(const void *)mesh->vertex,
                                        (uint32_t)mesh->n_vertices * VERTEX_TEXELS};
    b.Corners = &corners;
    native_run_program(d, program, &b, (t->width + ROW_PX - 1) / ROW_PX * t->height);
}

void native_polygon_planes(const struct native_drawing *d, const struct view *view,
                           const struct mesh *mesh, const struct native_seen_triangles *seen)
{
    const struct native_target *t = d->target;
    struct native_bindings b = native_bindings_of(d);
    for (uint32_t y = 0; y < t->height; y++)
        memcpy(t->planes.node + (size_t)y * t->planes.pitch, seen->number + y * seen->pitch,
               t->width * sizeof *seen->number);
    b.ptex = t->ptex;
    run(d, native_device_programs(d->device)->polygon_planes, b, view, mesh);
    native_find_groups(d);
}

void native_polygon_edges(const struct native_drawing *d, const struct view *view,
                          const struct mesh *mesh)
{
    struct native_bindings b = native_bindings_of(d);
    run(d, native_device_programs(d->device)->polygon_edges, b, view, mesh);
}
