/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The plan in plain words: what will be computed, what is left out and why, the critical step and what sets it, Biot number, memory.
 */
#include <math.h>
#include <string.h>

#include "core/collision_times.h"
#include "core/columns.h"
#include "core/stability.h"

static const char *yes_no(bool there)
{
    return there ? "yes" : "no ";
}

static void describe_models(const struct calx_plan *p, FILE *out)
{
    for (size_t l = 0; l < p->law_count; l++)
        fprintf(out, "  contact        %-18s %s\n", p->laws[l].plugin->name, p->laws[l].plugin->summary);
    if (p->conductance)
        fprintf(out, "  conductance    %-18s %s\n", p->conductance->name, p->conductance->summary);
    if (p->motion)
        fprintf(out, "  motion         %-18s %s\n", p->motion->name, p->motion->summary);
    if (p->heat)
        fprintf(out, "  temperature    %-18s %s\n", p->heat->name, p->heat->summary);
}

static void describe_heat_limit(struct calx_sim *s, FILE *out)
{
    double limit;
    int64_t id;
    if (!s->plan->conductance || !s->plan->heat || calx_heat_limit(s, &limit, &id, NULL))
        return;
    if (id < 0)
        fprintf(out, "  heat limit     no thermal contact yet\n");
    else
        fprintf(out, "  heat limit     %.4g s (least C/sum H, of particle %lld now): the heat step is %.3g of it%s\n", limit,
                (long long)id, s->heat_dt / limit, s->plan->heat_law->unconditional ? "; it may be longer" : "");
}

/* Times by which steps are often chosen, as far as the materials say what they need. */
static void describe_times(const struct calx_sim *s, FILE *out)
{
    const struct calx_scene *scene = s->scene;
    double speed = calx_critical_speed(scene), dt = s->dt;
    struct calx_collision_times t = calx_collision_times_find(scene, speed);
    if (isfinite(t.rayleigh))
        fprintf(out, "  Rayleigh time  %.4g s (%s): the step is %.3g of it\n", t.rayleigh,
                scene->materials[t.rayleigh_material].name, dt / t.rayleigh);
    if (isfinite(t.hertz))
        fprintf(out, "  Hertz impact   %.4g s (%s on %s at %.3g m/s): %.3g steps\n", t.hertz,
                scene->materials[t.hertz_material[0]].name, scene->materials[t.hertz_material[1]].name, speed, t.hertz / dt);
    if (speed > 0.0 && s->n)
        fprintf(out, "  displacement   %.3g of the smallest radius per step at %.3g m/s; a run stops beyond 0.5\n",
                speed * dt / s->radius_min, speed);
}

/* The longest stable step of the contacts there are now. */
static void describe_stability(struct calx_sim *s, FILE *out)
{
    struct calx_stability now;
    if (!s->plan->motion || calx_stability_look(s, CALX_SHARP, &now, NULL))
        return;
    if (s->plan->nonsmooth)
        return;
    if (!isfinite(now.limit)) {
        fprintf(out, "  contacts now   none that vibrates%s\n", s->plan->adapts ? "; the step follows the contacts" : "");
        return;
    }
    if (now.id < 0) {
        fprintf(out, "  contacts now   stable up to %.4g s at least, which a loaded plate sets: the step is %.3g of it\n", now.limit, s->dt / now.limit);
        return;
    }
    fprintf(out, "  contacts now   stable up to %.4g s at least, which particle %lld with %d contact%s sets (%.4g s by iteration; plain sums "
            "of stiffness: %.4g s): the step%s is %.3g of it\n", now.limit, (long long)now.id, now.contacts,
            now.contacts == 1 ? "" : "s", now.sharp, now.plain, s->plan->adapts ? ", which follows the contacts," : "", s->dt / now.limit);
    fprintf(out, "  shortest       contact now: particle %lld with ", (long long)now.pair[0]);
    if (now.pair[1] < 0)
        fprintf(out, "wall '%s'", s->scene->walls[-1 - now.pair[1]].name);
    else
        fprintf(out, "particle %lld", (long long)now.pair[1]);
    fprintf(out, ", %.4g s or %.3g steps\n", now.shortest, now.shortest / s->dt);
}

static void describe_step(const struct calx_plan *p, FILE *out)
{
    fprintf(out, "  time step      %.4g s", p->dt);
    if (!p->motion)
        fprintf(out, " (bodies do not move: of the integrator of temperature)\n");
    else if (isfinite(p->critical_dt))
        fprintf(out, ", %.3g of the stability limit %.4g s, which %s sets (one contact, as deep as is to be "
                "expected)\n", p->dt / p->critical_dt, p->critical_dt, p->critical_text);
    else if (p->nonsmooth)
        fprintf(out, " (given: rigid contacts set no limit; contacts are looked for from a gap of %.3g m on)\n", p->gap);
    else
        fprintf(out, " (no contact law limits it)\n");
    if (p->heat && p->motion)
        fprintf(out, "  heat step      %.4g s, every %lld steps of motion\n", p->heat_dt,
                (long long)p->heat_every);
}

