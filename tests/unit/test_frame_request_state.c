/* The states of a request: the table of transitions against a second list, random walks, and a
 * wrong transition. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "server/frame/request_state.h"

/* The allowed transitions, written a second time, grouped by the events of a request. */
static const struct {
    enum request_state from, to;
} MOVES[] = {
    /* the assets are ready */
    {REQUEST_LOADING, REQUEST_QUEUED},
    {REQUEST_LOADING, REQUEST_POLYGONS},
    {REQUEST_POLYGONS, REQUEST_QUEUED},
    /* the scheduler's turn: memory is there; a tile is drawn; another tile follows */
    {REQUEST_QUEUED, REQUEST_PARKED},
    {REQUEST_PARKED, REQUEST_QUEUED},
    {REQUEST_QUEUED, REQUEST_DRAWING},
    {REQUEST_DRAWING, REQUEST_QUEUED},
    {REQUEST_DRAWING, REQUEST_POLYGONS},
    {REQUEST_DRAWING, REQUEST_PROGRAMS},
    {REQUEST_PROGRAMS, REQUEST_QUEUED},
    /* after the last tile */
    {REQUEST_DRAWING, REQUEST_PAINTING},
    {REQUEST_DRAWING, REQUEST_ENCODING},
    {REQUEST_PAINTING, REQUEST_ENCODING},
    {REQUEST_ENCODING, REQUEST_HELD},
    /* a computation's turn */
    {REQUEST_LOADING, REQUEST_IN_LINE},
    {REQUEST_IN_LINE, REQUEST_COMPUTING},
    {REQUEST_COMPUTING, REQUEST_ABANDONED},
    {REQUEST_IN_LINE, REQUEST_ENDED},
    {REQUEST_COMPUTING, REQUEST_ENDED},
    /* the request is answered early, while a thread works for it */
    {REQUEST_LOADING, REQUEST_ABANDONED},
    {REQUEST_DRAWING, REQUEST_ABANDONED},
    {REQUEST_PAINTING, REQUEST_ABANDONED},
    {REQUEST_ENCODING, REQUEST_ABANDONED},
    /* the request is answered; painting cannot fail, and encoding always follows it */
    {REQUEST_LOADING, REQUEST_ENDED},
    {REQUEST_POLYGONS, REQUEST_ENDED},
    {REQUEST_PROGRAMS, REQUEST_ENDED},
    {REQUEST_QUEUED, REQUEST_ENDED},
    {REQUEST_PARKED, REQUEST_ENDED},
    {REQUEST_DRAWING, REQUEST_ENDED},
    {REQUEST_ENCODING, REQUEST_ENDED},
    {REQUEST_HELD, REQUEST_ENDED},
    {REQUEST_ABANDONED, REQUEST_ENDED},
};

static void test_table(void **test_state)
{
    (void)test_state;
    for (unsigned from = 0; from < N_REQUEST_STATES; from++)
        for (unsigned to = 0; to < N_REQUEST_STATES; to++) {
            bool listed = false;
            for (size_t i = 0; i < sizeof MOVES / sizeof *MOVES; i++)
                listed |= MOVES[i].from == from && MOVES[i].to == to;
            if (request_state_allows(from, to) != listed)
                fail_msg("from %u to %u: the table says %d", from, to, !listed);
        }
}

/* A request can be abandoned while a thread works for it, and while it waits for the store; in no
 * other state. */
static void test_who_can_be_abandoned(void **test_state)
{
    (void)test_state;
    for (unsigned from = 0; from < REQUEST_ABANDONED; from++)
        assert_true(request_state_allows(from, REQUEST_ABANDONED) ==
                    (request_state_is_busy(from) || from == REQUEST_LOADING));
}

/* Every walk from the first state reaches the end, nothing follows the end, and every state is on
 * some walk. */
static void test_walks(void **test_state)
{
    (void)test_state;
    uint32_t seed = 3;
    unsigned seen = 0;
    for (int walk = 0; walk < 2000; walk++) {
        enum request_state state = REQUEST_LOADING;
        unsigned steps = 0;
        while (state != REQUEST_ENDED) {
            seed = seed * 1664525u + 1013904223u;
            enum request_state next = (seed >> 16) % N_REQUEST_STATES;
            assert_true(++steps < 10000);
            seen |= 1u << state;
            if (!request_state_allows(state, next))
                continue;
            request_state_move(&state, next);
            assert_int_equal(state, next);
        }
        seen |= 1u << state;
    }
    assert_int_equal(seen, (1u << N_REQUEST_STATES) - 1);
    for (unsigned to = 0; to < N_REQUEST_STATES; to++)
        assert_false(request_state_allows(REQUEST_ENDED, to));
}

static void test_a_wrong_move_ends_the_program(void **test_state)
{
    (void)test_state;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        enum request_state state = REQUEST_HELD;
        signal(SIGABRT, SIG_DFL);
        close(STDERR_FILENO);
        request_state_move(&state, REQUEST_DRAWING);
        _exit(0);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_who_can_be_abandoned),
        cmocka_unit_test(test_walks),
        cmocka_unit_test(test_a_wrong_move_ends_the_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
