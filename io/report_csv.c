/* SPDX-License-Identifier: BSD-3-Clause
 *
 * report.csv: one line per point of the diagram; numbers with 17 digits, nothing where there is none.
 */
#include <math.h>

#include "io/file.h"
#include "io/report_parts.h"

static const char *const statuses[] = {"good", "unstable", "refused"};

static void print_header(const struct calx_report_job *job, FILE *f)
{
    fputs("integrator,dt [s],heat_dt [s],tolerance,stiffness_factor,status,runs,steps,evaluations,seconds [s],measured [s],"
          "spread [s],residual_relative", f);
    for (size_t q = 0; q < job->study.quantity_count; q++)
        fprintf(f, ",error %s,confidence %s", job->study.quantities[q].name, job->study.quantities[q].name);
    fputc('\n', f);
}

static void print_number(double v, FILE *f)
{
    if (isnan(v))
        fputc(',', f);
    else
        fprintf(f, ",%.17g", v);
}

static void print_result(const struct calx_report_job *job, const struct calx_report_result *r, FILE *f)
{
    const struct calx_report_point *p = r->point;
    const struct calx_report_study *s = &job->study;
    fprintf(f, "%s,%.17g", s->candidates[p->candidate].name, p->dt);
    print_number(p->heat_dt > 0 ? p->heat_dt : NAN, f);
    print_number(p->tolerance > 0 ? p->tolerance : NAN, f);
    fprintf(f, ",%.17g,%s,%zu", p->stiffness, r->runs || r->why[0] ? statuses[r->status] : "not run", r->runs);
    const double numbers[] = {r->steps, r->evaluations, r->seconds, r->measured, r->spread};
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        print_number(r->runs ? numbers[k] : NAN, f);
    print_number(r->residual, f);
    for (size_t q = 0; q < s->quantity_count; q++) {
        print_number(r->errors[q].error, f);
        print_number(r->errors[q].confidence, f);
    }
    fputc('\n', f);
}

/* What another code has measured: its error stands under its quantity. */
static void print_peer(const struct calx_report_job *job, const struct calx_report_peer *p, FILE *f)
{
    fprintf(f, "%s,%.17g,,,1,peer,,", p->name, p->dt);
    print_number(p->evaluations, f);
    print_number(p->seconds, f);
    fputs(",,,", f);
    for (size_t q = 0; q < job->study.quantity_count; q++) {
        print_number(q == p->quantity ? p->error : NAN, f);
        print_number(NAN, f);
    }
    fputc('\n', f);
}

int calx_report_write_csv(const struct calx_report_job *job, const struct calx_report_analysis *a,
                          struct calx_error *error)
{
    struct calx_file file;
    CALX_TRY(calx_report_create(job, "report.csv", &file, error));
    print_header(job, file.stream);
    for (size_t k = 0; k < a->count; k++)
        print_result(job, &a->results[k], file.stream);
    for (size_t k = 0; k < job->peer_count; k++)
        print_peer(job, &job->peers[k], file.stream);
    return calx_file_commit(&file, error);
}
