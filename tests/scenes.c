/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Scenes built in code, see scenes.h. Arrays grow one entry at a time: scenes are small.
 */
#include "tests/scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more entry of `bytes` after `count` of them, zeroed. */
static void *grow(void *list, size_t count, size_t bytes)
{
    char *grown = realloc(list, (count + 1) * bytes);
    ck_assert_ptr_nonnull(grown);
    memset(grown + count * bytes, 0, bytes);
    return grown;
}

static void *zeroed(size_t count, size_t bytes)
{
    void *p = calloc(count + 1, bytes);
    ck_assert_ptr_nonnull(p);
    return p;
}

struct calx_scene *scene_create(uint32_t dimension, uint32_t bodies, size_t particles)
{
    struct calx_scene *s = calx_scene_create();
    ck_assert_ptr_nonnull(s);
    s->dimension = dimension;
    s->bodies = bodies;
    s->thickness = bodies == CALX_DISCS ? 1.0 : 0.0;
    s->title = strdup("scene of a test");
    scene_material(s, "grain", 1000.0, 1000.0);
    s->models_count = 1;
    s->models = zeroed(1, sizeof *s->models);
    s->stage_count = 1;
    s->stages = zeroed(1, sizeof *s->stages);
    s->stages[0].duration = INFINITY;
    s->particles.count = particles;
    s->particles.position = zeroed(particles, sizeof *s->particles.position);
    s->particles.radius = zeroed(particles, sizeof *s->particles.radius);
    s->particles.material = zeroed(particles, sizeof *s->particles.material);
    for (size_t i = 0; i < particles; i++)
        s->particles.radius[i] = 1.0;
    return s;
}

int scene_material(struct calx_scene *s, const char *name, double density, double specific_heat)
{
    s->materials = grow(s->materials, s->material_count, sizeof *s->materials);
    struct calx_material *m = &s->materials[s->material_count];
    snprintf(m->name, sizeof m->name, "%s", name);
    m->density = density;
    m->specific_heat = specific_heat;
    return (int)s->material_count++;
}

static struct calx_value value_of(const char *name, double value)
{
    struct calx_value v = {.value = value, .pair = {-1, -1}};
    snprintf(v.name, sizeof v.name, "%s", name);
    return v;
}

void scene_material_value(struct calx_scene *s, int m, const char *name, double value)
{
    struct calx_material *to = &s->materials[m];
    to->values = grow(to->values, to->value_count, sizeof *to->values);
    to->values[to->value_count++] = value_of(name, value);
}

void scene_model(struct calx_scene *s, enum calx_kind kind, const char *plugin,
                 const struct given *given)
{
    struct calx_models *to = &s->models[0];
    to->list = grow(to->list, to->count, sizeof *to->list);
    struct calx_model *m = &to->list[to->count++];
    m->kind = kind;
    snprintf(m->plugin, sizeof m->plugin, "%s", plugin);
    for (; given && given->name; given++) {
        m->values = grow(m->values, m->value_count, sizeof *m->values);
        m->values[m->value_count++] = value_of(given->name, given->value);
    }
}

void scene_model1(struct calx_scene *s, enum calx_kind kind, const char *plugin, const char *name,
                  double value)
{
    scene_model(s, kind, plugin, (struct given[]){{name, value}, {NULL, 0.0}});
}

void scene_linear_by(struct calx_scene *s, const char *integrator, double stiffness,
                     double restitution, double friction, double dt)
{
    bool damped = !isnan(restitution);
    scene_model(s, CALX_CONTACT, "linear",
                (struct given[]){{"stiffness", stiffness},
                                 {damped ? "restitution" : NULL, restitution},
                                 {NULL, 0.0}});
    if (friction >= 0.0)
        scene_model(s, CALX_CONTACT, "coulomb",
                    (struct given[]){
                        {"stiffness", 2.0 / 7.0 * stiffness}, {"friction", friction}, {NULL, 0.0}});
    scene_model(s, CALX_MOTION, integrator, NULL);
    s->models[0].dt = dt;
}

void scene_linear(struct calx_scene *s, double stiffness, double restitution, double friction,
                  double dt)
{
    scene_linear_by(s, "velocity-verlet", stiffness, restitution, friction, dt);
}

void scene_put(struct calx_scene *s, size_t i, double x, double y, double z, double radius)
{
    memcpy(s->particles.position[i], (double[3]){x, y, z}, sizeof(double[3]));
    s->particles.radius[i] = radius;
}