/* What the scene has or lacks, with the reason: one row each. */
static void describe_features(const struct calx_sim *s, FILE *out)
{
    const struct calx_features *f = &s->features;
    const struct { bool there; const char *what, *why, *why_not; } rows[] = {
        {f->motion, "motion", "an integrator of motion is named", "no integrator of motion: bodies are frozen"},
        {f->search, "neighbour search", "bodies can meet", "fewer than two bodies, or nothing acts between them"},
        {f->wall_contacts, "wall contacts", "walls are within reach of bodies", "no walls, or nothing acts on contact"},
        {f->rotation, "rotation", "a tangential or rolling law needs it", "no law exerts a torque"},
        {f->history, "contact history", "a law keeps something while a contact lasts", "no law keeps anything"},
        {f->temperature, "temperature", "a conductance or an integrator of temperature is named", "no conductance"},
        {f->heat_network, "heat network", "the integrator of temperature solves for all bodies at once",
         "heat flows are summed per body"},
        {f->periodic, "periodic images", "an axis is periodic", "no axis is periodic"},
        {f->dimension == 3, "third axis", "the scene has three dimensions", "plane scene: z and two of three spins stay 0"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        fprintf(out, "  %s %-17s %s\n", yes_no(rows[k].there), rows[k].what,
                rows[k].there ? rows[k].why : rows[k].why_not);
    if (f->history)
        fprintf(out, "      %zu numbers kept per touching pair\n", f->history_columns);
}

/* The largest Biot number H/(k pi R) of a contact now. */
struct biot {
    const struct calx_sim *s;
    double largest;
};

static void take_biot(void *context, const struct calx_columns *c, size_t lane, int32_t row_i, int32_t row_j)
{
    struct biot *b = context;
    double k = calx_scene_material_value(b->s->scene, (size_t)b->s->r.material[row_i], "conductivity");
    double bi = c->conductance[lane] * c->curvature[0][lane] / (M_PI * k);
    (void)row_j;
    b->largest = bi > b->largest ? bi : b->largest;
}

static void describe_biot(struct calx_sim *s, FILE *out)
{
    struct biot b = {s, 0.0};
    struct calx_sink sink = {&b, take_biot};
    if (!s->plan->conductance)
        return;
    for (size_t k = 0; k < s->block_count; k++)
        s->engine->block_network(s, k, &sink);
    if (b.largest > 0.0)
        fprintf(out, "  Biot number    %.3g at most now (H/(k pi R))%s\n", b.largest,
                b.largest > 0.1 ? ": WARNING, above 0.1 one temperature per body is a poor picture" : "");
    else
        fprintf(out, "  Biot number    no contact yet\n");
}

static void describe_parts(const struct calx_scene *scene, FILE *out)
{
    for (size_t k = 0; k < scene->stage_count; k++)
        for (size_t w = 0; w < scene->wall_count; w++) {
            const struct calx_motion *m = &scene->stages[k].motion[w];
            if (m->free && (k == 0 || !scene->stages[k - 1].motion[w].free))
                fprintf(out, "  plate          '%s' is free along %c from stage '%s' on, %g kg\n", scene->walls[w].name,
                        "xyz"[m->free_axis], scene->stages[k].name, m->mass);
        }
    for (size_t w = 0; w < scene->wall_count; w++) {
        const struct calx_slab *b = &scene->walls[w].slab;
        if (b->along)
            fprintf(out, "  slab           behind '%s', %zu by %zu cells of %.3g by %.3g m\n", scene->walls[w].name, b->along, b->deep,
                    b->length / (double)b->along, b->depth / (double)b->deep);
    }
    for (size_t k = 0; k < scene->profile_count; k++)
        fprintf(out, "  profile        '%s', %zu layers along %c, %lld samples per window of %g s\n", scene->profiles[k].name,
                scene->profiles[k].layers, "xyz"[scene->profiles[k].axis],
                llround(scene->profiles[k].over / scene->profiles[k].every), scene->profiles[k].over);
    for (size_t k = 0; k < scene->steady_count; k++)
        fprintf(out, "  watched        '%s', %zu blocks of %g s, steady within %g\n", scene->steady[k].name, scene->steady[k].blocks,
                scene->steady[k].over, scene->steady[k].within);
}

void calx_sim_describe(const struct calx_sim *sim, FILE *out)
{
    struct calx_sim *s = (struct calx_sim *)sim; /* looking at contacts refreshes ghosts, nothing else */
    const struct calx_scene *scene = s->scene;
    const char *isa;
    calx_engine_pick(&isa);
    fprintf(out, "%s\n", scene->title ? scene->title : scene->file);
    fprintf(out, "  %zu %s in %uD, %zu walls of %zu primitives, %zu materials, %zu stages\n", s->n,
            scene->bodies == CALX_DISCS ? "discs" : "spheres", scene->dimension, scene->wall_count,
            s->primitive_count, scene->material_count, scene->stage_count);
    for (size_t k = 0; k < s->plan_count; k++) {
        if (s->plan_count > 1)
            fprintf(out, "models %zu of %zu\n", k + 1, s->plan_count);
        describe_models(&s->plans[k], out);
        describe_step(&s->plans[k], out);
    }
    describe_stability(s, out);
    if (s->plan->motion)
        describe_times(s, out);
    describe_heat_limit(s, out);
    describe_biot(s, out);
    describe_parts(scene, out);
    fprintf(out, "computed\n");
    describe_features(s, out);
    struct calx_features f = calx_sim_features(s);
    fprintf(out, "memory           %.3g MB of state, %.0f bytes per particle; %d threads, %s kernels\n",
            1e-6 * (double)f.bytes, s->n ? (double)f.bytes / (double)s->n : 0.0, s->threads, isa);
}
