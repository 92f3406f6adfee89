// Images in and out of memory, and text, through OpenImageIO: see image.h. No exception leaves this
// file.
//
// A reader is chosen by the first bytes and is given the bytes through a proxy, never a path: a
// name from outside opens no file here.
extern "C" {
#include "protocol/srgb.h"
#include "server/image/image.h"
}

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/half.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

namespace
{

constexpr int STRIP_ROWS = 64; // rows gathered at once: a multiple of EXR's 16-row blocks

struct signature {
    size_t offset;
    std::string_view bytes;
    const char *format; // OpenImageIO's name
};

constexpr signature SIGNATURES[] = {
    {0, {"\x89PNG\r\n\x1a\n", 8}, "png"},
    {0, {"\xff\xd8\xff", 3}, "jpeg"},
    {0, {"\x76\x2f\x31\x01", 4}, "openexr"},
    {0, {"II\x2a\0", 4}, "tiff"},
    {0, {"MM\0\x2a", 4}, "tiff"},
    {0, {"II\x2b\0", 4}, "tiff"},
    {0, {"MM\0\x2b", 4}, "tiff"},
    {0, {"#?RADIANCE", 10}, "hdr"},
    {0, {"#?RGBE", 6}, "hdr"},
    {0, {"GIF87a", 6}, "gif"},
    {0, {"GIF89a", 6}, "gif"},
    {8, {"WEBP", 4}, "webp"},
    {0, {"BM", 2}, "bmp"},
};

// PNM begins with P1 to P6, or PF or Pf for floats, then white space.
bool is_pnm(std::string_view file)
{
    return file.size() > 2 && file[0] == 'P' &&
           std::string_view("123456Ff").find(file[1]) != file.npos &&
           std::string_view(" \t\r\n").find(file[2]) != file.npos;
}

// TGA has no signature: checks that the header makes sense. No text passes, because its second byte
// must be 0 or 1.
bool is_tga(std::string_view file)
{
    auto at = [&](size_t i) { return static_cast<unsigned char>(file[i]); };
    if (file.size() < 18)
        return false;
    unsigned map = at(1), kind = at(2), bits = at(16), width = at(12) | at(13) << 8u,
             height = at(14) | at(15) << 8u;
    bool is_mapped = kind == 1 || kind == 9;
    bool is_known = is_mapped || kind == 2 || kind == 3 || kind == 10 || kind == 11;
    return is_known && map <= 1 && (!is_mapped || map == 1) && width > 0 && height > 0 &&
           (bits == 8 || bits == 15 || bits == 16 || bits == 24 || bits == 32);
}

// OpenImageIO's name of the format, or NULL. OpenImageIO is not asked about other formats: it would
// search the file system for a plug-in, and many of its readers are for formats that no light image
// has.
const char *format_of(std::string_view file)
{
    for (const signature &s : SIGNATURES)
        if (file.size() >= s.offset && file.substr(s.offset, s.bytes.size()) == s.bytes)
            return s.format;
    return is_pnm(file) ? "pnm" : is_tga(file) ? "targa" : nullptr;
}

// Detects a cut JPEG file, which libjpeg would fill with grey. In a whole file the last end marker
// follows the last start of a scan, and neither can occur inside of a scan.
bool is_cut_jpeg(std::string_view file)
{
    size_t scan = file.rfind("\xff\xda"), end = file.rfind("\xff\xd9");
    return end == file.npos || scan == file.npos || end < scan;
}

// Extracts one line from OpenImageIO's text, which may have several, and removes the placeholder
// file name.
std::string reason(std::string text)
{
    std::string::size_type end = text.find('\n');
    return text.empty() ? "the file is damaged" : text.substr(0, end);
}

// Reports a reader's error. OpenEXR reports lack of memory as text.
bool fail_reading(const OIIO::ImageInput &reader, const char *name, const char *what,
                  struct error *error)
{
    std::string why = reason(reader.geterror());
    if (why.find("bad_alloc") != why.npos)
        return error_set(error, ERROR_SERVER, "%s: no memory for the image", name);
    return error_set(error, ERROR_IMAGE, "%s: %s %s image: %s", name, what, reader.format_name(),
                     why.c_str());
}

bool open_reader(std::unique_ptr<OIIO::ImageInput> &reader, OIIO::Filesystem::IOMemReader &proxy,
                 OIIO::ImageSpec &spec, const std::string &format, const char *name,
                 struct error *error)
{
    reader = OIIO::ImageInput::create(format);
    if (!reader || !reader->supports("ioproxy")) {
        OIIO::geterror();
        return error_set(error, ERROR_IMAGE,
                         "%s: the OpenImageIO of this daemon cannot read '%s' from memory: convert "
                         "it to PNG or EXR",
                         name, format.c_str());
    }
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1); // values as stored, not premultiplied
    reader->set_ioproxy(&proxy);
    if (!reader->open("image." + format, spec, config))
        return fail_reading(*reader, name, "not a readable", error);
    return true;
}

