/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Radii of packings against the moments of their distributions and against mass fractions; the
 * random numbers that they are drawn from against the published sequence.
 */
#include "tests/regions.h"

/* ---- sizes ---- */

/* The mean of n draws has the deviation sd/sqrt(n), and the deviation of a sample sd sqrt((kurtosis
 * - 1)/(4 n)): sd/sqrt(2 n) for a normal one, up to 1.6 times that for the tails here (kurtosis 6
 * of the lognormal, 3.9 of the half normal). Five deviations are passed by one seed in 1.7 million,
 * and the seed is fixed. */
static const double SIGMAS = 5;

static const struct {
    struct calx_sizes sizes;
    double mean, deviation, tail, low, high;
} moments[] = {
    {{.kind = CALX_SIZES_FIXED, .a = 2e-5}, 2e-5, 0, 1, 2e-5, 2e-5},
    {{.kind = CALX_SIZES_UNIFORM, .a = 1e-5, .b = 3e-5},
     2e-5,
     2e-5 / 3.4641016151377544,
     1,
     1e-5,
     3e-5},
    /* cut at 3 deviations: the deviation shrinks by sqrt(1 - 6 phi(3)/(1 - 2 Q(3))) = 0.98658 */
    {{.kind = CALX_SIZES_NORMAL, .a = 2e-5, .b = 4e-6}, 2e-5, 4e-6 * 0.98658, 1, 8e-6, 3.2e-5},
    /* cut on one side at the mean: half normal, mean + sqrt(2/pi) sd, sd sqrt(1 - 2/pi) */
    {{.kind = CALX_SIZES_NORMAL, .a = 2e-5, .b = 2e-6, .min = 2e-5, .max = 1},
     2e-5 + 2e-6 * 0.7978845608,
     2e-6 * 0.6028102749,
     2,
     2e-5,
     1},
    {{.kind = CALX_SIZES_LOGNORMAL, .a = 2e-5, .b = 8e-6}, 2e-5, 8e-6, 2, 0, 1},
};

START_TEST(test_moments)
{
    enum { N = 20000 };
    struct calx_region region = make_rectangle();
    ck_assert_msg(calx_pack_region(&region, &moments[_i].sizes, N, 0, 11, NULL, &packing, &error) ==
                      CALX_OK,
                  "%s", error.text);
    double sum = 0, squares = 0;
    for (size_t i = 0; i < N; i++) {
        double r = packing.radius[i];
        ck_assert(r >= moments[_i].low && r <= moments[_i].high);
        sum += r;
    }
    for (size_t i = 0; i < N; i++)
        squares += pow(packing.radius[i] - sum / N, 2);
    double sd = moments[_i].deviation;
    const double ROUND = 1e-12 * moments[_i].mean; /* of the sums */
    ck_assert_double_eq_tol(sum / N, moments[_i].mean, SIGMAS * sd / sqrt(N) + ROUND);
    ck_assert_double_eq_tol(sqrt(squares / N), sd,
                            SIGMAS * moments[_i].tail * sd / sqrt(2 * N) + ROUND);
}
END_TEST

/* Numbers by mass: to a count, and to a fill level, where n_i = f w_i A/(pi r_i^2). */
START_TEST(test_masses)
{
    struct calx_region region = make_rectangle();
    const double radii[] = {0.001, 0.002, 0.0005}, weights[] = {30, 60, 10};
    const struct calx_sizes sizes = {
        .kind = CALX_SIZES_MASSES, .count = 3, .list = radii, .weight = weights};
    for (int mode = 0; mode < 2; mode++) {
        size_t count = mode == 0 ? 650 : 0;
        ck_assert_msg(calx_pack_region(&region, &sizes, count, mode == 0 ? 0 : 0.4, 2, NULL,
                                       &packing, &error) == CALX_OK,
                      "%s", error.text);
        size_t numbers[3] = {0}, changes = 0;
        for (size_t i = 0; i < packing.count; i++) {
            for (int c = 0; c < 3; c++)
                numbers[c] += packing.radius[i] == radii[c];
            changes += i > 0 && packing.radius[i] != packing.radius[i - 1];
        }
        ck_assert_uint_gt(changes, packing.count / 4); /* ids are not sorted by size */
        double total =
            mode == 0 ? 650 / (0.30 / 1e-6 + 0.60 / 4e-6 + 0.10 / 0.25e-6) : 0.4 * 0.01 / M_PI;
        const double shares[] = {0.30 / 1e-6, 0.60 / 4e-6, 0.10 / 0.25e-6};
        for (int c = 0; c < 3; c++) /* rounded sums: less than 1 off */
            ck_assert_double_eq_tol((double)numbers[c], shares[c] * total, 1);
        if (mode == 0)
            ck_assert_uint_eq(packing.count, 650);
        calx_packing_free(&packing);
    }
}
END_TEST

