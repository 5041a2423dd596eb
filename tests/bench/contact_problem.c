/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The contact problem of a step of nscd, apart from the run it comes from, so that solvers can be compared on it (tests/bench/rigid/run):
 *
 *     contact_problem make CASE FILE [PATH=VALUE...]   runs the case to its end; the problem of the last step, without impulses, goes to FILE
 *     contact_problem solve FILE OUT REPEATS TOLERANCE NAME=VALUE...   solves it from no impulses with these parameters of nscd
 *     contact_problem show CASE [PATH=VALUE...]   runs the case; prints the impulses of its last step, and the velocities after it, as JSON
 *
 * `solve` writes the impulses to OUT and prints the sweeps, the residual and the seconds of each repeat. A file: counts of contacts and rows
 * (int64), dt, then by column velocity (8 per row), position (4), normal (3 per contact), lever (2), gap, friction (double), i, j (int32).
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/state.h"
#include "io/case.h"
#include "plugins/nscd.h"

enum { NUMBERS = 7 }; /* per contact */

struct problem {
    int64_t n, rows;
    double dt;
    double *velocity, *position, *column[NUMBERS], *impulse[4], *none;
    int32_t *body[2];
    int8_t *axis;
};

static void *room(size_t count, size_t size)
{
    void *p = calloc(count + 1, size);
    if (!p) {
        fprintf(stderr, "contact_problem: not enough memory\n");
        exit(1);
    }
    return p;
}

static void allocate(struct problem *p)
{
    size_t n = (size_t)p->n, rows = (size_t)p->rows;
    p->velocity = room(8 * rows, sizeof(double));
    p->position = room(4 * rows, sizeof(double));
    p->none = room(8 * rows + n, sizeof(double));
    p->axis = room(1, 1);
    for (int k = 0; k < NUMBERS; k++)
        p->column[k] = room(n, sizeof(double));
    for (int k = 0; k < 4; k++)
        p->impulse[k] = room(n, sizeof(double));
    for (int k = 0; k < 2; k++)
        p->body[k] = room(n, sizeof(int32_t));
}

static void release(struct problem *p)
{
    void *all[] = {p->velocity, p->position, p->none, p->body[0], p->body[1], p->axis};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        free(all[k]);
    for (int k = 0; k < NUMBERS; k++)
        free(p->column[k]);
    for (int k = 0; k < 4; k++)
        free(p->impulse[k]);
}

/* Reads or writes the whole problem, whose counts are known. */
static bool move(struct problem *p, FILE *file, size_t (*one)(void *, size_t, size_t, FILE *))
{
    size_t n = (size_t)p->n, rows = (size_t)p->rows;
    bool good = one(p->velocity, sizeof(double), 8 * rows, file) == 8 * rows && one(p->position, sizeof(double), 4 * rows, file) == 4 * rows;
    for (int k = 0; k < NUMBERS; k++)
        good = good && one(p->column[k], sizeof(double), n, file) == n;
    for (int k = 0; k < 2; k++)
        good = good && one(p->body[k], sizeof(int32_t), n, file) == n;
    return good;
}

static size_t write_one(void *data, size_t size, size_t count, FILE *file)
{
    return fwrite(data, size, count, file);
}

static int fail(const char *what, const char *why)
{
    fprintf(stderr, "contact_problem: %s: %s\n", what, why);
    return 1;
}

/* ---- make ---- */

/* Velocities at the end of the step if no contact acted. */
static void take(const struct calx_problem *q, struct problem *p)
{
    *p = (struct problem){.n = (int64_t)q->n, .rows = (int64_t)q->bodies, .dt = q->dt};
    allocate(p);
    memcpy(p->velocity, q->before, 8 * q->bodies * sizeof(double));
    for (size_t row = 0; row < q->bodies; row++)
        for (size_t k = 0; k < 3 && p->velocity[8 * row + 3] > 0.0; k++)
            p->velocity[8 * row + k] += q->dt * q->gravity[k];
    memcpy(p->position, q->position, 4 * (q->bodies - q->walls) * sizeof(double));
    const double *columns[NUMBERS] = {q->normal[0], q->normal[1], q->normal[2], q->lever[0], q->lever[1], q->gap, q->friction};
    for (size_t k = 0; k < NUMBERS; k++)
        memcpy(p->column[k], columns[k], q->n * sizeof(double));
    for (size_t k = 0; k < 2; k++)
        memcpy(p->body[k], q->body[k], q->n * sizeof(int32_t));
}

