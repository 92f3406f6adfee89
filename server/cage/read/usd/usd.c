#include "server/cage/read/usd/usd.h"

#include "server/cage/read/usd/stage.h"

/* Binary files are told by their first bytes. */
static bool refuse_binary(const char *bytes, size_t size, const char *name, struct error *error)
{
    if (size >= 8 && memcmp(bytes, "PXR-USDC", 8) == 0)
        return error_set(error, ERROR_MODEL,
                         "%s: is USD's binary form, and the text form is read: convert it by "
                         "usdcat --flatten -o FILE.usda",
                         name);
    if (size >= 4 && memcmp(bytes, "PK\3\4", 4) == 0)
        return error_set(error, ERROR_MODEL,
                         "%s: is a package (.usdz), and USD's text form is read: convert it by "
                         "usdcat --flatten -o FILE.usda",
                         name);
    return true;
}

static bool begins_with(const struct usd_text *text, const char *beginning)
{
    size_t n = strlen(beginning);
    return (size_t)(text->file->end - text->at) >= n && memcmp(text->at, beginning, n) == 0;
}

/* Files before 2016 begin with "#sdf 1.4.32", and have the same form. The line is a comment of the
 * text that follows. */
static bool check_header(struct usd_text *text)
{
    if (begins_with(text, "\xef\xbb\xbf"))
        text->at += 3; /* a byte order mark, which some Windows programs write */
    if (begins_with(text, "#usda 1.") || begins_with(text, "#sdf 1.4"))
        return true;
    if (begins_with(text, "#usda"))
        return usd_fail(text->file, 1, "the file's version of USD is not read; #usda 1.0 is");
    return usd_fail(text->file, 1,
                    "is not a USD text file: it does not begin with #usda 1.0; OBJ, glTF and GLB "
                    "need a name that ends in .obj, .gltf or .glb");
}

bool usd_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
              struct error *error)
{
    if (!refuse_binary(bytes, size, name, error))
        return false;
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c_locale)
        return error_set(error, ERROR_SERVER, "%s: not enough memory to read it", name);
    const struct usd_file file = {name, (const char *)bytes + size, c_locale, error};
    struct usd_text text = {&file, bytes, 1};
    struct usd_layer layer = {0};
    bool ok =
        check_header(&text) && usd_layer_read(&layer, &text) && usd_stage_build(builder, &layer);
    builder->plain_triangles = cage_builder_has_triangles_alone(builder);
    usd_layer_finish(&layer);
    freelocale(c_locale);
    return ok;
}
