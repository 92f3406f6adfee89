/* Connections that have not identified themselves: which is closed for a new one, which address is
 * refused; and the client's address as a load balancer tells it. */
#include <arpa/inet.h>
#include <netinet/in.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/net/proxy_header.h"
#include "server/net/strangers.h"

static const struct strangers_limits LIMITS = {.all = 6, .of_peer = 3, .penalty_s = 30};
static struct strangers strangers;

static bool is_silent(const struct stranger *stranger)
{
    return stranger->owner == NULL;
}

static int set_up(void **state)
{
    (void)state;
    memset(&strangers, 0, sizeof strangers);
    strangers_init(&strangers);
    return 0;
}

static struct stranger from(uint64_t address, bool silent)
{
    return (struct stranger){
        .peer = {.key = {2, address}}, .is_silent = is_silent, .owner = silent ? NULL : &strangers};
}

static void leave(struct stranger *stranger, enum stranger_end end, uint64_t now_us)
{
    strangers_leave(&strangers, &LIMITS, stranger, end, now_us);
}

static struct stranger *enter(struct stranger *stranger)
{
    return strangers_enter(&strangers, &LIMITS, stranger, 0);
}

static void test_who_leaves(void **state)
{
    (void)state;
    struct stranger a[4], b[4], c = from(3, true), balancer[4];
    for (int i = 0; i < 3; i++) {
        a[i] = from(1, i > 0);
        assert_null(enter(&a[i]));
    }
    a[3] = from(1, true);
    assert_ptr_equal(enter(&a[3]), &a[1]); /* a[0] is older, but has sent something */
    leave(&a[1], STRANGER_GONE, 0);
    for (int i = 0; i < 3; i++) {
        b[i] = from(2, false);
        assert_null(enter(&b[i]));
    }
    b[3] = from(2, false);
    assert_ptr_equal(enter(&b[3]), &b[0]); /* all have sent something: the oldest leaves */
    leave(&b[0], STRANGER_GONE, 0);
    /* all places are taken: one of the address with most connections leaves */
    assert_ptr_equal(enter(&c), &a[2]);
    leave(&a[2], STRANGER_GONE, 0);
    /* an exempt address has no limit of its own, only that of all together */
    for (int i = 0; i < 4; i++) {
        balancer[i] = from(4, true);
        balancer[i].is_exempt = true;
        struct stranger *leaves = enter(&balancer[i]);
        assert_non_null(leaves);
        assert_true(leaves->peer.key[1] != 3);
        leave(leaves, STRANGER_GONE, 0);
    }
    assert_int_equal(strangers.n, 6);
}

/* The connection that leaves for a new one when all places are taken, found by counting each
 * address anew. */
static const struct stranger *leaves_by_counting(const struct stranger *all[], size_t n)
{
    const struct stranger *leaves = NULL;
    size_t most = 0;
    for (size_t i = 0; i < n; i++) { /* the oldest of the address first */
        size_t of_it = 0;
        for (size_t k = 0; k < n; k++)
            of_it += memcmp(all[i]->peer.key, all[k]->peer.key, sizeof all[i]->peer.key) == 0;
        if (of_it > most) {
            most = of_it;
            leaves = all[i];
        } else if (leaves && leaves->owner && !all[i]->owner &&
                   memcmp(leaves->peer.key, all[i]->peer.key, sizeof leaves->peer.key) == 0) {
            leaves = all[i]; /* the oldest of the address that has sent nothing */
        }
    }
    return leaves;
}

static void test_who_leaves_of_many(void **state)
{
    (void)state;
    enum { PLACES = 150 };
    static const struct strangers_limits limits = {.all = PLACES, .of_peer = 1000};
    static struct stranger many[PLACES + 1];
    srand(11);
    for (int addresses = 1; addresses <= 64; addresses *= 2) {
        const struct stranger *all[PLACES + 1];
        size_t n = 0;
        set_up(state);
        for (size_t i = 0; i <= PLACES; i++)
            many[i].link.tqe_prev = NULL;
        for (int i = 0; i < 1500; i++) {
            struct stranger *free = many;
            while (free->link.tqe_prev)
                free++;
            *free = from((uint64_t)(rand() % addresses), rand() % 3 == 0);
            free->peer.key[0] = (uint64_t)(rand() % 2);
            const struct stranger *expected = n == PLACES ? leaves_by_counting(all, n) : NULL;
            struct stranger *leaves = strangers_enter(&strangers, &limits, free, 0);
            assert_ptr_equal(leaves, expected);
            all[n++] = free;
            if (!leaves)
                continue;
            strangers_leave(&strangers, &limits, leaves, STRANGER_GONE, 0);
            leaves->link.tqe_prev = NULL;
            size_t at = 0;
            while (all[at] != leaves)
                at++;
            memmove(all + at, all + at + 1, (--n - at) * sizeof *all);
        }
    }
}

