/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Profiles: means in layers across an axis, over windows of time. Input: the state at each multiple of the profile's interval, with the contact
 * network as a frame shows it. Output: struct calx_layer. Method: a body counts in each layer with the volume of its slice there, a contact's
 * f_a l_b in each layer with the share of its branch l that runs there, so that a layer's stress is the mean over its planes of the force that
 * contacts carry across them; momentum is that of centres. Sums are over rows and contacts in the order of the blocks.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/columns.h"

/* One sample of one profile. */
struct sample {
    struct calx_sim *s;
    const struct calx_profile *p;
    struct calx_layer_sums *sums; /* of its layers */
    int32_t *contacts;            /* by id */
};

static double thickness_of(const struct calx_profile *p)
{
    return (p->high[p->axis] - p->low[p->axis]) / (double)p->layers;
}

static double area_of(const struct calx_profile *p)
{
    double area = 1.0;
    for (int k = 0; k < 3; k++)
        area *= k == p->axis ? 1.0 : p->high[k] - p->low[k];
    return area;
}

static size_t first_layer(const struct calx_sim *s, size_t profile)
{
    size_t first = 0;
    for (size_t k = 0; k < profile; k++)
        first += s->scene->profiles[k].layers;
    return first;
}

int calx_profile_create(struct calx_sim *s, struct calx_error *e)
{
    size_t count = s->scene->profile_count, layers = first_layer(s, count);
    s->profile_clocks = calx_memory_zeroed(count, sizeof *s->profile_clocks);
    s->layer_sums = calx_memory_zeroed(layers, sizeof *s->layer_sums);
    s->layers = calx_memory_zeroed(layers, sizeof *s->layers);
    if (!s->profile_clocks || !s->layer_sums || !s->layers)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for %zu layers of profiles", layers);
    for (size_t k = 0; k < count; k++)
        s->profile_clocks[k].end = -INFINITY;
    return 0;
}

/* ---- bodies ---- */

/* Volume of a ball, or of a disc of that thickness, between the planes at a and b from its centre; -R <= a <= b <= R. */
static double slice(const struct calx_scene *scene, double radius, double a, double b)
{
    double r2 = radius * radius;
    if (scene->bodies == CALX_SPHERES)
        return M_PI * (b - a) * (r2 - (a * a + a * b + b * b) / 3.0);
    double ca = sqrt((radius - a) * (radius + a)), cb = sqrt((radius - b) * (radius + b)); /* half chords */
    return (b * cb - a * ca + r2 * (atan2(b, cb) - atan2(a, ca))) * scene->thickness;
}

/* A body is seen whole, also the part of it, or of its contacts, that is beyond a periodic border: images from `first` to `last`. */
struct images {
    int first, last;
    double length;
};

static struct images images_of(const struct sample *m, double from, double to)
{
    const struct calx_profile *p = m->p;
    struct images i = {0, 0, 0.0};
    if (!m->s->scene->periodic[p->axis])
        return i;
    i.length = m->s->scene->high[p->axis] - m->s->scene->low[p->axis];
    i.first = (int)ceil((p->low[p->axis] - to) / i.length);
    i.last = (int)floor((p->high[p->axis] - from) / i.length);
    return i;
}

/* The layers that reach between two coordinates: from `first` to before `end`. */
static void layers_between(const struct calx_profile *p, double from, double to, size_t *first, size_t *end)
{
    double h = thickness_of(p), n = (double)p->layers;
    *first = (size_t)fmin(fmax(floor((from - p->low[p->axis]) / h), 0.0), n);
    *end = (size_t)fmin(fmax(ceil((to - p->low[p->axis]) / h), 0.0), n);
}

static void add_slice(const struct sample *m, struct calx_layer_sums *to, int32_t row, double volume)
{
    const struct calx_sim *s = m->s;
    const double *v = calx_row_v(s, row);
    double mass = v[3] > 0.0 ? volume * s->scene->materials[s->r.material[row]].density : 0.0;
    to->volume += volume;
    to->mass += mass;
    to->contacts += volume * m->contacts[s->r.id[row]];
    if (s->features.temperature)
        to->temperature += volume * v[7];
    for (int a = 0; a < 3; a++) {
        to->velocity[a] += volume * v[a];
        to->square[a] += volume * v[a] * v[a];
        to->momentum[a] += mass * v[a];
        for (int b = 0; b < 3; b++)
            to->flux[3 * a + b] += mass * v[a] * v[b];
    }
}

