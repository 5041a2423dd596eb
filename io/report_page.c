/* SPDX-License-Identifier: BSD-3-Clause
 *
 * report.md: the report as a page. The verdict, how errors were measured, the picture, a table per
 * quantity, what did not work, machine and versions.
 */
#include <math.h>
#include <string.h>

#include "io/file.h"
#include "io/report_parts.h"

static void print_reference(const struct calx_report_job *job, const struct calx_report_analysis *a, FILE *f)
{
    const struct calx_report_plan *plan = &job->plan;
    const struct calx_report_study *s = &job->study;
    char step[32];
    if (plan->reference == CALX_REPORT_EXACT)
        fputs("Errors are against the exact solution that the case gives, root mean square over time and over runs whose "
              "steps differ by a few per cent.\n", f);
    else if (plan->reference == CALX_REPORT_CONVERGED)
        fprintf(f, "The case gives no exact solution for all of it: errors are against three runs with steps down to %s, "
                   "extrapolated to step 0; root mean square over time, bodies, and runs whose steps differ by a few per cent.\n",
                calx_report_step(plan->references[2].dt, step, sizeof step));
    else
        fprintf(f, "Paths are chaotic here, so errors are those of means over time, averaged over %zu seeds, against runs of "
                   "the same seeds with step %s; confidence intervals are of 95 %%.\n", a->seeds,
                calx_report_step(plan->references[0].dt, step, sizeof step));
    if (plan->decorrelation < INFINITY)
        fprintf(f, "Two starts that differ by 1e-6 of a radius are 1e-2 apart after t = %.3g s: paths are not compared past "
                   "that.\n", plan->decorrelation);
    else if (!isnan(plan->decorrelation))
        fprintf(f, "A difference of starts grows by a factor of %.2g: paths can be compared.\n", plan->growth);
    fprintf(f, "Compared are the first %.4g s", plan->window);
    if (isfinite(s->duration))
        fprintf(f, " of %.4g s", s->duration);
    fprintf(f, ", at %d instants.\n\n", plan->samples);
}

static void print_scales(const struct calx_report_job *job, const struct calx_report_analysis *a, FILE *f)
{
    char floor[32];
    for (size_t q = 0; q < job->study.quantity_count; q++) {
        const struct calx_report_quantity *quantity = &job->study.quantities[q];
        const struct calx_report_scale *scale = &a->scales[q];
        if (scale->absolute)
            fprintf(f, "- **%s**: absolute, in %s", quantity->name, quantity->unit);
        else
            fprintf(f, "- **%s**: relative to %.4g%s%s%s", quantity->name, scale->scale, strcmp(quantity->unit, "1") ? " " : "",
                    strcmp(quantity->unit, "1") ? quantity->unit : "",
                    quantity->form == CALX_REPORT_PATHS ? " (the mean radius)" : "");
        if (quantity->exact)
            fprintf(f, "; solution: %s", quantity->exact->source);
        else if (scale->floor > 0)
            fprintf(f, "; the reference itself is uncertain by %s%s",
                    calx_report_percent(scale->floor, scale->absolute, quantity->unit, floor, sizeof floor),
                    isnan(scale->order) ? " (not extrapolated: its differences follow no order)" : "");
        fputs("\n", f);
    }
    fputc('\n', f);
}

/* One line per integrator: what it costs to be within the target, and what it gives at the case's step. */
static void print_integrators(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, FILE *f)
{
    const struct calx_report_study *s = &job->study;
    char error[32], step[32], time[32], declared[16];
    fprintf(f, "| integrator | order | declared | limit of dt | error at dt = %s | ns per evaluation | evaluations per step |\n"
               "|---|---|---|---|---|---|---|\n", calx_report_step(s->own_dt, step, sizeof step));
    for (size_t c = 0; c < s->candidate_count; c++) {
        const struct calx_report_candidate *candidate = &s->candidates[c];
        const struct calx_report_curve *curve = &a->curves[c * s->quantity_count + q];
        const struct calx_report_result *at = calx_report_nearest(a, (int)c, s->own_dt);
        uint32_t order = s->axis == CALX_MOTION
                             ? ((const struct calx_motion_integrator *)candidate->plugin->law)->order
                             : ((const struct calx_temperature_integrator *)candidate->plugin->law)->order;
        if (candidate->refused[0] || !at)
            continue; /* the notes say why */
        snprintf(declared, sizeof declared, candidate->value_count ? "-" : "%u", order); /* of the defaults */
        snprintf(time, sizeof time, "-");
        if (isfinite(candidate->critical))
            calx_report_step(candidate->critical, time, sizeof time);
        calx_report_percent(at->errors[q].error, a->scales[q].absolute, s->quantities[q].unit, error, sizeof error);
        fprintf(f, "| %s%s | ", candidate->name, candidate->own ? " (the case's)" : "");
        if (isnan(curve->order))
            fputs("-", f);
        else
            fprintf(f, "%.2f ± %.2f", curve->order, curve->order_error);
        fprintf(f, " | %s | %s | %s | %.0f ± %.0f %% | %.3g |\n", declared, time, error, 1e9 * candidate->cost,
                100 * candidate->spread, candidate->evaluations);
    }
    fputc('\n', f);
}