bool check_spec(const OIIO::ImageSpec &spec, const char *name, uint32_t max_px, struct error *error)
{
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.nchannels < 1)
        return error_set(error, ERROR_IMAGE, "%s: holds no flat image (%d x %d x %d, %d channels)",
                         name, spec.width, spec.height, spec.depth, spec.nchannels);
    if (static_cast<uint32_t>(spec.width) > max_px || static_cast<uint32_t>(spec.height) > max_px)
        return error_set(error, ERROR_IMAGE,
                         "%s: %d x %d pixels; at most %u x %u are taken here: scale it down", name,
                         spec.width, spec.height, max_px, max_px);
    uint64_t bytes = static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) * 4 *
                     (spec.format == OIIO::TypeDesc::UINT8 ? 1 : 4);
    if (bytes > IMAGE_MAX_BYTES || spec.image_bytes(true) > IMAGE_MAX_BYTES)
        return error_set(
            error, ERROR_IMAGE,
            "%s: %d x %d pixels take %llu bytes; at most %llu are taken: scale it down", name,
            spec.width, spec.height, static_cast<unsigned long long>(bytes),
            static_cast<unsigned long long>(IMAGE_MAX_BYTES));
    return true;
}

// Spreads the file's channels to RGBA in place; `pixels` hold `channels` samples with a stride of
// four.
template <typename T> void spread(T *pixels, size_t n, int channels, bool has_alpha, T opaque)
{
    for (T *p = pixels; p < pixels + 4 * n; p += 4) {
        T alpha = has_alpha ? p[channels == 2 ? 1 : 3] : opaque;
        if (channels < 3)
            p[1] = p[2] = p[0];
        p[3] = alpha;
    }
}

// Replaces NaN and infinity, which filtering would spread over a texture.
void make_finite(float *pixels, size_t n)
{
    constexpr float most = std::numeric_limits<float>::max();
    for (float *p = pixels; p < pixels + n; p++)
        *p = std::isnan(*p) ? 0.0f : std::clamp(*p, -most, most);
}

// Converts to linear light, premultiplied by alpha, for filtering. OpenImageIO tells for which
// files alpha is not in the colours yet.
void make_light(float *pixels, size_t n, bool is_encoded, bool is_straight)
{
    for (float *p = pixels; p < pixels + 4 * n; p += 4) {
        p[3] = std::clamp(p[3], 0.0f, 1.0f);
        for (int k = 0; k < 3; k++) {
            if (is_encoded)
                p[k] = static_cast<float>(srgb_to_linear(static_cast<double>(p[k])));
            if (is_straight)
                p[k] *= p[3];
        }
    }
}

bool is_opaque(const uint8_t *pixels, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (pixels[4 * i + 3] < 255)
            return false;
    return true;
}

