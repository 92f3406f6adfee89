/* The web server alone: answers larger than a socket's buffer, answers above the limit, and slots
 * that are used again. Refused requests are tested with the whole daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/base/clock.h"

#include "server/net/http.h"

#define LINES 25000 /* of 10 bytes: just under HTTP_MAX_ANSWER_BYTES */

struct fixture {
    struct loop *loop;
    struct http *http;
    pthread_t thread;
    atomic_bool stop;
};

static int get(void *owner, const char *path, struct text_buffer *body)
{
    (void)owner;
    int n = strcmp(path, "/large") == 0 ? LINES : strcmp(path, "/endless") == 0 ? 1000000 : 1;
    for (int i = 0; i < n; i++)
        text_buffer_add(body, "line %04d\n", i % 10000);
    return 200;
}

static void after(void *owner)
{
    struct fixture *f = owner;
    if (atomic_load(&f->stop))
        loop_stop(f->loop);
}

static void tick(void *owner)
{
    struct fixture *f = owner;
    http_tick(f->http, clock_now_us());
}

static void *serve(void *loop)
{
    loop_run(loop);
    return NULL;
}

/* Connections are added before the loop runs, because only one thread at a time may use the
 * loop. */
static int connect_to(const struct fixture *f)
{
    int ends[2], least = 1;
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &least, sizeof least);
    http_accept(f->http, ends[0]);
    return ends[1];
}

static void start(struct fixture *f)
{
    loop_set_ticking(f->loop, true);
    assert_int_equal(pthread_create(&f->thread, NULL, serve, f->loop), 0);
}

static void create(struct fixture *f)
{
    const struct loop_hooks hooks = {after, tick, f};
    const struct http_handler handler = {get, f};
    struct error error = {0};
    atomic_init(&f->stop, false);
    f->loop = loop_create(&hooks, &error);
    f->http = http_create(f->loop, &handler, &error);
    assert_non_null(f->http);
}

static void finish(struct fixture *f)
{
    atomic_store(&f->stop, true);
    pthread_join(f->thread, NULL);
    http_destroy(f->http);
    loop_destroy(f->loop);
}

/* Sends a request and reads the whole answer slowly. The caller frees *bytes. */
static size_t fetch(int fd, const char *path, char **bytes)
{
    static char room[1 << 20];
    char request[64];
    size_t used = 0;
    snprintf(request, sizeof request, "GET %s HTTP/1.1\r\n\r\n", path);
    assert_int_equal(send(fd, request, strlen(request), MSG_NOSIGNAL), strlen(request));
    for (;;) {
        ssize_t n = recv(fd, room + used, 3000, MSG_DONTWAIT);
        if (n == 0)
            break;
        used += n > 0 ? (size_t)n : 0;
        assert_true(used < sizeof room - 1);
        if (n < 0)
            usleep(200);
    }
    room[used] = 0;
    *bytes = strdup(room);
    close(fd);
    return used;
}

static void test_an_answer_larger_than_the_buffer(void **state)
{
    (void)state;
    struct fixture f;
    char *answer;
    create(&f);
    int fd = connect_to(&f);
    start(&f);
    size_t n = fetch(fd, "/large", &answer);
    const char *body = strstr(answer, "\r\n\r\n");
    assert_memory_equal(answer, "HTTP/1.1 200 OK\r\n", 17);
    assert_non_null(strstr(answer, "Content-Length: 250000\r\n"));
    assert_non_null(body);
    assert_int_equal(n - (size_t)(body + 4 - answer), 10 * LINES);
    assert_memory_equal(body + 4 + 10 * (LINES - 1), "line 4999\n", 10);
    free(answer);
    finish(&f);
}

static void test_an_answer_over_the_bound(void **state)
{
    (void)state;
    struct fixture f;
    char *answer;
    create(&f);
    int fd = connect_to(&f);
    start(&f);
    fetch(fd, "/endless", &answer);
    assert_memory_equal(answer, "HTTP/1.1 500 Internal Server Error\r\n", 36);
    assert_null(strstr(answer, "line"));
    free(answer);
    finish(&f);
}

static void test_slots(void **state)
{
    (void)state;
    struct fixture f;
    char byte;
    int fd[HTTP_MAX_CONNECTIONS + 1];
    create(&f);
    for (int i = 0; i <= HTTP_MAX_CONNECTIONS; i++)
        fd[i] = connect_to(&f);
    assert_int_equal(recv(fd[0], &byte, 1, MSG_DONTWAIT), 0); /* this is the oldest connection */
    for (int i = 1; i <= HTTP_MAX_CONNECTIONS; i++)
        assert_int_equal(recv(fd[i], &byte, 1, MSG_DONTWAIT), -1);
    for (int i = 0; i <= HTTP_MAX_CONNECTIONS; i++)
        close(fd[i]);
    start(&f);
    usleep(300000); /* until the loop has noticed that they closed */
    atomic_store(&f.stop, true);
    pthread_join(f.thread, NULL);
    /* The loop is stopped, so this thread may use it. */
    for (int i = 0; i < HTTP_MAX_CONNECTIONS; i++) {
        fd[i] = connect_to(&f);
        assert_int_equal(recv(fd[i], &byte, 1, MSG_DONTWAIT), -1);
        close(fd[i]);
    }
    http_destroy(f.http);
    loop_destroy(f.loop);
}

/* A descriptor that the loop cannot watch takes no slot and is closed. */
static void test_what_cannot_be_watched(void **state)
{
    (void)state;
    struct fixture f;
    char byte;
    int fd[HTTP_MAX_CONNECTIONS];
    create(&f);
    FILE *file = tmpfile(); /* epoll refuses regular files */
    assert_non_null(file);
    int copy = dup(fileno(file));
    fclose(file);
    http_accept(f.http, copy);
    assert_int_equal(fcntl(copy, F_GETFD), -1);
    for (int i = 0; i < HTTP_MAX_CONNECTIONS; i++)
        fd[i] = connect_to(&f);
    for (int i = 0; i < HTTP_MAX_CONNECTIONS; i++) {
        assert_int_equal(recv(fd[i], &byte, 1, MSG_DONTWAIT), -1);
        close(fd[i]);
    }
    http_destroy(f.http);
    loop_destroy(f.loop);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_answer_larger_than_the_buffer),
        cmocka_unit_test(test_an_answer_over_the_bound),
        cmocka_unit_test(test_slots),
        cmocka_unit_test(test_what_cannot_be_watched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