static void print_points(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, FILE *f)
{
    const struct calx_report_study *s = &job->study;
    char step[32], error[32], wide[32], time[32], soft[96];
    fputs("| integrator | dt | error | ± | evaluations | time | |\n|---|---|---|---|---|---|---|\n", f);
    for (size_t k = 0; k < a->count; k++) {
        const struct calx_report_result *r = &a->results[k];
        if (!r->runs && !r->why[0])
            continue;
        calx_report_beside(r->point, ", ", soft, sizeof soft);
        fprintf(f, "| %s%s | %s | ", s->candidates[r->point->candidate].name, soft,
                calx_report_step(r->point->dt, step, sizeof step));
        if (r->status != CALX_REPORT_GOOD) {
            fprintf(f, "- | - | - | - | %s |\n", r->status == CALX_REPORT_REFUSED ? "refused" : "unstable");
            continue;
        }
        fprintf(f, "%s | %s | %.0f | %s | %s%s |\n",
                calx_report_percent(r->errors[q].error, a->scales[q].absolute, s->quantities[q].unit, error, sizeof error),
                calx_report_percent(r->errors[q].confidence, a->scales[q].absolute, s->quantities[q].unit, wide,
                                    sizeof wide),
                r->evaluations, calx_report_time(r->seconds, time, sizeof time), r->front[q] ? "on the front" : "",
                a->verdicts[q].best == r ? " **the verdict**" : "");
    }
    fputc('\n', f);
}

/* What other codes gave, beside which the picture shows them. */
static void print_peers(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, FILE *f)
{
    char step[32], error[32], time[32];
    if (calx_report_points_curve(job, q, 0) == job->peer_count)
        return;
    fprintf(f, "Other codes, as %s says:\n\n| code | dt | error | evaluations | time |\n|---|---|---|---|---|\n",
            basename(job->study.options->points));
    for (size_t k = 0; k < job->peer_count; k++) {
        const struct calx_report_peer *p = &job->peers[k];
        if (p->quantity != q)
            continue;
        fprintf(f, "| %s | %s | %s | ", p->name, calx_report_step(p->dt, step, sizeof step),
                calx_report_percent(p->error, a->scales[q].absolute, job->study.quantities[q].unit, error, sizeof error));
        fprintf(f, isnan(p->evaluations) ? "- | " : "%.0f | ", p->evaluations);
        fprintf(f, "%s |\n", isnan(p->seconds) ? "-" : calx_report_time(p->seconds, time, sizeof time));
    }
    fputc('\n', f);
}

/* Verdicts measured anew: what was promised, what came. */
static void print_again(const struct calx_report_job *job, const struct calx_report_analysis *a, FILE *f)
{
    char promised[32], got[32], wide[32];
    bool any = false;
    for (size_t q = 0; q < job->study.quantity_count; q++) {
        const struct calx_report_again *g = &a->again[q];
        const char *unit = job->study.quantities[q].unit;
        bool absolute = a->scales[q].absolute;
        if (!g->seeds)
            continue;
        if (!any)
            fprintf(f, "## Measured again\n\nThe same steps with %zu other seeds:\n\n"
                       "| quantity | promised at most | came to | |\n|---|---|---|---|\n", g->seeds);
        any = true;
        fprintf(f, "| %s | %s | %s ± %s | %s |\n", job->study.quantities[q].name,
                calx_report_percent(calx_report_upper(&job->plan, &a->verdicts[q].best->errors[q]), absolute, unit, promised,
                                    sizeof promised),
                calx_report_percent(g->mean, absolute, unit, got, sizeof got),
                calx_report_percent(g->confidence, absolute, unit, wide, sizeof wide), g->holds ? "holds" : "**does not hold**");
    }
    if (any)
        fputc('\n', f);
}

/* Integrators of which there is no point: for want of time, or because no run came to its end. */
static void print_absent(const struct calx_report_job *job, const struct calx_report_analysis *a, FILE *f)
{
    const struct calx_report_study *s = &job->study;
    const char *before = "- left out for want of time (more with --budget, or name fewer with --integrators): ";
    bool any = false;
    for (size_t c = 0; c < s->candidate_count; c++) {
        bool failed = false;
        for (size_t k = 0; k < a->count; k++)
            failed |= a->results[k].point->candidate == (int)c && a->results[k].why[0];
        if (s->candidates[c].refused[0] || failed || calx_report_nearest(a, (int)c, s->own_dt))
            continue;
        fprintf(f, "%s%s", any ? ", " : before, s->candidates[c].name);
        any = true;
    }
    if (any)
        fputc('\n', f);
    for (size_t c = 0; c < s->candidate_count; c++)
        for (size_t k = 0; k < a->count && !calx_report_nearest(a, (int)c, s->own_dt); k++)
            if (a->results[k].point->candidate == (int)c && a->results[k].why[0]) {
                fprintf(f, "- no run of %s came to its end: %s\n", s->candidates[c].name, a->results[k].why);
                break;
            }
}

