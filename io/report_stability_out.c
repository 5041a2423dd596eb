/* SPDX-License-Identifier: BSD-3-Clause
 *
 * stability.md, stability.csv and the map of what holds where (stability.svg, .png): one row per
 * integrator, stiffness and damping, the step in stability limits to the right.
 */
#include <math.h>
#include <string.h>

#include "io/file.h"
#include "io/report_parts.h"

/* From good to bad; the first whose bits all hold gives the colour. */
static const struct {
    unsigned bits;
    const char *colour, *name;
} grades[] = {
    {CALX_REPORT_BOUNDS | CALX_REPORT_ENERGY | CALX_REPORT_ORDER, "#4daf7c", "all hold"},
    {CALX_REPORT_BOUNDS | CALX_REPORT_ENERGY, "#f2d16b", "order lost"},
    {CALX_REPORT_BOUNDS, "#ef9b52", "energy lost"},
    {CALX_REPORT_SEEN, "#c9443f", "unstable"},
};
enum { GRADES = sizeof grades / sizeof *grades };

static size_t grade_of(unsigned holds)
{
    size_t g = 0;
    while (g + 1 < GRADES && (holds & grades[g].bits) != grades[g].bits)
        g++;
    return g;
}

static void name_row(const struct calx_report_job *job, const struct calx_report_sweep *w, char *text, size_t size)
{
    snprintf(text, size, "%s, k x %g%s", job->study.candidates[w->candidate].name, w->stiffness,
             w->damping == 0 ? ", undamped" : "");
}

/* ---- table ---- */

static void print_share(double share, FILE *f)
{
    if (share > 0)
        fprintf(f, " %.2f |", share);
    else
        fputs(" - |", f);
}

static void print_rows(const struct calx_report_job *job, const struct calx_report_sweep *w, size_t count, FILE *f)
{
    char step[32];
    fputs("| integrator | stiffness | damping | limit of dt | order holds to | energy holds to | bounds hold to |\n"
          "|---|---|---|---|---|---|---|\n", f);
    for (size_t k = 0; k < count; k++) {
        fprintf(f, "| %s | x %g | x %g | %s |", job->study.candidates[w[k].candidate].name, w[k].stiffness,
                w[k].damping, calx_report_step(w[k].limit, step, sizeof step));
        print_share(calx_report_holds_to(&w[k], CALX_REPORT_BOUNDS | CALX_REPORT_ORDER), f);
        print_share(calx_report_holds_to(&w[k], CALX_REPORT_BOUNDS | CALX_REPORT_ENERGY), f);
        print_share(calx_report_holds_to(&w[k], CALX_REPORT_BOUNDS), f);
        fputc('\n', f);
    }
}

static int write_csv(const struct calx_report_job *job, const struct calx_report_sweep *w, size_t count,
                     struct calx_error *error)
{
    struct calx_file file;
    CALX_TRY(calx_report_create(job, "stability.csv", &file, error));
    fputs("integrator,stiffness_factor,damping_factor,limit [s],step_over_limit,bounds,energy,order_holds,"
          "residual_relative,error,order\n", file.stream);
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < CALX_REPORT_LADDER; i++)
            if (w[k].holds[i] & CALX_REPORT_SEEN)
                fprintf(file.stream, "%s,%g,%g,%.17g,%.17g,%d,%d,%d,%.6g,%.6g,%.6g\n",
                        job->study.candidates[w[k].candidate].name, w[k].stiffness, w[k].damping, w[k].limit,
                        w[k].share[i], !!(w[k].holds[i] & CALX_REPORT_BOUNDS), !!(w[k].holds[i] & CALX_REPORT_ENERGY),
                        !!(w[k].holds[i] & CALX_REPORT_ORDER), w[k].residual[i], w[k].error[i], w[k].order[i]);
    return calx_file_commit(&file, error);
}

/* ---- picture ---- */

static void print_boxes(const struct calx_report_sweep *w, size_t count, FILE *f)
{
    for (size_t g = 0; g < GRADES; g++) {
        fprintf(f, "$g%zu << EOD\n1 -9 1 1 -9 -9\n", g); /* out of sight: no block is empty */
        for (size_t k = 0; k < count; k++)
            for (int i = 0; i < CALX_REPORT_LADDER; i++)
                if (w[k].holds[i] & CALX_REPORT_SEEN && grade_of(w[k].holds[i]) == g)
                    fprintf(f, "%.5g %zu %.5g %.5g %.2f %.2f\n", w[k].share[i], count - k, w[k].share[i] / 1.18,
                            w[k].share[i] * 1.18, (double)(count - k) - 0.4, (double)(count - k) + 0.4);
        fputs("EOD\n", f);
    }
}