std::vector<float> light_of_bytes()
{
    std::vector<float> table(256);
    for (int i = 0; i < 256; i++)
        table[static_cast<size_t>(i)] = static_cast<float>(srgb_to_linear(i / 255.0));
    return table;
}

// Converts a transparent 8-bit image to floats: 8 bits of premultiplied colour would be too few.
void *floats_of(const uint8_t *bytes, size_t n, bool is_straight)
{
    const std::vector<float> light = light_of_bytes();
    float *pixels = static_cast<float *>(std::malloc(n * 4 * sizeof *pixels));
    for (size_t i = 0; pixels && i < n; i++) {
        float alpha = static_cast<float>(bytes[4 * i + 3]) / 255.0f;
        for (size_t k = 0; k < 3; k++)
            pixels[4 * i + k] = light[bytes[4 * i + k]] * (is_straight ? alpha : 1.0f);
        pixels[4 * i + 3] = alpha;
    }
    return pixels;
}

bool fail_memory(const OIIO::ImageSpec &spec, const char *name, struct error *error)
{
    return error_set(error, ERROR_SERVER, "%s: no memory for %d x %d pixels", name, spec.width,
                     spec.height);
}

bool read_pixels(struct image *image, OIIO::ImageInput &reader, const OIIO::ImageSpec &spec,
                 const char *name, struct error *error)
{
    bool is_float = spec.format != OIIO::TypeDesc::UINT8;
    size_t sample_bytes = is_float ? sizeof(float) : 1;
    size_t n = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    std::unique_ptr<void, void (*)(void *)> pixels(std::calloc(n, 4 * sample_bytes), std::free);
    if (!pixels)
        return fail_memory(spec, name, error);
    int channels = std::min(spec.nchannels, 4);
    OIIO::TypeDesc type(is_float ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    if (!reader.read_image(0, 0, 0, channels, type, pixels.get(),
                           static_cast<OIIO::stride_t>(4 * sample_bytes)))
        return fail_reading(reader, name, "damaged", error);
    bool has_alpha = channels == 2 || (channels == 4 && (spec.alpha_channel == 3));
    bool is_straight = spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    if (is_float) {
        float *values = static_cast<float *>(pixels.get());
        spread(values, n, channels, has_alpha, 1.0f);
        make_finite(values, 4 * n);
        make_light(values, n, !spec.format.is_floating_point(), is_straight);
    } else {
        uint8_t *values = static_cast<uint8_t *>(pixels.get());
        spread<uint8_t>(values, n, channels, has_alpha, 255);
        is_float = !is_opaque(values, n);
        if (is_float)
            pixels.reset(floats_of(values, n, is_straight));
        if (!pixels)
            return fail_memory(spec, name, error);
    }
    *image = {static_cast<uint32_t>(spec.width), static_cast<uint32_t>(spec.height), is_float,
              pixels.release()};
    if (image_check(image, name, IMAGE_MAX_PX, error))
        return true;
    image_finish(image);
    return false;
}

// A file whose format is known, opened by its reader.
struct opened_file {
    OIIO::Filesystem::IOMemReader proxy; // outlives the reader
    std::unique_ptr<OIIO::ImageInput> reader;
    OIIO::ImageSpec spec;
    opened_file(const void *bytes, size_t size) : proxy(bytes, size)
    {
    }
};

bool open_file(opened_file &opened, std::string_view file, const char *name, uint32_t max_px,
               struct error *error)
{
    if (file.empty())
        return error_set(error, ERROR_IMAGE, "%s: not an image: the file is empty", name);
    const char *format = format_of(file);
    if (!format)
        return error_set(error, ERROR_IMAGE,
                         "%s: it is not an image format that is read: " IMAGE_READ_FORMATS, name);
    if (!std::strcmp(format, "jpeg") && is_cut_jpeg(file))
        return error_set(error, ERROR_IMAGE, "%s: the jpeg file is cut off", name);
    return open_reader(opened.reader, opened.proxy, opened.spec, format, name, error) &&
           check_spec(opened.spec, name, max_px, error);
}

bool decode(struct image *image, const void *bytes, size_t size, const char *name, uint32_t max_px,
            struct error *error)
{
    opened_file opened(bytes, size);
    return open_file(opened, {static_cast<const char *>(bytes), size}, name, max_px, error) &&
           read_pixels(image, *opened.reader, opened.spec, name, error);
}

bool measure(struct image *image, const void *bytes, size_t size, const char *name, uint32_t max_px,
             struct error *error)
{
    opened_file opened(bytes, size);
    if (!open_file(opened, {static_cast<const char *>(bytes), size}, name, max_px, error))
        return false;
    const OIIO::ImageSpec &spec = opened.spec;
    const bool may_be_transparent = spec.nchannels == 2 || spec.nchannels >= 4;
    *image = {static_cast<uint32_t>(spec.width), static_cast<uint32_t>(spec.height),
              spec.format != OIIO::TypeDesc::UINT8 || may_be_transparent, nullptr};
    if (spec.format == OIIO::TypeDesc::UINT8 && image_bytes(image) > IMAGE_MAX_BYTES)
        image->is_float = false; // it is refused if it is transparent
    return true;
}

// --- encoding

struct file_format {
    const char *name,
        *file_name;     // OpenImageIO's name, and a file name whose ending tells it the format
    const char *colour; // the 8-bit channels that it takes; NULL: any
};

constexpr file_format FORMATS[] = {
    {"openexr", "image.exr", nullptr},
    {"tiff", "image.tif", "RGBA"},
};

constexpr size_t sample_bytes_in(enum image_type type)
{
    return type == IMAGE_UINT8 ? 1 : 4;
}

// Converts a colour to what readers of OpenEXR expect: linear light, premultiplied by alpha.
// `alpha` is that of the pixel.
half light_of(uint8_t value, uint8_t alpha, bool is_alpha)
{
    static const std::vector<float> light = light_of_bytes();
    float share = static_cast<float>(alpha) / 255.0f;
    return half(is_alpha ? share : light[value] * share);
}

using channel_list = std::vector<const struct image_channel *>;

// Chooses the channels of the file, in its order.
bool choose_channels(channel_list &chosen, const file_format &format,
                     const struct image_channel *channels, size_t n, struct error *error)
{
    for (size_t i = 0; !format.colour && i < n; i++)
        chosen.push_back(&channels[i]);
    for (const char *c = format.colour; c && *c; c++)
        for (size_t i = 0; i < n; i++)
            if (channels[i].name[0] == *c && !channels[i].name[1] &&
                channels[i].type == IMAGE_UINT8)
                chosen.push_back(&channels[i]);
    for (size_t i = 0; i < n; i++)
        if (std::find(chosen.begin(), chosen.end(), &channels[i]) == chosen.end())
            return error_set(
                error, ERROR_REQUEST,
                "a %s file cannot hold the plane %s: write EXR, or ask for colour only",
                format.name, channels[i].name);
    if (chosen.empty() || (format.colour && chosen.size() < 3))
        return error_set(error, ERROR_REQUEST, "a %s file needs %s", format.name,
                         format.colour ? "the colour plane" : "at least one plane");
    return true;
}

void set_channels(OIIO::ImageSpec &spec, const channel_list &channels, bool mixed)
{
    for (size_t i = 0; i < channels.size(); i++) {
        spec.channelnames[i] = channels[i]->name;
        if (spec.channelnames[i] == "A")
            spec.alpha_channel = static_cast<int>(i);
        if (mixed)
            spec.channelformats.push_back(channels[i]->type == IMAGE_FLOAT ? OIIO::TypeDesc::FLOAT
                                          : channels[i]->type == IMAGE_UINT32
                                              ? OIIO::TypeDesc::UINT
                                              : OIIO::TypeDesc::HALF);
    }
}

void set_attributes(OIIO::ImageSpec &spec, enum image_format format,
                    const struct image_attribute *attributes, size_t n)
{
    // OpenImageIO writes the time of day unless there is a DateTime.
    spec.attribute("DateTime", "");
    switch (format) {
    case IMAGE_EXR: {
        // Rec. 709 with white point D65: x and y of red, green, blue and white.
        static const float chromaticities[8] = {0.64f, 0.33f, 0.3f,    0.6f,
                                                0.15f, 0.06f, 0.3127f, 0.329f};
        spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), chromaticities);
        spec.attribute("oiio:ColorSpace", "Linear");
        spec.attribute("compression", "zip:4");
        break;
    }
    case IMAGE_TIFF:
        spec.attribute("oiio:UnassociatedAlpha", 1);
        spec.attribute("compression", "zip");
        spec.attribute("tiff:zipquality", 4);
        spec.attribute("tiff:predictor", 2); // horizontal differences
        break;
    }
    std::string description; // TIFF has only one text field
    for (size_t i = 0; i < n; i++) {
        if (format != IMAGE_TIFF)
            spec.attribute(attributes[i].name, attributes[i].value);
        else
            description += std::string(attributes[i].name) + "=" + attributes[i].value + "\n";
    }
    if (!description.empty())
        spec.attribute("ImageDescription", description);
}

