#include "server/assets/model_file.h"

#include <errno.h>
#include <fcntl.h>
#include <openssl/sha.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/log.h"

struct load {
    struct task task;
    struct model_file_order order;
    char name[STORE_NAME_BYTES]; /* the file's name without folders */
    uint8_t holder[OWNER_BYTES];
    int fd;
    uint8_t *bytes;
    size_t size;
    uint8_t sha256[MODEL_ID_BYTES];
    bool read;
};

int model_folder_open(const char *path, struct error *error)
{
    int fd = open(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        error_set(error, ERROR_REQUEST, "cannot open the folder of --models, %s: %s", path,
                  strerror(errno));
    return fd;
}

/* --- a file below the folder
 *
 * openat2() would find it in one call, but its arguments lie in memory, where no list of system calls
 * can look (sandbox/confine.h): a daemon that may call it could write files. */

enum { MAX_PATH_BYTES = 4096, MAX_DEPTH = 64 };

/* Divides a path into names, without `.` and what `..` takes back. Returns their number; -1 with
 * errno if it cannot be the path of a file below the folder. */
static int split(char *path, const char *names[static MAX_DEPTH])
{
    int n = 0;
    char *rest = path;
    errno = EXDEV;
    if (*path == '/' || *path == 0 || path[strlen(path) - 1] == '/')
        return -1;
    for (const char *name; (name = strsep(&rest, "/"));) {
        if (!*name || strcmp(name, ".") == 0)
            continue;
        bool is_back = strcmp(name, "..") == 0;
        if (is_back ? n == 0 : n == MAX_DEPTH)
            return -1;
        if (is_back)
            n--;
        else
            names[n++] = name;
    }
    return n;
}

static bool on_one_mount(int a_fd, int b_fd)
{
    struct statx a, b;
    if (statx(a_fd, "", AT_EMPTY_PATH, STATX_MNT_ID, &a) < 0 ||
        statx(b_fd, "", AT_EMPTY_PATH, STATX_MNT_ID, &b) < 0)
        return false;
    errno = EXDEV;
    return a.stx_mnt_id == b.stx_mnt_id && a.stx_dev_major == b.stx_dev_major &&
           a.stx_dev_minor == b.stx_dev_minor;
}

/* Opens one name in a folder: no link, no other file system. */
static int open_name(int folder_fd, const char *name, int flags)
{
    /* Opening a pipe must not block the loop. */
    int fd = openat(folder_fd, name, flags | O_NOFOLLOW | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (fd < 0 || on_one_mount(folder_fd, fd))
        return fd;
    close(fd);
    return -1;
}

/* Opens a file below the folder, name by name, so that it lies there even if folders change
 * meanwhile. -1 with errno. */
static int open_below(int folder_fd, const char *path)
{
    char copy[MAX_PATH_BYTES];
    const char *names[MAX_DEPTH];
    errno = ENAMETOOLONG;
    if ((size_t)snprintf(copy, sizeof copy, "%s", path) >= sizeof copy)
        return -1;
    const int n = split(copy, names);
    int fd = n > 0 ? folder_fd : -1;
    for (int i = 0; fd >= 0 && i < n; i++) {
        const int before = fd;
        fd = open_name(before, names[i], i + 1 < n ? O_PATH | O_DIRECTORY : O_RDONLY);
        const int failure = errno;
        if (before != folder_fd)
            close(before);
        errno = failure;
    }
    return fd;
}

/* Opens the file. Returns NULL, or what is wrong with it. */
static const char *open_file(struct load *load, const char *name)
{
    struct stat file;
    load->fd = open_below(load->order.folder_fd, name);
    if (load->fd < 0 || fstat(load->fd, &file) < 0)
        return strerror(errno);
    if (!S_ISREG(file.st_mode))
        return "not a plain file";
    if (file.st_size < 1)
        return "it is empty";
    if ((uint64_t)file.st_size > load->order.max_bytes)
        return "it is larger than the daemon takes";
    load->size = (size_t)file.st_size;
    return NULL;
}

/* --- on the pool */

static void load_run(struct task *task, void *context)
{
    (void)context;
    struct load *load = task->owner;
    size_t used = 0;
    load->bytes = malloc(load->size);
    for (ssize_t n = 1; load->bytes && n > 0 && used<load->size; used += n> 0 ? (size_t)n : 0)
        n = read(load->fd, load->bytes + used, load->size - used);
    load->read = load->bytes && used == load->size;
    if (load->read)
        SHA256(load->bytes, load->size, load->sha256);
}

/* --- back on the loop */

static void load_destroy(struct load *load)
{
    if (load->fd >= 0)
        close(load->fd);
    free(load->bytes);
    free(load);
}

static void load_done(struct task *task)
{
    struct load *load = task->owner;
    const struct model_file_order *order = &load->order;
    struct error error = {0};
    bool ok = load->read;
    if (!ok) {
        account_refund(store_account(order->store), ACCOUNT_INPUT, load->size);
        error_set(&error, ERROR_SERVER, "%s: it could not be read to its end: try again",
                  load->name);
    } else {
        ok = store_add(order->store, STORE_SHARED, load->holder, ASSET_MODEL, load->sha256,
                       load->name, load->bytes, load->size, store_account(order->store), &error);
        load->bytes = NULL; /* the store owns them now */
    }
    order->loaded(order->owner, ok ? load->sha256 : NULL, &error);
    load_destroy(load);
}

bool model_file_load(const struct model_file_order *order, struct error *error)
{
    struct load *load = calloc(1, sizeof *load);
    if (!load)
        return error_set(error, ERROR_SERVER, "no memory to read a file");
    load->order = *order;
    memcpy(load->holder, order->holder, sizeof load->holder);
    const char *slash = strrchr(order->name, '/');
    snprintf(load->name, sizeof load->name, "%s", slash ? slash + 1 : order->name);
    const char *wrong = open_file(load, order->name);
    if (wrong) {
        log_event(LOG_INFO, "model file refused", log_text("file", order->name),
                  log_text("text", wrong));
        error_set(error, ERROR_MODEL, "no model file '%.200s' at this daemon", order->name);
    } else if (store_reserve(order->store, load->holder, store_account(order->store), ACCOUNT_INPUT,
                             load->size, load->name, ERROR_MODEL, error)) {
        load->task = (struct task){load_run, load_done, load, {NULL}};
        pool_submit(order->pool, &load->task, POOL_LATER);
        return true;
    }
    load_destroy(load);
    return false;
}
