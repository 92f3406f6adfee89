#include "server/output/metadata.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "server/output/false_colour.h"
#include "server/base/hex.h"

enum { VERSION, DEVICE, DRIVER, SOFTWARE, MODEL, CAMERA, LINES, LIGHT, COLOURS, SURFACE, SHOW };

static const char *const NAMES[METADATA_ATTRIBUTES] = {
    [VERSION] = "sheen:version",   [DEVICE] = "sheen:device", [DRIVER] = "sheen:driver",
    [SOFTWARE] = "sheen:software", [MODEL] = "sheen:model",   [CAMERA] = "sheen:camera",
    [LINES] = "sheen:lines",       [LIGHT] = "sheen:light",   [COLOURS] = "sheen:colours",
    [SURFACE] = "sheen:surface",   [SHOW] = "sheen:show",
};

#define VEC3 "%.17g,%.17g,%.17g"
#define VEC3_OF(v) (v)[0], (v)[1], (v)[2]
#define COLOUR "%.9g,%.9g,%.9g,%.9g"
#define COLOUR_OF(c) (double)(c)[0], (double)(c)[1], (double)(c)[2], (double)(c)[3]

/* Appends to an attribute's value; what does not fit is cut off. */
static void __attribute__((format(printf, 2, 3))) add(char *value, const char *format, ...)
{
    size_t used = strlen(value);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(value + used, METADATA_VALUE_BYTES - used, format, arguments);
    va_end(arguments);
}

static void describe_camera(char *value, const struct camera *camera)
{
    bool ortho = camera->kind == CAMERA_ORTHOGRAPHIC;
    add(value, "eye=" VEC3 " target=" VEC3 " up=" VEC3 " %s=%.17g", VEC3_OF(camera->eye),
        VEC3_OF(camera->target), VEC3_OF(camera->up), ortho ? "ortho_height" : "fov_deg",
        ortho ? camera->ortho_height : camera->fov_deg);
    if (camera->window.width_px)
        add(value, " window=%.17g,%.17g of %ux%u", camera->window.x, camera->window.y,
            camera->window.width_px, camera->window.height_px);
}

static void describe_lines(char *value, const struct frame_request *request)
{
    static const char *const families[] = {"reflection", "highlight", "isophote", "zebra",
                                           "environment"};
    const struct lines *lines = &request->lines;
    add(value, "%s", families[lines->family]);
    if (lines->has_direction)
        add(value, " direction=" VEC3, VEC3_OF(lines->direction));
    if (lines->eye_kind != LINE_EYE_CAMERA)
        add(value, " %s=" VEC3, lines->eye_kind == LINE_EYE_POINT ? "eye" : "eye_direction",
            VEC3_OF(lines->eye));
    if (request->unfiltered)
        add(value, " unfiltered");
    else if (request->aliased)
        add(value, " aliased");
}

static void describe_surface(char *value, const struct surface *surface)
{
    static const char *const kinds[] = {"exact", "polygon", "wireframe"};
    add(value, "%s", kinds[surface->kind]);
    if (surface->kind != SURFACE_EXACT)
        add(value, ":%u", surface->level);
}

static void describe_show(char *value, const sheen_Show *show)
{
    static const char *const kinds[] = {"lines",  "curvature", "gaussian", "mean",
                                        "normal", "ptex",      "draft"};
    add(value, "%s", kinds[show->kind]);
    if (show->has_direction)
        add(value, " direction=%.17g,%.17g,%.17g", show->direction.x, show->direction.y,
            show->direction.z);
    if (show->has_range)
        add(value, " range=%.17g", show->range);
    if (show->kind != sheen_ShowKind_SHOW_LINES && !false_colour_has_legend(show))
        add(value, " legend=off");
}

static void describe_pattern(char *value, const struct pattern *pattern, const sheen_Light *asked)
{
    static const char *const kinds[] = {"stripes", "lattice", "circles", "image",
                                        "lines",   "rainbow", "distance"};
    add(value, " pattern=%s count=%.17g", kinds[pattern->kind], pattern->count);
    if (pattern->period > 0)
        add(value, " period=%.17g", pattern->period);
    add(value, " duty=%.17g rotation_deg=%.17g offset=%.17g soft=%.17g opacity=%.17g",
        pattern->duty, pattern->rotation_deg, pattern->offset, pattern->soft, pattern->opacity);
    for (uint32_t i = 0; i < pattern->n_at; i++)
        add(value, "%s%.17g", i ? "/" : " at=", pattern->at[i]);
    if (pattern->n_at)
        add(value, " width=%.17g", pattern->width);
    add(value, " foreground=" COLOUR " background=" COLOUR, COLOUR_OF(pattern->foreground),
        COLOUR_OF(pattern->background));
    if (asked && asked->pattern.has_image_sha256) {
        char hex[2 * MODEL_ID_BYTES + 1];
        hex_write(asked->pattern.image_sha256, MODEL_ID_BYTES, hex);
        add(value, " image=%s", hex);
    }
}

static void describe_light(char *value, const struct light *light, const sheen_Light *asked)
{
    static const char *const kinds[] = {"rectangle", "plane", "tunnel", "sphere"};
    add(value, "%s%s%s centre=" VEC3 " u=" VEC3 " v=" VEC3, *value ? " | " : "", kinds[light->kind],
        light->one_sided ? " one-sided" : "", VEC3_OF(light->centre), VEC3_OF(light->u),
        VEC3_OF(light->v));
    describe_pattern(value, &light->pattern, asked);
}

void metadata_init(struct metadata *metadata, const struct frame_request *request,
                   const sheen_Render *asked, const struct renderer_info *info)
{
    char hex[2 * MODEL_ID_BYTES + 1];
    for (int i = 0; i < METADATA_ATTRIBUTES; i++) {
        metadata->attributes[i] = (struct image_attribute){NAMES[i], metadata->values[i]};
        metadata->values[i][0] = 0;
    }
    hex_write(asked->model_sha256, MODEL_ID_BYTES, hex);
    add(metadata->values[VERSION], "%s", SHEEN_VERSION);
    add(metadata->values[DEVICE], "%s", info->device);
    add(metadata->values[DRIVER], "%s", info->driver);
    add(metadata->values[SOFTWARE], "%s", info->software ? "yes" : "no");
    add(metadata->values[MODEL], "%s", hex);
    describe_camera(metadata->values[CAMERA], &request->camera);
    describe_lines(metadata->values[LINES], request);
    for (uint32_t i = 0; i < request->n_lights; i++)
        describe_light(metadata->values[LIGHT], &request->lights[i],
                       i < asked->lights_count ? &asked->lights[i] : NULL);
    add(metadata->values[COLOURS], "miss=" COLOUR " empty=" COLOUR " base=" COLOUR,
        COLOUR_OF(request->miss), COLOUR_OF(request->empty), COLOUR_OF(request->base));
    describe_surface(metadata->values[SURFACE], &request->surface);
    describe_show(metadata->values[SHOW], &asked->show);
}
