#include "server/output/encode.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "server/base/fault.h"
#include "server/output/png.h"

#define ZSTD_LEVEL 1
#define MAX_CHANNELS 22 /* of all planes together */
_Static_assert(MAX_CHANNELS <= PICTURE_MAX_CHANNELS, "a picture holds all channels");

struct encoding;

struct strip_task {
    struct task task;
    struct encoding *encoding;
    size_t index;
    size_t start, size; /* bytes `start` to `size` of the block belong to the frame */
    bool has_alpha;     /* PNG: the strip was encoded with alpha */
    uint32_t checksum;  /* PNG: of the strip */
    struct error error; /* why it failed */
};

struct encoding {
    struct encoded *encoded;
    struct codec_layout layout;
    struct encode_format format;
    enum pool_urgency urgency;
    const struct image_attribute *attributes;
    size_t n_attributes;
    void (*finished)(void *owner, struct encoded *encoded, const struct error *error);
    void *owner;
    struct pool *pool;
    struct workers *workers;

    struct error error; /* why it failed */
    struct task file_task;
    size_t file_size;
    struct jpeg_layout jpeg;
    struct strip_layout png;
    atomic_bool has_alpha; /* a strip that is not opaque was found */
    struct strip_task *strips;
    size_t n_strips, n_strips_left;
    bool (*join)(struct encoding *encoding); /* puts the encoded strips together; false: no
                                              * memory */
};

/* The encoders of one thread. */
struct encoders {
    struct codec_encoder *zstd;
    struct jpeg_encoder *jpeg;
    struct png_encoder *png;
};

static void stop_context(void *context)
{
    struct encoders *encoders = context;
    codec_encoder_destroy(encoders->zstd);
    jpeg_encoder_destroy(encoders->jpeg);
    png_encoder_destroy(encoders->png);
    free(encoders);
}

static bool start_context(void *owner, void **context, struct error *error)
{
    (void)owner;
    struct encoders *encoders = calloc(1, sizeof *encoders);
    if (encoders && (encoders->zstd = codec_encoder_create(ZSTD_LEVEL)) &&
        (encoders->jpeg = jpeg_encoder_create()) && (encoders->png = png_encoder_create())) {
        *context = encoders;
        return true;
    }
    if (encoders)
        stop_context(encoders);
    return error_set(error, ERROR_SERVER, "no memory for the encoders of a thread");
}

const struct pool_context encode_context = {start_context, stop_context, NULL};

void encoded_destroy(struct encoded *encoded)
{
    if (!encoded)
        return;
    if (encoded->unsent)
        --*encoded->unsent;
    if (encoded->released)
        encoded->released(encoded->memory_of);
    frame_finish(&encoded->frame);
    struct block_cache *block_cache = encoded->block_cache;
    for (size_t i = 0; i < encoded->n_blocks; i++)
        block_cache_give(block_cache, encoded->blocks[i]);
    block_cache_give(block_cache, encoded->blocks);
    block_cache_give(block_cache, encoded->pieces);
    block_cache_give(block_cache, encoded);
}

static void end_encoding(struct encoding *encoding, const struct error *error)
{
    struct encoded *encoded = encoding->encoded;
    struct block_cache *block_cache = encoded->block_cache;
    if (error) {
        encoded_destroy(encoded);
        encoded = NULL;
    }
    encoding->finished(encoding->owner, encoded, error);
    block_cache_give(block_cache, encoding->strips);
    block_cache_give(block_cache, encoding);
}

static void set_no_memory(const struct encoding *encoding, struct error *error)
{
    error_set(error, ERROR_SERVER, "no memory to encode %u x %u pixels: try again later",
              encoding->layout.width_px, encoding->layout.height_px);
}

static void end_without_memory(struct encoding *encoding)
{
    set_no_memory(encoding, &encoding->error);
    end_encoding(encoding, &encoding->error);
}

static void add_piece(struct encoded *encoded, const uint8_t *bytes, size_t size)
{
    encoded->pieces[encoded->n_pieces++] = (struct encoded_piece){bytes, size};
    encoded->size += size;
}

