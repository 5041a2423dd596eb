/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The case reader on good input: every field of the scene of tests/data/cases/everything.xml,
 * settings from the command line, the grammar and the reference. Mistakes and hostile files have
 * their own file, test_case_mistakes.c.
 */
#include <dirent.h>
#include <libxml/relaxng.h>
#include <math.h>

#include "io/schema.h"
#include "tests/case_files.h"

/* ---- a good file
 * --------------------------------------------------------------------------------------- */

/* Quantities are at most three roundings from their values. */
#define ROUNDING 1e-15
#define EQUAL(a, b) ck_assert_double_eq_tol(a, b, ROUNDING *(1 + fabs((double)(b))))

static double at_time(const struct calx_function *f, double t)
{
    return calx_evaluate(f, t, (double[3]){0, 0, 0});
}

START_TEST(test_surroundings)
{
    read_everything(NULL, 0);
    ck_assert_ptr_nonnull(scene);
    ck_assert_str_eq(scene->title, "Everything & more");
    ck_assert_uint_eq(scene->dimension, 2);
    ck_assert_uint_eq(scene->bodies, CALX_DISCS);
    EQUAL(scene->thickness, 0.05);
    ck_assert(scene->periodic[0] && !scene->periodic[1] && !scene->periodic[2]);
    ck_assert(scene->bounded[0] && scene->bounded[1] && !scene->bounded[2]);
    EQUAL(scene->low[1], -1);
    EQUAL(scene->high[1], 2);
    EQUAL(scene->from_dissipation, 0.9);
    ck_assert(scene->split_effusivity);
    EQUAL(scene->skin, 0.001);
    ck_assert_uint_eq(scene->seed, 5);
}
END_TEST

static const struct calx_value *find_value(const struct calx_value *values, size_t count,
                                           const char *name, int a, int b)
{
    for (size_t k = 0; k < count; k++)
        if (strcmp(values[k].name, name) == 0 && values[k].pair[0] == a && values[k].pair[1] == b)
            return &values[k];
    ck_abort_msg("no value %s for %d %d", name, a, b);
}

static const struct calx_model *find_model(const struct calx_models *models, enum calx_kind kind,
                                           const char *plugin)
{
    for (size_t k = 0; k < models->count; k++)
        if (models->list[k].kind == kind && strcmp(models->list[k].plugin, plugin) == 0)
            return &models->list[k];
    ck_abort_msg("no model %s", plugin);
}

START_TEST(test_materials_and_models)
{
    read_everything(NULL, 0);
    ck_assert_ptr_nonnull(scene);
    const struct calx_material *copper = &scene->materials[0], *steel = &scene->materials[1];
    ck_assert_int_eq(calx_scene_material(scene, "copper"), 0);
    ck_assert_int_eq(calx_scene_material(scene, "steel"), 1);
    EQUAL(copper->density, 8900);
    EQUAL(copper->specific_heat, 172);
    EQUAL(find_value(copper->values, copper->value_count, "conductivity", -1, -1)->value, 385);
    EQUAL(find_value(steel->values, steel->value_count, "young", -1, -1)->value, 210e9);
    ck_assert(isnan(steel->density));
    ck_assert_uint_eq(scene->models_count, 2);
    const struct calx_models *models = &scene->models[0];
    ck_assert_uint_eq(models->count, 4);
    ck_assert(models->lever_full && !models->frozen);
    ck_assert_double_eq(models->dt, 0);
    EQUAL(models->dt_fraction, 0.2);
    EQUAL(models->heat_dt, 0.001);
    const struct calx_model *linear = find_model(models, CALX_CONTACT, "linear");
    EQUAL(find_value(linear->values, linear->value_count, "stiffness", -1, -1)->value, 6000);
    EQUAL(find_value(linear->values, linear->value_count, "stiffness", 0, 1)->value, 5000);
    EQUAL(find_value(linear->values, linear->value_count, "clip", -1, -1)->value, 1);
    const struct calx_model *theta = find_model(models, CALX_TEMPERATURE, "heat-theta");
    EQUAL(find_value(theta->values, theta->value_count, "theta", -1, -1)->value, 1);
    find_model(models, CALX_CONDUCTANCE, "constant");
    find_model(models, CALX_MOTION, "velocity-verlet");
}
END_TEST

