/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What a scene does not need is absent: no array, no search, no line that claims it. Each feature
 * appears exactly when something in the scene asks for it: the flags, the pointers of the state and
 * the plan in words must agree.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/scenes.h"

/* What one scene has beyond a grain that falls on a floor. */
enum part {
    SECOND_GRAIN = 1,
    FRICTION = 2,
    DAMPING = 4,
    CONDUCTION = 8,
    NETWORK = 16,
    PERIODIC = 32,
    FROZEN = 64,
    NO_WALL = 128,
    NO_LAW = 256,
    PLANAR = 512,
    VERLET = 1024
};

static struct calx_scene *scene_of(int parts)
{
    struct calx_scene *s =
        scene_create(parts & PLANAR ? 2 : 3, CALX_SPHERES, parts & SECOND_GRAIN ? 2 : 1);
    if (!(parts & NO_LAW))
        scene_model(s, CALX_CONTACT, "linear",
                    (struct given[]){{"stiffness", 1e4},
                                     {parts & DAMPING ? "restitution" : NULL, 0.5},
                                     {NULL, 0.0}});
    if (parts & FRICTION)
        scene_model(s, CALX_CONTACT, "coulomb",
                    (struct given[]){{"stiffness", 3e3}, {"friction", 0.5}, {NULL, 0.0}});
    if (parts & CONDUCTION) {
        scene_model1(s, CALX_CONDUCTANCE, "constant", "conductance", 1.0);
        scene_model1(s, CALX_TEMPERATURE, parts & NETWORK ? "heat-theta" : "heat-euler", NULL, 0.0);
    }
    if (!(parts & FROZEN))
        scene_model1(s, CALX_MOTION, parts & VERLET ? "verlet" : "velocity-verlet", NULL, 0.0);
    s->models[0].frozen = parts & FROZEN;
    s->models[0].dt = 1e-3;
    scene_put(s, 0, 0.5, 2.0, 0.0, 0.5);
    if (parts & SECOND_GRAIN)
        scene_put(s, 1, 1.7, 2.0, 0.0, 0.5);
    if (!(parts & NO_WALL))
        scene_plane(s, scene_wall(s, "floor", 0), (double[3]){0, 0, 0}, (double[3]){0, 1, 0});
    if (parts & PERIODIC)
        scene_extent(s, 0, 0.0, 4.0, 'p');
    return s;
}

static const struct {
    const char *name;
    int parts;
    struct calx_features expected; /* flags; the rest is not compared */
} table[] = {
    {"one grain, elastic floor (case 1)", 0, {.motion = 1, .contacts = 1, .wall_contacts = 1}},
    {"nothing acts", NO_LAW, {.motion = 1}},
    {"nothing acts between two", NO_LAW | SECOND_GRAIN, {.motion = 1}},
    {"no wall", NO_WALL | SECOND_GRAIN, {.motion = 1, .contacts = 1, .search = 1}},
    {"two grains", SECOND_GRAIN, {.motion = 1, .contacts = 1, .wall_contacts = 1, .search = 1}},
    {"damping",
     DAMPING,
     {.motion = 1, .contacts = 1, .wall_contacts = 1, .history = 1, .history_columns = 1}},
    {"friction",
     FRICTION,
     {.motion = 1,
      .contacts = 1,
      .wall_contacts = 1,
      .history = 1,
      .rotation = 1,
      .history_columns = 3}},
    {"friction and damping",
     FRICTION | DAMPING,
     {.motion = 1,
      .contacts = 1,
      .wall_contacts = 1,
      .history = 1,
      .rotation = 1,
      .history_columns = 4}},
    {"conduction", CONDUCTION, {.motion = 1, .contacts = 1, .wall_contacts = 1, .temperature = 1}},
    {"implicit conduction",
     CONDUCTION | NETWORK,
     {.motion = 1, .contacts = 1, .wall_contacts = 1, .temperature = 1, .heat_network = 1}},
    {"frozen bed",
     CONDUCTION | FROZEN | SECOND_GRAIN | NO_LAW,
     {.contacts = 1, .wall_contacts = 1, .temperature = 1, .search = 1}},
    {"periodic", PERIODIC, {.motion = 1, .contacts = 1, .wall_contacts = 1, .periodic = 1}},
    {"periodic, two grains",
     PERIODIC | SECOND_GRAIN,
     {.motion = 1, .contacts = 1, .wall_contacts = 1, .periodic = 1, .search = 1}},
    {"plane", PLANAR, {.motion = 1, .contacts = 1, .wall_contacts = 1}},
    {"plane, friction",
     PLANAR | FRICTION | VERLET,
     {.motion = 1,
      .contacts = 1,
      .wall_contacts = 1,
      .history = 1,
      .rotation = 1,
      .history_columns = 3}},
};

