#include "protocol/child.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>

extern char **environ;

/* Sources lie above the descriptors that they become, so that no dup2 overwrites one that is still
 * needed. */
static int describe_files(posix_spawn_file_actions_t *actions, const struct child_files *files)
{
    int failed = posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDWR, 0);
    failed = failed ? failed : posix_spawn_file_actions_addopen(actions, 1, "/dev/null", O_RDWR, 0);
    if (!failed && files->stderr_fd >= 0)
        failed = posix_spawn_file_actions_adddup2(actions, files->stderr_fd, 2);
    failed = failed ? failed
                    : posix_spawn_file_actions_adddup2(actions, files->socket_fd, files->socket_as);
    return failed ? failed
                  : posix_spawn_file_actions_addclosefrom_np(actions, files->socket_as + 1);
}

static int describe_signals(posix_spawnattr_t *attributes)
{
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    int failed = posix_spawnattr_setsigmask(attributes, &none);
    failed = failed ? failed : posix_spawnattr_setsigdefault(attributes, &all);
    return failed ? failed
                  : posix_spawnattr_setflags(attributes,
                                             POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
}

int child_start(pid_t *pid, const char *path, const char *const argv[],
                const struct child_files *files)
{
    /* posix_spawnp() takes char *const[] for history's sake and writes to none of it. */
    const union {
        const char *const *in;
        char *const *out;
    } arguments = {.in = argv};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    failed = posix_spawnattr_init(&attributes);
    if (!failed) {
        failed = describe_files(&actions, files);
        failed = failed ? failed : describe_signals(&attributes);
        if (!failed)
            failed = posix_spawnp(pid, path, &actions, &attributes, arguments.out, environ);
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&actions);
    return failed;
}
