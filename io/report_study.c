/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Opens what a report is about: the case, the integrators that fit it, draws of its random numbers.
 * Input: options. Output: struct calx_report_study. Which integrators there are is for the registry
 * to say: a user's own one joins by being in a folder of plugins.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/report_parts.h"

static int out_of_memory(struct calx_error *error)
{
    return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
}

static const double LEAST = 1. / 16; /* share of its limit at which an integrator fits the case or does not */

/* ---- the case ---- */

static const struct calx_model *model_of(const struct calx_models *models, enum calx_kind kind)
{
    for (size_t k = 0; k < models->count; k++)
        if (models->list[k].kind == kind)
            return &models->list[k];
    return NULL;
}

static void look_at_models(struct calx_report_study *s)
{
    const struct calx_scene *scene = s->run.scene;
    const struct calx_features f = calx_sim_features(s->run.sim);
    s->axis = f.motion ? CALX_MOTION : CALX_TEMPERATURE;
    s->temperature = f.temperature;
    s->own_dt = calx_sim_dt(s->run.sim);
    s->own_heat_dt = scene->models[scene->stages[0].models].heat_dt;
    if (!(s->own_heat_dt > 0))
        s->own_heat_dt = s->own_dt;
}

/* The longest time that goes into all of them a whole number of times; 0 if there is none above a thousandth. */
static double common_divisor(double a, double b)
{
    double least = 1e-3 * fmin(a, b);
    while (b > least) {
        double rest = fabs(a - rint(a / b) * b);
        a = b;
        b = rest;
    }
    return b < 1e-9 * a ? a : 0;
}

static void look_at_times(struct calx_report_study *s)
{
    const struct calx_scene *scene = s->run.scene;
    s->duration = calx_sim_end(s->run.sim);
    s->common = scene->stages[0].duration;
    for (size_t k = 1; k < scene->stage_count && s->common > 0; k++)
        s->common = common_divisor(s->common, scene->stages[k].duration);
    for (size_t k = 0; k < scene->stage_count; k++)
        if (scene->stages[k].condition[0] || !isfinite(scene->stages[k].duration))
            s->common = 0;
}

static void look_at_particles(struct calx_report_study *s)
{
    const struct calx_particles *p = &s->run.scene->particles;
    double sum = 0;
    for (size_t i = 0; i < p->count; i++)
        sum += p->radius[i];
    s->particles = p->count;
    s->radius = p->count ? sum / (double)p->count : 1;
    s->body_count = p->count < CALX_REPORT_BODIES ? p->count : CALX_REPORT_BODIES;
    for (size_t b = 0; b < s->body_count; b++)
        s->bodies[b] = b * p->count / s->body_count;
}

/* ---- the integrators ---- */

/* The case's own, then the cheaper ones: where the budget does not suffice the last are left out. */
static int by_rank(const void *a, const void *b)
{
    const struct calx_report_candidate *x = a, *y = b;
    if (x->own != y->own)
        return x->own ? -1 : 1;
    if (x->evaluations != y->evaluations)
        return x->evaluations < y->evaluations ? -1 : 1;
    return strcmp(x->name, y->name);
}

/* Evaluations of forces per step before any is counted. An adaptive integrator does not say: as many as a step of fourth order. */
static double stages_of(const struct calx_report_study *s, const struct calx_plugin *plugin)
{
    const struct calx_motion_integrator *law = s->axis == CALX_MOTION ? plugin->law : NULL;
    return law && law->stages ? law->stages : law ? 4 : 1;
}

/* An adaptive integrator gives all bodies the sub-step of the one that needs the shortest: with many there is always one. It is taken then
 * only if it is asked for. */
static bool is_hopeless(const struct calx_report_study *s, const struct calx_plugin *plugin)
{
    enum { MANY = 20 };
    const struct calx_motion_integrator *law = s->axis == CALX_MOTION ? plugin->law : NULL;
    return law && !law->stages && !law->solves_impulses && s->particles > MANY;
}

static void note_adaptive(struct calx_report_study *s, const char *name)
{
    size_t used = strlen(s->adaptive);
    snprintf(s->adaptive + used, sizeof s->adaptive - used, "%s%s", used ? "," : "", name);
}

/* The first choice that is what the case says is the case's own. */
static void add_candidate(struct calx_report_study *s, struct calx_report_candidate c)
{
    const struct calx_scene *scene = s->run.scene;
    const struct calx_model *own = model_of(&scene->models[scene->stages[0].models], s->axis);
    c.own = s->own < 0 && calx_report_choice_is(&c, own);
    c.evaluations = stages_of(s, c.plugin);
    for (size_t k = 0; k < s->candidate_count; k++)
        if (strcmp(s->candidates[k].name, c.name) == 0)
            return;
    s->own = c.own ? 0 : s->own;
    s->candidates[s->candidate_count++] = c;
}