static void print_script(const struct calx_report_job *job, const struct calx_report_sweep *w, size_t count, FILE *f)
{
    char name[192];
    int height = 150 + 24 * (int)count;
    fprintf(f, "# Redraws stability.svg or stability.png: gnuplot -e \"kind='svg'\" stability.gp\n"
               "if (!exists(\"kind\")) kind = 'svg'\n"
               "if (kind eq 'svg') { set terminal svg size 900,%d font 'Helvetica,14' background '#ffffff' } "
               "else { set terminal pngcairo size 900,%d font 'Sans,11' background '#ffffff' }\n"
               "set output 'stability.'.kind\nset encoding utf8\n", height, height);
    print_boxes(w, count, f);
    fprintf(f, "set logscale x 2\nset xrange [0.05:2.5]\nset yrange [0.4:%.1f]\nset ytics (", (double)count + 0.6);
    for (size_t k = 0; k < count; k++) {
        name_row(job, &w[k], name, sizeof name);
        fprintf(f, "%s\"%s\" %zu", k ? ", " : "", name, count - k);
    }
    fputs(") scale 0 textcolor rgb '#000000'\nset xtics textcolor rgb '#000000' (\"1/16\" 0.0625, \"1/8\" 0.125, \"1/4\" 0.25, \"1/2\" 0.5, \"1\" 1, \"2\" 2)\n"
          "set xlabel \"step / the stability limit that calx estimates\"\nset key above center horizontal samplen 2\n"
          "set style fill solid 1 noborder\nset border lc rgb '#888888'\n"
          "set arrow from 1, graph 0 to 1, graph 1 nohead lw 2 dt 2 lc rgb '#000000' front\nplot ", f);
    for (size_t g = 0; g < GRADES; g++)
        fprintf(f, "%s$g%zu using 1:2:3:4:5:6 with boxxyerror lc rgb '%s' title \"%s\"", g ? ", \\\n  " : "", g,
                grades[g].colour, grades[g].name);
    fputc('\n', f);
}

/* ---- the page ---- */

static int write_page(const struct calx_report_job *job, const struct calx_report_sweep *w, size_t count, bool picture,
                      struct calx_error *error)
{
    struct calx_file file;
    const struct calx_scene *scene = job->study.run.scene;
    char machine[512];
    CALX_TRY(calx_report_create(job, "stability.md", &file, error));
    FILE *f = file.stream;
    fprintf(f, "# %s: up to which step it holds\n\n", *scene->title ? scene->title : job->study.run.name);
    if (picture)
        fputs("![what holds at which step](stability.png)\n\n", f);
    fputs("Steps are in units of the stability limit that calx estimates for the integrator, stiffness and damping; each number is the "
          "largest step up to which it held at all smaller ones too.\n\n", f);
    print_rows(job, w, count, f);
    fputc('\n', f);
    for (size_t k = 0; k < count; k++) {
        char name[192];
        name_row(job, &w[k], name, sizeof name);
        if (w[k].why[0])
            fprintf(f, "- %s: not even 1/64 of the limit came to its end: %s\n", name, w[k].why);
    }
    fprintf(f, "\n- **Order**: from the step to its half the error in paths falls by 2^p, with p not more than 1/2 below that at small "
               "steps; against the same integrator with 1/64 of the limit. It means nothing in a chaotic scene.\n"
               "- **Energy**: the worst imbalance is within (w dt)^2/4, w dt = 2 dt/limit, or a hundredth.\n"
               "- **Bounds**: no guard stopped the run, and temperatures stayed in their range.\n\n"
               "Compared are the first %.4g s of the case. calx " CALX_VERSION ", %s. All numbers: stability.csv\n",
            job->plan.window, calx_report_machine(machine, sizeof machine));
    return calx_file_commit(&file, error);
}

int calx_report_write_stability(const struct calx_report_job *job, const struct calx_report_sweep *w, size_t count,
                                struct calx_error *error)
{
    struct calx_file file;
    bool drawn;
    CALX_TRY(write_csv(job, w, count, error));
    CALX_TRY(calx_report_create(job, "stability.gp", &file, error));
    print_script(job, w, count, file.stream);
    CALX_TRY(calx_file_commit(&file, error));
    CALX_TRY(calx_report_draw(job->study.folder, "stability.gp", &drawn, error));
    if (!drawn)
        fprintf(stderr, "calx: there is no gnuplot: no picture (install gnuplot-nox, then: gnuplot %s/stability.gp)\n",
                job->study.folder);
    CALX_TRY(write_page(job, w, count, drawn, error));
    if (!job->study.options->progress) /* quiet */
        return CALX_OK;
    print_rows(job, w, count, stdout);
    printf("\nthe page: %s/stability.md\n", job->study.folder);
    return CALX_OK;
}
