/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx check`: says what a run would compute, leave out, cost and write, without running it.
 * Input: a case. Output: the plan in plain words, run time and memory, files to come.
 * Method: a fraction of a second of steps is made to measure the speed; the state is then thrown
 * away.
 */
#include <math.h>
#include <stdio.h>

#include "io/commands.h"
#include "io/run.h"

static const double trial = 0.3; /* s of steps */

/* Steps per second of the case as it begins; 0 if it ended at once. A step that fails is reported,
 * not hidden. */
static int measure_speed(struct calx_run *run, double *speed, struct calx_error *error)
{
    double begin = calx_terminal_clock(), now = begin;
    int64_t steps = 0;
    while (!calx_sim_done(run->sim) && now - begin < trial) {
        CALX_TRY(calx_sim_step(run->sim, error));
        ++steps;
        now = calx_terminal_clock();
    }
    *speed = now > begin ? (double)steps / (now - begin) : 0;
    return CALX_OK;
}

static void print_cost(const struct calx_run *run, double speed)
{
    char text[3][32];
    double end = calx_sim_end(run->sim), steps = end / calx_sim_dt(run->sim);
    double n = (double)calx_sim_particle_count(run->sim);
    printf(
        "\nCost\n  memory of the state: %s bytes\n",
        calx_terminal_number((double)calx_sim_features(run->sim).bytes, text[0], sizeof text[0]));
    printf("  speed as the case begins: %s steps/s, %s particle-steps/s\n",
           calx_terminal_number(speed, text[0], sizeof text[0]),
           calx_terminal_number(speed * n, text[1], sizeof text[1]));
    if (isfinite(end) && speed > 0)
        printf("  run time: about %s for %s steps%s\n",
               calx_terminal_duration(steps / speed, text[0], sizeof text[0]),
               calx_terminal_number(steps, text[1], sizeof text[1]), " at most");
    else if (speed > 0)
        printf(
            "  run time: unknown, a condition ends it; %s per simulated second\n",
            calx_terminal_duration(1 / (speed * calx_sim_dt(run->sim)), text[0], sizeof text[0]));
}

/* Frames of all stages at most; infinite if a stage has no latest end. */
static double count_frames(const struct calx_scene *scene)
{
    double frames = 1;
    for (size_t i = 0; i < scene->stage_count; ++i) {
        const struct calx_stage_spec *stage = &scene->stages[i];
        frames += 1 + (stage->output_every > 0 ? floor(stage->duration / stage->output_every) : 0);
    }
    return frames;
}

/* Groups of particles are walls without any. */
static bool has_surfaces(const struct calx_scene *scene)
{
    bool has = false;
    for (size_t w = 0; w < scene->wall_count; w++)
        has |= scene->walls[w].primitive_count > 0;
    return has;
}

static void print_output(const struct calx_run *run)
{
    char text[32];
    double frames = count_frames(run->scene);
    printf("\nOutput\n  in %s: ", run->folder);
    if (isfinite(frames))
        printf("at most %s frames\n", calx_terminal_number(frames, text, sizeof text));
    else
        printf("as many frames as the condition allows\n");
    printf("  %s.pvd  particles\n", run->name);
    if (has_surfaces(run->scene))
        printf("  %s_walls.pvd  walls\n", run->name);
    if (run->scene->output.network)
        printf("  %s_contacts.pvd  contact network\n", run->name);
    printf("  %s.csv  %zu columns\n  %s.restart  restart point\n", run->name, run->column_count,
           run->name);
    printf("  expectations judged: %zu\n", calx_verify_count(run->verify));
}

static int check_opened(struct calx_run *run, struct calx_error *error)
{
    double speed;
    calx_sim_describe(run->sim, stdout);
    CALX_TRY(measure_speed(run, &speed, error));
    print_cost(run, speed);
    print_output(run);
    return CALX_OK;
}

static int check_case(const struct calx_arguments *a)
{
    const struct calx_run_options options = {
        .case_path = a->operands[0],
        .threads = a->threads,
        .force = a->force,
        .settings = a->settings,
        .setting_count = a->setting_count,
    };
    struct calx_run run;
    struct calx_error error;
    int code = calx_run_open(&run, &options, stderr, &error);
    if (code == CALX_OK)
        code = check_opened(&run, &error);
    int status = code == CALX_OK ? 0 : calx_options_report(&error);
    calx_run_close(&run);
    return status;
}

#define OPTIONS 3
static const struct calx_option *const used[OPTIONS] = {&calx_option_set, &calx_option_threads,
                                                     &calx_option_force};

const struct calx_command calx_command_check = {
    "check",
    "CASE [options]",
    "say what a run would compute, leave out and cost",
    "Reads the case, reports its mistakes all at once, prints the plan, and makes steps for 0.3 s "
    "to measure the speed.\n\n"
    "examples:\n"
    "  calx check cases/06-smooth-drum\n"
    "  calx check case.xml --set integrator/dt=1e-5\n",
    OPTIONS,
    used,
    1,
    1,
    check_case,
};