/* Room for n blocks and as many pieces. */
static bool allocate(struct encoded *encoded, size_t n)
{
    encoded->blocks = block_cache_take(encoded->block_cache, n * sizeof *encoded->blocks);
    encoded->pieces = block_cache_take(encoded->block_cache, n * sizeof *encoded->pieces);
    encoded->n_blocks = encoded->blocks ? n : 0;
    for (size_t i = 0; i < encoded->n_blocks; i++)
        encoded->blocks[i] = NULL;
    return encoded->blocks && encoded->pieces;
}

struct encoded *encoded_of(struct block_cache *block_cache, uint8_t *bytes, size_t size)
{
    struct encoded *encoded = block_cache_take(block_cache, sizeof *encoded);
    if (!encoded)
        return NULL;
    *encoded = (struct encoded){.block_cache = block_cache};
    if (!allocate(encoded, 1)) {
        encoded_destroy(encoded);
        return NULL;
    }
    encoded->blocks[0] = bytes;
    add_piece(encoded, bytes, size);
    return encoded;
}

/* --- RAW: the planes are the bytes */

static void start_raw(struct encoding *encoding)
{
    struct encoded *encoded = encoding->encoded;
    if (!allocate(encoded, CODEC_PLANES)) {
        end_without_memory(encoding);
        return;
    }
    for (unsigned plane = 0; plane < CODEC_PLANES; plane++)
        if (encoding->layout.planes & (1u << plane))
            add_piece(encoded, encoded->frame.plane[plane],
                      codec_plane_bytes(&encoding->layout, plane));
    end_encoding(encoding, NULL);
}

/* --- strips: block 1 + i is strip i, block 0 what precedes the strips in the file */

/* NULL: the strip has failed. */
static uint8_t *take_strip(struct strip_task *strip, size_t bound)
{
    struct encoded *encoded = strip->encoding->encoded;
    uint8_t **block = &encoded->blocks[1 + strip->index];
    if (!*block) /* a strip that is repeated keeps its block */
        *block = fault_at("encode") ? NULL : block_cache_take(encoded->block_cache, bound);
    if (!*block)
        set_no_memory(strip->encoding, &strip->error);
    return *block;
}

static void add_strips(struct encoding *encoding)
{
    for (size_t i = 0; i < encoding->n_strips; i++) {
        const struct strip_task *strip = &encoding->strips[i];
        add_piece(encoding->encoded, encoding->encoded->blocks[1 + i] + strip->start,
                  strip->size - strip->start);
    }
}

/* Submits again the strips that were encoded without alpha before another strip was found to have
 * alpha. False: there is none. */
static bool repeat_strips(struct encoding *encoding)
{
    for (size_t i = 0; i < encoding->n_strips; i++) {
        struct strip_task *strip = &encoding->strips[i];
        if (strip->has_alpha == atomic_load(&encoding->has_alpha))
            continue;
        encoding->n_strips_left++;
        pool_submit(encoding->pool, &strip->task, encoding->urgency);
    }
    return encoding->n_strips_left > 0;
}

static void strip_done(struct task *task)
{
    const struct strip_task *strip = task->owner;
    struct encoding *encoding = strip->encoding;
    if (strip->error.kind != ERROR_NONE)
        encoding->error = strip->error;
    if (--encoding->n_strips_left > 0 ||
        (encoding->error.kind == ERROR_NONE && repeat_strips(encoding)))
        return;
    frame_finish(&encoding->encoded->frame);
    if (encoding->error.kind != ERROR_NONE)
        end_encoding(encoding, &encoding->error);
    else if (encoding->join(encoding))
        end_encoding(encoding, NULL);
    else
        end_without_memory(encoding);
}

static void start_strips(struct encoding *encoding, size_t n,
                         void (*run)(struct task *task, void *context),
                         bool (*join)(struct encoding *encoding))
{
    encoding->strips =
        block_cache_take(encoding->encoded->block_cache, n * sizeof *encoding->strips);
    if (!encoding->strips || !allocate(encoding->encoded, n + 1)) {
        end_without_memory(encoding);
        return;
    }
    encoding->n_strips = encoding->n_strips_left = n;
    encoding->join = join;
    for (size_t i = 0; i < n; i++) {
        struct strip_task *strip = &encoding->strips[i];
        *strip = (struct strip_task){.encoding = encoding, .index = i};
        strip->task = (struct task){run, strip_done, strip, {NULL}};
        pool_submit(encoding->pool, &strip->task, encoding->urgency);
    }
}