static void test_hurry(void **state)
{
    (void)state;
    struct stranger a[4];
    for (uint64_t i = 0; i < 4; i++) {
        assert_int_equal(strangers_patience_us(&strangers, &LIMITS, 3000000), 3000000);
        a[i] = from(i, true);
        assert_null(enter(&a[i]));
    }
    assert_int_equal(strangers_patience_us(&strangers, &LIMITS, 3000000), STRANGERS_HURRY_US);
    assert_int_equal(strangers_patience_us(&strangers, &LIMITS, 500000), 500000);
    leave(&a[0], STRANGER_GONE, 0);
    assert_int_equal(strangers_patience_us(&strangers, &LIMITS, 3000000), 3000000);
}

/* Lets one connection come and leave so many times. Returns whether its address is refused
 * afterwards. */
static bool visit(uint64_t address, unsigned times, enum stranger_end end, uint64_t now_us)
{
    bool refused = false;
    while (times-- > 0) {
        struct stranger one = from(address, true);
        assert_null(enter(&one));
        refused = strangers_leave(&strangers, &LIMITS, &one, end, now_us);
    }
    return refused;
}

static bool admits(uint64_t address, uint64_t now_us)
{
    const struct stranger one = from(address, true);
    return strangers_admits(&strangers, &one.peer, now_us);
}

static void test_penalties(void **state)
{
    (void)state;
    assert_false(visit(1, 14, STRANGER_GONE, 1));
    assert_true(admits(1, 1));
    assert_true(visit(1, 1, STRANGER_GONE, 1));
    assert_false(admits(1, 1));
    assert_true(admits(2, 1));         /* other addresses are not refused */
    assert_false(admits(1, 14000000)); /* until the whole penalty has passed */
    assert_true(admits(1, 15000002));
    assert_true(visit(2, 3, STRANGER_WRONG, 1)); /* wrong credentials count more */
    visit(2, 100, STRANGER_WRONG, 1);
    assert_false(admits(2, 29000000));
    assert_true(admits(2, 31000002)); /* never longer than the limit */
    visit(3, 20, STRANGER_GONE, 1);
    /* a connection that has identified itself clears its address */
    visit(3, 1, STRANGER_ADMITTED, 1);
    assert_true(admits(3, 1));
    for (uint64_t i = 0; i < 100; i++) /* one connection every two seconds */
        assert_false(visit(4, 1, STRANGER_GONE, 1 + i * 2000000));
    const struct strangers_limits none = {.all = 6, .of_peer = 3, .penalty_s = 0};
    for (int i = 0; i < 100; i++) {
        struct stranger one = from(5, true);
        strangers_enter(&strangers, &none, &one, 1);
        assert_false(strangers_leave(&strangers, &none, &one, STRANGER_WRONG, 1));
    }
    assert_true(admits(5, 1));
}

/* With more addresses than entries, the entry with the least penalty is removed, and no other. */
static void test_penalties_have_a_bound(void **state)
{
    (void)state;
    visit(7, 15, STRANGER_GONE, 1);
    for (uint64_t i = 0; i < 3 * STRANGERS_MAX_PENALTIES; i++)
        visit(1000 + i, 1, STRANGER_GONE, 2);
    assert_false(admits(7, 3));
}

static const struct sockaddr *v4(const char *text)
{
    static struct sockaddr_in address;
    address = (struct sockaddr_in){.sin_family = AF_INET};
    assert_int_equal(inet_pton(AF_INET, text, &address.sin_addr), 1);
    return (const struct sockaddr *)&address;
}

static const struct sockaddr *v6(const char *text)
{
    static struct sockaddr_in6 address;
    address = (struct sockaddr_in6){.sin6_family = AF_INET6};
    assert_int_equal(inet_pton(AF_INET6, text, &address.sin6_addr), 1);
    return (const struct sockaddr *)&address;
}

