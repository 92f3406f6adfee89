#include "server/threads/task.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

struct completions {
    struct loop *loop;
    struct loop_source source; /* the eventfd */
    int event_fd;
    pthread_mutex_t lock;
    struct task_list list;
};

static void wake_ready(struct loop_source *source, uint32_t events)
{
    (void)events;
    struct completions *completions = source->owner;
    uint64_t count;
    /* Reset the eventfd first: a later post then signals it again. */
    if (read(completions->event_fd, &count, sizeof count) < 0 && errno != EAGAIN)
        abort(); /* an eventfd cannot fail in any other way */
    completions_deliver(completions);
}

struct completions *completions_create(struct loop *loop, struct error *error)
{
    struct completions *completions = calloc(1, sizeof *completions);
    if (!completions) {
        error_set(error, ERROR_SERVER, "no memory for the completion queue");
        return NULL;
    }
    completions->loop = loop;
    completions->event_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (completions->event_fd < 0) {
        error_set(error, ERROR_SERVER, "eventfd: %s", strerror(errno));
        free(completions);
        return NULL;
    }
    pthread_mutex_init(&completions->lock, NULL);
    STAILQ_INIT(&completions->list);
    completions->source = (struct loop_source){completions->event_fd, wake_ready, completions};
    if (!loop_watch(loop, &completions->source, EPOLLIN, error)) {
        completions_destroy(completions);
        return NULL;
    }
    return completions;
}

void completions_destroy(struct completions *completions)
{
    if (!completions)
        return;
    loop_unwatch(completions->loop, &completions->source);
    close(completions->event_fd);
    pthread_mutex_destroy(&completions->lock);
    free(completions);
}

void completions_wake(struct completions *completions)
{
    const uint64_t one = 1;
    if (write(completions->event_fd, &one, sizeof one) < 0 && errno != EAGAIN)
        abort(); /* EAGAIN: the counter is full, so it is signalled already */
}

void completions_post(struct completions *completions, struct task *task)
{
    pthread_mutex_lock(&completions->lock);
    bool was_empty = STAILQ_EMPTY(&completions->list);
    STAILQ_INSERT_TAIL(&completions->list, task, link);
    pthread_mutex_unlock(&completions->lock);
    if (was_empty)
        completions_wake(completions);
}

void completions_deliver(struct completions *completions)
{
    struct task_list list = STAILQ_HEAD_INITIALIZER(list);
    pthread_mutex_lock(&completions->lock);
    STAILQ_CONCAT(&list, &completions->list);
    pthread_mutex_unlock(&completions->lock);
    while (!STAILQ_EMPTY(&list)) {
        struct task *task = STAILQ_FIRST(&list);
        STAILQ_REMOVE_HEAD(&list, link);
        task->done(task);
    }
}