/* A case that has run to its end. */
struct finished {
    struct calx_registry *registry;
    struct calx_scene *scene;
    struct calx_sim *sim;
};

static int run(const char *path, int count, char **words, struct finished *f)
{
    struct calx_setting settings[16];
    struct calx_problems problems = {0};
    struct calx_error e = {0};
    size_t given = 0;
    for (; (int)given < count && given < 16; given++) {
        char *equals = strchr(words[given], '=');
        if (!equals)
            return fail(words[given], "path=value was expected");
        *equals = '\0';
        settings[given] = (struct calx_setting){words[given], equals + 1};
    }
    f->registry = calx_registry_create(NULL);
    f->scene = f->registry ? calx_case_read(path, f->registry, settings, given, &problems) : NULL;
    calx_problems_print(&problems, stderr);
    calx_problems_clear(&problems);
    f->sim = f->scene ? calx_sim_create(f->scene, f->registry, 0, &e) : NULL;
    int code = !f->sim;
    while (!code && !calx_sim_done(f->sim))
        code = calx_sim_step(f->sim, &e);
    return code ? fail(path, e.text) : 0;
}

static void end(struct finished *f)
{
    calx_sim_free(f->sim);
    calx_scene_free(f->scene);
    calx_registry_free(f->registry);
}

static int make(int count, char **words)
{
    struct finished f;
    struct problem p;
    if (run(words[0], count - 2, words + 2, &f))
        return 1;
    FILE *file = fopen(words[1], "wb");
    take(calx_store_problem(f.sim), &p);
    bool good = file && fwrite(&p.n, sizeof p.n, 1, file) == 1 && fwrite(&p.rows, sizeof p.rows, 1, file) == 1 &&
                fwrite(&p.dt, sizeof p.dt, 1, file) == 1 && move(&p, file, write_one);
    if (file)
        good = !fclose(file) && good;
    release(&p);
    end(&f);
    return good ? 0 : fail(words[1], "cannot be written");
}

/* ---- show ---- */

static long long id_of(const struct calx_sim *s, int32_t row)
{
    return row < 0 ? -1 : (long long)s->r.id[row];
}

static int show(int count, char **words)
{
    struct finished f;
    if (run(words[0], count - 1, words + 1, &f))
        return 1;
    const struct calx_sim *s = f.sim;
    const struct calx_problem *q = calx_store_problem(f.sim);
    printf("{\"contacts\": [");
    for (size_t c = 0; c < q->n; c++) {
        printf("%s{\"i\": %lld, \"j\": %lld, \"normal\": [", c ? ",\n" : "", id_of(s, q->body[0][c]), id_of(s, q->body[1][c]));
        for (int k = 0; k < 3; k++)
            printf("%s%.17g", k ? ", " : "", q->normal[k][c]);
        printf("], \"impulse\": [");
        for (int k = 0; k < 3; k++)
            printf("%s%.17g", k ? ", " : "", q->normal_impulse[c] * q->normal[k][c] + q->impulse[k][c]);
        printf("]}");
    }
    printf("],\n\"bodies\": {");
    for (size_t row = 0, first = 1; row < s->r.rows; row++) {
        bool own = false;
        for (size_t b = 0; b < s->block_count; b++)
            own |= row >= (size_t)s->blocks[b].first && row < (size_t)(s->blocks[b].first + s->blocks[b].own);
        const double *v = calx_row_v(s, (int32_t)row);
        if (!own)
            continue;
        printf("%s\"%lld\": [%.17g, %.17g, %.17g, %.17g, %.17g, %.17g]", first ? "" : ", ", (long long)s->r.id[row], v[0], v[1], v[2], v[4], v[5], v[6]);
        first = 0;
    }
    printf("}}\n");
    end(&f);
    return 0;
}

/* ---- solve ---- */

static void serial(void *engine, size_t n, void (*part)(void *context, size_t first, size_t last), void *context)
{
    (void)engine;
    part(context, 0, n);
}

