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

#include <OpenImageIO/imageio.h>

extern char **environ;

namespace
{

const int time_limit_s = 120;

int channel_index(const OIIO::ImageSpec &spec, const char *name)
{
    for (int i = 0; i < spec.nchannels; i++)
        if (spec.channelnames[(size_t)i] == name)
            return i;
    throw std::runtime_error(std::string("no channel ") + name);
}

/* The whole picture as stored in the file, decoded once. */
class native_picture
{
  public:
    explicit native_picture(OIIO::ImageInput *input) : spec(input->spec())
    {
        stride = spec.pixel_bytes(true);
        bytes.resize(stride * (size_t)spec.image_pixels());
        if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeUnknown, bytes.data()))
            throw std::runtime_error(input->geterror());
    }
    /* A channel of type T; an error unless the file gives its type as `promised`. */
    template <typename T>
    void extract(const char *name, OIIO::TypeDesc promised, std::vector<T> *values) const
    {
        int index = channel_index(spec, name);
        if (spec.channelformat(index) != promised)
            throw std::runtime_error(std::string("channel ") + name + " is of type " +
                                     spec.channelformat(index).c_str());
        size_t offset = spec.pixel_bytes(0, index, true);
        values->resize((size_t)spec.image_pixels());
        for (size_t i = 0; i < values->size(); i++)
            std::memcpy(&(*values)[i], &bytes[i * stride + offset], sizeof(T));
    }

  private:
    const OIIO::ImageSpec &spec;
    size_t stride;
    std::vector<unsigned char> bytes;
};

bool names_plane(const std::string &aov, const std::string &plane)
{
    return ("," + aov + ",").find("," + plane + ",") != std::string::npos;
}

void read_channel(OIIO::ImageInput *input, const char *channel, std::vector<float> *values)
{
    int index = channel_index(input->spec(), channel);
    values->resize((size_t)input->spec().image_pixels());
    if (!input->read_image(0, 0, index, index + 1, OIIO::TypeFloat, values->data()))
        throw std::runtime_error(std::string("channel ") + channel + ": " + input->geterror());
}

void read_colour(OIIO::ImageInput *input, planes *planes)
{
    read_channel(input, "R", &planes->red);
    read_channel(input, "G", &planes->green);
    read_channel(input, "B", &planes->blue);
    read_channel(input, "A", &planes->alpha);
    for (std::vector<float> *colour : {&planes->red, &planes->green, &planes->blue})
        for (size_t i = 0; i < colour->size(); i++) {
            float alpha = planes->alpha[i];
            (*colour)[i] = alpha > 0 ? (float)displayed_of((double)((*colour)[i] / alpha)) : 0;
        }
}

void read_all(OIIO::ImageInput *input, const std::string &aov, planes *planes)
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
    native_picture picture(input);
    for (auto &w : wanted)
        if (names_plane(aov, w.plane))
            picture.extract(w.channel, OIIO::TypeFloat, w.values);
    if (names_plane(aov, "ptex"))
        picture.extract("ptex.face", OIIO::TypeUInt32, &planes->face);
    if (names_plane(aov, "light") || names_plane(aov, "coverage"))
        read_colour(input, planes);
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
    auto input = OIIO::ImageInput::open(path);
    if (!input)
        throw std::runtime_error(path + ": " + OIIO::geterror());
    planes planes;
    planes.width_px = input->spec().width;
    planes.height_px = input->spec().height;
    try {
        read_all(input.get(), aov, &planes);
    } catch (const std::exception &failure) {
        throw std::runtime_error(path + ": " + failure.what());
    }
    return planes;
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
