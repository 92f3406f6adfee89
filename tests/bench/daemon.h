/* Runs a real sheend on a Unix socket and a TCP port, as long as this object lives. */
#ifndef SHEEN_TESTS_BENCH_DAEMON_H
#define SHEEN_TESTS_BENCH_DAEMON_H

#include <string>

#include <sys/types.h>

#include "tests/oracle/render.h"

class daemon_process
{
    temporary_folder folder;

  public:
    /* Throws std::runtime_error with the program's message if it does not start. */
    daemon_process(const std::string &program, const std::string &device);
    ~daemon_process();
    daemon_process(const daemon_process &) = delete;
    daemon_process &operator=(const daemon_process &) = delete;

    std::string unix_address, tcp_address;
    /* The processor time of all its threads since its start. */
    double cpu_ms() const;

  private:
    void stop();
    pid_t child = 0;
};

#endif