START_TEST(test_walls)
{
    read_everything(NULL, 0);
    ck_assert_ptr_nonnull(scene);
    ck_assert_uint_eq(scene->wall_count, 2);
    const struct calx_wall *drum = &scene->walls[0], *lid = &scene->walls[1];
    ck_assert(drum->closed && drum->isothermal && drum->material == 1);
    ck_assert_uint_eq(drum->primitive_count, 4);
    EQUAL(at_time(&drum->temperature, 0), 373.15);
    for (size_t k = 0; k < 4; k++) {
        EQUAL(fabs(drum->primitives[k].a[0]), 0.04);
        EQUAL(fabs(drum->primitives[k].a[1]), 0.04);
    }
    ck_assert(!lid->closed && !lid->isothermal && lid->material == 0);
    ck_assert_uint_eq(lid->primitive_count, 7);
    const struct calx_primitive *p = lid->primitives;
    EQUAL(p[0].b[0], 0.1);
    ck_assert_int_eq(p[1].surface, p[2].surface); /* the joint turns by 0.6 degrees */
    ck_assert_int_ne(p[2].surface, p[3].surface);
    ck_assert_int_ne(p[0].surface, p[1].surface);
    ck_assert(p[4].shape == CALX_PLANE && p[5].shape == CALX_CYLINDER && p[6].shape == CALX_SPHERE);
    EQUAL(p[4].a[1], -0.05);
    EQUAL(p[4].n[1], 1);
    EQUAL(p[5].radius, 0.03);
    EQUAL(p[5].a[0], 0.005);
    EQUAL(p[5].n[2], 1);
    ck_assert(!p[5].inside && p[6].inside);
}
END_TEST

START_TEST(test_particles)
{
    read_everything(NULL, 0);
    ck_assert_ptr_nonnull(scene);
    const struct calx_particles *p = &scene->particles;
    ck_assert_uint_eq(p->count, 1 + 6 + 2 + 15);
    EQUAL(p->position[0][1], 0.002);
    EQUAL(p->velocity[0][1], -1);
    EQUAL(p->spin[0][2], 2);
    EQUAL(p->temperature[0], 300);
    ck_assert(p->fixed[0] && !p->fixed[1] && !p->fixed[7] && p->fixed[8]);
    EQUAL(p->position[6][0], 0.018); /* the last of the grid, x fastest */
    EQUAL(p->position[6][1], 0.024);
    EQUAL(p->temperature[6], 273.15 + 20 + 24);
    EQUAL(p->position[8][1], 0.21);
    EQUAL(p->velocity[8][0], 2);
    EQUAL(p->temperature[8], 360);
    EQUAL(p->radius[8], 0.001);
    for (size_t i = 9; i < p->count; i++) {
        double margin = 0.04 + p->radius[i];
        ck_assert(p->radius[i] >= 0.001 && p->radius[i] <= 0.002);
        ck_assert(p->position[i][0] >= margin && p->position[i][1] <= 0.12 - margin);
        ck_assert(fabs(p->velocity[i][0]) <= 0.1 && p->velocity[i][0] != 0 &&
                  p->velocity[i][2] == 0);
        ck_assert_int_eq(p->material[i], 0);
    }
}
END_TEST

START_TEST(test_stages)
{
    read_everything(NULL, 0);
    ck_assert_ptr_nonnull(scene);
    ck_assert_uint_eq(scene->stage_count, 3);
    const struct calx_stage_spec *settle = scene->stages, *turn = settle + 1, *third = settle + 2;
    ck_assert_str_eq(settle->condition, "kinetic-energy");
    ck_assert_int_eq(settle->relation, CALX_BELOW);
    EQUAL(settle->bound, 1e-9);
    EQUAL(settle->duration, 5);
    EQUAL(settle->output_every, 0.02);
    EQUAL(at_time(&settle->gravity[1], 0), -9.81);
    ck_assert(!settle->motion[0].moves);
    ck_assert_str_eq(turn->condition, "");
    EQUAL(turn->duration, 3);
    EQUAL(turn->output_every, 0.005);
    EQUAL(at_time(&turn->gravity[0], 0), -1);
    EQUAL(at_time(&turn->gravity[1], 3), 6);
    EQUAL(at_time(&turn->wall_temperature[0], 10), 410);
    for (int w = 0; w < 2; w++) {
        ck_assert(turn->motion[w].moves);
        EQUAL(at_time(&turn->motion[w].rate, 0), acos(-1) / 6);
        EQUAL(turn->motion[w].about[1], 0.002);
        EQUAL(turn->motion[w].axis[2], 1);
        EQUAL(at_time(&turn->motion[w].velocity[0], 2), 0.2);
    }
    ck_assert_str_eq(third->name, "3");
    EQUAL(at_time(&third->motion[0].rate, 0), acos(-1) / 6); /* goes on */
    EQUAL(at_time(&third->motion[1].rate, 0), 0);            /* replaced */
    EQUAL(third->motion[1].amplitude[1], 0.001);
    EQUAL(third->motion[1].frequency, 20);
    EQUAL(third->motion[1].phase, acos(0));
    EQUAL(at_time(&third->gravity[0], 0), -1);
    ck_assert(settle->models == 0 && turn->models == 0 && third->models == 1);
    const struct calx_models *models = &scene->models[1];
    ck_assert_uint_eq(models->count, 5);
    EQUAL(models->dt, 2e-6);
    ck_assert(!models->lever_full);
    const struct calx_model *linear = find_model(models, CALX_CONTACT, "linear");
    ck_assert_uint_eq(linear->value_count, 1);
    EQUAL(linear->values[0].value, 3000);
    find_model(models, CALX_CONDUCTANCE, "constant");
}
END_TEST