/* A body at `centre` along the axis. */
static void add_body(const struct sample *m, int32_t row, double centre)
{
    const struct calx_profile *p = m->p;
    double radius = calx_row_x(m->s, row)[3], h = thickness_of(p);
    size_t first, end;
    layers_between(p, centre - radius, centre + radius, &first, &end);
    for (size_t k = first; k < end; k++) {
        double a = p->low[p->axis] + h * (double)k - centre, b = p->low[p->axis] + h * (double)(k + 1) - centre;
        a = fmax(a, -radius);
        b = fmin(b, radius);
        if (a < b)
            add_slice(m, &m->sums[k], row, slice(m->s->scene, radius, a, b));
    }
}

static void add_bodies(const struct sample *m)
{
    const struct calx_sim *s = m->s;
    const int32_t *carrier = s->scene->particles.carrier;
    for (size_t b = 0; b < s->block_count; b++)
        for (int32_t row = s->blocks[b].first; row < s->blocks[b].first + s->blocks[b].own; row++) {
            const double *x = calx_row_x(s, row), at = x[m->p->axis];
            if (carrier && carrier[s->r.id[row]] >= 0 && !m->p->groups)
                continue;
            struct images i = images_of(m, at - x[3], at + x[3]);
            for (int k = i.first; k <= i.last; k++)
                add_body(m, row, at + k * i.length);
        }
}

/* ---- contacts ---- */

/* force x branch into the layers that the branch runs through, from coordinate z to z - branch along the axis. */
static void add_branch(const struct sample *m, double z, const double force[3], const double branch[3])
{
    const struct calx_profile *p = m->p;
    double along = branch[p->axis], low = fmin(z, z - along), high = fmax(z, z - along), h = thickness_of(p);
    size_t first, end;
    layers_between(p, low, high, &first, &end);
    if (low == high) { /* across: in one layer, in the upper one on a border */
        double place = (low - p->low[p->axis]) / h;
        end = place >= 0.0 && place < (double)p->layers ? (size_t)place + 1 : 0;
        first = end ? end - 1 : 0;
    }
    for (size_t k = first; k < end; k++) {
        double from = p->low[p->axis] + h * (double)k, to = p->low[p->axis] + h * (double)(k + 1);
        double share = low == high ? 1.0 : (fmin(high, to) - fmax(low, from)) / (high - low);
        for (int a = 0; share > 0.0 && a < 3; a++)
            for (int b = 0; b < 3; b++)
                m->sums[k].contact[3 * a + b] += share * force[a] * branch[b];
    }
}

/* Between two bodies that are held in place there is no force that means anything. */
static void take(void *context, const struct calx_columns *c, size_t lane, int32_t row_i, int32_t row_j)
{
    const struct sample *m = context;
    const struct calx_sim *s = m->s;
    const double *x = calx_row_x(s, row_i);
    bool free_i = calx_row_v(s, row_i)[3] > 0.0, free_j = row_j >= 0 && calx_row_v(s, row_j)[3] > 0.0;
    if (c->overlap[lane] > 0.0) {
        m->contacts[calx_row_id(s, row_i)]++;
        if (row_j >= 0)
            m->contacts[calx_row_id(s, row_j)]++;
    }
    if (!free_i && !free_j)
        return;
    double reach = x[3] - c->overlap[lane] + (row_j >= 0 ? 1.0 / c->curvature[1][lane] : 0.0);
    double force[3], branch[3], at = x[m->p->axis];
    for (int k = 0; k < 3; k++) {
        branch[k] = reach * c->normal[k][lane];
        force[k] = c->fn[lane] * c->normal[k][lane];
        if (s->plan->needs & CALX_NEEDS_TANGENT)
            force[k] += c->ft[k][lane];
    }
    double other = at - branch[m->p->axis];
    struct images i = images_of(m, fmin(at, other), fmax(at, other));
    for (int k = i.first; k <= i.last; k++)
        add_branch(m, at + k * i.length, force, branch);
}

/* ---- samples and windows ---- */