static void print_notes(const struct calx_report_job *job, const struct calx_report_analysis *a, FILE *f)
{
    const struct calx_report_study *s = &job->study;
    for (size_t c = 0; c < s->candidate_count; c++)
        if (s->candidates[c].refused[0])
            fprintf(f, "- %s does not fit this case: %s\n", s->candidates[c].name, s->candidates[c].refused);
    for (size_t c = 0; c < s->candidate_count; c++)
        if (s->candidates[c].unsafe)
            fprintf(f, "- %s is stable at no step: calx runs it only if forced, and the verdict leaves it out\n",
                    s->candidates[c].name);
    for (size_t k = 0; k < a->count; k++)
        if (a->results[k].status == CALX_REPORT_UNSTABLE) {
            fprintf(f, "- the first that failed: %s with dt = %.3g s: %s\n",
                    s->candidates[a->results[k].point->candidate].name, a->results[k].point->dt,
                    a->results[k].why);
            break;
        }
    print_absent(job, a, f);
    if (s->adaptive[0])
        fprintf(f, "- adaptive integrators were left out: they give all bodies the sub-step of the one that needs the shortest, and of many "
                   "one always does; to have them: --integrators %s\n", s->adaptive);
    double start = 0;
    for (size_t k = 0; k < s->run.scene->stage_count; start += s->run.scene->stages[k++].duration)
        if (start >= job->plan.window && k > 0)
            fprintf(f, "- stage %zu%s%s, from t = %.4g s, was not reached: a larger --budget compares more of the case\n", k + 1,
                    s->run.scene->stages[k].name[0] ? " " : "", s->run.scene->stages[k].name, start);
    if (job->skipped)
        fprintf(f, "- %zu runs of %zu were left out: the budget did not allow them\n", job->skipped,
                job->plan.recipe_count + job->plan.reference_count);
    fputc('\n', f);
}

static void print_machine(const struct calx_report_job *job, FILE *f)
{
    const struct calx_report_study *s = &job->study;
    char machine[512], spent[32], budget[32];
    double seconds = 0, evaluations = 0;
    for (size_t k = 0; k < job->store.count; k++) {
        seconds += job->store.runs[k].wall + job->store.runs[k].setup;
        evaluations += (double)job->store.runs[k].evaluations;
    }
    fprintf(f, "calx " CALX_VERSION ", %s. %zu runs, %.3g evaluations of all forces, %s of a budget of %s%s. "
               "Times are counted evaluations times the median cost of an evaluation of each integrator%s; "
               "costs that differ by less than 10 %% or their scatter count as equal in the verdict.\n",
            calx_report_machine(machine, sizeof machine), job->store.count, evaluations,
            calx_terminal_duration(seconds, spent, sizeof spent),
            calx_terminal_duration(s->options->budget, budget, sizeof budget), job->beyond ? " and of measuring again, which is beyond it" : "",
            isnan(s->heat_low) && isnan(s->tight) ? "" : ", of other heat steps and tolerances the median of the clock");
}

/* A paragraph; the first one is bold. */
static void print_verdict(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, bool first,
                          FILE *f)
{
    char text[1024] = "";
    FILE *line = fmemopen(text, sizeof text - 1, "w");
    if (line) {
        calx_report_print_verdict(job, a, q, line);
        fclose(line);
    }
    text[strcspn(text, "\n")] = '\0';
    fprintf(f, first ? "**%s**\n" : "\n%s\n", text);
}

int calx_report_write_page(const struct calx_report_job *job, const struct calx_report_analysis *a, bool picture,
                           struct calx_error *error)
{
    struct calx_file file;
    const struct calx_report_study *s = &job->study;
    CALX_TRY(calx_report_create(job, "report.md", &file, error));
    FILE *f = file.stream;
    fprintf(f, "# %s: integrator and step\n\n", *s->run.scene->title ? s->run.scene->title : s->run.name);
    for (size_t rank = 0; rank < s->quantity_count; rank++)
        print_verdict(job, a, calx_report_ranked(job, a, rank), rank == 0, f);
    fputc('\n', f);
    if (picture)
        fputs("![error against run time](report.png)\n\n", f);
    print_reference(job, a, f);
    print_scales(job, a, f);
    for (size_t q = 0; q < s->quantity_count; q++) {
        fprintf(f, "## %s\n\n", s->quantities[q].name);
        print_integrators(job, a, q, f);
        print_points(job, a, q, f);
        print_peers(job, a, q, f);
    }
    print_again(job, a, f);
    fputs("## Notes\n\n", f);
    print_notes(job, a, f);
    print_machine(job, f);
    return calx_file_commit(&file, error);
}