static void test_networks(void **state)
{
    (void)state;
    struct proxy_networks networks = {0};
    struct error error = {0};
    assert_true(proxy_networks_add(&networks, "10.1.2.3", &error));
    assert_true(proxy_networks_add(&networks, "192.168.16.0/20", &error));
    assert_true(proxy_networks_add(&networks, "fd00:1::/33", &error));
    assert_true(proxy_networks_hold(&networks, v4("10.1.2.3")));
    assert_false(proxy_networks_hold(&networks, v4("10.1.2.4")));
    assert_true(proxy_networks_hold(&networks, v4("192.168.31.255")));
    assert_false(proxy_networks_hold(&networks, v4("192.168.32.0")));
    assert_true(proxy_networks_hold(&networks, v6("::ffff:10.1.2.3")));
    assert_true(proxy_networks_hold(&networks, v6("fd00:1:7fff::1")));
    assert_false(proxy_networks_hold(&networks, v6("fd00:1:8000::1")));
    assert_false(proxy_networks_hold(&networks, &(struct sockaddr){.sa_family = AF_UNIX}));
    static const char *const bad[] = {"",          "10.1.2",      "10.1.2.3/33",
                                      "10.1.2.3/", "10.1.2.3/-1", "host.example",
                                      "::/129",    "10.1.2.3/8x"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(proxy_networks_add(&networks, bad[i], &error));
    assert_int_equal(networks.n, 3);
    while (networks.n < PROXY_MAX_NETWORKS)
        assert_true(proxy_networks_add(&networks, "::/0", &error));
    assert_false(proxy_networks_add(&networks, "::/0", &error));
}

static void test_headers(void **state)
{
    (void)state;
    uint8_t header[PROXY_HEADER_MOST_BYTES] = {0x0d, 0x0a, 0x0d, 0x0a, 0x00, 0x0d, 0x0a,
                                               0x51, 0x55, 0x49, 0x54, 0x0a, 0x21, 0x11,
                                               0,    12,   192,  0,    2,    7};
    struct sockaddr_storage address;
    bool is_local;
    header[24] = 0x12; /* the client's port is the source port */
    header[25] = 0x67;
    assert_int_equal(proxy_header_length(header), 28);
    assert_true(proxy_header_read(header, 28, &is_local, &address));
    assert_false(is_local);
    const struct sockaddr_in *in = (const struct sockaddr_in *)&address;
    assert_int_equal(ntohl(in->sin_addr.s_addr), 0xc0000207);
    assert_int_equal(ntohs(in->sin_port), 0x1267);
    header[15] = 11; /* too short for the addresses */
    assert_false(proxy_header_read(header, proxy_header_length(header), &is_local, &address));
    header[15] = 200; /* extensions follow, which are ignored */
    assert_true(proxy_header_read(header, proxy_header_length(header), &is_local, &address));
    header[13] = 0x21;
    assert_true(proxy_header_read(header, proxy_header_length(header), &is_local, &address));
    assert_int_equal(address.ss_family, AF_INET6);
    header[15] = 35;
    assert_false(proxy_header_read(header, proxy_header_length(header), &is_local, &address));
    header[13] = 0x31; /* an address of a Unix socket: no peer address */
    assert_true(proxy_header_read(header, proxy_header_length(header), &is_local, &address));
    assert_true(is_local);
    header[12] = 0x20; /* LOCAL: the balancer's own check */
    header[15] = 0;
    assert_int_equal(proxy_header_length(header), 16);
    assert_true(proxy_header_read(header, 16, &is_local, &address));
    assert_true(is_local);
    static const struct {
        size_t at;
        uint8_t value;
    } wrong[] = {{0, 0x0c}, {11, 0x0b}, {12, 0x11}, {12, 0x22}, {14, 0x08}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        uint8_t bad[PROXY_HEADER_FIXED_BYTES];
        memcpy(bad, header, sizeof bad);
        bad[wrong[i].at] = wrong[i].value;
        assert_int_equal(proxy_header_length(bad), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_who_leaves, set_up),
        cmocka_unit_test_setup(test_who_leaves_of_many, set_up),
        cmocka_unit_test_setup(test_hurry, set_up),
        cmocka_unit_test_setup(test_penalties, set_up),
        cmocka_unit_test_setup(test_penalties_have_a_bound, set_up),
        cmocka_unit_test(test_networks),
        cmocka_unit_test(test_headers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
