/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A contact law to start from: a linear spring with a dashpot, fn = k d - c vn.
 *
 * Copy this file to contact-NAME.c, change what is between the braces, and build it with one
 * command: cc -O3 -fno-math-errno -fno-trapping-math -ffp-contract=off -fPIC -shared
 * -fvisibility=hidden -I SOURCE contact-NAME.c -o contact-NAME.so -lm (SOURCE: the folder that
 * holds core/plugin.h.) Test it with `calx plugins --check ./contact-NAME.so`, put it into a folder
 * that the environment variable CALX_PLUGINS names, and write <contact plugin="NAME"
 * stiffness="1000 N/m"/> in a case.
 *
 * Reference: say here which paper the law is from, and which equation.
 */
#include "core/plugin.h"

/* 1. The numbers of the law for one pair of materials: first those that the case gives, each a
 * double (or double[2], for body i and body j, if it is a property of a material), then whatever
 * prepare computes from them. */
struct template
{
    double stiffness, damping;
};

/* 2. The table: everything that calx knows about these numbers comes from here (units, ranges,
 * defaults, documentation, the schema of case files, error messages). Every value in [min, max]
 * must give finite forces. Say CALX_REQUIRED, or CALX_OPTIONAL (the field is NaN if not given), or
 * a default in .initial. */
static const struct calx_parameter parameters[] = {
    {.name = "stiffness",
     .symbol = "k",
     .unit = "N/m",
     .doc = "Stiffness of the spring.",
     .min = 1e-9,
     .max = 1e15,
     .flags = CALX_REQUIRED,
     .scope = CALX_PAIR,
     .offset = offsetof(struct template, stiffness)},
    {.name = "damping",
     .symbol = "c",
     .unit = "N s/m",
     .doc = "Damping coefficient.",
     .initial = 0,
     .min = 0,
     .max = 1e12,
     .scope = CALX_PAIR,
     .offset = offsetof(struct template, damping)},
};

/* 3. Called once for each pair of materials, before the run: the place to refuse values that do not
 * fit together (write why, return 1), to compute what the kernels would compute again and again,
 * and to give back what these values do not need. Here: without damping nothing must be remembered
 * from step to step. */
static int prepare(const struct calx_setup *setup, void *params, struct calx_demand *demand,
                   char *why, size_t why_size)
{
    const struct template *p = params;
    (void)setup, (void)why,
        (void)why_size; /* snprintf(why, why_size, "..."), return 1; to refuse */
    demand->needs = p->damping > 0 ? CALX_USES_VELOCITY : 0;
    demand->history_scalars = p->damping > 0;
    return 0;
}

/* 4. The kernel: a plain loop over the contacts of a batch, the columns as restrict parameters,
 * conditions as selects on values: then the compiler vectorises it. n is a whole number of vectors;
 * the results of the padding at the end are not used. It may run in many threads at once: no
 * globals, no memory, no printing.
 *
 * Signs: overlap > 0 when touching, vn > 0 when separating, fn > 0 pushes apart. Forces are added.
 * A contact is seen once more after its end, with overlap <= 0: add no force then, but finish the
 * books. The energy that the law takes out of the motion since the evaluation before is (old +
 * new)/2 of its dissipative force times the velocity times dt, so the old force is kept in a
 * history column, which is 0 when a contact begins. */
CALX_KERNEL static void push(size_t n, double k, double damping, double dt,
                             const double *restrict overlap, const double *restrict vn,
                             double *restrict fn, double *restrict work, double *restrict old)
{
    for (size_t c = 0; c < n; c++) {
        double touch = overlap[c] > 0 ? 1 : 0;
        double dissipative = -touch * damping * vn[c];
        fn[c] += touch * k * overlap[c] + dissipative;
        work[c] -= 0.5 * (old[c] + dissipative) * vn[c] * dt;
        old[c] = dissipative;
    }
}

CALX_KERNEL static void push_elastic(size_t n, double k, const double *restrict overlap,
                                     double *restrict fn)
{
    for (size_t c = 0; c < n; c++)
        fn[c] += overlap[c] > 0 ? k * overlap[c] : 0;
}

/* 5. Unpacks the batch and calls the kernel. Columns that the law did not ask for (item 7) are
 * NULL. */
static void force(const void *params, const struct calx_contacts *b)
{
    const struct template *p = params;
    if (p->damping > 0)
        push(calx_padded(b->n), p->stiffness, p->damping, b->dt, b->overlap, b->vn, b->fn, b->work,
             b->history[0]);
    else
        push_elastic(calx_padded(b->n), p->stiffness, b->overlap, b->fn);
}

/* 6. What the contact stores and how stiff it is, asked for now and then: for the energy balance
 * and for the time step. */
static void response(const void *params, const struct calx_contacts *b,
                     const struct calx_response *r)
{
    const struct template *p = params;
    for (size_t c = 0; c < b->n; c++) {
        if (b->overlap[c] <= 0)
            continue;
        if (r->energy)
            r->energy[c] += 0.5 * p->stiffness * b->overlap[c] * b->overlap[c];
        if (r->stiffness[0])
            r->stiffness[0][c] += p->stiffness;
        if (r->damping[0])
            r->damping[0][c] += p->damping;
    }
}

/* 7. The law: its part in a stack of laws, and what it needs at most (enum calx_need, history with
 * names). */
static const char *const history[] = {"damping-force"};

static const struct calx_contact_law law = {
    .provides = CALX_NORMAL,
    .demand = {.needs = CALX_USES_VELOCITY, .history_scalars = 1},
    .history = history,
    .prepare = prepare,
    .force = force,
    .response = response,
};

/* 8. The one symbol that the file exports. */
CALX_EXPORT const struct calx_plugin calx_plugin = {
    CALX_DESCRIPTOR_PREFIX,
    .kind = CALX_CONTACT,
    .name = "template",
    .summary = "a spring and a dashpot: the example to start a law from",
    .reference = "Cundall and Strack, Geotechnique 29 (1979) 47",
    .equation = "fn = k d - c vn",
    .parameter_count = sizeof parameters / sizeof *parameters,
    .parameters = parameters,
    .params_size = sizeof(struct template),
    .law = &law,
};
