#include "tests/oracle/render.h"
#include "tests/oracle/srgb.h"

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <spawn.h>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>

extern char **environ;

namespace
{

const int time_limit_s = 120;

/* A file whose channels are all read at once, each into its own vector. */
class exr_file
{
  public:
    explicit exr_file(const std::string &path)
        : file(path.c_str()), window(file.header().dataWindow())
    {
    }
    int width_px() const
    {
        return window.max.x - window.min.x + 1;
    }
    int height_px() const
    {
        return window.max.y - window.min.y + 1;
    }
    /* A channel of 32 bits a value, which the file must have as this type. */
    template <typename T>
    void want(const char *name, Imf::PixelType promised, std::vector<T> *values)
    {
        if (channel(name).type != promised)
            throw std::runtime_error(std::string("channel ") + name + " is of type " +
                                     std::to_string(channel(name).type));
        insert(name, promised, values);
    }
    /* A channel of any type, as floats. */
    void want_floats(const char *name, std::vector<float> *values)
    {
        channel(name);
        insert(name, Imf::FLOAT, values);
    }
    void read()
    {
        file.setFrameBuffer(wanted);
        file.readPixels(window.min.y, window.max.y);
    }

  private:
    const Imf::Channel &channel(const char *name) const
    {
        const Imf::Channel *found = file.header().channels().findChannel(name);
        if (!found)
            throw std::runtime_error(std::string("no channel ") + name);
        return *found;
    }
    template <typename T> void insert(const char *name, Imf::PixelType type, std::vector<T> *values)
    {
        static_assert(sizeof(T) == 4, "a float or uint32_t");
        values->resize((size_t)width_px() * (size_t)height_px());
        wanted.insert(name, Imf::Slice::Make(type, values->data(), window));
    }

    Imf::InputFile file;
    const Imath::Box2i window;
    Imf::FrameBuffer wanted;
};

bool names_plane(const std::string &aov, const std::string &plane)
{
    return ("," + aov + ",").find("," + plane + ",") != std::string::npos;
}

/* From linear light to sRGB. */
void display_colour(planes *planes)
{
    for (std::vector<float> *colour : {&planes->red, &planes->green, &planes->blue})
        for (size_t i = 0; i < colour->size(); i++) {
            float alpha = planes->alpha[i];
            (*colour)[i] = alpha > 0 ? (float)displayed_of((double)((*colour)[i] / alpha)) : 0;
        }
}

void read_all(exr_file *file, const std::string &aov, planes *planes)
{
    struct {
        const char *plane, *channel;
        std::vector<float> *values;
    } wanted[] = {
        {"P", "P.X", &planes->px},
        {"P", "P.Y", &planes->py},
        {"P", "P.Z", &planes->pz},
        {"N", "N.X", &planes->nx},
        {"N", "N.Y", &planes->ny},
        {"N", "N.Z", &planes->nz},
        {"ptex", "ptex.u", &planes->u},
        {"ptex", "ptex.v", &planes->v},
        {"k", "k.min", &planes->k_min},
        {"k", "k.max", &planes->k_max},
        {"coverage", "coverage", &planes->coverage},
        {"light", "light.s", &planes->s},
        {"light", "light.t", &planes->t},
        {"dlight", "light.dsdx", &planes->dsdx},
        {"dlight", "light.dsdy", &planes->dsdy},
        {"dlight", "light.dtdx", &planes->dtdx},
        {"dlight", "light.dtdy", &planes->dtdy},
    };
    for (auto &w : wanted)
        if (names_plane(aov, w.plane))
            file->want(w.channel, Imf::FLOAT, w.values);
    if (names_plane(aov, "ptex"))
        file->want("ptex.face", Imf::UINT, &planes->face);
    if (names_plane(aov, "light") || names_plane(aov, "coverage")) {
        file->want_floats("R", &planes->red);
        file->want_floats("G", &planes->green);
        file->want_floats("B", &planes->blue);
        file->want_floats("A", &planes->alpha);
    }
    file->read();
    display_colour(planes);
}

/* The child's exit code; or kills the child and returns -1 after the time limit. */
int wait_for(pid_t child)
{
    for (int waited_ms = 0;; waited_ms += 2) {
        int status;
        if (waitpid(child, &status, WNOHANG) == child)
            return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        if (waited_ms >= time_limit_s * 1000)
            break;
        usleep(2000);
    }
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    return -1;
}

std::string read_text(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

} // namespace

planes read_planes(const std::string &path, const std::string &aov)
{
    try {
        exr_file file(path);
        planes planes;
        planes.width_px = file.width_px();
        planes.height_px = file.height_px();
        read_all(&file, aov, &planes);
        return planes;
    } catch (const std::exception &failure) {
        throw std::runtime_error(path + ": " + failure.what());
    }
}

program_result run_program(const std::vector<std::string> &arguments,
                           const temporary_folder &folder)
{
    std::string output_path = folder.file("output.txt"), errors_path = folder.file("errors.txt");
    std::vector<char *> argv;
    for (const std::string &argument : arguments)
        argv.push_back(const_cast<char *>(argument.c_str()));
    argv.push_back(nullptr);
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, output_path.c_str(), flags, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, errors_path.c_str(), flags, 0600);
    pid_t child;
    int spawned = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    program_result result;
    result.exit_code = spawned == 0 ? wait_for(child) : -1;
    result.output = read_text(output_path);
    result.errors = read_text(errors_path);
    return result;
}
