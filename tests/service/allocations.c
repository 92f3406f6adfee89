/* Counts the heap blocks that the code of build/sheend-faults takes, in the first eight bytes of
 * the file $SHEEN_ALLOCATIONS, where a test reads them while the daemon runs. The linker redirects
 * that code's calls to the wrappers here (--wrap); calls of libraries are not redirected. */
#include <fcntl.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* NOLINTBEGIN: the names are the linker's */
void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *block, size_t size);
char *__real_strdup(const char *text);
char *__real_strndup(const char *text, size_t most);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *block, size_t size);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t most);
/* NOLINTEND */

static _Atomic(uint64_t) *count; /* NULL: no test counts */

/* Runs before main(), while there is one thread. */
__attribute__((constructor)) static void open_count(void)
{
    const char *path = getenv("SHEEN_ALLOCATIONS");
    int fd = path ? open(path, O_RDWR | O_CLOEXEC) : -1;
    if (fd < 0)
        return;
    void *map = mmap(NULL, sizeof *count, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    close(fd);
    count = map == MAP_FAILED ? NULL : map;
}

static void add(void)
{
    if (count)
        atomic_fetch_add(count, 1);
}

void *__wrap_malloc(size_t size)
{
    add();
    return __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    add();
    return __real_calloc(n, size);
}

void *__wrap_realloc(void *block, size_t size)
{
    add();
    return __real_realloc(block, size);
}

char *__wrap_strdup(const char *text)
{
    add();
    return __real_strdup(text);
}

char *__wrap_strndup(const char *text, size_t most)
{
    add();
    return __real_strndup(text, most);
}