START_TEST(test_results)
{
    read_everything(NULL, 0);
    ck_assert_ptr_nonnull(scene);
    const struct calx_output *output = &scene->output;
    ck_assert_uint_eq(output->fields, CALX_FIELD_VELOCITY | CALX_FIELD_TEMPERATURE);
    ck_assert(output->network && output->single && output->compression == 9);
    EQUAL(output->csv_every, 0.001);
    ck_assert_uint_eq(scene->probe_count, 4);
    const struct calx_probe *probes = scene->probes;
    ck_assert(strcmp(probes[0].reduce, "mean") == 0 && probes[0].material == 0 &&
              probes[0].particle == -1);
    ck_assert(probes[1].particle == 3 && probes[1].material == -1 && probes[1].wall == -1);
    ck_assert(probes[2].component == 'y' && strcmp(probes[2].quantity, "velocity") == 0);
    ck_assert_str_eq(probes[3].classes, "start-height");
    EQUAL(probes[3].cell, 0.005);
    ck_assert_uint_eq(scene->expect_count, 4);
    const struct calx_expect *e = scene->expects;
    ck_assert(e[0].when == CALX_MAXIMUM && !e[0].has_value && strcmp(e[0].stage, "turn") == 0);
    EQUAL(e[0].below, 2);
    EQUAL(e[0].above, 0.001);
    ck_assert_str_eq(e[0].source, "a bound");
    ck_assert(e[1].when == CALX_AT_TIME && e[1].has_value && isnan(e[1].above) &&
              isnan(e[1].below));
    EQUAL(e[1].time, 0.03);
    EQUAL(at_time(&e[1].value, 1), 273.15 + 31);
    EQUAL(e[1].atol, 0.5);
    EQUAL(e[1].rtol, 0.001);
    ck_assert(e[2].when == CALX_ALWAYS && at_time(&e[2].value, 0) == 24);
    ck_assert(e[3].when == CALX_CHANGE && at_time(&e[3].value, 0) == 0);
    EQUAL(e[3].atol, 0.001);
    ck_assert_uint_eq(scene->exact_count, 1);
    ck_assert_str_eq(scene->exacts[0].of, "top");
    EQUAL(at_time(&scene->exacts[0].value, 3), 273.15 + 26);
    EQUAL(scene->exacts[0].from, 0.005);
    ck_assert_str_eq(scene->exacts[0].source, "a line");
}
END_TEST

START_TEST(test_profiles)
{
    read_everything(NULL, 0);
    ck_assert_ptr_nonnull(scene);
    ck_assert_uint_eq(scene->profile_count, 2);
    const struct calx_profile *p = scene->profiles;
    ck_assert(strcmp(p[0].name, "across") == 0 && p[0].axis == 1 && p[0].layers == 4 && p[0].groups);
    const double low[3] = {-1, -1, -0.025}, high[3] = {1, 1, 0.025};
    for (int k = 0; k < 3; k++) {
        EQUAL(p[0].low[k], low[k]);
        EQUAL(p[0].high[k], high[k]);
    }
    EQUAL(p[0].every, 0.001);
    EQUAL(p[0].over, 0.02);
    EQUAL(p[0].after, 1);
    ck_assert(p[1].axis == 0 && p[1].layers == 3 && !p[1].groups);
    EQUAL(p[1].low[0], -0.5);
    EQUAL(p[1].high[0], 0.5);
    EQUAL(p[1].low[1], -0.5); /* 2 m about the middle of the domain, 0.5 m */
    EQUAL(p[1].high[1], 1.5);
    EQUAL(p[1].every, 0.005);
    EQUAL(p[1].after, 0);
}
END_TEST

