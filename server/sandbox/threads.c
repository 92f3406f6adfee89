#include "server/sandbox/threads.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define ATTEMPTS 50000
#define NAP_NS 200000

/* A thread that has ended counts as idle. */
static bool is_idle(const char *thread)
{
    char path[64], line[512];
    snprintf(path, sizeof path, "/proc/self/task/%.20s/stat", thread);
    FILE *file = fopen(path, "re");
    if (!file)
        return true;
    const char *end = fgets(line, sizeof line, file) ? strrchr(line, ')') : NULL;
    fclose(file);
    return !end || end[1] != ' ' || end[2] == 'S';
}

/* The name of the calling thread's folder: in a namespace of processes of its own the thread has another
 * number there than gettid() gives. */
static bool own_folder(char name[static 32])
{
    char path[64];
    ssize_t n = readlink("/proc/thread-self", path, sizeof path - 1); /* PID/task/TID */
    if (n <= 0)
        return false;
    path[n] = 0;
    const char *slash = strrchr(path, '/');
    snprintf(name, 32, "%.31s", slash ? slash + 1 : path);
    return true;
}

static bool all_idle(void)
{
    char own[32];
    if (!own_folder(own))
        return false;
    DIR *threads = opendir("/proc/self/task");
    bool idle = threads != NULL;
    for (const struct dirent *entry; idle && (entry = readdir(threads));)
        idle = entry->d_name[0] == '.' || strcmp(entry->d_name, own) == 0 || is_idle(entry->d_name);
    if (threads)
        closedir(threads);
    return idle;
}

bool threads_wait_idle(void)
{
    const struct timespec nap = {.tv_nsec = NAP_NS};
    for (int i = 0; i < ATTEMPTS; i++) {
        if (all_idle())
            return true;
        nanosleep(&nap, NULL);
    }
    errno = ETIMEDOUT;
    return false;
}