/* A layer of the window from the sums of its samples. */
static struct calx_layer mean_of(const struct calx_sim *s, const struct calx_layer_sums *sum, double samples, double volume)
{
    struct calx_layer l = {.solid_fraction = sum->volume / (samples * volume),
                           .coordination = sum->contacts / sum->volume,
                           .temperature = s->features.temperature ? sum->temperature / sum->volume : NAN};
    for (int a = 0; a < 3; a++) {
        l.velocity[a] = sum->velocity[a] / sum->volume;
        l.fluctuation[a] = sqrt(fmax(sum->square[a] / sum->volume - l.velocity[a] * l.velocity[a], 0.0));
        for (int b = 0; b < 3; b++) {
            double mean = sum->mass > 0.0 ? sum->momentum[a] * sum->momentum[b] / sum->mass : 0.0;
            l.contact_stress[3 * a + b] = sum->contact[3 * a + b] / (samples * volume);
            l.kinetic_stress[3 * a + b] = (sum->flux[3 * a + b] - mean) / (samples * volume);
        }
        if (!(sum->volume > 0.0))
            l.fluctuation[a] = NAN;
    }
    return l;
}

static void end_window(struct calx_sim *s, size_t profile)
{
    const struct calx_profile *p = &s->scene->profiles[profile];
    struct calx_profile_clock *clock = &s->profile_clocks[profile];
    size_t first = first_layer(s, profile);
    double h = thickness_of(p), samples = (double)clock->samples;
    for (size_t k = 0; k < p->layers; k++) {
        s->layers[first + k] = mean_of(s, &s->layer_sums[first + k], samples, h * area_of(p));
        s->layers[first + k].position = p->low[p->axis] + h * ((double)k + 0.5);
    }
    memset(s->layer_sums + first, 0, p->layers * sizeof *s->layer_sums);
    clock->samples = 0;
    clock->windows++;
    clock->end = s->time;
}

static int take_sample(struct calx_sim *s, size_t profile, struct calx_error *e)
{
    struct sample m = {.s = s, .p = &s->scene->profiles[profile],
                       .sums = s->layer_sums + first_layer(s, profile), .contacts = calloc(s->n + 1, sizeof *m.contacts)};
    struct calx_sink sink = {&m, take};
    if (!m.contacts)
        return calx_error_set(e, CALX_ERROR_MEMORY, "not enough memory for profile '%s'", m.p->name);
    for (size_t b = 0; s->features.contacts && b < s->block_count; b++)
        s->engine->block_network(s, b, &sink);
    add_bodies(&m);
    free(m.contacts);
    return 0;
}

/* The slack forgives the rounding of summed steps. */
int64_t calx_profile_multiples(const struct calx_sim *s, double after, double every, double t)
{
    return (int64_t)fmax(floor((t - after + 1e-6 * s->dt) / every), 0.0);
}

static int64_t multiples(const struct calx_sim *s, size_t profile, double t)
{
    const struct calx_profile *p = &s->scene->profiles[profile];
    return calx_profile_multiples(s, p->after, p->every, t);
}

bool calx_profile_due(const struct calx_sim *s, double t)
{
    for (size_t k = 0; k < s->scene->profile_count; k++)
        if (multiples(s, k, t) > s->profile_clocks[k].taken)
            return true;
    return false;
}

int calx_profile_step(struct calx_sim *s, struct calx_error *e)
{
    for (size_t k = 0; k < s->scene->profile_count; k++) {
        const struct calx_profile *p = &s->scene->profiles[k];
        struct calx_profile_clock *clock = &s->profile_clocks[k];
        for (int64_t end = multiples(s, k, s->time); clock->taken < end;) {
            CALX_TRY(take_sample(s, k, e));
            clock->taken++;
            clock->samples++;
            if (clock->taken % llround(p->over / p->every) == 0)
                end_window(s, k);
        }
    }
    return 0;
}

/* A resumed case may sample at other times: none of those that are past. */
void calx_profile_resume(struct calx_sim *s)
{
    for (size_t k = 0; k < s->scene->profile_count; k++)
        s->profile_clocks[k].taken = multiples(s, k, s->time);
}

struct calx_profile_view calx_sim_profile(const struct calx_sim *s, size_t profile)
{
    const struct calx_profile_clock *clock = &s->profile_clocks[profile];
    return (struct calx_profile_view){clock->windows, clock->end, s->layers + first_layer(s, profile)};
}
