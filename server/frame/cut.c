#include "server/frame/cut.h"

/* Weights of a pixel: a light of stripes counts 2. They come from the processors' time on the native device with
 * two threads at 640x480 and 800x600, the surface filling the picture, while other programs took most of the machine:
 * the surface itself 60 to 110 ns a pixel, each light of stripes 12 to 16, of a lattice or circles 20 to 25, of a
 * rainbow 36 to 40. Families of lines and kinds of lights differ by a tenth, so that they have no weight.
 * Mesa's software device takes 2.4 times as much for all of these. */
enum { SURFACE_WEIGHT = 8 };
static const unsigned PATTERN_WEIGHT[] = {
    [sheen_PatternKind_PATTERN_STRIPES] = 2, [sheen_PatternKind_PATTERN_LATTICE] = 3,
    [sheen_PatternKind_PATTERN_CIRCLES] = 3, [sheen_PatternKind_PATTERN_IMAGE] = 3,
    [sheen_PatternKind_PATTERN_LINES] = 3,   [sheen_PatternKind_PATTERN_RAINBOW] = 5,
    [sheen_PatternKind_PATTERN_DISTANCE] = 3};
enum { N_PATTERNS = sizeof PATTERN_WEIGHT / sizeof *PATTERN_WEIGHT };

/* The cost of an interactive tile: by these weights about 6 ms of the native device where two processors draw and
 * have nothing else to do, and 12 ms of Mesa's. Another client waits for a tile at least; tiles twice as large draw
 * frames of 1280x720 and 1920x1080 no faster. The times have not been measured on an idle machine, nor on a GPU. */
#define NATIVE_TILE_COST 800000u /* for two threads */
#define MESA_TILE_COST 667000u
#define GPU_TILE_COST 64000000u

/* Stills and batches have tiles of at most so many pixels, since they come while interactive frames wait.
 * With more than two lights of stripes the tiles are smaller. */
#define SOFTWARE_TILE_PX (256u * 256)
#define HARDWARE_TILE_PX (512u * 512)
#define STILL_WEIGHT 12u /* of a pixel, up to which those numbers hold */

/* The planes of frames of up to this many such tiles are kept, for all classes: a still after a drag is
 * only shaded again. Planes of larger frames would take too much memory. */
#define KEPT_TILES 32

static unsigned pixel_weight(const sheen_Render *render)
{
    unsigned weight = SURFACE_WEIGHT;
    if (render->show.kind != sheen_ShowKind_SHOW_LINES)
        return weight;
    for (pb_size_t i = 0; i < render->lights_count; i++) {
        sheen_PatternKind kind = render->lights[i].pattern.kind;
        weight += (unsigned)kind < N_PATTERNS ? PATTERN_WEIGHT[kind] : 0;
    }
    return render->lights_count ? weight : weight + PATTERN_WEIGHT[0];
}

/* More threads of the native device draw larger tiles in the same time. The cut may depend on their number
 * only where it does not change the frame. */
static uint64_t interactive_cost(const struct cut_device *device)
{
    if (!device->software)
        return GPU_TILE_COST;
    return device->n_threads > 0 ? NATIVE_TILE_COST / 2 * device->n_threads : MESA_TILE_COST;
}

static uint64_t still_px(unsigned weight, bool software)
{
    uint64_t px = software ? SOFTWARE_TILE_PX : HARDWARE_TILE_PX;
    return weight > STILL_WEIGHT ? px * STILL_WEIGHT / weight : px;
}

struct cut cut_frame(const sheen_Render *render, const struct cut_device *device)
{
    uint64_t px = (uint64_t)render->width_px * render->height_px;
    uint64_t device_px = device->software ? SOFTWARE_TILE_PX : HARDWARE_TILE_PX;
    unsigned weight = pixel_weight(render);
    /* Planes in place are those of whole pictures. */
    struct cut cut = {still_px(weight, device->software),
                      px <= KEPT_TILES * device_px && !render->has_window};
    if (render->request_class != sheen_RequestClass_CLASS_INTERACTIVE || !cut.in_place)
        return cut;
    uint64_t most_px = interactive_cost(device) / weight;
    /* Each tile of polygons draws the whole mesh again, in slices. */
    bool is_whole = px <= most_px || render->surface != sheen_SurfaceKind_SURFACE_EXACT;
    cut.tile_px = is_whole ? 0 : most_px;
    return cut;
}