void put_light(uint8_t *to, uint8_t value, uint8_t alpha, bool is_alpha)
{
    half light = light_of(value, alpha, is_alpha);
    std::memcpy(to, &light, sizeof light);
}

uint8_t alpha_at(const struct image_channel *alpha, uint32_t x, uint32_t y)
{
    return alpha ? static_cast<const uint8_t *>(
                       alpha->data)[y * alpha->row_stride_bytes + x * alpha->pixel_stride_bytes]
                 : 255;
}

// The 8-bit channel A, or NULL: opaque.
const struct image_channel *alpha_of(const channel_list &channels)
{
    for (const struct image_channel *channel : channels)
        if (channel->type == IMAGE_UINT8 && !std::strcmp(channel->name, "A"))
            return channel;
    return nullptr;
}

// Copies rows [first, last) of all channels, interleaved; in a mixed file 8-bit colours become
// light in HALF.
void gather(std::vector<uint8_t> &strip, const channel_list &channels, uint32_t width,
            uint32_t first, uint32_t last, size_t pixel_bytes, bool mixed)
{
    const struct image_channel *alpha = alpha_of(channels);
    size_t offset = 0;
    for (const struct image_channel *channel : channels) {
        size_t bytes = sample_bytes_in(channel->type);
        uint8_t *to = strip.data() + offset;
        for (uint32_t y = first; y < last; y++) {
            const uint8_t *from =
                static_cast<const uint8_t *>(channel->data) + y * channel->row_stride_bytes;
            for (uint32_t x = 0; x < width; x++, to += pixel_bytes) {
                if (bytes == 4)
                    std::memcpy(to, from, 4);
                else if (mixed)
                    put_light(to, *from, alpha_at(alpha, x, y), channel == alpha);
                else
                    *to = *from;
                from += channel->pixel_stride_bytes;
            }
        }
        offset += bytes == 1 && mixed ? sizeof(half) : bytes;
    }
}

