/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The report as one JSON object: verdicts, curves, points, what errors are measured against.
 */
#include <math.h>
#include <string.h>

#include "io/report_parts.h"

static void print_string(const char *text, FILE *f)
{
    fputc('"', f);
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        if (*c < 0x20 || *c == '"' || *c == '\\')
            fprintf(f, "\\u%04x", *c);
        else
            fputc(*c, f);
    fputc('"', f);
}

static void print_number(const char *key, double v, FILE *f)
{
    if (isfinite(v))
        fprintf(f, ", \"%s\": %.17g", key, v);
    else
        fprintf(f, ", \"%s\": null", key);
}

static void print_verdict(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t q, FILE *f)
{
    const struct calx_report_study *s = &job->study;
    const struct calx_report_verdict *v = &a->verdicts[q];
    char text[1024] = "";
    FILE *line = fmemopen(text, sizeof text - 1, "w");
    if (line) {
        calx_report_print_verdict(job, a, q, line);
        fclose(line);
    }
    text[strcspn(text, "\n")] = '\0';
    fputs("{\"quantity\": ", f);
    print_string(s->quantities[q].name, f);
    fputs(", \"unit\": ", f);
    print_string(s->quantities[q].unit, f);
    fputs(", \"text\": ", f);
    print_string(text, f);
    fprintf(f, ", \"exact\": %s", s->quantities[q].exact ? "true" : "false");
    print_number("scale", a->scales[q].scale, f);
    print_number("reference_uncertainty", a->scales[q].floor, f);
    fputs(", \"integrator\": ", f);
    if (v->best)
        print_string(s->candidates[v->best->point->candidate].name, f);
    else
        fputs("null", f);
    print_number("dt", v->best ? v->best->point->dt : NAN, f);
    print_number("target", v->target, f);
    print_number("error", v->best ? calx_report_upper(&job->plan, &v->best->errors[q]) : NAN, f);
    print_number("seconds", v->whole, f);
    print_number("own_step_finer_than_needed", v->own_factor, f);
    print_number("best_reached", v->reached, f);
    const struct calx_report_again *again = &a->again[q];
    if (again->seeds) {
        fprintf(f, ", \"again\": {\"holds\": %s", again->holds ? "true" : "false");
        print_number("seeds", (double)again->seeds, f);
        print_number("error", again->mean, f);
        print_number("confidence", again->confidence, f);
        fputc('}', f);
    }
    fputc('}', f);
}

static void print_integrator(const struct calx_report_job *job, const struct calx_report_analysis *a, size_t c, FILE *f)
{
    const struct calx_report_study *s = &job->study;
    const struct calx_report_candidate *candidate = &s->candidates[c];
    fputs("{\"name\": ", f);
    print_string(candidate->name, f);
    fprintf(f, ", \"own\": %s, \"refused\": ", candidate->own ? "true" : "false");
    print_string(candidate->refused, f);
    print_number("critical", candidate->critical, f);
    print_number("cost", candidate->cost, f);
    print_number("spread", candidate->spread, f);
    print_number("evaluations_per_step", candidate->evaluations, f);
    fputs(", \"orders\": {", f);
    for (size_t q = 0; q < s->quantity_count; q++) {
        double order = a->curves[c * s->quantity_count + q].order;
        fputs(q ? ", " : "", f);
        print_string(s->quantities[q].name, f);
        if (isfinite(order))
            fprintf(f, ": %.6g", order);
        else
            fputs(": null", f);
    }
    fputs("}}", f);
}

static void print_point(const struct calx_report_job *job, const struct calx_report_result *r, FILE *f)
{
    static const char *const statuses[] = {"good", "unstable", "refused"};
    const struct calx_report_study *s = &job->study;
    fputs("{\"integrator\": ", f);
    print_string(s->candidates[r->point->candidate].name, f);
    fprintf(f, ", \"status\": \"%s\"", r->runs || r->why[0] ? statuses[r->status] : "not run");
    print_number("dt", r->point->dt, f);
    print_number("heat_dt", r->point->heat_dt > 0 ? r->point->heat_dt : NAN, f);
    print_number("tolerance", r->point->tolerance > 0 ? r->point->tolerance : NAN, f);
    print_number("stiffness_factor", r->point->stiffness, f);
    print_number("runs", (double)r->runs, f);
    print_number("steps", r->steps, f);
    print_number("evaluations", r->evaluations, f);
    print_number("seconds", r->seconds, f);
    print_number("measured", r->measured, f);
    fputs(", \"errors\": {", f);
    for (size_t q = 0; q < s->quantity_count; q++) {
        fputs(q ? ", " : "", f);
        print_string(s->quantities[q].name, f);
        if (isfinite(r->errors[q].error))
            fprintf(f, ": [%.17g, %.17g]", r->errors[q].error, r->errors[q].confidence);
        else
            fputs(": null", f);
    }
    fputs("}}", f);
}

static void print_peer(const struct calx_report_job *job, const struct calx_report_peer *p, FILE *f)
{
    fputs("{\"name\": ", f);
    print_string(p->name, f);
    fputs(", \"quantity\": ", f);
    print_string(job->study.quantities[p->quantity].name, f);
    print_number("dt", p->dt, f);
    print_number("error", p->error, f);
    print_number("seconds", p->seconds, f);
    print_number("evaluations", p->evaluations, f);
    fputc('}', f);
}

void calx_report_print_json(const struct calx_report_job *job, const struct calx_report_analysis *a, FILE *f)
{
    static const char *const words[] = {"exact", "converged", "statistics"};
    const struct calx_report_study *s = &job->study;
    double evaluations = 0;
    for (size_t k = 0; k < job->store.count; k++)
        evaluations += (double)job->store.runs[k].evaluations;
    fputs("{\"case\": ", f);
    print_string(s->run.name, f);
    fputs(", \"version\": \"" CALX_VERSION "\", \"reference\": ", f);
    print_string(words[job->plan.reference], f);
    print_number("target", s->options->target, f);
    print_number("window", job->plan.window, f);
    print_number("duration", s->duration, f);
    print_number("decorrelation", job->plan.decorrelation, f);
    print_number("own_dt", s->own_dt, f);
    print_number("seeds", (double)a->seeds, f);
    print_number("planned_seconds", job->plan.seconds, f);
    print_number("planned_evaluations", job->plan.evaluations, f);
    print_number("evaluations", evaluations, f);
    print_number("seconds_per_evaluation", job->cost, f);
    print_number("runs", (double)job->store.count, f);
    print_number("resumed_runs", (double)job->store.found, f);
    print_number("skipped_runs", (double)job->skipped, f);
    fputs(", \"verdicts\": [", f);
    for (size_t q = 0; q < s->quantity_count; q++) {
        fputs(q ? ", " : "", f);
        print_verdict(job, a, q, f);
    }
    fputs("], \"integrators\": [", f);
    for (size_t c = 0; c < s->candidate_count; c++) {
        fputs(c ? ", " : "", f);
        print_integrator(job, a, c, f);
    }
    fputs("], \"points\": [", f);
    for (size_t k = 0; k < a->count; k++) {
        fputs(k ? ", " : "", f);
        print_point(job, &a->results[k], f);
    }
    fputs("], \"peers\": [", f);
    for (size_t k = 0; k < job->peer_count; k++) {
        fputs(k ? ", " : "", f);
        print_peer(job, &job->peers[k], f);
    }
    fputs("]}\n", f);
}
