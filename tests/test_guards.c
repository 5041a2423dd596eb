/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Guards at run time: each trips on a case made for it, at a time after the start, and says time,
 * particle, contact, law and remedy. What is kept is sound: a restart point from before, from which
 * the run goes on to trip again at the same place in the same words, and frames up to it. The same
 * cases a little inside the bound run to their end.
 */
#include <check.h>
#include <math.h>
#include <string.h>

#include "io/run.h"
#include "tests/folder.h"

#define COUNT(table) ((int)(sizeof(table) / sizeof *(table)))

#define CASE(dimension, inside)                                                                    \
    "<case dimension='" dimension                                                                  \
    "'><material name='m' density='1000' specific-heat='1000' conductivity='1'/>" inside "</case>"
#define PAIR(dt, gap, speed)                                                                       \
    "<integrator plugin='velocity-verlet' dt='" dt                                                 \
    "'/><particles material='m' radius='0.01'><particle at='0 0'/>"                                \
    "<particle at='" gap " 0' velocity='-" speed " 0'/></particles>"

/* m* = 0.5 4/3 pi 1e-6 1000 = 2.0944e-3 kg; k = 1e4: half a period is pi sqrt(m* / k) = 1.43775 ms.
 */
#define SPRING "<contact plugin='linear' stiffness='1e4'/>"
#define OUTPUT "<output every='1 ms'/>"

/* Heat: H = 1 W/K from a plate to a body of C = 4/3 pi 1e-6 1000 1000 = 4.18879 J/K. With theta =
 * 1/2 and z = dt H/(2 C) = 2.39 the distance to the plate's temperature is multiplied by (1 - z)/(1
 * + z) = -0.40956 in a step: 440.956 K beside 300 and 400. */
#define HEAT(dt, more)                                                                             \
    "<conductance plugin='constant' conductance='1'/><integrator of='temperature' "                \
    "plugin='heat-theta' theta='0.5' "                                                             \
    "dt='" dt "' " more                                                                            \
    "/><walls name='plate' material='m' temperature='400'><plane normal='0 1'/></walls>"           \
    "<particles material='m' radius='0.01'><particle at='0 0.0099' "                               \
    "temperature='300'/></particles>"                                                              \
    "<stage for='200'/><output every='" dt "'/>"

struct trip {
    const char *name, *text;
    double from, to; /* s, when; from > to: not at all */
    const char *words[9];
};

