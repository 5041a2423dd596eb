/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The contact network of a frame: each touching contact with its forces, worked out again from the present state without changing it.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/columns.h"
#include "core/frame.h"

static const double SLIP = 0.999; /* a contact slips when friction is mobilised to this share */

struct network {
    struct calx_sim *s;
    struct calx_frame *f;
    size_t capacity;
    bool full, failed;
};

static int grow(struct network *n)
{
    size_t capacity = n->capacity ? 2 * n->capacity : 1024;
    struct calx_frame *f = n->f;
    void **all[] = {(void **)&f->pair, (void **)&f->pair_position, (void **)&f->normal_force,
                    (void **)&f->tangential_force, (void **)&f->heat_flow, (void **)&f->overlap,
                    (void **)&f->status};
    size_t bytes[] = {sizeof *f->pair, sizeof *f->pair_position, 8, 8, 8, 8, sizeof *f->status};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        void *p = realloc(*all[k], capacity * bytes[k]);
        if (!p)
            return 1;
        *all[k] = p;
    }
    n->capacity = capacity;
    return 0;
}

/* Friction counts as mobilised when a law that limits it says so: |ft| at its limit mu |fn|, with mu found by name. */
static double friction_of(const struct calx_plan *p, size_t type)
{
    for (size_t l = 0; l < p->law_count; l++) {
        const struct calx_parameter *row = calx_plugin_parameter(p->laws[l].plugin, "friction");
        if (row)
            return *(const double *)(p->laws[l].params + p->laws[l].plugin->params_size * type + row->offset);
    }
    return INFINITY;
}

static void record(struct network *n, const struct calx_columns *c, size_t lane, int32_t row_i,
                   const int64_t id[2], size_t type)
{
    struct calx_frame *f = n->f;
    size_t k = f->contact_count++;
    const double *x = calx_row_x(n->s, row_i);
    double reach = x[3] - c->overlap[lane], ft2 = 0.0;
    reach += id[1] >= 0 ? 1.0 / c->curvature[1][lane] : 0.0;
    for (int q = 0; q < 3; q++) {
        f->pair_position[k][0][q] = x[q];
        f->pair_position[k][1][q] = x[q] - reach * c->normal[q][lane];
        double ft = n->s->plan->needs & CALX_NEEDS_TANGENT ? c->ft[q][lane] : 0.0;
        ft2 += ft * ft;
    }
    f->pair[k][0] = id[0];
    f->pair[k][1] = id[1];
    f->normal_force[k] = c->fn[lane];
    f->tangential_force[k] = sqrt(ft2);
    f->overlap[k] = c->overlap[lane];
    f->heat_flow[k] = n->s->plan->conductance
        ? c->conductance[lane] * (c->temperature[1][lane] - c->temperature[0][lane]) : 0.0;
    double limit = friction_of(n->s->plan, type) *
                   fabs(n->s->plan->cohesion ? c->coulomb[lane] : c->fn[lane]);
    f->status[k] = n->s->plan->nonsmooth && c->fn[lane] < 0.0 ? 2 : sqrt(ft2) > 0.0 && sqrt(ft2) >= SLIP * limit;
}

/* Rigid bodies touch where they exchange an impulse. */
static bool touches(const struct calx_plan *p, const struct calx_columns *c, size_t lane)
{
    return p->nonsmooth ? c->fn[lane] != 0.0 : c->overlap[lane] > 0.0;
}

static void take(void *context, const struct calx_columns *c, size_t lane, int32_t row_i, int32_t row_j)
{
    struct network *n = context;
    const struct calx_sim *s = n->s;
    int64_t id[2] = {calx_row_id(s, row_i), row_j < 0 ? row_j : calx_row_id(s, row_j)};
    size_t material_j = row_j < 0 ? (size_t)s->scene->walls[-1 - row_j].material : (size_t)s->r.material[row_j];
    size_t type = (size_t)s->r.material[row_i] * s->scene->material_count + material_j;
    if (touches(s->plan, c, lane))
        for (int k = 0; k < 2; k++)
            if (id[k] >= 0)
                n->f->contacts[id[k]]++;
    if (!n->full || n->failed || (s->plan->nonsmooth && c->fn[lane] == 0.0))
        return;
    if (n->f->contact_count == n->capacity && grow(n))
        n->failed = true;
    else
        record(n, c, lane, row_i, id, type);
}

/* A global integrator of temperature keeps no flows in the rows: they are those of the network now. */
static void add_network_heat(const struct calx_frame *f, double *heat)
{
    for (size_t k = 0; k < f->contact_count; k++)
        for (int q = 0; q < 2; q++)
            if (f->pair[k][q] >= 0)
                heat[f->pair[k][q]] += q ? -f->heat_flow[k] : f->heat_flow[k];
}

int calx_frame_network(struct calx_sim *s, struct calx_frame *f, bool with_contacts)
{
    struct network n = {.s = s, .f = f, .full = with_contacts || s->plan->global_heat};
    struct calx_sink sink = {&n, take};
    if (!s->features.contacts)
        return 0;
    for (size_t b = 0; b < s->block_count; b++)
        s->engine->block_network(s, b, &sink);
    if (s->plan->global_heat && f->heat)
        add_network_heat(f, f->heat);
    return n.failed;
}
