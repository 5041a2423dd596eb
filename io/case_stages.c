/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The stages of a case. Output: scene->stages, each complete: what a stage does not change is that
 * of the stage before, the first starts from what the case says.
 */
#include "io/case_reader.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/calx.h"
#include "core/measure.h"
#include "io/quantity.h"

/* ---- motion of walls
 * ----------------------------------------------------------------------------------- */

static bool needs_together(struct calx_reader *r, const xmlNode *node, const char *first,
                           const char *second)
{
    bool has_first = calx_case_given(node, first) != NULL,
         has_second = calx_case_given(node, second) != NULL;
    if (has_first != has_second)
        calx_case_fail(r, node, has_first ? first : second, "'%s' and '%s' are given together",
                       first, second);
    return has_first && has_second;
}

static void read_rotation(struct calx_reader *r, const xmlNode *node, struct calx_motion *m)
{
    double length;
    calx_case_function(r, node, "rotate", &m->rate);
    calx_case_vector(r, node, "about", m->about);
    m->axis[2] = 1.0;
    if (r->scene->dimension == 2 || !calx_case_given(node, "rotate"))
        return;
    if (!calx_case_given(node, "axis"))
        calx_case_fail(
            r, node, NULL,
            "attribute 'axis' is missing: in 3D a rotation has the direction of its axis");
    if (!calx_case_vector(r, node, "axis", m->axis))
        return;
    length = sqrt(m->axis[0] * m->axis[0] + m->axis[1] * m->axis[1] + m->axis[2] * m->axis[2]);
    if (!(length > 0))
        calx_case_fail(r, node, "axis", "has no direction");
    for (size_t k = 0; k < 3 && length > 0; k++)
        m->axis[k] /= length;
}

static bool is_rest(const struct calx_function *f)
{
    return !f->eval && f->value == 0;
}

/* Along the free axis nothing is prescribed. */
static void check_plate(struct calx_reader *r, const xmlNode *node, const struct calx_motion *m)
{
    const int k = m->free_axis;
    if (k >= (int)r->scene->dimension)
        calx_case_fail(r, node, "free", "there is no z in 2D");
    if (!is_rest(&m->rate))
        calx_case_fail(r, node, "rotate", "a plate that is free along an axis does not rotate");
    if (!is_rest(&m->velocity[k]))
        calx_case_fail(r, node, "velocity", "the plate is free along %c, expected 0 there", "xyz"[k]);
    if (!is_rest(&m->displacement[k]))
        calx_case_fail(r, node, "displacement", "the plate is free along %c, expected 0 there", "xyz"[k]);
    if (m->amplitude[k] != 0)
        calx_case_fail(r, node, "amplitude", "the plate is free along %c, expected 0 there", "xyz"[k]);
}

static void read_plate(struct calx_reader *r, const xmlNode *node, struct calx_motion *m)
{
    static const char *const parts[] = {"mass", "load", "damping"};
    int axis = calx_case_word(r, node, "free");
    m->free = axis >= 0;
    for (size_t k = 0; k < 3; k++)
        if (!calx_case_given(node, "free") && calx_case_given(node, parts[k]))
            calx_case_fail(r, node, parts[k], "is for a plate that is free along an axis, which 'free' names");
    if (!m->free)
        return;
    m->free_axis = axis;
    m->mass = calx_case_number(r, node, "mass");
    m->damping = calx_case_number(r, node, "damping");
    calx_case_function(r, node, "load", &m->load);
    if (!calx_case_given(node, "mass"))
        calx_case_fail(r, node, NULL, "attribute 'mass' is missing: a plate that is free moves as a body");
    check_plate(r, node, m);
}

static struct calx_motion read_motion(struct calx_reader *r, const xmlNode *node)
{
    struct calx_motion m = {.moves = true};
    bool oscillates = needs_together(r, node, "amplitude", "frequency");
    if (!calx_case_given(node, "rotate") && !calx_case_given(node, "velocity") &&
        !calx_case_given(node, "displacement") && !calx_case_given(node, "free") && !oscillates)
        calx_case_fail(
            r, node, NULL,
            "has no motion, expected rotate, velocity, amplitude and frequency, displacement, or free");
    read_rotation(r, node, &m);
    calx_case_functions(r, node, "velocity", m.velocity);
    m.has_displacement = calx_case_functions(r, node, "displacement", m.displacement);
    if (oscillates) {
        calx_case_vector(r, node, "amplitude", m.amplitude);
        m.frequency = calx_case_number(r, node, "frequency");
        m.phase = calx_case_number(r, node, "phase");
    }
    read_plate(r, node, &m);
    return m;
}