static const char parts[] =
    "<case dimension='2' bodies='discs' thickness='20 mm'>\n"
    "<material name='iron' density='7800' specific-heat='450' conductivity='80'/>\n"
    "<contact plugin='linear' stiffness='6000 N/m'/><conductance plugin='constant' conductance='1'/>\n"
    "<integrator plugin='velocity-verlet'/>\n"
    "<domain x='-1 3 m' y='-5 5 m' periodic='x'/>\n"
    "<walls name='floor' material='iron'><plane point='0 -2 m' normal='0 1'/>\n"
    "<slab depth='10 cm' cells='40 20' temperature='20 degC'/></walls>\n"
    "<walls name='lid' material='iron'><segment from='3 2 m' to='-1 2 m'/>\n"
    "<slab depth='1 cm' cells='5 3' temperature='300' far='isothermal' far-temperature='400' theta='1'/></walls>\n"
    "<walls name='side' material='iron'><segment from='0 0' to='0 1'/><slab depth='1 cm' cells='5 3' temperature='300'/></walls>\n"
    "<particles material='iron'><particle at='0 0.5' radius='1 mm'/></particles>\n"
    "<stage for='1 s'><move walls='lid' free='y' mass='2 kg' load='-10*t [N]' damping='3 N s/m' velocity='0.5 0'/></stage>\n"
    "<probe name='slide' of='wall-velocity' wall='lid' component='x'/><probe name='hot' of='slab-max-temperature' wall='lid'/>\n"
    "<profile name='p' axis='y' layers='7' over='1 s'/>\n"
    "<probe name='speed' of='layer-velocity' profile='p' layer='7' component='x'/>\n"
    "<steady name='warm' of='hot' over='0.4 s' after='2 s' blocks='6' within='2 degC'/>\n"
    "<steady name='flow' of='layer-velocity' profile='p' component='y' over='2 s' every='1 s' within='3 mm/s'/></case>\n";

static void check_slab(const struct calx_slab *b, const double corner[3], const double along[2], double length, bool periodic)
{
    for (int k = 0; k < 2; k++) {
        EQUAL(b->corner[k], corner[k]);
        EQUAL(b->axis[0][k], along[k]);
        EQUAL(b->axis[1][k], k ? -along[0] : along[1]); /* on the right */
    }
    EQUAL(b->corner[2], -0.01);
    EQUAL(b->axis[2][2], 1);
    EQUAL(b->length, length);
    EQUAL(b->width, 0.02);
    EQUAL(b->conductivity, 80);
    EQUAL(b->capacity, 7800 * 450);
    ck_assert(b->periodic == periodic);
}

/* Two, and the columns that they add. */
static void check_watches(const struct calx_steady *w)
{
    static const char *const columns[] = {"warm_drift", "warm_since", "flow_drift", "flow_since"};
    ck_assert_uint_eq(scene->steady_count, 2);
    ck_assert(w[0].blocks == 6 && w[0].signal.profile == -1 && strcmp(w[0].signal.quantity, "slab-max-temperature") == 0);
    ck_assert(w[0].signal.wall == 1);
    EQUAL(w[0].over, 0.4);
    EQUAL(w[0].every, 0.02);
    EQUAL(w[0].after, 2);
    EQUAL(w[0].within, 2); /* a difference */
    ck_assert(w[1].blocks == 10 && w[1].signal.profile == 0 && w[1].signal.component == 'y');
    EQUAL(w[1].every, 1);
    EQUAL(w[1].after, 0);
    EQUAL(w[1].within, 0.003);
    for (size_t k = 0; k < 4; k++) {
        const struct calx_probe *p = &scene->probes[3 + k];
        ck_assert_str_eq(p->name, columns[k]);
        ck_assert_uint_eq(p->steady, 1 + k / 2);
        ck_assert_str_eq(p->quantity, k % 2 ? "steady-since" : "steady-drift");
    }
}

