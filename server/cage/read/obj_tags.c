#include "server/cage/read/obj_reader.h"

#include <math.h>
#include <stdlib.h>

#include "server/cage/read/numbers/decimal.h"

#define NO_INDEX UINT32_MAX

/* "t NAME ints/floats/strings ..." */
struct tag {
    struct obj_field name;
    uint32_t n_ints, n_floats, n_strings;
};

static bool scan_count(const char **at, const char *end, uint32_t *count)
{
    const char *p = *at;
    if (p == end || *p < '0' || *p > '9')
        return false;
    *count = 0;
    for (; p < end && *p >= '0' && *p <= '9'; p++) {
        if (*count > CAGE_MAX_CORNERS / 10)
            return false;
        *count = *count * 10 + (uint32_t)(*p - '0');
    }
    *at = p;
    return true;
}

static bool read_counts(struct obj_reader *reader, struct tag *tag)
{
    struct obj_field field;
    if (!obj_text_field(&reader->text, &tag->name))
        return obj_fail(reader, "t has no tag name");
    if (!obj_text_field(&reader->text, &field))
        return obj_fail(reader, "t %.*s has no counts, for example 2/1/0", OBJ_SHOWN(&tag->name));
    const char *p = field.text, *end = p + field.length;
    if (!(scan_count(&p, end, &tag->n_ints) && p < end && *p++ == '/' &&
          scan_count(&p, end, &tag->n_floats) && p < end && *p++ == '/' &&
          scan_count(&p, end, &tag->n_strings) && p == end))
        return obj_fail(reader,
                        "t %.*s needs its counts as ints/floats/strings, for example 2/1/0, "
                        "not '%.*s'",
                        OBJ_SHOWN(&tag->name), OBJ_SHOWN(&field));
    return true;
}

static bool missing(const struct obj_reader *reader, const struct tag *tag, const char *what)
{
    return obj_fail(reader, "t %.*s ends before its last %s: it announces %u/%u/%u",
                    OBJ_SHOWN(&tag->name), what, tag->n_ints, tag->n_floats, tag->n_strings);
}

/* Parses an index from 0 on (tags count from 0, faces from 1). A number that cannot be an index
 * becomes NO_INDEX; cage_repair() then leaves the tag out, because there is no such element. */
static bool read_index(struct obj_reader *reader, const struct tag *tag, uint32_t *index)
{
    struct obj_field field;
    if (!obj_text_field(&reader->text, &field))
        return missing(reader, tag, "integer");
    const char *p = field.text, *end = p + field.length;
    if (scan_count(&p, end, index) && p == end)
        return true;
    p = field.text + (field.length > 1 && field.text[0] == '-');
    while (p < end && *p >= '0' && *p <= '9')
        p++;
    *index = NO_INDEX;
    return p == end || obj_fail(reader, "t %.*s: not an index: '%.*s'", OBJ_SHOWN(&tag->name),
                                OBJ_SHOWN(&field));
}

/* Negative sharpness is smooth, as in OpenSubdiv. */
static bool read_sharpness(struct obj_reader *reader, const struct tag *tag, float *sharpness)
{
    struct obj_field field;
    double value;
    if (!obj_text_field(&reader->text, &field))
        return missing(reader, tag, "sharpness");
    if (decimal_read(field.text, field.length, reader->c_locale, &value) != DECIMAL_OK ||
        !isfinite((float)value))
        return obj_fail(reader, "t %.*s: not a sharpness: '%.*s'", OBJ_SHOWN(&tag->name),
                        OBJ_SHOWN(&field));
    if (value < 0 && !reader->warned_negative) {
        reader->warned_negative = true;
        cage_warn(&reader->builder->cage,
                  "%s:%u: t %.*s: sharpness %g counts as 0, as any other below 0", reader->name,
                  reader->line, OBJ_SHOWN(&tag->name), value);
    }
    *sharpness = value > 0 ? (float)value : 0;
    return true;
}