void scene_move(struct calx_scene *s, size_t i, double vx, double vy, double vz)
{
    if (!s->particles.velocity)
        s->particles.velocity = zeroed(s->particles.count, sizeof *s->particles.velocity);
    memcpy(s->particles.velocity[i], (double[3]){vx, vy, vz}, sizeof(double[3]));
}

void scene_spin(struct calx_scene *s, size_t i, double wx, double wy, double wz)
{
    if (!s->particles.spin)
        s->particles.spin = zeroed(s->particles.count, sizeof *s->particles.spin);
    memcpy(s->particles.spin[i], (double[3]){wx, wy, wz}, sizeof(double[3]));
}

void scene_warm(struct calx_scene *s, size_t i, double temperature)
{
    if (!s->particles.temperature) {
        s->particles.temperature = zeroed(s->particles.count, sizeof *s->particles.temperature);
        for (size_t k = 0; k < s->particles.count; k++)
            s->particles.temperature[k] = 293.15;
    }
    s->particles.temperature[i] = temperature;
}

void scene_fix(struct calx_scene *s, size_t i)
{
    if (!s->particles.fixed)
        s->particles.fixed = zeroed(s->particles.count, 1);
    s->particles.fixed[i] = 1;
}

void scene_gravity(struct calx_scene *s, double gx, double gy, double gz)
{
    double g[3] = {gx, gy, gz};
    for (size_t k = 0; k < s->stage_count; k++)
        for (int q = 0; q < 3; q++)
            s->stages[k].gravity[q].value = g[q];
}

void scene_extent(struct calx_scene *s, int k, double low, double high, char kind)
{
    s->low[k] = low;
    s->high[k] = high;
    s->periodic[k] = kind == 'p';
    s->bounded[k] = kind == 'b';
}

int scene_wall(struct calx_scene *s, const char *name, int material)
{
    s->walls = grow(s->walls, s->wall_count, sizeof *s->walls);
    struct calx_wall *w = &s->walls[s->wall_count];
    snprintf(w->name, sizeof w->name, "%s", name);
    w->material = material;
    for (size_t k = 0; k < s->stage_count; k++) {
        s->stages[k].motion = grow(s->stages[k].motion, s->wall_count, sizeof *s->stages[k].motion);
        s->stages[k].wall_temperature = grow(s->stages[k].wall_temperature, s->wall_count,
                                             sizeof *s->stages[k].wall_temperature);
    }
    return (int)s->wall_count++;
}

int scene_group(struct calx_scene *s, const char *name)
{
    int group = scene_wall(s, name, -1);
    s->walls[group].carries = true;
    return group;
}

void scene_carry(struct calx_scene *s, size_t i, int group)
{
    if (!s->particles.carrier) {
        s->particles.carrier = zeroed(s->particles.count, sizeof *s->particles.carrier);
        for (size_t k = 0; k < s->particles.count; k++)
            s->particles.carrier[k] = -1;
    }
    s->particles.carrier[i] = group;
}

struct calx_primitive *scene_primitive(struct calx_scene *s, int wall, struct calx_primitive p)
{
    struct calx_wall *w = &s->walls[wall];
    w->primitives = grow(w->primitives, w->primitive_count, sizeof *w->primitives);
    w->primitives[w->primitive_count] = p;
    return &w->primitives[w->primitive_count++];
}

void scene_segment(struct calx_scene *s, int wall, double ax, double ay, double bx, double by,
                   int32_t surface)
{
    scene_primitive(
        s, wall,
        (struct calx_primitive){
            .shape = CALX_SEGMENT, .a = {ax, ay, 0.0}, .b = {bx, by, 0.0}, .surface = surface});
}

void scene_plane(struct calx_scene *s, int wall, const double a[3], const double n[3])
{
    scene_primitive(s, wall,
                    (struct calx_primitive){
                        .shape = CALX_PLANE, .a = {a[0], a[1], a[2]}, .n = {n[0], n[1], n[2]}});
}

void scene_wall_temperature(struct calx_scene *s, int wall, double temperature)
{
    s->walls[wall].isothermal = true;
    s->walls[wall].temperature.value = temperature;
    for (size_t k = 0; k < s->stage_count; k++)
        s->stages[k].wall_temperature[wall].value = temperature;
}

struct calx_motion *scene_motion(struct calx_scene *s, size_t stage, int wall)
{
    struct calx_motion *m = &s->stages[stage].motion[wall];
    m->moves = true;
    if (m->axis[0] == 0.0 && m->axis[1] == 0.0)
        m->axis[2] = 1.0;
    return m;
}