START_TEST(test_plates_and_slabs)
{
    put_file("case.xml", parts);
    scene = calx_case_read(in_folder("case.xml"), registry, NULL, 0, &problems);
    calx_problems_print(&problems, stderr);
    ck_assert_ptr_nonnull(scene);
    const struct calx_slab *floor_slab = &scene->walls[0].slab, *lid = &scene->walls[1].slab;
    check_slab(floor_slab, (double[3]){-1, -2, 0}, (double[2]){1, 0}, 4, true);
    check_slab(lid, (double[3]){3, 2, 0}, (double[2]){-1, 0}, 4, true);
    check_slab(&scene->walls[2].slab, (double[3]){0, 0, 0}, (double[2]){0, 1}, 1, false);
    ck_assert(floor_slab->along == 40 && floor_slab->deep == 20 && !floor_slab->far_isothermal);
    EQUAL(floor_slab->start, 293.15);
    EQUAL(floor_slab->theta, 0.5);
    EQUAL(floor_slab->depth, 0.1);
    ck_assert(lid->far_isothermal && lid->far == 400 && lid->theta == 1);
    const struct calx_motion *m = &scene->stages[0].motion[1];
    ck_assert(m->moves && m->free && m->free_axis == 1 && m->mass == 2 && m->damping == 3);
    EQUAL(at_time(&m->load, 2), -20);
    ck_assert(!scene->stages[0].motion[0].free);
    ck_assert(scene->probes[2].profile == 0 && scene->probes[2].layer == 7);
    check_watches(scene->steady);
}
END_TEST

/* ---- settings
 * ------------------------------------------------------------------------------------------ */

START_TEST(test_settings)
{
    const struct calx_setting settings[] = {
        {"stage[turn]/for", "1 s"},         {"stage[3]/for", "2 s"},
        {"particles/pack/count", "4"},      {"integrator/dt", "1e-5"},
        {"gravity", "0 -1.6 m/s2"},         {"title", "Moon"},
        {"contact[linear]/stiffness", "7"}, {"integrator[temperature]/dt", "2 ms"},
        {"expect[4]/source", "set"}};
    read_everything(settings, sizeof settings / sizeof *settings);
    ck_assert_ptr_nonnull(scene);
    EQUAL(scene->stages[1].duration, 1);
    EQUAL(scene->stages[2].duration, 2);
    ck_assert_uint_eq(scene->particles.count, 9 + 4);
    EQUAL(scene->models[0].dt, 1e-5);
    EQUAL(scene->models[0].heat_dt, 0.002);
    EQUAL(at_time(&scene->stages[0].gravity[1], 0), -1.6);
    ck_assert_str_eq(scene->title, "Moon");
    const struct calx_model *linear = find_model(&scene->models[0], CALX_CONTACT, "linear");
    EQUAL(find_value(linear->values, linear->value_count, "stiffness", -1, -1)->value, 7);
    ck_assert_str_eq(scene->expects[3].source, "set");
}
END_TEST

static const struct {
    struct calx_setting setting;
    const char *words[2];
} bad_settings[] = {
    {{"", "1"}, {"--set", "element/attribute"}},
    {{"stage[tur]/for", "1"}, {"stage[turn]", "stage[settle]"}},
    {{"stage/for", "1"}, {"3 elements", "choose one"}},
    {{"stage[4]/for", "1"}, {"stage[4]", "stage[turn]"}},
    {{"stge/for", "1"}, {"'stge'", "stage[turn]"}},
    {{"stage[turn", "1"}, {"--set", "element/attribute"}},
    {{"stage[turn]", "1"}, {"element", "attribute"}},
    {{"integrator", "1"}, {"integrator", "attribute"}},
    {{"stage[turn]/fro", "1"}, {"'fro'", "nearest is 'for'"}},
    {{"stage[turn]/for", "1 kg"}, {"'kg'", "'s'"}},
    {{"particles/pack/count", "many"}, {"count", "whole number"}},
    {{"contact[linear]/stifness", "1"}, {"'stifness'", "stiffness"}},
};

START_TEST(test_bad_settings)
{
    read_everything(&bad_settings[_i].setting, 1);
    ck_assert_ptr_null(scene);
    ck_assert_uint_eq(problems.count, 1);
    for (int k = 0; k < 2; k++)
        ck_assert_ptr_nonnull(strstr(problems.list[0].text, bad_settings[_i].words[k]));
}
END_TEST

/* ---- grammar and reference
 * ------------------------------------------------------------------------------ */