static int solve_once(const struct nscd *nscd, const struct problem *p, double *velocity, struct calx_problem *q)
{
    const struct calx_motion_host host = {.size = sizeof host, .dt = p->dt, .parallel = serial};
    char why[512] = "";
    double *const *c = p->column;
    size_t n = (size_t)p->n;
    memcpy(velocity, p->velocity, 8 * (size_t)p->rows * sizeof(double));
    for (int k = 0; k < 4; k++)
        memset(p->impulse[k], 0, n * sizeof(double));
    *q = (struct calx_problem){.size = sizeof *q, .n = n, .bodies = (size_t)p->rows, .dt = p->dt, .position = p->position, .before = p->none,
        .velocity = velocity, .body = {p->body[0], p->body[1]}, .normal = {c[0], c[1], c[2]}, .lever = {c[3], c[4]}, .gap = c[5],
        .wall_before = {p->none, p->none, p->none}, .wall_after = {p->none, p->none, p->none}, .friction = c[6], .restitution = p->none,
        .pull = p->none, .normal_impulse = p->impulse[3], .impulse = {p->impulse[0], p->impulse[1], p->impulse[2]}, .gravity = {0, 0, -1},
        .axis = p->axis};
    return nscd_solve(nscd, &host, q, why, sizeof why) ? fail("nscd", why) : 0;
}

static bool set(struct nscd *p, const char *word)
{
    static const struct {
        const char *name;
        size_t offset;
    } known[] = {{"solver=", offsetof(struct nscd, solver)}, {"order=", offsetof(struct nscd, order)}, {"sweeps=", offsetof(struct nscd, sweeps)},
                 {"relaxation=", offsetof(struct nscd, relaxation)}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strncmp(word, known[k].name, strlen(known[k].name)) == 0) {
            *(double *)((char *)p + known[k].offset) = strtod(word + strlen(known[k].name), NULL);
            return true;
        }
    return false;
}

static int solve(int count, char **words)
{
    struct problem p = {0};
    struct nscd nscd = {.theta = 0.5, .tolerance = strtod(words[3], NULL), .accuracy = 1e9, .sweeps = 1e5, .unsolved = 1, .relaxation = 1};
    FILE *file = fopen(words[0], "rb");
    bool good = file && fread(&p.n, sizeof p.n, 1, file) == 1 && fread(&p.rows, sizeof p.rows, 1, file) == 1 &&
                fread(&p.dt, sizeof p.dt, 1, file) == 1;
    if (good)
        allocate(&p);
    good = good && move(&p, file, fread);
    if (file)
        fclose(file);
    if (!good)
        return fail(words[0], "is not a whole problem");
    for (int k = 4; k < count; k++)
        if (!set(&nscd, words[k]))
            return fail(words[k], "solver=, order=, sweeps= or relaxation= was expected");
    double *velocity = room(8 * (size_t)p.rows, sizeof(double));
    struct calx_problem q = {0};
    printf("{\"seconds\": [");
    for (int repeat = 0; repeat < atoi(words[2]); repeat++) {
        struct timespec a, b;
        clock_gettime(CLOCK_MONOTONIC, &a);
        if (solve_once(&nscd, &p, velocity, &q))
            return 1;
        clock_gettime(CLOCK_MONOTONIC, &b);
        printf("%s%.6f", repeat ? ", " : "", (double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec));
    }
    printf("], \"sweeps\": %.0f, \"residual\": %.3e}\n", q.sweeps, q.residual);
    file = fopen(words[1], "wb");
    good = file != NULL;
    for (int k = 0; good && k < 4; k++)
        good = fwrite(p.impulse[(k + 3) % 4], sizeof(double), (size_t)p.n, file) == (size_t)p.n;
    free(velocity);
    release(&p);
    return file && !fclose(file) && good ? 0 : fail(words[1], "cannot be written");
}

int main(int argc, char **argv)
{
    if (argc >= 4 && strcmp(argv[1], "make") == 0)
        return make(argc - 2, argv + 2);
    if (argc >= 6 && strcmp(argv[1], "solve") == 0)
        return solve(argc - 2, argv + 2);
    if (argc >= 3 && strcmp(argv[1], "show") == 0)
        return show(argc - 2, argv + 2);
    fprintf(stderr, "usage: contact_problem make CASE FILE [PATH=VALUE...]\n       contact_problem solve FILE OUT REPEATS TOLERANCE [NAME=VALUE...]\n"
                    "       contact_problem show CASE [PATH=VALUE...]\n");
    return 2;
}
