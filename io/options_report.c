/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The options of `calx report`.
 */
#include <errno.h>
#include <stdlib.h>

#include "io/options.h"
#include "io/quantity.h"

static int set_text(const char **text, const char *option, const char *what, const char *value,
                    struct calx_error *error)
{
    if (!*value)
        return calx_error_set(error, CALX_ERROR_INPUT, "%s needs %s", option, what);
    *text = value;
    return CALX_OK;
}

static int set_integrators(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_text(&a->integrators, "--integrators", "names with commas between them, parameters behind colons as in nscd:solver=apgd", value, error);
}

static int set_step_range(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_text(&a->step_range, "--steps", "two steps, as in 1e-6..1e-4", value, error);
}

static int set_heat_range(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_text(&a->heat_range, "--heat-steps", "two steps, as in 1e-5..1e-3", value, error);
}

static int set_soften(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_text(&a->soften, "--soften", "factors, as in 10,100", value, error);
}

static int set_tolerances(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_text(&a->tolerance_range, "--tolerances", "two numbers, as in 1e-10..1e-4", value, error);
}

static int set_points(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_text(&a->points, "--points", "a CSV file", value, error);
}

static int set_quantity(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_text(&a->quantities, "--quantity", "names with commas between them", value, error);
}

static int set_positive(double *number, const char *option, const char *unit, double most, const char *value,
                        struct calx_error *error)
{
    struct calx_error why;
    if (calx_quantity_parse(value, unit, number, &why))
        return calx_error_set(error, CALX_ERROR_INPUT, "%s: %.300s", option, why.text);
    if (*number > 0 && *number <= most)
        return CALX_OK;
    return calx_error_set(error, CALX_ERROR_INPUT, "%s %s: expected above 0 and at most %g", option, value, most);
}

static int set_target(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_positive(&a->target, "--target", "1", 1, value, error);
}

static int set_budget(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_positive(&a->budget, "--budget", "s", 1e7, value, error);
}

static int set_count(int *count, const char *option, const char *value, struct calx_error *error)
{
    enum { MOST = 1000 };
    char *end;
    errno = 0;
    long n = strtol(value, &end, 10);
    if (errno || end == value || *end || n < 2 || n > MOST)
        return calx_error_set(error, CALX_ERROR_INPUT, "%s needs a whole number from 2 to %d, not '%s'", option, MOST, value);
    *count = (int)n;
    return CALX_OK;
}

static int set_seeds(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_count(&a->seeds, "--seeds", value, error);
}

static int set_again(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return set_count(&a->again, "--again", value, error);
}

static int set_stability(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)value, (void)error;
    a->stability = true;
    return CALX_OK;
}

static int set_json(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)value, (void)error;
    a->json = true;
    return CALX_OK;
}

const struct calx_option calx_option_integrators = {"--integrators", "A,B:P=V,...", "only these (all that there are); B with the parameter P of value V",
                                                    set_integrators};
const struct calx_option calx_option_step_range = {"--steps", "A..B", "smallest and largest step (around the limit)",
                                                   set_step_range};
const struct calx_option calx_option_heat_range = {"--heat-steps", "A..B", "heat steps too, beside the case's step of motion",
                                                   set_heat_range};
const struct calx_option calx_option_soften = {"--soften", "A,B,...", "contacts softer by these factors too", set_soften};
const struct calx_option calx_option_tolerances = {"--tolerances", "A..B", "tolerances of the case's solvers too", set_tolerances};
const struct calx_option calx_option_points = {
    "--points", "FILE.csv", "other codes' points: name,dt,error,seconds,evaluations[,quantity]", set_points};
const struct calx_option calx_option_again = {"--again", "N", "measure the verdicts again with N other seeds, beyond the budget",
                                              set_again};
const struct calx_option calx_option_quantity = {
    "--quantity", "Q,...", "what to compare: a probe, a column of the CSV, a quantity, paths, temperatures", set_quantity};
const struct calx_option calx_option_target = {"--target", "ERROR", "the relative error to live with (1e-3)", set_target};
const struct calx_option calx_option_seeds = {"--seeds", "N", "seeds for statistics (as many as fit)", set_seeds};
const struct calx_option calx_option_stability = {"--stability", NULL, "where energy, order and bounds hold, past the limit",
                                                  set_stability};
const struct calx_option calx_option_budget = {"--budget", "TIME", "time for the whole report (3min)", set_budget};
const struct calx_option calx_option_report_json = {"--json", NULL, "the report as one JSON object", set_json};
