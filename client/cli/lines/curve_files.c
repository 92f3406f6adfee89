#include "client/cli/lines/curve_files.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "client/cli/lines/cubics.h"
#include "client/cli/output/json.h"

/* Cubic paths are within this distance of the points, px. */
static const double PATH_TOLERANCE_PX = 0.02;

static const struct sheen_curve *curve_of(const struct curve_drawing *drawing, size_t part)
{
    return &drawing->curves->curves[drawing->parts[part].curve];
}

/* The number of points that a part has: its ends and all of the curve's points between. */
static size_t points_of(const struct curve_part *part)
{
    double first = floor(part->from) + 1, last = ceil(part->to) - 1;
    return 2 + (last >= first ? (size_t)(last - first) + 1 : 0);
}

/* Point k of a part. */
static double place_of(const struct curve_part *part, size_t k)
{
    double at = k == 0 ? part->from : floor(part->from) + (double)k;
    return at < part->to && k + 1 < points_of(part) ? at : part->to;
}

/* --- SVG */

static void write_path(FILE *out, const struct cubic *cubics, size_t n)
{
    fprintf(out, "<path d=\"M%.3f %.3f", cubics[0].control[0][0], cubics[0].control[0][1]);
    for (size_t i = 0; i < n; i++) {
        const double(*c)[2] = cubics[i].control;
        fprintf(out, "C%.3f %.3f %.3f %.3f %.3f %.3f", c[1][0], c[1][1], c[2][0], c[2][1], c[3][0],
                c[3][1]);
    }
    fputs("\"/>\n", out);
}

/* The points of a part in the picture; parts that reach behind the camera are cut there. Returns their number. */
static size_t project(const struct curve_drawing *drawing, size_t index, struct plane_point *points)
{
    const struct curve_part *part = &drawing->parts[index];
    const struct sheen_curve *curve = curve_of(drawing, index);
    size_t n = 0, n_points = points_of(part);
    for (size_t k = 0; k < n_points; k++) {
        double position[3], along[3];
        curve_at(curve, place_of(part, k), position, along);
        if (!(projection_place(drawing->projection, position, points[n].at) > 0))
            break;
        projection_tangent(drawing->projection, position, along, points[n].along);
        n++;
    }
    return n;
}

static bool write_part(FILE *out, const struct curve_drawing *drawing, size_t index)
{
    size_t most = points_of(&drawing->parts[index]);
    struct plane_point *points = malloc(most * sizeof(*points));
    struct cubic *cubics = malloc(most * sizeof(*cubics));
    bool ok = points && cubics;
    if (ok) {
        size_t n = project(drawing, index, points);
        if (n > 1)
            write_path(out, cubics, cubics_fit(points, n, PATH_TOLERANCE_PX, cubics));
    }
    free(points);
    free(cubics);
    return ok;
}

/* Writes the parts of one line, visible or hidden ones. */
static bool write_line(FILE *out, const struct curve_drawing *drawing, size_t first, size_t last,
                       bool visible)
{
    bool ok = true, is_open = false;
    for (size_t i = first; i < last && ok; i++) {
        if (drawing->parts[i].visible != visible)
            continue;
        if (!is_open && !visible)
            fputs("<g class=\"hidden\" stroke-dasharray=\"3 3\" stroke-opacity=\"0.5\">\n", out);
        is_open = true;
        ok = write_part(out, drawing, i);
    }
    if (is_open && !visible)
        fputs("</g>\n", out);
    return ok;
}

bool curve_write_svg(FILE *out, const struct curve_drawing *drawing)
{
    static const char *const COLOURS[] = {"#d00000", "#0050d0", "#008040", "#a000a0",
                                          "#c06000", "#007080", "#606000", "#404040"};
    uint32_t width = drawing->projection->width_px, height = drawing->projection->height_px;
    bool ok = true;
    uint32_t light = UINT32_MAX;
    fprintf(out,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%" PRIu32 "\" height=\"%" PRIu32
            "\" viewBox=\"0 0 %" PRIu32 " %" PRIu32 "\">\n"
            "<g fill=\"none\" stroke-width=\"1\" stroke-linecap=\"round\">\n",
            width, height, width, height);
    for (size_t first = 0, last; first < drawing->n_parts && ok; first = last) {
        const struct sheen_curve *curve = curve_of(drawing, first);
        for (last = first + 1; last < drawing->n_parts; last++)
            if (curve_of(drawing, last)->line != curve->line)
                break;
        if (curve->light != light) {
            if (light != UINT32_MAX)
                fputs("</g>\n", out);
            light = curve->light;
            fprintf(out, "<g id=\"light-%" PRIu32 "\" stroke=\"%s\">\n", light + 1,
                    COLOURS[light % (sizeof(COLOURS) / sizeof(*COLOURS))]);
        }
        fprintf(out, "<g id=\"line-%" PRIu32 "\"", curve->line + 1);
        if (!isnan(curve->place)) {
            fputs(" data-place=\"", out);
            json_write_double(out, curve->place);
            fputc('"', out);
        }
        fputs(">\n", out);
        ok = write_line(out, drawing, first, last, true) &&
             (drawing->visible_only || write_line(out, drawing, first, last, false));
        fputs("</g>\n", out);
    }
    if (light != UINT32_MAX)
        fputs("</g>\n", out);
    fputs("</g>\n</svg>\n", out);
    return ok;
}