static void check_flags(const struct calx_features *f, const struct calx_features *e, int parts,
                        const char *what)
{
    const struct {
        bool got, expected;
        const char *flag;
    } rows[] = {{f->motion, e->motion, "motion"},
                {f->rotation, e->rotation, "rotation"},
                {f->temperature, e->temperature, "temperature"},
                {f->history, e->history, "history"},
                {f->search, e->search, "search"},
                {f->periodic, e->periodic, "periodic"},
                {f->contacts, e->contacts, "contacts"},
                {f->wall_contacts, e->wall_contacts, "wall contacts"},
                {f->heat_network, e->heat_network, "heat network"}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        ck_assert_msg(rows[k].got == rows[k].expected, "%s: %s is %d", what, rows[k].flag,
                      rows[k].got);
    ck_assert_msg(f->history_columns == e->history_columns, "%s: %zu columns of history", what,
                  f->history_columns);
    ck_assert_uint_eq(f->dimension, parts & PLANAR ? 2 : 3);
    ck_assert_uint_gt(f->bytes, 0);
}

static void check_arrays(const struct calx_sim *s, const struct calx_features *e, int parts,
                         const char *what)
{
    const struct {
        const void *array;
        bool expected;
        const char *name;
    } rows[] = {
        {s->r.inverse_capacity, e->temperature, "heat capacities"},
        {s->r.image, e->periodic, "images"},
        {s->r.shift, e->periodic && e->search, "shifts of ghosts"},
        {s->r.heat_store, false,
         "waiting heat"}, /* nothing is dissipated into heat in these scenes */
        {s->edge_i, e->heat_network, "edges of the heat network"},
        {s->r.extra[0], parts & VERLET, "extra state of the integrator"},
        {s->r.extra[CALX_EXTRA_MAX], parts & VERLET && e->rotation, "extra state of rotation"},
        {s->wall_contacts, e->wall_contacts, "wall contacts"}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        ck_assert_msg((rows[k].array != NULL) == rows[k].expected, "%s: %s %s there", what,
                      rows[k].name, rows[k].array ? "are" : "are not");
    ck_assert_msg(s->r.stride == (e->rotation || e->temperature ? 8 : 4), "%s: %zu numbers per row",
                  what, s->r.stride);
    ck_assert_msg(!e->search ? s->pairs.reach == 0 : s->pairs.reach <= 1, "%s: %zu pairs", what,
                  s->pairs.reach);
}

static void check_frame(struct calx_sim *s, const struct calx_features *e, const char *what)
{
    struct calx_frame *f = calx_frame_create(s, true);
    ck_assert_msg(!f->spin == !e->rotation, "%s: spin in the frame", what);
    ck_assert_msg(!f->temperature == !e->temperature, "%s: temperature in the frame", what);
    ck_assert_msg(!f->heat == !e->temperature, "%s: heat in the frame", what);
    ck_assert_msg(!f->force == !e->contacts, "%s: force in the frame", what);
    calx_frame_free(f);
}

/* The line of the plan in words that names the feature starts with yes or no. */
static void check_words(const struct calx_sim *s, const struct calx_features *e, int parts,
                        const char *what)
{
    const struct {
        const char *words;
        bool expected;
    } rows[] = {{"motion  ", e->motion},
                {"neighbour search", e->search},
                {"wall contacts", e->wall_contacts},
                {"rotation", e->rotation},
                {"contact history", e->history},
                {"temperature  ", e->temperature},
                {"heat network", e->heat_network},
                {"periodic images", e->periodic},
                {"third axis", !(parts & PLANAR)}};
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    calx_sim_describe(s, out);
    fclose(out);
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        char line[64];
        snprintf(line, sizeof line, "  %s %s", rows[k].expected ? "yes" : "no ", rows[k].words);
        ck_assert_msg(strstr(text, line) != NULL, "%s: no line '%s' in\n%s", what, line, text);
    }
    free(text);
}

START_TEST(only_what_is_needed_exists)
{
    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        struct run r = run_start(scene_of(table[k].parts), 1);
        run_steps(&r, 3);
        struct calx_features f = calx_sim_features(r.sim);
        check_flags(&f, &table[k].expected, table[k].parts, table[k].name);
        check_arrays(r.sim, &table[k].expected, table[k].parts, table[k].name);
        check_frame(r.sim, &table[k].expected, table[k].name);
        check_words(r.sim, &table[k].expected, table[k].parts, table[k].name);
        run_free(&r);
    }
}
END_TEST

/* A grain without a search is never sorted again; its list of walls is made once. */
START_TEST(a_single_grain_is_never_searched)
{
    struct run r = run_start(scene_of(0), 1);
    run_steps(&r, 2000);
    ck_assert_int_eq(r.sim->rebuilds, 1);
    ck_assert_int_eq(calx_sim_step_count(r.sim), 2000);
    run_free(&r);
}
END_TEST

/* In a plane scene z, its speed and two of three spins keep their zeros exactly. */
START_TEST(the_third_axis_stays_empty)
{
    struct calx_scene *s = scene_of(PLANAR | FRICTION | SECOND_GRAIN);
    scene_move(s, 0, 0.5, -0.5, 0.0);
    scene_spin(s, 0, 0.0, 0.0, 5.0);
    struct run r = run_start(s, 1);
    run_steps(&r, 5000);
    for (int64_t i = 0; i < 2; i++) {
        const double *x = run_x(&r, i), *v = run_v(&r, i);
        ck_assert(x[2] == 0.0 && v[2] == 0.0 && v[4] == 0.0 && v[5] == 0.0);
        ck_assert(v[6] != 0.0);
    }
    run_free(&r);
}
END_TEST

/* Bytes per particle: spin or temperature double the rows of v and a, nothing else may. */
START_TEST(memory_grows_with_features_only)
{
    struct run plain = run_start(scene_of(0), 1), rough = run_start(scene_of(FRICTION), 1),
               warm = run_start(scene_of(CONDUCTION), 1);
    size_t least = calx_sim_features(plain.sim).bytes, rows = 2 * 4 * sizeof(double);
    size_t history = 2 * 3 * sizeof(double); /* of one wall contact, now and next */
    ck_assert_uint_eq(calx_sim_features(rough.sim).bytes, least + rows + history);
    ck_assert_uint_eq(calx_sim_features(warm.sim).bytes,
                      least + rows + sizeof(double)); /* and its heat capacity */
    run_free(&plain);
    run_free(&rough);
    run_free(&warm);
}
END_TEST

int main(void)
{
    const TTest *tests[] = {only_what_is_needed_exists, a_single_grain_is_never_searched,
                            the_third_axis_stays_empty, memory_grows_with_features_only};
    return run_tests("features", sizeof tests / sizeof *tests, tests);
}
