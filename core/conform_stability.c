/* SPDX-License-Identifier: BSD-3-Clause
 *
 * How far an integrator of motion can be trusted: its limits on omega*dt without damping, on c/m*dt
 * of a damper alone, both by bisection; that the limit the engine derives from them for damped
 * springs is safe; and the energy of an oscillator over 1e5 periods, for those that say it does not
 * drift.
 */
#include <math.h>

#include "core/conform_rows.h"

/* Limits are found to 0.1 %; close to one, growth needs thousands of steps to show. */
static const double LIMIT_SLACK = 0.02;
/* Round-off of 1e-16 in each of 2e6 steps if all of one sign: 2e-10; more where a step has several
 * stages. */
static const double DRIFT = 1e-9;
enum { PERIODS = 100000, PER_PERIOD = 20, SAMPLE = 100 * PER_PERIOD, BISECTIONS = 12 };

/* The largest energy of the first body in the next `steps`; its velocity in units of omega. */
static double largest_energy(struct calx_oscillators *s, const struct calx_choice *c, size_t steps)
{
    double most = 0, omega = s->omega > 0 ? s->omega : 1;
    for (size_t n = 0; n < steps; n++) {
        calx_oscillators_step(s, c);
        double energy = s->omega > 0 ? s->x[0] * s->x[0] + s->v[0] * s->v[0] / (omega * omega)
                                     : s->v[0] * s->v[0];
        if (!(energy < 1e100))
            return INFINITY;
        most = fmax(most, energy);
    }
    return most;
}

/* Whether the energy of an oscillator less than doubles within a period; omega 0: a damper alone,
 * whether it brings to rest. */
static bool is_stable(const struct calx_choice *c, double omega, double damping)
{
    struct calx_oscillators s;
    double period = omega > 0 ? 2 * M_PI / omega : 2000;
    size_t window = 200 + (size_t)period, gap = 1800 + 3 * (size_t)period;
    calx_oscillators_begin(&s, 1, 4, 1, false);
    s.omega = omega;
    s.damping = damping;
    s.v[0] = 1;
    calx_oscillators_start(&s, c);
    double first = largest_energy(&s, c, window);
    double middle = largest_energy(&s, c, gap - window), second = largest_energy(&s, c, window);
    if (isinf(first) || isinf(middle) || isinf(second) || s.failed)
        return false;
    return omega > 0 ? second <= first * pow(2, (double)gap / period) : second <= first;
}

/* The largest stable value of one of the two, relative to what is declared; INFINITY if it is not
 * within a factor of two. */
static double limit(const struct calx_choice *c, double declared, bool damping)
{
    double low = 0.5 * declared, high = 2 * declared;
#define STABLE(value) (damping ? is_stable(c, 0, value) : is_stable(c, value, 0))
    if (!STABLE(low) || STABLE(high))
        return INFINITY;
    for (int k = 0; k < BISECTIONS; k++) {
        double middle = 0.5 * (low + high);
        if (STABLE(middle))
            low = middle;
        else
            high = middle;
    }
#undef STABLE
    return low / declared;
}

/* At 0.98 of the limit that the engine takes for damped springs, and below. */
static double unsafe_fractions(const struct calx_choice *c)
{
    static const double fractions[] = {0.05, 0.1, 0.2, 0.5, 1, 2};
    size_t unsafe = 0;
    for (size_t k = 0; k < sizeof fractions / sizeof *fractions; k++)
        for (double share = 0.98; share > 0.2; share -= 0.24) {
            double y = fractions[k] * c->motion.stability / c->motion.damping;
            double omega = share * c->motion.stability * (sqrt(1 + y * y) - y);
            unsafe += !is_stable(c, omega, 2 * fractions[k] * omega);
        }
    return (double)unsafe;
}

/* Over 100 periods, weighted by sin^4, so that the ends of the sample leave 1/200^5 of what the
 * energy swings. */
static double mean_energy(struct calx_oscillators *s, const struct calx_choice *c)
{
    double sum = 0, weights = 0;
    for (size_t n = 0; n < SAMPLE; n++) {
        double weight = pow(sin(M_PI * ((double)n + 0.5) / SAMPLE), 4);
        calx_oscillators_step(s, c);
        sum += weight * (s->x[0] * s->x[0] + s->v[0] * s->v[0]);
        weights += weight;
    }
    return sum / weights;
}

static void check_drift(const struct calx_choice *c, struct calx_conformance *report)
{
    struct calx_oscillators s;
    if (!c->motion.symplectic)
        return;
    calx_oscillators_begin(&s, 1, 4, 2 * M_PI / PER_PERIOD, false);
    calx_oscillators_start(&s, c);
    double first = mean_energy(&s, c);
    for (size_t n = 2 * SAMPLE; n < (size_t)PERIODS * PER_PERIOD; n++)
        calx_oscillators_step(&s, c);
    calx_conform_note(report, "no drift of energy in 1e5 periods",
                      fabs(mean_energy(&s, c) / first - 1), DRIFT, c->where);
}

void calx_conform_stability(struct calx_choice *c, struct calx_conformance *report)
{
    const struct calx_motion_integrator *m = &c->motion;
    check_drift(c, report);
    if (!m->stages) { /* sub-steps do what is needed: its longest step must work */
        calx_conform_note(report, "its longest step is stable",
                          !is_stable(c, m->stability, 0) + !is_stable(c, 0, m->damping), 0,
                          c->where);
        return;
    }
    calx_conform_note(report, "stability limit as declared",
                      fabs(limit(c, m->stability, false) - 1), LIMIT_SLACK, c->where);
    calx_conform_note(report, "damping limit as declared", fabs(limit(c, m->damping, true) - 1),
                      LIMIT_SLACK, c->where);
    calx_conform_note(report, "stable below the limit for damped springs", unsafe_fractions(c), 0,
                      c->where);
}