static xmlRelaxNGValidCtxt *open_grammar(xmlRelaxNG **grammar)
{
    FILE *file = fopen(in_folder("calx.rng"), "w");
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(calx_schema_write(file, registry), CALX_OK);
    fclose(file);
    xmlRelaxNGParserCtxt *parser = xmlRelaxNGNewParserCtxt(in_folder("calx.rng"));
    *grammar = xmlRelaxNGParse(parser);
    xmlRelaxNGFreeParserCtxt(parser);
    ck_assert_ptr_nonnull(*grammar);
    return xmlRelaxNGNewValidCtxt(*grammar);
}

static int validate(xmlRelaxNGValidCtxt *grammar, const char *path)
{
    xmlDoc *document = xmlReadFile(path, NULL, XML_PARSE_NONET);
    ck_assert_msg(document != NULL, "%s", path);
    int result = xmlRelaxNGValidateDoc(grammar, document);
    xmlFreeDoc(document);
    return result;
}

static int validate_cases(xmlRelaxNGValidCtxt *grammar)
{
    char path[1024];
    int count = 0;
    DIR *cases = opendir(source_path("cases"));
    ck_assert_ptr_nonnull(cases);
    for (struct dirent *entry; (entry = readdir(cases));) {
        snprintf(path, sizeof path, "%s/%s/case.xml", source_path("cases"), entry->d_name);
        if (access(path, R_OK) != 0)
            continue;
        ck_assert_msg(validate(grammar, path) == 0, "%s does not fit the grammar", path);
        count++;
    }
    closedir(cases);
    return count;
}

START_TEST(test_grammar)
{
    xmlRelaxNG *schema;
    xmlRelaxNGValidCtxt *grammar = open_grammar(&schema);
    put_file("bad.xml", "<case><stage fro='1 s'/></case>");
    ck_assert_int_ne(validate(grammar, in_folder("bad.xml")), 0);
    ck_assert_int_eq(validate(grammar, source_path("tests/data/cases/everything.xml")), 0);
    ck_assert_int_gt(validate_cases(grammar), 0);
    xmlRelaxNGFreeValidCtxt(grammar);
    xmlRelaxNGFree(schema);
}
END_TEST

/* cases/FORMAT.md is what `calx schema --reference` prints. */
START_TEST(test_reference)
{
    static char want[1 << 17], got[1 << 17];
    FILE *file = tmpfile(), *committed = fopen(source_path("cases/FORMAT.md"), "r");
    ck_assert(file && committed);
    ck_assert_int_eq(calx_schema_write_reference(file), CALX_OK);
    rewind(file);
    want[fread(want, 1, sizeof want - 1, file)] = '\0';
    got[fread(got, 1, sizeof got - 1, committed)] = '\0';
    fclose(file);
    fclose(committed);
    ck_assert_uint_gt(strlen(want), 1000);
    ck_assert_msg(strcmp(got, want) == 0,
                  "cases/FORMAT.md is not up to date: calx schema --reference > cases/FORMAT.md");
}
END_TEST

/* The example of the reference is a case. */
START_TEST(test_example_of_the_reference)
{
    static char text[1 << 17];
    FILE *file = fopen(source_path("cases/FORMAT.md"), "r");
    ck_assert_ptr_nonnull(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    char *begin = strstr(text, "<case"), *end = strstr(text, "</case>");
    ck_assert(begin && end);
    end[strlen("</case>")] = '\0';
    put_file("example.xml", begin);
    scene = calx_case_read(in_folder("example.xml"), registry, NULL, 0, &problems);
    calx_problems_print(&problems, stderr);
    ck_assert_ptr_nonnull(scene);
    ck_assert_uint_eq(scene->expect_count, 1);
}
END_TEST

static void add_tests(TCase *cases)
{
    tcase_add_loop_test(cases, test_bad_settings, 0, COUNT(bad_settings));
    tcase_add_test(cases, test_settings);
    tcase_add_test(cases, test_surroundings);
    tcase_add_test(cases, test_materials_and_models);
    tcase_add_test(cases, test_walls);
    tcase_add_test(cases, test_particles);
    tcase_add_test(cases, test_stages);
    tcase_add_test(cases, test_results);
    tcase_add_test(cases, test_profiles);
    tcase_add_test(cases, test_plates_and_slabs);
    tcase_add_test(cases, test_grammar);
    tcase_add_test(cases, test_reference);
    tcase_add_test(cases, test_example_of_the_reference);
}

int main(void)
{
    return run_suite("case", add_tests);
}
