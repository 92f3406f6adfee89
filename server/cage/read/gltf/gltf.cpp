#include "server/cage/read/gltf/gltf.h"

#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "server/cage/read/gltf/gltf_extensions.h"
#include "server/cage/read/gltf/gltf_reader.hpp"

namespace gltf
{

void Reader::refuse(const char *format, ...)
{
    char text[320];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    error_set(failure, ERROR_MODEL, "%s: %s", name, text);
    throw Refused();
}

namespace
{

bool starts_with(const std::string &text, const char *start)
{
    return text.compare(0, strlen(start), start) == 0;
}

/* File access and images: refused and skipped. */

bool no_file(const std::string &, void *)
{
    return false;
}

std::string same_path(const std::string &path, void *)
{
    return path;
}

bool no_reading(std::vector<unsigned char> *, std::string *, const std::string &, void *)
{
    return false;
}

bool no_writing(std::string *, const std::string &, const std::vector<unsigned char> &, void *)
{
    return false;
}

bool skip_image(tinygltf::Image *, const int, std::string *, std::string *, int, int,
                const unsigned char *, int, void *)
{
    return true;
}

/* The library's message without its internal names, such as "[json.exception.parse_error.101]".
 * *broken: the JSON itself is malformed. */
std::string plain_problem(const std::string &problem, bool *broken)
{
    std::string line = problem.substr(0, problem.find('\n'));
    size_t end = starts_with(line, "[json.exception.") ? line.find("] ") : std::string::npos;
    *broken = end != std::string::npos;
    return *broken ? "its JSON is broken: " + line.substr(end + 2) : line;
}

struct Container {
    gltf_container c = {};
    ~Container()
    {
        gltf_container_finish(&c);
    }
};

void parse(Reader &reader, const gltf_container &container)
{
    const char *text = reinterpret_cast<const char *>(container.bytes);
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks({no_file, same_path, no_reading, no_writing, nullptr});
    loader.SetImageLoader(skip_image, nullptr);
    std::string problem, warning;
    bool done = container.binary ? loader.LoadBinaryFromMemory(&reader.model, &problem, &warning,
                                                               container.bytes, container.size)
                                 : loader.LoadASCIIFromString(&reader.model, &problem, &warning,
                                                              text, container.size, "");
    /* The library drops what it cannot parse and continues, so that a part of the cage may be
     * missing: any message counts as an error. */
    if (done && problem.empty())
        return;
    static const std::string absent = "File not found : ";
    bool broken;
    problem = plain_problem(problem, &broken);
    if (reader.packing && !broken) /* the missing part is in the packed data */
        reader.need(gltf_extension_refuse_packing(reader.packing, reader.name, reader.failure));
    if (starts_with(problem, (absent + "data:").c_str()))
        reader.refuse("its '%.60s...' is no data: URI that is read: application/octet-stream in "
                      "base64 is",
                      problem.c_str() + absent.size());
    if (starts_with(problem, absent.c_str()))
        reader.refuse("it refers to the file '%.100s', but nothing outside the given file is read: "
                      "export as GLB or with embedded buffers",
                      problem.c_str() + absent.size());
    reader.refuse("not a glTF file that can be read: %.200s", problem.c_str());
}

void warn_count(Reader &reader, const char *what, size_t count)
{
    if (count > 0)
        cage_warn(&reader.builder->cage, "%s: %s: %zu", reader.name, what, count);
}

void warn_if(Reader &reader, const char *what, bool said)
{
    if (said)
        cage_warn(&reader.builder->cage, "%s: %s", reader.name, what);
}

void add_warnings(Reader &reader)
{
    const PassedOver &passed = reader.passed_over;
    if (reader.ngon_breaks > 0)
        cage_warn(&reader.builder->cage,
                  "%s: FB_ngon_encoding is broken, triangles that do not continue their polygon: "
                  "%zu; a tool may have reordered them",
                  reader.name, reader.ngon_breaks);
    warn_if(reader, "skins are passed over: the cage stands in its bind pose", passed.skins);
    warn_if(reader, "its morph targets have weight 0: the rest shape is shown", passed.morph_rest);
    warn_if(reader,
            "a mesh has other numbers of morph targets and of weights: its rest shape is shown",
            passed.morph_weights);
    warn_count(reader, "points and lines are passed over, primitives", passed.points_and_lines);
    warn_count(reader, "primitives without POSITION are passed over", passed.without_position);
    warn_count(reader, "nodes that KHR_node_visibility hides are passed over", passed.hidden_nodes);
}

/* Refuses a scene without faces, with the reason if it is known. */
void check_faces(Reader &reader)
{
    const PassedOver &passed = reader.passed_over;
    if (reader.builder->cage.n_faces > 0)
        return;
    if (passed.points_and_lines > 0)
        reader.refuse("it holds points and lines alone: no triangle makes a surface");
    if (passed.without_position > 0)
        reader.refuse("none of its triangles has a POSITION");
    if (passed.hidden_nodes > 0)
        reader.refuse("KHR_node_visibility hides all that it holds");
}

void read(Reader &reader, const void *bytes, size_t size)
{
    {
        Container container;
        reader.need(gltf_container_init(&container.c, bytes, size, reader.name, reader.failure));
        reader.binary = container.c.binary;
        reader.packing = container.c.json.packing;
        warn_if(reader,
                "the chunks of the GLB are not on multiples of 4 bytes; its writer is at fault",
                container.c.unaligned);
        parse(reader, container.c);
    }
    add_scene(reader);
    reader.model = {}; /* frees the buffers before the steps that follow, which take memory */
    check_faces(reader);
    add_warnings(reader);
}

} // namespace

} // namespace gltf

extern "C" bool gltf_read(cage_builder *builder, const void *bytes, size_t size, const char *name,
                          error *error)
{
    try {
        gltf::Reader reader = {};
        reader.builder = builder;
        builder->cage.up = CAGE_UP_Y; /* as the specification says */
        reader.name = name;
        reader.failure = error;
        reader.file_bytes = size;
        gltf::read(reader, bytes, size);
        return true;
    } catch (const gltf::Refused &) {
        return false;
    } catch (const std::bad_alloc &) {
        return error_set(error, ERROR_SERVER, "%s: not enough memory to read it", name);
    } catch (const std::exception &problem) {
        return error_set(error, ERROR_MODEL, "%s: not a glTF file that can be read: %.200s", name,
                         problem.what());
    } catch (...) {
        return error_set(error, ERROR_MODEL, "%s: not a glTF file that can be read", name);
    }
}