bool write_rows(OIIO::ImageOutput &writer, const OIIO::ImageSpec &spec,
                const channel_list &channels, bool mixed)
{
    uint32_t width = static_cast<uint32_t>(spec.width), height = static_cast<uint32_t>(spec.height);
    size_t pixel_bytes = 0;
    for (const struct image_channel *channel : channels) {
        size_t bytes = sample_bytes_in(channel->type);
        pixel_bytes += bytes == 1 && mixed ? sizeof(half) : bytes;
    }
    std::vector<uint8_t> strip(pixel_bytes * width * std::min<uint32_t>(height, STRIP_ROWS));
    for (uint32_t first = 0; first < height; first += STRIP_ROWS) {
        uint32_t last = std::min<uint32_t>(first + STRIP_ROWS, height);
        gather(strip, channels, width, first, last, pixel_bytes, mixed);
        // UNKNOWN: the samples already have the file's types.
        OIIO::TypeDesc type(mixed ? OIIO::TypeDesc::UNKNOWN : OIIO::TypeDesc::UINT8);
        if (!writer.write_scanlines(static_cast<int>(first), static_cast<int>(last), 0, type,
                                    strip.data()))
            return false;
    }
    return true;
}

bool encode(enum image_format kind, uint32_t width, uint32_t height,
            const struct image_channel *channels, size_t n_channels,
            const struct image_attribute *attributes, size_t n_attributes, uint8_t **bytes,
            size_t *size, struct error *error)
{
    const file_format &format = FORMATS[kind];
    channel_list chosen;
    if (!choose_channels(chosen, format, channels, n_channels, error))
        return false;
    bool mixed = kind == IMAGE_EXR;
    if (width == 0 || height == 0 || width > IMAGE_MAX_PX || height > IMAGE_MAX_PX)
        return error_set(error, ERROR_REQUEST, "an image of %u x %u pixels cannot be written",
                         width, height);
    OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height),
                         static_cast<int>(chosen.size()),
                         OIIO::TypeDesc(mixed ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::UINT8));
    set_channels(spec, chosen, mixed);
    set_attributes(spec, kind, attributes, n_attributes);

    std::vector<unsigned char> file;
    OIIO::Filesystem::IOVecOutput proxy(file);
    std::unique_ptr<OIIO::ImageOutput> writer = OIIO::ImageOutput::create(format.name);
    if (!writer || !writer->supports("ioproxy"))
        return error_set(error, ERROR_IMAGE, "this OpenImageIO cannot write %s to memory: %s",
                         format.name, reason(OIIO::geterror()).c_str());
    writer->set_ioproxy(&proxy);
    if (!writer->open(format.file_name, spec) || !write_rows(*writer, spec, chosen, mixed) ||
        !writer->close())
        return error_set(error, ERROR_IMAGE, "writing %s failed: %s", format.name,
                         reason(writer->geterror()).c_str());
    uint8_t *copy = static_cast<uint8_t *>(std::malloc(file.size()));
    if (!copy)
        throw std::bad_alloc();
    std::memcpy(copy, file.data(), file.size());
    *bytes = copy;
    *size = file.size();
    return true;
}

