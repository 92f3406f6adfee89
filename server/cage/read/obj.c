#include "server/cage/read/obj.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/cage/read/numbers/decimal.h"
#include "server/cage/read/obj_reader.h"

bool obj_fail(const struct obj_reader *reader, const char *format, ...)
{
    char text[320];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return error_set(reader->error, ERROR_MODEL, "%s:%u: %s", reader->name, reader->line, text);
}

static bool read_vertex(struct obj_reader *reader)
{
    double position[3];
    for (int i = 0; i < 3; i++) {
        struct obj_field field;
        char axis = "xyz"[i];
        if (!obj_text_field(&reader->text, &field))
            return obj_fail(reader, "v has %d coordinate%s, needs 3", i, i == 1 ? "" : "s");
        switch (decimal_read(field.text, field.length, reader->c_locale, &position[i])) {
        case DECIMAL_OK:
            break;
        case DECIMAL_BAD:
            return obj_fail(reader, "coordinate %c of v is not a number: '%.*s'", axis,
                            OBJ_SHOWN(&field));
        case DECIMAL_NOT_FINITE:
            return obj_fail(reader, "coordinate %c of v is not finite: '%.*s'", axis,
                            OBJ_SHOWN(&field));
        }
        if (fabs(position[i]) > CAGE_MAX_COORDINATE)
            return obj_fail(reader, "coordinate %c of v is %g, beyond the largest that is read, %g",
                            axis, position[i], CAGE_MAX_COORDINATE);
    }
    /* A weight or a colour may follow; neither changes the position. */
    return obj_read_weight(reader) && cage_builder_vertex(reader->builder, position, reader->error);
}

/* Parses an integer with a sign; saturates far beyond any valid index. */
static bool scan_index(const char **at, const char *end, int64_t *index)
{
    const char *p = *at;
    bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    if (p == end || *p < '0' || *p > '9')
        return false;
    int64_t value = 0;
    for (; p < end && *p >= '0' && *p <= '9'; p++)
        if (value < INT64_C(1000000000000))
            value = value * 10 + (*p - '0');
    *index = negative ? -value : value;
    *at = p;
    return true;
}

bool obj_scan_corner(const struct obj_field *field, int64_t *vertex)
{
    const char *p = field->text, *end = p + field->length;
    int64_t unused;
    if (!scan_index(&p, end, vertex))
        return false;
    if (p == end)
        return true;
    if (*p++ != '/')
        return false;
    if (p < end && *p != '/' && !scan_index(&p, end, &unused))
        return false;
    if (p == end)
        return true;
    if (*p++ != '/')
        return false;
    return p == end || (scan_index(&p, end, &unused) && p == end);
}

static bool read_face(struct obj_reader *reader)
{
    struct cage_builder *builder = reader->builder;
    size_t n_vertices = builder->cage.n_vertices;
    struct obj_field field;
    for (size_t corner = 1; obj_text_field(&reader->text, &field); corner++) {
        int64_t index;
        if (!obj_scan_corner(&field, &index))
            return obj_fail(reader, "face corner %zu is not v, v/t, v//n or v/t/n: '%.*s'", corner,
                            OBJ_SHOWN(&field));
        if (index == 0)
            return obj_fail(reader, "face corner %zu refers to vertex 0, but OBJ counts from 1",
                            corner);
        if (index < 0 && index < -(int64_t)n_vertices)
            return obj_fail(reader,
                            "face corner %zu refers to vertex %lld, but only %zu vertices stand "
                            "before it",
                            corner, (long long)index, n_vertices);
        if (index > (int64_t)CAGE_MAX_VERTICES)
            return obj_fail(reader,
                            "face corner %zu refers to vertex %lld, beyond the largest "
                            "that is read, %u",
                            corner, (long long)index, CAGE_MAX_VERTICES);
        /* Vertices may follow the face that uses them: read_all() checks the index at the end of
         * the file. */
        uint32_t vertex = (uint32_t)(index < 0 ? (int64_t)n_vertices + index : index - 1);
        if (!cage_builder_face_vertex(builder, vertex, reader->error))
            return false;
    }
    return cage_builder_end_face(builder, reader->line, reader->error);
}

/* True for keywords of OBJ that do not concern a cage. */
static bool is_passed_over(const struct obj_field *keyword)
{
    static const char *const words[] = {"vn", "vt",     "vp",     "o", "g",
                                        "s",  "usemtl", "mtllib", "l", "p"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (obj_field_is(keyword, words[i]))
            return true;
    return false;
}

static bool read_statement(struct obj_reader *reader)
{
    struct obj_field keyword;
    if (!obj_text_field(&reader->text, &keyword))
        return true;
    reader->line = reader->text.line;
    if (obj_field_is(&keyword, "v"))
        return read_vertex(reader);
    if (obj_field_is(&keyword, "f"))
        return read_face(reader);
    if (obj_field_is(&keyword, "t"))
        return obj_read_tag(reader);
    bool is_known;
    if (!obj_read_surface(reader, &keyword, &is_known))
        return false;
    if (!is_known && !is_passed_over(&keyword) && !reader->warned_keyword) {
        reader->warned_keyword = true;
        cage_warn(&reader->builder->cage,
                  "%s:%u: unknown keyword '%.*s' passed over, and any others", reader->name,
                  reader->line, OBJ_SHOWN(&keyword));
    }
    return true;
}

static bool read_all(struct obj_reader *reader)
{
    while (reader->text.at < reader->text.end) {
        if (!read_statement(reader))
            return false;
        obj_text_next_line(&reader->text);
    }
    if (!obj_end_surfaces(reader))
        return false;
    const struct cage_builder *builder = reader->builder;
    const struct cage *cage = &builder->cage;
    for (size_t f = 0; f < cage->n_faces; f++) {
        for (uint32_t c = cage->face_start[f]; c < cage->face_start[f + 1]; c++) {
            if (cage->face_vertex[c] < cage->n_vertices)
                continue;
            reader->line = builder->face_line[f];
            return obj_fail(
                reader, "face corner %u refers to vertex %u, but the file has %zu vertices",
                c - cage->face_start[f] + 1, cage->face_vertex[c] + 1, cage->n_vertices);
        }
    }
    return true;
}

#define OTHER_FORMATS "sheen reads OBJ; glTF and GLB need a name that ends in .gltf or .glb"

bool obj_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
              struct error *error)
{
    const char *zero = memchr(bytes, 0, size);
    if (zero)
        return error_set(
            error, ERROR_MODEL,
            "%s: is not an OBJ file: byte %zu is 0, so the file is damaged, UTF-16 or of another "
            "kind. " OTHER_FORMATS,
            name, (size_t)(zero - (const char *)bytes));
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c_locale)
        return error_set(error, ERROR_SERVER, "%s: not enough memory to read it", name);
    struct obj_reader reader = {
        .text = {.at = bytes, .end = (const char *)bytes + size, .line = 1},
        .builder = builder,
        .name = name,
        .c_locale = c_locale,
        .error = error,
    };
    if (size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0)
        reader.text.at += 3; /* a byte order mark, which some Windows programs write */
    bool ok = read_all(&reader);
    builder->plain_triangles = cage_builder_has_triangles_alone(builder);
    const struct cage *cage = &builder->cage;
    if (ok && cage->n_vertices == 0 && cage->n_faces == 0 && cage->n_patches == 0)
        ok =
            error_set(error, ERROR_MODEL,
                      "%s: is not an OBJ file: it has no vertex and no face. " OTHER_FORMATS, name);
    obj_surface_finish(&reader);
    freelocale(c_locale);
    return ok;
}