/* --- ZSTD: a table and the strips */

static void zstd_run(struct task *task, void *context)
{
    struct strip_task *strip = task->owner;
    struct encoding *encoding = strip->encoding;
    struct encoders *encoders = context;
    struct codec_strip place = codec_strip_at(&encoding->layout, strip->index);
    size_t bound = codec_strip_bound(&place);
    uint8_t *bytes = take_strip(strip, bound);
    if (!bytes)
        return;
    strip->size = codec_strip_encode(encoders->zstd, &place,
                                     encoding->encoded->frame.plane[place.plane], bytes, bound);
    if (strip->size == 0)
        set_no_memory(encoding, &strip->error);
}

static bool zstd_join(struct encoding *encoding)
{
    struct block_cache *block_cache = encoding->encoded->block_cache;
    uint32_t *lengths = block_cache_take(block_cache, encoding->n_strips * sizeof *lengths);
    uint8_t *table = block_cache_take(block_cache, encoding->layout.table_bytes);
    encoding->encoded->blocks[0] = table;
    bool ok = lengths && table;
    for (size_t i = 0; ok && i < encoding->n_strips; i++)
        lengths[i] = (uint32_t)encoding->strips[i].size;
    if (ok) {
        codec_table_encode(&encoding->layout, lengths, table);
        add_piece(encoding->encoded, table, encoding->layout.table_bytes);
        add_strips(encoding);
    }
    block_cache_give(block_cache, lengths);
    return ok;
}

/* --- JPEG: a head and the strips */

static void jpeg_run(struct task *task, void *context)
{
    struct strip_task *strip = task->owner;
    struct encoding *encoding = strip->encoding;
    struct encoders *encoders = context;
    uint8_t *bytes = take_strip(strip, encoding->jpeg.strips.bound);
    if (bytes)
        jpeg_strip_encode(encoders->jpeg, &encoding->jpeg, strip->index,
                          encoding->encoded->frame.plane[0], bytes, &strip->start, &strip->size,
                          &strip->error);
}

static bool jpeg_join(struct encoding *encoding)
{
    struct encoded *encoded = encoding->encoded;
    const size_t start = encoding->strips[0].start;
    const size_t bound = jpeg_head_bound(start, encoding->attributes, encoding->n_attributes);
    uint8_t *head = block_cache_take(encoded->block_cache, bound);
    encoded->blocks[0] = head;
    if (!head)
        return false;
    add_piece(encoded, head,
              jpeg_head_write(&encoding->jpeg, encoded->blocks[1], start, encoding->attributes,
                              encoding->n_attributes, head));
    add_strips(encoding);
    return true;
}

static void start_jpeg(struct encoding *encoding)
{
    jpeg_layout_init(&encoding->jpeg, encoding->layout.width_px, encoding->layout.height_px,
                     &encoding->format.jpeg);
    start_strips(encoding, encoding->jpeg.strips.n, jpeg_run, jpeg_join);
}

/* --- PNG: a head and the strips, of which the last holds the tail */

static void png_run(struct task *task, void *context)
{
    struct strip_task *strip = task->owner;
    struct encoding *encoding = strip->encoding;
    struct encoders *encoders = context;
    const uint8_t *rgba = encoding->encoded->frame.plane[0];
    struct png_strip written = {0};
    uint8_t *bytes = take_strip(strip, encoding->png.bound);
    uint8_t *row =
        bytes ? block_cache_take(encoding->encoded->block_cache, png_row_bytes(&encoding->png))
              : NULL;
    /* Most pictures are opaque, so each strip is searched for alpha only when it is encoded. */
    if (!atomic_load(&encoding->has_alpha) &&
        !png_strip_is_opaque(&encoding->png, strip->index, rgba))
        atomic_store(&encoding->has_alpha, true);
    strip->has_alpha = atomic_load(&encoding->has_alpha);
    if (!row)
        set_no_memory(encoding, &strip->error);
    else
        png_strip_encode(encoders->png, &encoding->png, strip->index, rgba, strip->has_alpha, row,
                         bytes, &written, &strip->error);
    block_cache_give(encoding->encoded->block_cache, row);
    strip->size = written.size;
    strip->checksum = written.checksum;
}