/* ---- random numbers ---- */

/* The published sequence of xoshiro256** from the state 1, 2, 3, 4, and splitmix64's from 0. */
START_TEST(test_random_stream)
{
    static const uint64_t published[] = {11520u,
                                         0u,
                                         1509978240u,
                                         1215971899390074240u,
                                         1216172134540287360u,
                                         607988272756665600u,
                                         16172922978634559625u,
                                         8476171486693032832u,
                                         10595114339597558777u,
                                         2904607092377533576u};
    static const uint64_t seeded[] = {0xe220a8397b1dcdafu, 0x6e789e6aa1b965f4u, 0x06c45d188009454fu,
                                      0xf88bb8a8724c81ecu};
    struct calx_random random = {{1, 2, 3, 4}};
    for (size_t i = 0; i < sizeof published / sizeof *published; i++)
        ck_assert_uint_eq(calx_random_bits(&random), published[i]);
    calx_random_seed(&random, 0);
    ck_assert_mem_eq(random.s, seeded, sizeof seeded);
}
END_TEST

START_TEST(test_random_distributions)
{
    enum { N = 200000 };
    struct calx_random random;
    calx_random_seed(&random, 1);
    double u = 0, uu = 0, n = 0, nn = 0, nnnn = 0;
    size_t below[7] = {0};
    for (int i = 0; i < N; i++) {
        double a = calx_random_uniform(&random), b = calx_random_normal(&random);
        ck_assert(a >= 0 && a < 1);
        u += a;
        uu += a * a;
        n += b;
        nn += b * b;
        nnnn += b * b * b * b;
        below[calx_random_below(&random, 7)]++;
    }
    /* deviations of one draw: u sqrt(1/12), u^2 sqrt(4/45), n 1, n^2 sqrt(2), n^4 sqrt(96) */
    ck_assert_double_eq_tol(u / N, 0.5, SIGMAS * sqrt(1. / 12 / N));
    ck_assert_double_eq_tol(uu / N, 1. / 3, SIGMAS * sqrt(4. / 45 / N));
    ck_assert_double_eq_tol(n / N, 0, SIGMAS * sqrt(1. / N));
    ck_assert_double_eq_tol(nn / N, 1, SIGMAS * sqrt(2. / N));
    ck_assert_double_eq_tol(nnnn / N, 3, SIGMAS * sqrt(96. / N));
    for (int k = 0; k < 7; k++)
        ck_assert_double_eq_tol((double)below[k] / N, 1. / 7, SIGMAS * sqrt(6. / 49 / N));
}
END_TEST

#define LOOP(name, table) tcase_add_loop_test(tcase, name, 0, sizeof table / sizeof *table)

int main(void)
{
    Suite *suite = suite_create("pack_sizes");
    TCase *tcase = tcase_create("pack_sizes");
    tcase_add_checked_fixture(tcase, begin, end);
    tcase_set_timeout(tcase, 300);
    LOOP(test_moments, moments);
    tcase_add_test(tcase, test_masses);
    tcase_add_test(tcase, test_random_stream);
    tcase_add_test(tcase, test_random_distributions);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