// Runs work() and turns exceptions into errors.
template <typename Work> bool guarded(const char *what, struct error *error, Work work)
{
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return error_set(error, ERROR_SERVER, "%s: no memory for the image", what);
    } catch (const std::exception &e) {
        return error_set(error, ERROR_IMAGE, "%s: %s", what, e.what());
    } catch (...) {
        return error_set(error, ERROR_IMAGE, "%s: the image library failed", what);
    }
}

} // namespace

extern "C" bool image_decode(struct image *image, const void *bytes, size_t size, const char *name,
                             uint32_t max_px, struct error *error)
{
    *image = {};
    return guarded(name, error, [&] { return decode(image, bytes, size, name, max_px, error); });
}

extern "C" bool image_measure(struct image *size, const void *bytes, size_t n_bytes,
                              const char *name, uint32_t max_px, struct error *error)
{
    *size = {};
    return guarded(name, error, [&] { return measure(size, bytes, n_bytes, name, max_px, error); });
}

extern "C" void image_use_one_thread(void)
{
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
}

extern "C" bool image_encode(enum image_format format, uint32_t width_px, uint32_t height_px,
                             const struct image_channel *channels, size_t n_channels,
                             const struct image_attribute *attributes, size_t n_attributes,
                             uint8_t **bytes, size_t *size, struct error *error)
{
    *bytes = nullptr;
    *size = 0;
    return guarded("encoding", error, [&] {
        return encode(format, width_px, height_px, channels, n_channels, attributes, n_attributes,
                      bytes, size, error);
    });
}