static bool read_crease(struct obj_reader *reader, const struct tag *tag)
{
    struct cage *cage = &reader->builder->cage;
    uint32_t n_edges = tag->n_ints / 2;
    if (tag->n_ints < 2 || tag->n_ints % 2 != 0)
        return obj_fail(reader, "t crease needs pairs of vertices, not %u", tag->n_ints);
    if (tag->n_floats != 1 && tag->n_floats != n_edges && tag->n_floats != tag->n_ints)
        return obj_fail(reader, "t crease has %u sharpnesses for %u edges: give one, or one each",
                        tag->n_floats, n_edges);
    size_t first = cage->n_creases;
    for (uint32_t i = 0; i < n_edges; i++) {
        struct cage_crease crease = {.sharpness = 0};
        if (!read_index(reader, tag, &crease.vertex[0]) ||
            !read_index(reader, tag, &crease.vertex[1]) ||
            !cage_builder_crease(reader->builder, &crease, reader->line, reader->error))
            return false;
    }
    /* If there is one sharpness for each vertex, OpenSubdiv uses every other one: that of the
     * edge's start. */
    uint32_t step = tag->n_floats == n_edges ? 1 : 2;
    for (uint32_t i = 0; i < tag->n_floats; i++) {
        float sharpness;
        if (!read_sharpness(reader, tag, &sharpness))
            return false;
        if (tag->n_floats == 1)
            for (size_t e = first; e < cage->n_creases; e++)
                cage->crease[e].sharpness = sharpness;
        else if (i % step == 0)
            cage->crease[first + i / step].sharpness = sharpness;
    }
    return true;
}

static bool read_corner(struct obj_reader *reader, const struct tag *tag)
{
    struct cage *cage = &reader->builder->cage;
    if (tag->n_ints < 1)
        return obj_fail(reader, "t corner names no vertex");
    if (tag->n_floats != 1 && tag->n_floats != tag->n_ints)
        return obj_fail(reader,
                        "t corner has %u sharpnesses for %u vertices: give one, or one each",
                        tag->n_floats, tag->n_ints);
    size_t first = cage->n_corners;
    for (uint32_t i = 0; i < tag->n_ints; i++) {
        struct cage_corner corner = {.sharpness = 0};
        if (!read_index(reader, tag, &corner.vertex) ||
            !cage_builder_corner(reader->builder, &corner, reader->line, reader->error))
            return false;
    }
    float sharpness = 0;
    for (uint32_t i = 0; i < tag->n_ints; i++) {
        if (i < tag->n_floats && !read_sharpness(reader, tag, &sharpness))
            return false;
        cage->corner[first + i].sharpness = sharpness;
    }
    return true;
}

static bool read_hole(struct obj_reader *reader, const struct tag *tag)
{
    if (tag->n_ints < 1)
        return obj_fail(reader, "t hole names no face");
    for (uint32_t i = 0; i < tag->n_ints; i++) {
        uint32_t face;
        if (!read_index(reader, tag, &face) ||
            !cage_builder_hole(reader->builder, face, reader->line, reader->error))
            return false;
    }
    return true;
}

static bool read_interpolate_boundary(struct obj_reader *reader, const struct tag *tag)
{
    static const enum cage_boundary modes[] = {CAGE_BOUNDARY_NONE, CAGE_BOUNDARY_EDGE_AND_CORNER,
                                               CAGE_BOUNDARY_EDGE_ONLY};
    uint32_t mode;
    if (tag->n_ints != 1)
        return obj_fail(reader, "t interpolateboundary needs one number, 1/0/0");
    if (!read_index(reader, tag, &mode))
        return false;
    if (mode >= sizeof modes / sizeof *modes)
        return obj_fail(reader,
                        "t interpolateboundary is none of 0 (none), 1 (edge and corner), 2 (edge "
                        "only)");
    reader->builder->cage.boundary = modes[mode];
    return true;
}

/* Reads a tag that is one of n words; *choice is its index in words[]. `needs` lists them for the
 * message. */
static bool read_word(struct obj_reader *reader, const struct tag *tag, const char *const *words,
                      size_t n, const char *needs, size_t *choice)
{
    struct obj_field field;
    if (tag->n_strings != 1 || tag->n_ints != 0 || tag->n_floats != 0)
        return obj_fail(reader, "t %.*s needs one word, 0/0/1", OBJ_SHOWN(&tag->name));
    if (!obj_text_field(&reader->text, &field))
        return missing(reader, tag, "word");
    for (*choice = 0; *choice < n; ++*choice)
        if (obj_field_is(&field, words[*choice]))
            return true;
    return obj_fail(reader, "t %.*s is '%.*s', needs %s", OBJ_SHOWN(&tag->name), OBJ_SHOWN(&field),
                    needs);
}