/* A motion of zeros stops a wall: nothing needs to be computed for it. */
static bool moves(const struct calx_motion *m)
{
    bool rest = is_rest(&m->rate) && !m->has_displacement && m->frequency == 0 && !m->free;
    for (size_t k = 0; k < 3; k++)
        rest &= is_rest(&m->velocity[k]);
    return !rest;
}

static void read_move(struct calx_reader *r, const xmlNode *node, struct calx_stage_spec *stage,
                      bool *moved)
{
    const char *text = calx_case_given(node, "walls"), *words[64];
    char *copy;
    struct calx_motion motion = read_motion(r, node);
    size_t count = calx_case_split(text ? text : "", "", &copy, words, 64);
    motion.moves = moves(&motion);
    for (size_t k = 0; k < count; k++) {
        int wall = calx_case_find_wall(r, node, "walls", words[k]);
        if (wall >= 0 && moved[wall])
            calx_case_fail(r, node, "walls", "'%s' has another <move> in this stage", words[k]);
        if (wall >= 0) {
            stage->motion[wall] = motion;
            moved[wall] = true;
        }
    }
    free(copy);
}

static void read_moves(struct calx_reader *r, const xmlNode *node, struct calx_stage_spec *stage)
{
    bool *moved = calloc(r->scene->wall_count + 1, sizeof *moved);
    for (const xmlNode *move = calx_case_first(node, "move"); moved && move;
         move = calx_case_next(move, "move"))
        read_move(r, move, stage, moved);
    free(moved);
}

/* ---- end of a stage
 * ------------------------------------------------------------------------------------ */

static size_t scene_measures(const char **names, size_t max)
{
    size_t count = 0;
    for (size_t k = 0; k < calx_measure_count() && count < max; k++)
        if (!calx_measure_at(k)->per_particle && !calx_case_needed_choice(calx_measure_at(k)))
            names[count++] = calx_measure_at(k)->name;
    return count;
}

static const struct calx_measure *find_measure(struct calx_reader *r, const xmlNode *node,
                                               const char *name)
{
    const struct calx_measure *measure = calx_measure_find(name);
    const char *names[96];
    if (measure && !measure->per_particle && !calx_case_needed_choice(measure))
        return measure;
    calx_case_fail_name(r, node, "until", "quantity of the whole scene", name, names,
                        scene_measures(names, 96));
    return NULL;
}

/* "kinetic-energy < 1e-9 J" */
static void read_condition(struct calx_reader *r, const xmlNode *node, const char *text,
                           struct calx_stage_spec *stage)
{
    const char *relation = strpbrk(text, "<>");
    size_t length = (size_t)(relation - text);
    char name[sizeof stage->condition] = "";
    struct calx_error e = {0};
    while (length && isspace((unsigned char)text[length - 1]))
        length--;
    if (length >= sizeof name)
        length = sizeof name - 1;
    memcpy(name, text, length);
    const struct calx_measure *measure = find_measure(r, node, name + strspn(name, " \t\r\n"));
    if (!measure)
        return;
    snprintf(stage->condition, sizeof stage->condition, "%s", measure->name);
    stage->relation = *relation == '<' ? CALX_BELOW : CALX_ABOVE;
    if (calx_quantity_parse(relation + 1, measure->unit, &stage->bound, &e))
        calx_case_fail_with(r, node, "until", &e);
}

/* A time of the run: it must be known when the stage begins. */
static void read_end(struct calx_reader *r, const xmlNode *node, double begin,
                     struct calx_stage_spec *stage)
{
    double end = calx_case_number(r, node, "until");
    if (isnan(begin) && !isnan(end))
        calx_case_fail(r, node, "until",
                       "a time, but a stage before ends by a condition; use 'for'");
    else if (end <= begin)
        calx_case_fail(r, node, "until", "%g s, but the stages before end at %g s", end, begin);
    else
        stage->duration = end - begin;
}

static void read_length(struct calx_reader *r, const xmlNode *node, double begin,
                        struct calx_stage_spec *stage)
{
    const char *length = calx_case_given(node, "for"), *until = calx_case_given(node, "until");
    double at_most = calx_case_number(r, node, "at-most");
    bool condition = until && strpbrk(until, "<>");
    stage->condition[0] = '\0';
    stage->duration = INFINITY;
    if ((length != NULL) == (until != NULL))
        calx_case_fail(r, node, NULL, "has %s, expected either 'for' or 'until'",
                       length ? "both 'for' and 'until'" : "no end");
    for (size_t k = 0; k < 2; k++) {
        const char *name = k ? "hold" : "at-most";
        if (calx_case_given(node, name) && !condition)
            calx_case_fail(r, node, name, "is for a stage that ends by a condition");
    }
    if (condition) {
        read_condition(r, node, until, stage);
        stage->hold = calx_case_number(r, node, "hold");
        stage->duration = isnan(at_most) ? INFINITY : at_most;
    } else if (length) {
        stage->duration = calx_case_number(r, node, "for");
    } else if (until) {
        read_end(r, node, begin, stage);
    }
}