/* Those of the list, with their parameters. */
static int take_named(struct calx_report_study *s, struct calx_error *error)
{
    const char *list = s->options->integrators;
    struct calx_report_candidate c;
    char word[2 * sizeof c.name];
    while (calx_report_options_word(&list, word, sizeof word)) {
        CALX_TRY(calx_report_choice_read(s, word, &c, error));
        add_candidate(s, c);
    }
    return CALX_OK;
}

/* All that there are. */
static int take_all(struct calx_report_study *s, struct calx_error *error)
{
    struct calx_report_candidate c;
    for (size_t k = 0; k < calx_registry_count(s->run.registry); k++) {
        const struct calx_plugin *plugin = calx_registry_at(s->run.registry, k);
        if (plugin->kind != s->axis)
            continue;
        CALX_TRY(calx_report_choice_read(s, plugin->name, &c, error));
        const size_t before = s->candidate_count;
        add_candidate(s, c);
        if (before == s->candidate_count || s->candidates[before].own || !is_hopeless(s, plugin))
            continue;
        s->candidate_count = before;
        note_adaptive(s, plugin->name);
    }
    return CALX_OK;
}

static size_t words_in(const char *list)
{
    size_t count = 1;
    for (; *list; list++)
        count += *list == ',';
    return count;
}

static int find_candidates(struct calx_report_study *s, struct calx_error *error)
{
    const char *list = s->options->integrators;
    size_t most = list ? words_in(list) : calx_registry_load_all(s->run.registry, NULL);
    s->candidates = calloc(most + 1, sizeof *s->candidates);
    if (!s->candidates)
        return out_of_memory(error);
    CALX_TRY(list ? take_named(s, error) : take_all(s, error));
    qsort(s->candidates, s->candidate_count, sizeof *s->candidates, by_rank);
    return CALX_OK;
}

/* The limit, found with a step that is this share of it; *why: the refusal. */
static int look_for_limit(struct calx_report_study *s, struct calx_scene *scene, double share, double *limit, char *why, size_t size)
{
    struct calx_error refused = {0};
    *why = '\0';
    for (size_t m = 0; m < scene->models_count; m++) {
        scene->models[m].dt = s->axis == CALX_MOTION ? 0 : s->own_dt;
        scene->models[m].dt_fraction = share;
        scene->models[m].safety = 1;
        scene->models[m].forced = true; /* a limit is asked for, not whether steps of that length resolve contacts */
    }
    struct calx_sim *sim = calx_sim_create(scene, s->run.registry, s->options->threads, &refused);
    if (sim && s->axis == CALX_MOTION)
        *limit = calx_sim_dt(sim) / share;
    else if (!sim && !strstr(refused.text, "no time step"))
        calx_report_shorten(why, size, refused.text);
    calx_sim_free(sim);
    return !*why;
}

int calx_report_limit(struct calx_report_study *s, const struct calx_report_recipe *recipe, double *limit,
                      char *why, size_t size, struct calx_error *error)
{
    struct calx_scene *scene = calx_report_variant_create(s, s->run.scene, recipe);
    *limit = INFINITY;
    if (!scene)
        return out_of_memory(error);
    double share = 1; /* at the limit itself a fast body may move too far in a step */
    while (!look_for_limit(s, scene, share, limit, why, size) && share > LEAST)
        share *= 0.5;
    calx_report_variant_free(scene);
    return CALX_OK;
}

/* An integrator without a limit runs at any step, or (limit 0) at none: a very small one shows which. */
static int look_for_safety(struct calx_report_study *s, size_t c, struct calx_error *error)
{
    const struct calx_report_recipe recipe = {.candidate = (int)c, .dt = s->own_dt / 64, .stiffness = 1, .damping = 1};
    struct calx_scene *scene = calx_report_variant_create(s, s->run.scene, &recipe);
    struct calx_error why = {0};
    if (!scene)
        return out_of_memory(error);
    struct calx_sim *sim = calx_sim_create(scene, s->run.registry, s->options->threads, &why);
    s->candidates[c].unsafe = !sim;
    calx_sim_free(sim);
    calx_report_variant_free(scene);
    return CALX_OK;
}

static int find_limit(struct calx_report_study *s, size_t c, struct calx_error *error)
{
    struct calx_report_candidate *candidate = &s->candidates[c];
    const struct calx_report_recipe recipe = {.candidate = (int)c, .stiffness = 1, .damping = 1};
    CALX_TRY(calx_report_limit(s, &recipe, &candidate->critical, candidate->refused, sizeof candidate->refused, error));
    return isfinite(candidate->critical) || candidate->refused[0] ? CALX_OK : look_for_safety(s, c, error);
}

