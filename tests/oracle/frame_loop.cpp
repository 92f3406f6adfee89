#include "tests/oracle/frame_loop.h"

#include <cstdio>
#include <memory>
#include <stdexcept>

#include "tests/oracle/frame_client.h"

namespace
{

const int exit_bad_model = 3;

} // namespace

std::string render_view(const std::string &sheen, const std::string &model_path, view *view,
                        const std::string &aov, const std::vector<std::string> &more_options,
                        planes *planes, int *exit_code)
{
    temporary_folder folder;
    std::string file = folder.file("frame.exr");
    std::vector<std::string> command = {sheen, "render", model_path, "-o",
                                        file,  "--aov",  aov,        "--json"};
    for (const std::vector<std::string> &options : {view_options(*view), more_options})
        command.insert(command.end(), options.begin(), options.end());
    program_result result = run_program(command, folder);
    *exit_code = result.exit_code;
    std::string what = model_path + " " + view->name + ": ";
    if (result.exit_code != 0)
        return what + "sheen render ended with " + std::to_string(result.exit_code) + ": " +
               result.errors;
    try {
        *planes = read_planes(file, aov);
    } catch (const std::exception &failure) {
        return what + failure.what();
    }
    if (planes->width_px != view->width_px || planes->height_px != view->height_px)
        return what + "the picture has another size than asked for";
    if (view->chosen_by_sheen && !read_camera(result.output, view))
        return what + "no camera in the JSON: " + result.output;
    return "";
}

frame_source frames_by_command(const std::string &sheen)
{
    return [sheen](const model &model, view *view, planes *planes) {
        int exit_code;
        return render_view(sheen, model.path, view, "P,N,ptex,k", {}, planes, &exit_code);
    };
}

frame_source frames_by_library()
{
    auto client = std::make_shared<std::unique_ptr<frame_client>>(); /* of the latest model */
    auto path = std::make_shared<std::string>();
    return [client, path](const model &model, view *view, planes *planes) -> std::string {
        try {
            if (*path != model.path)
                client->reset(new frame_client(model.path));
            *path = model.path;
            *planes = (*client)->draw(view);
            return "";
        } catch (const std::exception &failure) {
            path->clear();
            return model.path + " " + view->name + ": " + failure.what();
        }
    };
}

void for_each_frame(const frame_source &draw, const std::vector<std::string> &models,
                    const view_list &views, verdict *verdict, const frame_judge &judge)
{
    for (const std::string &path : models) {
        model model;
        try {
            model = read_model(path);
        } catch (const std::exception &failure) {
            verdict->check(false, failure.what());
            continue;
        }
        for (view &view : views(model)) {
            planes planes;
            std::string wrong = draw(model, &view, &planes);
            if (verdict->check(wrong.empty(), wrong))
                judge(model, view, planes);
        }
        std::fflush(stdout);
    }
}