/* --- DXF */

static void write_vertex(FILE *out, const char *layer, const double point[3])
{
    fprintf(out, "0\nVERTEX\n8\n%s", layer);
    for (int i = 0; i < 3; i++) {
        fprintf(out, "\n%d\n", 10 * (i + 1));
        json_write_double(out, point[i]);
    }
    fputs("\n70\n32\n", out);
}

static void begin_polyline(FILE *out, const char *layer, bool is_closed)
{
    fprintf(out, "0\nPOLYLINE\n8\n%s\n66\n1\n10\n0\n20\n0\n30\n0\n70\n%d\n", layer,
            is_closed ? 9 : 8);
}

static void write_polyline(FILE *out, const struct curve_drawing *drawing, size_t index)
{
    const struct curve_part *part = &drawing->parts[index];
    const struct sheen_curve *curve = curve_of(drawing, index);
    char layer[40];
    snprintf(layer, sizeof(layer), "LIGHT_%" PRIu32, curve->light + 1);
    bool is_whole = part->from == 0 && part->to == (double)curve->n_points;
    begin_polyline(out, layer, curve->is_closed && is_whole);
    size_t n = points_of(part) - (curve->is_closed && is_whole);
    for (size_t k = 0; k < n; k++) {
        double position[3], along[3];
        curve_at(curve, place_of(part, k), position, along);
        write_vertex(out, layer, position);
    }
    fprintf(out, "0\nSEQEND\n8\n%s\n", layer);
}

/* Without --visible-only a curve is one polyline. */
static void write_whole(FILE *out, const struct curve_drawing *drawing, uint32_t index)
{
    const struct sheen_curve *curve = &drawing->curves->curves[index];
    char layer[40];
    snprintf(layer, sizeof(layer), "LIGHT_%" PRIu32, curve->light + 1);
    begin_polyline(out, layer, curve->is_closed);
    for (size_t k = 0; k < curve->n_points; k++)
        write_vertex(out, layer, curve->points[k].position);
    fprintf(out, "0\nSEQEND\n8\n%s\n", layer);
}

void curve_write_dxf(FILE *out, const struct curve_drawing *drawing)
{
    fputs("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n",
          out);
    for (uint32_t i = 0; !drawing->visible_only && i < drawing->curves->n_curves; i++)
        write_whole(out, drawing, i);
    for (size_t i = 0; drawing->visible_only && i < drawing->n_parts; i++)
        if (drawing->parts[i].visible)
            write_polyline(out, drawing, i);
    fputs("0\nENDSEC\n0\nEOF\n", out);
}

/* --- CSV */

static void write_field(FILE *out, double value)
{
    fputc(',', out);
    if (!isnan(value))
        json_write_double(out, value);
}

void curve_write_csv(FILE *out, const struct curve_drawing *drawing)
{
    size_t part = 0;
    fputs(
        "curve,light,line,place,closed,visible,x,y,z,nx,ny,nz,tx,ty,tz,face,u,v,residual,length\n",
        out);
    for (uint32_t i = 0; i < drawing->curves->n_curves; i++) {
        const struct sheen_curve *curve = &drawing->curves->curves[i];
        while (drawing->parts[part].curve != i)
            part++;
        for (size_t k = 0; k < curve->n_points; k++) {
            const struct sheen_curve_point *point = &curve->points[k];
            while ((double)k > drawing->parts[part].to)
                part++;
            bool is_visible = drawing->parts[part].visible;
            if (drawing->visible_only && !is_visible)
                continue;
            fprintf(out, "%" PRIu32 ",%" PRIu32 ",%" PRIu32, i, curve->light + 1, curve->line + 1);
            write_field(out, curve->place);
            fprintf(out, ",%d,%d", curve->is_closed, is_visible);
            for (int d = 0; d < 3; d++)
                write_field(out, point->position[d]);
            for (int d = 0; d < 3; d++)
                write_field(out, point->normal[d]);
            for (int d = 0; d < 3; d++)
                write_field(out, point->along[d]);
            fprintf(out, ",%" PRIu32, point->face);
            write_field(out, point->uv[0]);
            write_field(out, point->uv[1]);
            write_field(out, point->residual);
            write_field(out, point->length);
            fputc('\n', out);
        }
    }
}