static int find_limits(struct calx_report_study *s, struct calx_error *error)
{
    size_t fit = 0;
    for (size_t c = 0; c < s->candidate_count; c++) {
        CALX_TRY(find_limit(s, c, error));
        fit += !s->candidates[c].refused[0];
    }
    if (fit)
        return CALX_OK;
    return calx_error_set(error, CALX_ERROR_INPUT, "no integrator fits this case%s%s",
                          s->candidate_count ? ": " : "", s->candidate_count ? s->candidates[0].refused : "");
}

static int check_tolerances(const struct calx_report_study *s, struct calx_error *error)
{
    bool any = isnan(s->tight);
    for (size_t c = 0; c < s->candidate_count; c++)
        any |= !s->candidates[c].refused[0] && calx_report_variant_has_tolerance(s, (int)c);
    return any ? CALX_OK : calx_error_set(error, CALX_ERROR_INPUT, "--tolerances: no integrator of this report has a tolerance");
}

/* ---- draws ---- */

/* A perturbed start stands for a draw where the case draws no random numbers. */
static bool same_start(const struct calx_particles *a, const struct calx_particles *b)
{
    size_t bytes = a->count * sizeof *a->position;
    return a->count == b->count && memcmp(a->position, b->position, bytes) == 0 &&
           (!a->velocity || memcmp(a->velocity, b->velocity, bytes) == 0) &&
           (!a->spin || memcmp(a->spin, b->spin, bytes) == 0);
}

static struct calx_scene *read_draw(struct calx_report_study *s, int draw, struct calx_error *error)
{
    struct calx_problems problems = {0};
    struct calx_scene *scene =
        calx_case_read_draw(s->run.file, s->run.registry, s->options->settings,
                            s->options->setting_count, (uint64_t)draw, &problems);
    if (!scene)
        calx_error_set(error, CALX_ERROR_INPUT, "draw %d of the random numbers of the case: %.300s", draw,
                       problems.kept ? problems.list[0].text : "cannot be read");
    calx_problems_clear(&problems);
    return scene;
}

const struct calx_scene *calx_report_study_scene(struct calx_report_study *s, int draw,
                                                 struct calx_error *error)
{
    if (draw == 0 || !s->random)
        return s->run.scene;
    size_t k = (size_t)draw;
    if (k >= s->scene_count) {
        struct calx_scene **grown = realloc(s->scenes, (k + 1) * sizeof *grown);
        if (!grown) {
            out_of_memory(error);
            return NULL;
        }
        s->scenes = grown;
        while (s->scene_count <= k)
            grown[s->scene_count++] = NULL;
    }
    if (!s->scenes[k])
        s->scenes[k] = read_draw(s, draw, error);
    return s->scenes[k];
}

/* Whether random numbers make a difference to where bodies start. */
static int look_at_draws(struct calx_report_study *s, struct calx_error *error)
{
    double begin = calx_terminal_clock();
    s->random = true;
    const struct calx_scene *other = calx_report_study_scene(s, 1, error);
    if (!other)
        return error->code;
    s->drawing = calx_terminal_clock() - begin;
    s->random = !same_start(&s->run.scene->particles, &other->particles);
    return CALX_OK;
}

/* ---- life ---- */

int calx_report_study_open(struct calx_report_study *s, const struct calx_report_options *o,
                           struct calx_error *error)
{
    const struct calx_run_options options = {.case_path = o->case_path,
                                             .out = o->out,
                                             .threads = o->threads,
                                             .settings = o->settings,
                                             .setting_count = o->setting_count};
    *s = (struct calx_report_study){.options = o, .own = -1};
    CALX_TRY(calx_report_options_read(s, error));
    CALX_TRY(calx_run_open(&s->run, &options, stderr, error));
    if (asprintf(&s->folder, o->out ? "%s" : "%s-report", s->run.folder) < 0) {
        s->folder = NULL;
        return out_of_memory(error);
    }
    look_at_models(s);
    if (!s->temperature && s->axis == CALX_TEMPERATURE)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "%s: nothing moves and nothing gets warmer: there is no integrator to choose",
                              s->run.file);
    look_at_times(s);
    look_at_particles(s);
    CALX_TRY(find_candidates(s, error));
    CALX_TRY(find_limits(s, error));
    CALX_TRY(check_tolerances(s, error));
    return look_at_draws(s, error);
}

void calx_report_study_clear(struct calx_report_study *s)
{
    for (size_t k = 0; k < s->scene_count; k++)
        calx_scene_free(s->scenes[k]);
    free(s->scenes);
    free(s->candidates);
    free(s->folder);
    calx_run_close(&s->run);
    *s = (struct calx_report_study){0};
}