size_t scene_stage(struct calx_scene *s)
{
    size_t k = s->stage_count, n = s->wall_count;
    s->stages = grow(s->stages, k, sizeof *s->stages);
    s->stages[k] = s->stages[k - 1];
    s->stages[k].motion = zeroed(n, sizeof *s->stages[k].motion);
    s->stages[k].wall_temperature = zeroed(n, sizeof *s->stages[k].wall_temperature);
    for (size_t w = 0; w < n; w++) {
        s->stages[k].motion[w] = s->stages[k - 1].motion[w];
        s->stages[k].wall_temperature[w] = s->stages[k - 1].wall_temperature[w];
    }
    return s->stage_count++;
}

struct calx_models *scene_models_anew(struct calx_scene *s, size_t stage)
{
    size_t k = s->models_count;
    s->models = grow(s->models, k, sizeof *s->models);
    struct calx_models *to = &s->models[k];
    *to = s->models[0];
    to->list = zeroed(to->count, sizeof *to->list);
    for (size_t m = 0; m < to->count; m++) {
        const struct calx_model *from = &s->models[0].list[m];
        to->list[m] = *from;
        to->list[m].values = zeroed(from->value_count, sizeof *from->values);
        if (from->value_count)
            memcpy(to->list[m].values, from->values, from->value_count * sizeof *from->values);
    }
    s->stages[stage].models = (int)s->models_count++;
    return to;
}

struct run run_start(struct calx_scene *scene, int threads)
{
    struct calx_error e = {0};
    struct run r = {.scene = scene, .registry = calx_registry_create(NULL)};
    ck_assert_ptr_nonnull(r.registry);
    r.sim = calx_sim_create(scene, r.registry, threads, &e);
    ck_assert_msg(r.sim != NULL, "%s", e.text);
    return r;
}

void run_refused(struct calx_scene *scene, struct calx_error *e)
{
    struct run r = {.scene = scene, .registry = calx_registry_create(NULL)};
    r.sim = calx_sim_create(scene, r.registry, 1, e);
    ck_assert_ptr_null(r.sim);
    run_free(&r);
}

struct run run_again(const struct run *first, int threads)
{
    struct run r = run_start(first->scene, threads);
    r.scene = NULL;
    return r;
}

void run_steps(const struct run *r, size_t steps)
{
    struct calx_error e = {0};
    for (size_t k = 0; k < steps; k++)
        if (calx_sim_step(r->sim,
                          &e)) /* an assertion that holds writes to a file: not in each step */
            ck_abort_msg("%s", e.text);
}

void run_free(struct run *r)
{
    calx_sim_free(r->sim);
    calx_registry_free(r->registry);
    calx_scene_free(r->scene);
    *r = (struct run){0};
}

static int32_t row_of(const struct calx_sim *s, int64_t id)
{
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++)
            if (s->r.id[row] == id)
                return row;
    ck_abort_msg("no particle %lld", (long long)id);
    return -1;
}

const double *run_x(const struct run *r, int64_t id)
{
    return calx_row_x(r->sim, row_of(r->sim, id));
}

const double *run_v(const struct run *r, int64_t id)
{
    return calx_row_v(r->sim, row_of(r->sim, id));
}

double run_mass(const struct run *r, int64_t id)
{
    const struct calx_scene *s = calx_sim_scene(r->sim);
    return calx_particle_mass(s, s->particles.radius[id],
                              s->materials[s->particles.material[id]].density);
}

double slope(size_t n, const double *x, const double *y)
{
    double mx = 0.0, my = 0.0, sxy = 0.0, sxx = 0.0;
    for (size_t k = 0; k < n; k++) {
        mx += log(x[k]) / (double)n;
        my += log(y[k]) / (double)n;
    }
    for (size_t k = 0; k < n; k++) {
        sxy += (log(x[k]) - mx) * (log(y[k]) - my);
        sxx += (log(x[k]) - mx) * (log(x[k]) - mx);
    }
    return sxy / sxx;
}

int run_tests(const char *name, size_t n, const TTest *const *tests)
{
    Suite *suite = suite_create(name);
    for (size_t k = 0; k < n; k++) {
        TCase *tcase = tcase_create(tests[k]->name);
        tcase_add_test(tcase, tests[k]);
        suite_add_tcase(suite, tcase);
    }
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