/* ---- stages
 * -------------------------------------------------------------------------------------------- */

static bool copy_wall_arrays(const struct calx_scene *scene, const struct calx_stage_spec *before,
                             struct calx_stage_spec *stage)
{
    size_t n = scene->wall_count;
    stage->motion = calloc(n + 1, sizeof *stage->motion);
    stage->wall_temperature = calloc(n + 1, sizeof *stage->wall_temperature);
    if (!stage->motion || !stage->wall_temperature)
        return false;
    for (size_t w = 0; w < n; w++) {
        stage->wall_temperature[w] =
            before ? before->wall_temperature[w] : scene->walls[w].temperature;
        if (before)
            stage->motion[w] = before->motion[w];
    }
    return true;
}

static void read_wall_temperature(struct calx_reader *r, const xmlNode *node,
                                  struct calx_stage_spec *stage)
{
    int wall = calx_case_wall(r, node, "name");
    if (wall < 0)
        return;
    if (!r->scene->walls[wall].isothermal)
        calx_case_fail(
            r, node, NULL,
            "these walls are insulated, give them a temperature where they are made (line %d)",
            r->scene->walls[wall].place.line);
    calx_case_function(r, node, "temperature", &stage->wall_temperature[wall]);
}

static void read_changes(struct calx_reader *r, const xmlNode *node, struct calx_stage_spec *stage)
{
    const xmlNode *gravity = calx_case_first(node, "gravity"),
                  *output = calx_case_first(node, "stage-output");
    stage->models = calx_case_stage_models(r, node, stage->models);
    read_moves(r, node, stage);
    if (gravity) {
        memset(stage->gravity, 0, sizeof stage->gravity);
        calx_case_read_gravity(r, gravity, stage->gravity);
    }
    if (output)
        stage->output_every = calx_case_number(r, output, "every");
    for (const xmlNode *walls = calx_case_first(node, "stage-walls"); walls;
         walls = calx_case_next(walls, "stage-walls"))
        read_wall_temperature(r, walls, stage);
}

static void name_stage(struct calx_reader *r, const xmlNode *node, struct calx_stage_spec *stage)
{
    const char *name = calx_case_given(node, "name");
    if (name)
        snprintf(stage->name, sizeof stage->name, "%.47s", name);
    else
        snprintf(stage->name, sizeof stage->name, "%zu", r->scene->stage_count);
    for (size_t k = 0; k + 1 < r->scene->stage_count; k++)
        if (strcmp(r->scene->stages[k].name, stage->name) == 0)
            calx_case_fail(r, node, NULL, "there is already a stage '%s' on line %d", stage->name,
                           r->scene->stages[k].place.line);
}

static void start_from_case(struct calx_reader *r, struct calx_stage_spec *stage)
{
    const xmlNode *gravity = calx_case_first(r->root, "gravity"),
                  *output = calx_case_first(r->root, "output");
    double every = output ? calx_case_number(r, output, "every") : NAN;
    stage->output_every = isnan(every) ? 0.0 : every;
    if (gravity)
        calx_case_read_gravity(r, gravity, stage->gravity);
}

static double read_stage(struct calx_reader *r, const xmlNode *node, double begin)
{
    struct calx_scene *scene = r->scene;
    struct calx_stage_spec *stage =
        calx_case_append(r, &scene->stages, &scene->stage_count, sizeof *scene->stages);
    if (!stage)
        return begin;
    const struct calx_stage_spec *before = scene->stage_count > 1 ? stage - 1 : NULL;
    if (before)
        *stage = *before;
    else
        start_from_case(r, stage);
    stage->place = calx_case_place(r, node);
    if (!copy_wall_arrays(scene, before, stage)) {
        calx_problems_add(r->problems, stage->place, "no memory");
        return begin;
    }
    name_stage(r, node, stage);
    read_length(r, node, begin, stage);
    read_changes(r, node, stage);
    return *stage->condition ? NAN : begin + stage->duration;
}

void calx_case_read_stages(struct calx_reader *r)
{
    double begin = 0.0;
    for (const xmlNode *node = calx_case_first(r->root, "stage"); node;
         node = calx_case_next(node, "stage"))
        begin = read_stage(r, node, begin);
}