static bool png_join(struct encoding *encoding)
{
    struct encoded *encoded = encoding->encoded;
    struct strip_task *last = &encoding->strips[encoding->n_strips - 1];
    const bool has_alpha = atomic_load(&encoding->has_alpha);
    uint8_t *head = block_cache_take(encoded->block_cache,
                                     png_head_bound(encoding->attributes, encoding->n_attributes));
    encoded->blocks[0] = head;
    if (!head)
        return false;
    uint32_t checksum = 1;
    for (size_t i = 0; i < encoding->n_strips; i++)
        checksum =
            png_checksum(checksum, &encoding->png, i, has_alpha, encoding->strips[i].checksum);
    last->size += png_tail_write(checksum, encoded->blocks[encoding->n_strips] + last->size);
    add_piece(encoded, head,
              png_head_write(&encoding->png, has_alpha, encoding->attributes,
                             encoding->n_attributes, head));
    add_strips(encoding);
    return true;
}

static void start_png(struct encoding *encoding)
{
    png_layout_init(&encoding->png, encoding->layout.width_px, encoding->layout.height_px);
    start_strips(encoding, encoding->png.n, png_run, png_join);
}

/* --- files, by a worker process */

/* The channels of every plane, in the order of the planes' bits. */
static const struct {
    const char *name;
    unsigned plane;
    enum image_type type;
    size_t offset_bytes;
} CHANNELS[MAX_CHANNELS] = {
    {"R", 0, IMAGE_UINT8, 0},           {"G", 0, IMAGE_UINT8, 1},
    {"B", 0, IMAGE_UINT8, 2},           {"A", 0, IMAGE_UINT8, 3},
    {"P.X", 1, IMAGE_FLOAT, 0},         {"P.Y", 1, IMAGE_FLOAT, 4},
    {"P.Z", 1, IMAGE_FLOAT, 8},         {"N.X", 2, IMAGE_FLOAT, 0},
    {"N.Y", 2, IMAGE_FLOAT, 4},         {"N.Z", 2, IMAGE_FLOAT, 8},
    {"ptex.face", 3, IMAGE_UINT32, 0},  {"ptex.u", 3, IMAGE_FLOAT, 4},
    {"ptex.v", 3, IMAGE_FLOAT, 8},      {"light.s", 4, IMAGE_FLOAT, 0},
    {"light.t", 4, IMAGE_FLOAT, 4},     {"k.min", 5, IMAGE_FLOAT, 0},
    {"k.max", 5, IMAGE_FLOAT, 4},       {"light.dsdx", 6, IMAGE_FLOAT, 0},
    {"light.dsdy", 6, IMAGE_FLOAT, 4},  {"light.dtdx", 6, IMAGE_FLOAT, 8},
    {"light.dtdy", 6, IMAGE_FLOAT, 12}, {"coverage", 7, IMAGE_FLOAT, 0},
};

static enum image_format file_format(sheen_Encoding encoding)
{
    return encoding == sheen_Encoding_ENCODING_EXR ? IMAGE_EXR : IMAGE_TIFF;
}

static void add_channels(const struct encoding *encoding, struct picture *picture)
{
    for (size_t i = 0; i < MAX_CHANNELS; i++) {
        unsigned plane = CHANNELS[i].plane;
        size_t stride = codec_pixel_bytes(plane);
        if (encoding->layout.planes & (1u << plane))
            picture->channels[picture->n_channels++] = (struct image_channel){
                CHANNELS[i].name, CHANNELS[i].type,
                (const uint8_t *)encoding->encoded->frame.plane[plane] + CHANNELS[i].offset_bytes,
                stride, stride * encoding->layout.width_px};
    }
}

static void file_run(struct task *task, void *context)
{
    (void)context;
    struct encoding *encoding = task->owner;
    struct picture picture = {.format = file_format(encoding->format.encoding),
                              .width_px = encoding->layout.width_px,
                              .height_px = encoding->layout.height_px,
                              .n_attributes = encoding->n_attributes};
    for (size_t i = 0; i < encoding->n_attributes; i++)
        picture.attributes[i] = encoding->attributes[i];
    add_channels(encoding, &picture);
    struct picture_block planes[CODEC_PLANES];
    size_t n_planes = 0;
    for (unsigned plane = 0; plane < CODEC_PLANES; plane++)
        if (encoding->layout.planes & (1u << plane))
            planes[n_planes++] = (struct picture_block){
                encoding->encoded->frame.plane[plane], codec_plane_bytes(&encoding->layout, plane)};
    workers_write_image(encoding->workers, &picture, planes, n_planes,
                        encoding->encoded->block_cache, &encoding->encoded->blocks[0],
                        &encoding->file_size, &encoding->error);
}

