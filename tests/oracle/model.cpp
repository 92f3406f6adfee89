#include "tests/oracle/model.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

namespace fs = std::filesystem;

namespace
{

void measure_box(model *model)
{
    const int n = 8;
    bool first = true;
    for (uint32_t face = 0; face < model->oracle->n_ptex_faces(); face++)
        for (int i = 0; i < (n + 1) * (n + 1); i++) {
            vec3 p;
            if (!model->oracle->evaluate(face, i % (n + 1) / (double)n, i / (n + 1) / (double)n,
                                         &p))
                continue;
            if (first)
                model->box_min = model->box_max = p;
            first = false;
            model->box_min = {std::min(model->box_min.x, p.x), std::min(model->box_min.y, p.y),
                              std::min(model->box_min.z, p.z)};
            model->box_max = {std::max(model->box_max.x, p.x), std::max(model->box_max.y, p.y),
                              std::max(model->box_max.z, p.z)};
        }
    if (first)
        throw std::runtime_error("no surface at all");
}

model make_model(const std::string &path, std::shared_ptr<const cage> cage)
{
    model model;
    model.path = path;
    model.name = fs::path(path).filename();
    model.cage = cage;
    try {
        model.oracle.reset(new osd_oracle(*cage));
        measure_box(&model);
    } catch (const std::exception &failure) {
        throw std::runtime_error(path + ": " + failure.what());
    }
    return model;
}

bool is_cage_file(const fs::path &path)
{
    fs::path ending = path.extension();
    return ending == ".obj" || ending == ".gltf" || ending == ".glb";
}

bool is_catmull_clark_by_name(const std::string &name)
{
    return name.rfind("loop_", 0) != 0 && name.rfind("bilinear_", 0) != 0 &&
           name.find("nonman") == std::string::npos;
}

std::vector<std::string> list_folder(const std::string &folder)
{
    std::vector<std::string> found, passed_over;
    for (const fs::directory_entry &entry : fs::directory_iterator(folder)) {
        if (!is_cage_file(entry.path()))
            continue;
        std::string name = entry.path().filename();
        (is_catmull_clark_by_name(name) ? found : passed_over).push_back(entry.path());
    }
    std::sort(found.begin(), found.end());
    if (!passed_over.empty())
        std::printf("%s: passing over %zu of other schemes or not manifold\n", folder.c_str(),
                    passed_over.size());
    return found;
}

} // namespace

model read_model(const std::string &path)
{
    return make_model(path, read_cage_file(path));
}

model with_boundary(const model &original, cage_boundary boundary)
{
    /* A shallow copy. The deleter keeps the original, which owns the memory, alive. */
    std::shared_ptr<const cage> owner = original.cage;
    std::shared_ptr<struct cage> cage(new struct cage(*owner),
                                      [owner](struct cage *c) { delete c; });
    cage->boundary = boundary;
    return make_model(original.path, cage);
}

std::vector<std::string> list_models(const std::vector<std::string> &arguments)
{
    std::vector<std::string> files;
    for (const std::string &argument : arguments) {
        if (fs::is_directory(argument)) {
            std::vector<std::string> found = list_folder(argument);
            files.insert(files.end(), found.begin(), found.end());
        } else if (fs::exists(argument)) {
            files.push_back(argument);
        } else {
            std::printf("MISSING: %s is not there; going on without it\n", argument.c_str());
        }
    }
    return files;
}
