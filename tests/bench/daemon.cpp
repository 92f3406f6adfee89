#include "tests/bench/daemon.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include <csignal>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

daemon_process::daemon_process(const std::string &program, const std::string &device)
    : unix_address("unix:" + folder.file("sheen.sock"))
{
    std::string said_path = folder.file("said.txt"), tcp = "tcp:127.0.0.1:0";
    const char *argv[] = {program.c_str(), "--listen", unix_address.c_str(), "--listen",
                          tcp.c_str(),     "--device", device.c_str(),       nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, said_path.c_str(), O_WRONLY | O_CREAT, 0600);
    int failed =
        posix_spawn(&child, argv[0], &actions, nullptr, const_cast<char **>(argv), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed)
        throw std::runtime_error(program + ": cannot be started");
    const std::string host = "tcp:127.0.0.1:", digits = "0123456789";
    std::string said;
    for (int waited = 0; waited < 1500; waited++, usleep(10000)) {
        std::ifstream file(said_path);
        said.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        size_t at = said.find(host);
        size_t end = at == said.npos ? at : said.find_first_not_of(digits, at + host.size());
        if (end != said.npos) { /* the whole port is there */
            tcp_address = said.substr(at, end - at);
            return;
        }
    }
    stop();
    throw std::runtime_error(program + " does not listen: " + said);
}

daemon_process::~daemon_process()
{
    stop();
}

void daemon_process::stop()
{
    kill(child, SIGTERM);
    waitpid(child, nullptr, 0);
}

double daemon_process::cpu_ms() const
{
    clockid_t clock;
    timespec time;
    if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &time) != 0)
        throw std::runtime_error("the daemon has gone");
    return (double)time.tv_sec * 1e3 + (double)time.tv_nsec * 1e-6;
}