static void file_done(struct task *task)
{
    struct encoding *encoding = task->owner;
    frame_finish(&encoding->encoded->frame);
    if (!encoding->encoded->blocks[0]) {
        end_encoding(encoding, &encoding->error);
        return;
    }
    add_piece(encoding->encoded, encoding->encoded->blocks[0], encoding->file_size);
    end_encoding(encoding, NULL);
}

static void start_file(struct encoding *encoding)
{
    if (!allocate(encoding->encoded, 1)) {
        end_without_memory(encoding);
        return;
    }
    encoding->file_task = (struct task){file_run, file_done, encoding, {NULL}};
    pool_submit(encoding->pool, &encoding->file_task, encoding->urgency);
}

_Static_assert((int)JPEG_420 == (int)sheen_JpegSubsampling_JPEG_420, "same order");

struct encode_format encode_format_of(const sheen_Render *render)
{
    struct encode_format format = {.encoding = render->encoding, .jpeg = JPEG_DEFAULTS};
    if (render->has_jpeg_quality)
        format.jpeg.quality = render->jpeg_quality;
    if (render->has_jpeg_subsampling)
        format.jpeg.subsampling = (enum jpeg_subsampling)render->jpeg_subsampling;
    return format;
}

uint64_t encode_bytes(const struct codec_layout *layout, const struct encode_format *format)
{
    struct jpeg_layout jpeg;
    struct strip_layout png;
    switch (format->encoding) {
    case sheen_Encoding_ENCODING_RAW:
        return 0;
    case sheen_Encoding_ENCODING_JPEG:
        jpeg_layout_init(&jpeg, layout->width_px, layout->height_px, &format->jpeg);
        return (uint64_t)jpeg.strips.n * jpeg.strips.bound;
    case sheen_Encoding_ENCODING_PNG:
        png_layout_init(&png, layout->width_px, layout->height_px);
        return (uint64_t)png.n * png.bound;
    default:
        return layout->raw_bytes;
    }
}

void encode_start(struct pool *pool, struct workers *workers, struct frame *frame,
                  const struct codec_layout *layout, const struct encode_format *format,
                  enum pool_urgency urgency, const struct image_attribute *attributes,
                  size_t n_attributes,
                  void (*finished)(void *owner, struct encoded *encoded, const struct error *error),
                  void *owner)
{
    struct block_cache *block_cache = frame->block_cache;
    struct encoding *encoding = block_cache_take(block_cache, sizeof *encoding);
    struct encoded *encoded = block_cache_take(block_cache, sizeof *encoded);
    if (!encoding || !encoded) {
        block_cache_give(block_cache, encoding);
        block_cache_give(block_cache, encoded);
        frame_finish(frame);
        struct error error = {0};
        error_set(&error, ERROR_SERVER, "no memory to encode a frame: try again later");
        finished(owner, NULL, &error);
        return;
    }
    *encoded = (struct encoded){.frame = *frame, .block_cache = block_cache};
    *frame = (struct frame){0};
    *encoding = (struct encoding){
        .encoded = encoded,
        .layout = *layout,
        .format = *format,
        .urgency = urgency,
        .attributes = attributes,
        .n_attributes = n_attributes,
        .finished = finished,
        .owner = owner,
        .pool = pool,
        .workers = workers,
    };
    switch (format->encoding) {
    case sheen_Encoding_ENCODING_RAW:
        start_raw(encoding);
        break;
    case sheen_Encoding_ENCODING_ZSTD:
        start_strips(encoding, layout->n_strips, zstd_run, zstd_join);
        break;
    case sheen_Encoding_ENCODING_PNG:
        start_png(encoding);
        break;
    case sheen_Encoding_ENCODING_JPEG:
        start_jpeg(encoding);
        break;
    default:
        start_file(encoding);
        break;
    }
}