static const struct trip trips[] = {
    {"not finite",
     CASE("2", SPRING PAIR("20 us", "0.1",
                           "0.1") "<gravity x='0' y='-sqrt(0.05 - t)'/><stage for='0.1'/>" OUTPUT),
     0.0499,
     0.0502,
     {"particle 0", "not finite", "touches nothing", "reduce dt"}},
    {"too deep, a soft contact",
     CASE("2", "<contact plugin='linear' stiffness='100'/>" PAIR("20 us", "0.0201",
                                                                 "3") "<stage for='0.1'/>" OUTPUT),
     1e-4,
     0.01,
     {"particle 0", "particle 1", "% of the smaller radius", "linear", "raise the stiffness"}},
    {"energy from nothing",
     /* a grain between two plates: omega^2 = 2 k/m, the limit 2/omega = 0.92 ms (sqrt(m/(2k)) =
      * 0.45765 ms): 0.05 % above it the amplitude grows by 1 + sqrt(8 * 5e-4) in each step */
     CASE("2", SPRING "<walls name='plates' material='m'><plane point='0 -0.009' normal='0 "
                      "1'/><plane point='0 0.009' normal='0 -1'/></walls>"
                      "<integrator plugin='velocity-verlet' dt='0.91576 ms' "
                      "force='yes'/><particles material='m' radius='0.01'>"
                      "<particle at='0 0' velocity='0 1e-4'/></particles><stage for='1'/><output "
                      "every='2 ms'/>"),
     0.02,
     0.9,
     {"energy came from nothing", "particle 0", "wall 'plates'", "linear", "dt = 0.00091576"}},
    {"overshoot of temperatures",
     CASE("2", HEAT("20", "monotone='no'")),
     15,
     25,
     {"particle 0 has 440.956", "which conduction cannot bring about", "between 300 and 400 K",
      "wall 'plate'", "constant", "heat-theta", "monotone"}},
    {"no overshoot if monotone", CASE("2", HEAT("20", "")), 1, 0, {NULL}},
    {"explicit heat step",
     CASE("2", "<conductance plugin='constant' conductance='1'/><contact plugin='linear' "
               "stiffness='1e4' restitution='0.1'/>"
               "<integrator plugin='velocity-verlet' dt='20 us'/><integrator of='temperature' "
               "plugin='heat-euler' dt='8 s'/><gravity>0 -9.81</gravity>"
               "<walls name='plate' material='m' temperature='400'><plane normal='0 1'/></walls>"
               "<particles material='m' radius='0.01'><particle at='0 0.012' "
               "temperature='300'/></particles>"
               "<stage for='0.2'/><output every='0.01'/>"),
     0.02,
     0.1,
     {"heat step of 8 s is too long", "particle", "heat-theta"}},
    {"too fast",
     CASE("2", SPRING PAIR("20 us", "0.05",
                           "0.1") "<gravity x='0' y='-1e6*t'/><stage for='0.1'/>" OUTPUT),
     0.01,
     0.1,
     {"particle", "moves", "more than half the smallest radius", "touches nothing", "Reduce dt"}},
    {"fewer than ten steps",
     CASE("2", SPRING PAIR("0.15 ms", "0.0201", "0.1") "<stage for='0.01'/>" OUTPUT),
     0.0009,
     0.0012,
     {"particle 0", "particle 1", "linear", "resolved by 9.6 steps", "lasts 0.00144 s",
      "dt=\"7.2e-05 s\"", "force"}},
    {"ten steps",
     CASE("2", SPRING PAIR("0.1437 ms", "0.0201", "0.1") "<stage for='0.01'/>" OUTPUT),
     1,
     0,
     {NULL}},
    {"fewer than ten steps, between records",
     CASE("2", SPRING PAIR("0.15 ms", "0.0201", "0.1") "<stage for='0.01'/><output every='0.01'/>"),
     0.0009,
     0.0012,
     {"resolved by 9.6 steps"}},
    {"fewer than ten steps, forced",
     CASE("2", SPRING
          "<integrator plugin='velocity-verlet' dt='0.15 ms' force='yes'/><particles material='m' "
          "radius='0.01'><particle at='0 0'/>"
          "<particle at='0.0201 0' velocity='-0.1 0'/></particles><stage for='0.01'/>" OUTPUT),
     1,
     0,
     {NULL}},
    {"Hertz, deeper than expected",
     /* gravity that nobody could foresee presses the grain into the plate */
     "<case><material name='m' density='1000' young='1e6' poisson='0'/><contact plugin='hertz'/>"
     "<integrator plugin='velocity-verlet' dt='1 ms'/><gravity x='0' y='-0.01 - 100*t' "
     "z='0'/><walls name='plate' material='m'><plane normal='0 1 0'/></walls>"
     "<particles material='m' radius='0.01'><particle at='0 0.01 0'/></particles><stage "
     "for='1'/><output every='10 ms'/></case>",
     0.011,
     0.9,
     {"particle 0", "wall 'plate'", "hertz", "fewer than 10"}},
};

static struct calx_run run;

static int go(const char *out, bool resume, struct calx_error *e)
{
    char path[512], results[512];
    snprintf(path, sizeof path, "%s", in_folder("case.xml"));
    snprintf(results, sizeof results, "%s", in_folder(out));
    struct calx_run_options options = {
        .case_path = path, .out = results, .files = true, .resume = resume, .threads = 1};
    int code = calx_run_open(&run, &options, stderr, e);
    return code ? code : calx_run_go(&run, e);
}

START_TEST(a_guard_trips_and_what_is_kept_is_sound)
{
    const struct trip *t = &trips[_i];
    struct calx_error first = {0}, second = {0};
    put_file("case.xml", t->text);
    int code = go("out", false, &first);
    double time = run.sim ? calx_sim_time(run.sim) : NAN, kept = run.scheduled_frame;
    char series[512] = "";
    if (run.series)
        snprintf(series, sizeof series, "%s", calx_series_path(run.series));
    calx_run_close(&run);
    if (t->from > t->to) {
        ck_assert_msg(code == CALX_OK, "%s: %s", t->name, first.text);
        return;
    }
    ck_assert_msg(code == CALX_ERROR_PHYSICS, "%s: code %d %s", t->name, code, first.text);
    ck_assert_msg(time >= t->from && time <= t->to, "%s: at %g s: %s", t->name, time, first.text);
    for (const char *const *word = t->words; *word; word++)
        ck_assert_msg(strstr(first.text, *word) != NULL, "%s: no '%s' in: %s", t->name, *word,
                      first.text);
    ck_assert_msg(strstr(first.text, "at t = ") == first.text &&
                      strstr(first.text, "kept: frames and restart point"),
                  "%s", first.text);
    ck_assert_msg(kept >= 0.0 && kept < time, "%s: kept up to %g s, tripped at %g s", t->name, kept,
                  time);
    ck_assert_int_eq(access(series, F_OK), 0);
    code = go("out", true, &second);
    ck_assert_int_eq(calx_sim_step_count(run.sim) > run.first_step,
                     1); /* it did go on from there */
    calx_run_close(&run);
    ck_assert_int_eq(code, CALX_ERROR_PHYSICS);
    ck_assert_str_eq(first.text, second.text);
}
END_TEST