static bool read_crease_method(struct obj_reader *reader, const struct tag *tag)
{
    static const char *const words[] = {"normal", "chaikin"};
    size_t choice;
    if (!read_word(reader, tag, words, 2, "normal or chaikin", &choice))
        return false;
    reader->builder->cage.chaikin = choice == 1;
    return true;
}

static bool read_smooth_triangles(struct obj_reader *reader, const struct tag *tag)
{
    static const char *const words[] = {"catmark", "smooth"};
    size_t choice;
    if (!read_word(reader, tag, words, 2, "catmark or smooth", &choice))
        return false;
    reader->builder->cage.smooth_triangles = choice == 1;
    return true;
}

/* Reads sheen's own tag `scheme`. OBJ files without it are Catmull-Clark's. If there are several,
 * the last one holds, as of the other settings. */
static bool read_scheme(struct obj_reader *reader, const struct tag *tag)
{
    static const char *const words[] = {
        [CAGE_SCHEME_CATMULL_CLARK] = "catmark",
        [CAGE_SCHEME_LOOP] = "loop",
        [CAGE_SCHEME_BILINEAR] = "bilinear",
    };
    size_t choice;
    if (!read_word(reader, tag, words, 3, "catmark, loop or bilinear", &choice))
        return false;
    reader->builder->cage.scheme = (enum cage_scheme)choice;
    return true;
}

/* Reads sheen's own tag `weld`. It has no vertices, because all equal positions are joined. */
static bool read_weld(struct obj_reader *reader, const struct tag *tag)
{
    if (tag->n_ints != 0 || tag->n_floats != 0 || tag->n_strings != 0)
        return obj_fail(reader, "t weld needs nothing, 0/0/0");
    return reader->builder->weld = true;
}

/* Ignores tags that change no position, hierarchical edits, which are not supported, and unknown
 * names. */
static void pass_over(struct obj_reader *reader, const struct tag *tag)
{
    struct cage *cage = &reader->builder->cage;
    struct obj_field field;
    if (tag->name.length > 11 && memcmp(tag->name.text, "facevarying", 11) == 0) {
        if (!reader->warned_facevarying)
            cage_warn(cage, "%s:%u: t %.*s is about textures and passed over", reader->name,
                      reader->line, OBJ_SHOWN(&tag->name));
        reader->warned_facevarying = true;
    } else {
        cage_warn(cage, "%s:%u: t %.*s is not read: the surface is drawn as if it were not there",
                  reader->name, reader->line, OBJ_SHOWN(&tag->name));
    }
    while (obj_text_field(&reader->text, &field))
        ;
}

bool obj_read_tag(struct obj_reader *reader)
{
    struct tag tag;
    if (!read_counts(reader, &tag))
        return false;
    bool ok;
    if (obj_field_is(&tag.name, "crease"))
        ok = read_crease(reader, &tag);
    else if (obj_field_is(&tag.name, "corner"))
        ok = read_corner(reader, &tag);
    else if (obj_field_is(&tag.name, "hole"))
        ok = read_hole(reader, &tag);
    else if (obj_field_is(&tag.name, "interpolateboundary"))
        ok = read_interpolate_boundary(reader, &tag);
    else if (obj_field_is(&tag.name, "creasemethod"))
        ok = read_crease_method(reader, &tag);
    else if (obj_field_is(&tag.name, "smoothtriangles"))
        ok = read_smooth_triangles(reader, &tag);
    else if (obj_field_is(&tag.name, "scheme"))
        ok = read_scheme(reader, &tag);
    else if (obj_field_is(&tag.name, "weld"))
        ok = read_weld(reader, &tag);
    else {
        pass_over(reader, &tag);
        ok = true;
    }
    struct obj_field field;
    if (ok && obj_text_field(&reader->text, &field))
        return obj_fail(reader, "t %.*s has more than it announces (%u/%u/%u): '%.*s'",
                        OBJ_SHOWN(&tag.name), tag.n_ints, tag.n_floats, tag.n_strings,
                        OBJ_SHOWN(&field));
    return ok;
}
