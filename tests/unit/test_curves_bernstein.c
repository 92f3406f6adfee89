/* The kit of polynomials in Bernstein form against direct evaluation, and its roots against known ones. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/curves/fields/bernstein.h"

static double random_number(void)
{
    static uint64_t state = 0x9e3779b97f4a7c15u;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

/* The value by the definition, in long double. */
static long double direct(const struct net *net, long double u, long double v)
{
    long double sum = 0;
    for (int i = 0; i <= net->m; i++) {
        for (int j = 0; j <= net->n; j++) {
            long double b = net->c[i * (net->n + 1) + j];
            for (int k = 0; k < i; k++)
                b *= u * (net->m - k) / (k + 1);
            for (int k = 0; k < j; k++)
                b *= v * (net->n - k) / (k + 1);
            for (int k = i; k < net->m; k++)
                b *= 1 - u;
            for (int k = j; k < net->n; k++)
                b *= 1 - v;
            sum += b;
        }
    }
    return sum;
}

static struct net random_net(struct net_room *room, int m, int n)
{
    struct net net = net_take(room, m, n);
    for (size_t k = 0; k < net_size(&net); k++)
        net.c[k] = 2 * random_number() - 1;
    return net;
}

static double memory[1 << 16];

static void values_are_of_the_definition(void **state)
{
    (void)state;
    for (int round = 0; round < 50; round++) {
        struct net_room room = {memory, 0};
        struct net net = random_net(&room, round % 17, (round * 7) % 17);
        double u = random_number(), v = random_number();
        assert_true(fabsl((long double)net_value(&net, u, v) - direct(&net, u, v)) < 1e-14L);
    }
}

static void products_and_sums_are_those_of_values(void **state)
{
    (void)state;
    for (int round = 0; round < 50; round++) {
        struct net_room room = {memory, 0};
        struct net a = random_net(&room, round % 9, (round * 5) % 9);
        struct net b = random_net(&room, (round * 3) % 9, (round * 2) % 9);
        double u = random_number(), v = random_number();
        long double x = direct(&a, u, v), y = direct(&b, u, v);
        net_scale(&a);
        net_scale(&b);
        struct net product = net_product(&room, &a, &b), sum = net_sum(&room, 2, &a, -3, &b);
        net_unscale(&product);
        net_unscale(&sum);
        assert_int_equal(product.m, a.m + b.m);
        assert_int_equal(sum.n, a.n > b.n ? a.n : b.n);
        assert_true(fabsl(direct(&product, u, v) - x * y) < 1e-14L);
        assert_true(fabsl(direct(&sum, u, v) - (2 * x - 3 * y)) < 1e-13L);
    }
}

static void halves_and_derivatives_are_of_the_same_polynomial(void **state)
{
    (void)state;
    for (int axis = 0; axis < 2; axis++) {
        struct net_room room = {memory, 0};
        struct net net = random_net(&room, 12, 9), low = net_take(&room, 12, 9);
        struct net high = net_take(&room, 12, 9), slope = net_derivative(&room, &net, axis);
        net_halve(&net, axis, &low, &high);
        for (int round = 0; round < 20; round++) {
            double u = random_number(), v = random_number(), h = 1e-6;
            double u2 = axis ? u : u / 2, v2 = axis ? v / 2 : v;
            assert_true(fabsl(direct(&low, u, v) - direct(&net, u2, v2)) < 1e-14L);
            u2 += axis ? 0 : 0.5;
            v2 += axis ? 0.5 : 0;
            assert_true(fabsl(direct(&high, u, v) - direct(&net, u2, v2)) < 1e-14L);
            long double change = direct(&net, u + (axis ? 0 : h), v + (axis ? h : 0)) -
                                 direct(&net, u - (axis ? 0 : h), v - (axis ? h : 0));
            assert_true(fabsl(direct(&slope, u, v) - change / (2 * h)) < 1e-8L);
        }
    }
}

/* Signs are claimed only where they hold, and are found where coefficients are clearly of one sign. */
static void signs_are_those_of_all_values(void **state)
{
    (void)state;
    int known = 0;
    for (int round = 0; round < 2000; round++) {
        struct net_room room = {memory, 0};
        struct net net = random_net(&room, 3, 3);
        double shift = 3 * random_number() - 1.5;
        for (size_t k = 0; k < net_size(&net); k++)
            net.c[k] += shift;
        int sign = net_sign(&net), slopes[2] = {net_slope_sign(&net, 0), net_slope_sign(&net, 1)};
        known += sign != 0;
        for (int i = 0; i < 20; i++) {
            double u = random_number(), v = random_number();
            assert_true(sign == 0 || sign * direct(&net, u, v) > 0);
            for (int axis = 0; axis < 2; axis++) {
                struct net slope = net_derivative(&room, &net, axis);
                assert_true(slopes[axis] == 0 || slopes[axis] * direct(&slope, u, v) > 0);
            }
        }
    }
    assert_true(known > 100 && known < 1900);
}

/* Products of linear factors with known roots, some of them outside of (0,1). */
static void all_roots_are_found_and_no_others(void **state)
{
    (void)state;
    for (int round = 0; round < 2000; round++) {
        struct net_room room = {memory, 0};
        struct net net = net_take(&room, 0, 0);
        double known[16], roots[NET_MOST_DEGREE], least = 1;
        int n = 1 + round % 12, inside = 0;
        net.c[0] = round & 1 ? 1 : -1;
        for (int k = 0; k < n; k++) {
            double root = 2 * random_number() - 0.5;
            struct net factor = net_take(&room, 1, 0);
            factor.c[0] = -root;
            factor.c[1] = 1 - root;
            net = net_product(&room, &net, &factor);
            int at = inside;
            for (int i = 0; i < inside; i++)
                least = fmin(least, fabs(root - known[i]));
            least = fmin(least, fmin(fabs(root), fabs(1 - root)));
            for (; root > 0 && root < 1 && at > 0 && known[at - 1] > root; at--)
                known[at] = known[at - 1];
            if (root > 0 && root < 1) {
                known[at] = root;
                inside++;
            }
        }
        net_unscale(&net);
        if (least < 1e-3) /* rounding moves roots that are near to each other */
            continue;
        assert_int_equal(curve_roots(net.c, net.m, roots), inside);
        for (int k = 0; k < inside; k++)
            assert_true(fabs(roots[k] - known[k]) < 1e-8);
    }
}

static void a_constant_has_no_roots(void **state)
{
    (void)state;
    const double zero[4] = {0, 0, 0, 0}, one[1] = {1};
    double roots[NET_MOST_DEGREE];
    assert_int_equal(curve_roots(zero, 3, roots), 0);
    assert_int_equal(curve_roots(one, 0, roots), 0);
    assert_true(curve_value(one, 0, 0.3) == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_of_the_definition),
        cmocka_unit_test(products_and_sums_are_those_of_values),
        cmocka_unit_test(halves_and_derivatives_are_of_the_same_polynomial),
        cmocka_unit_test(signs_are_those_of_all_values),
        cmocka_unit_test(all_roots_are_found_and_no_others),
        cmocka_unit_test(a_constant_has_no_roots),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