enum { GRAINS = 240 };

/* A light ball and heavy grains that close in on it from all sides: each contact alone is resolved
 * well, together they are 1/3 of their number times as stiff. Ball: 4/3 pi 1e-3 * 1 = 4.19e-3 kg;
 * grains 4/3 pi 1e-9 * 1e9 = 4.19 kg. Half a period of a contact: pi sqrt(4.18e-3/1e4) = 2.03 ms;
 * the limit of all: 2/sqrt(240/3 * 1e4/4.19e-3) = 0.145 ms. */
static void put_shell(const char *step)
{
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    fprintf(
        f,
        "<case><material name='light' density='1'/><material name='heavy' density='1e9'/>" SPRING
        "<integrator plugin='velocity-verlet' %s/><particles><particle at='0 0 0' radius='0.1' "
        "material='light'/>",
        step);
    for (int i = 0; i < GRAINS; i++) {
        double z = 1 - (2.0 * i + 1) / GRAINS, turn = M_PI * (3 - sqrt(5.0)) * i,
               rho = sqrt(1 - z * z), d = 0.1015;
        fprintf(f,
                "<particle at='%.12g %.12g %.12g' velocity='%.12g %.12g %.12g' radius='0.001' "
                "material='heavy'/>",
                d * rho * cos(turn), d * rho * sin(turn), d * z, -0.1 * rho * cos(turn),
                -0.1 * rho * sin(turn), -0.1 * z);
    }
    fprintf(f, "</particles><stage for='8 ms'/>" OUTPUT "</case>");
    fclose(f);
    put_file("case.xml", text);
    free(text);
}

START_TEST(unstable_only_together)
{
    struct calx_error e = {0};
    put_shell("dt='0.17 ms'");
    int code = go("out", false, &e);
    double time = calx_sim_time(run.sim);
    calx_run_close(&run);
    ck_assert_msg(code == CALX_ERROR_PHYSICS &&
                      strstr(e.text, "above the stability limit of the contacts, 0.00014") &&
                      strstr(e.text, "particle 0 with 240 contacts sets (linear)"),
                  "%d at %g s: %s", code, time, e.text);
    ck_assert_double_eq_tol(time, 0.005, 0.001); /* when they touch: 0.5 mm at 0.1 m/s */
}
END_TEST

/* An automatic step goes below half of that limit when they touch, and the stage still ends where
 * it should. */
START_TEST(an_automatic_step_follows)
{
    struct calx_error e = {0};
    put_shell("");
    int code = go("out", false, &e);
    double dt = calx_sim_dt(run.sim), time = calx_sim_time(run.sim);
    struct calx_ledger l = calx_sim_ledger(run.sim);
    calx_run_close(&run);
    ck_assert_msg(code == CALX_OK, "%s", e.text);
    ck_assert_msg(dt > 0.5 * 0.0723e-3 && dt <= 0.0724e-3, "%g s", dt);
    ck_assert_double_eq_tol(time, 8e-3, 1e-15);
    ck_assert_double_lt(fabs(l.residual),
                        1e-3 * l.elastic); /* (omega dt)^2/8 of what vibrates, which is little */
}
END_TEST

/* Heat of dissipation may warm a body above all that was there: a pile of energy that damping turns
 * to heat. */
START_TEST(dissipation_may_heat)
{
    struct calx_error e = {0};
    put_file(
        "case.xml",
        CASE("2",
             "<heat/><contact plugin='linear' stiffness='1e4' restitution='0.1'/>" PAIR(
                 "20 us", "0.0201",
                 "1") "<conductance plugin='constant' conductance='1'/><stage for='0.02'/>" OUTPUT
                      "<probe name='hot' of='temperature' reduce='max'/><expect of='hot' "
                      "change='yes' above='1e-4 K'/>"));
    int code = go("out", false, &e);
    size_t failures = code ? 0 : calx_verify_failures(run.verify);
    calx_run_close(&run);
    ck_assert_msg(code == CALX_OK, "%s", e.text);
    ck_assert_uint_eq(failures, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("guards");
    TCase *test = tcase_create("guards");
    tcase_add_checked_fixture(test, make_folder, remove_folder);
    tcase_add_loop_test(test, a_guard_trips_and_what_is_kept_is_sound, 0, COUNT(trips));
    tcase_add_test(test, unstable_only_together);
    tcase_add_test(test, an_automatic_step_follows);
    tcase_add_test(test, dissipation_may_heat);
    suite_add_tcase(suite, test);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
