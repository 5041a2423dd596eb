/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The tables of the case file: every element, its attributes with form, unit, default and range,
 * its children. To add an attribute: add a row here and read it in the io/case_*.c of its element;
 * grammar and reference follow.
 */
#include "io/element_tables.h"

#include "core/scene.h"

/* ---- materials and models
 * ------------------------------------------------------------------------------ */

static const struct calx_attribute material_attributes[] = {
    {"name", NAME, NULL, NULL, NULL, NEEDED, "by which particles and walls refer to it"},
    {"density", QUANTITY, "kg/m3", NULL, NULL, POSITIVE,
     "needed for particles that move or change temperature"},
    {"specific-heat", QUANTITY, "J/(kg K)", NULL, NULL, POSITIVE,
     "needed for particles that change temperature"},
    {"conductivity", QUANTITY, "W/(m K)", NULL, NULL, NOT_NEGATIVE, "thermal conductivity"},
    {"young", QUANTITY, "Pa", NULL, NULL, POSITIVE, "Young's modulus"},
    {"poisson", QUANTITY, "1", NULL, NULL, -1, 0.5, CALX_ATTRIBUTE_OPEN_MIN, "Poisson's ratio"},
};
static const struct calx_element material = {
    "material", "material",
    "What particles and walls are made of. Further attributes are the parameters of scope material "
    "of the plugins that the case names.",
    ATTRIBUTES(material_attributes), .parameters = CALX_TAKES_MATERIAL};

static const struct calx_attribute pair_attributes[] = {
    {"of", TEXT, NULL, NULL, NULL, NEEDED,
     "the names of two materials, or of one for contacts with itself"},
};
static const struct calx_element pair = {"pair", "pair",
                                         "Parameters of the model for contacts between two "
                                         "materials, instead of those of the model's element.",
                                         ATTRIBUTES(pair_attributes),
                                         .parameters = CALX_TAKES_PAIR};
static const struct calx_child model_children[] = {{&pair, '*'}};

static const struct calx_attribute contact_attributes[] = {
    {"plugin", NAME, NULL, NULL, NULL, NEEDED, "name of a contact law; `calx plugins` lists them"},
    {"lever", WORD, NULL, "middle|full", "middle", NO_RANGE,
     "where forces act: in the middle of the overlap, or at full radius to reproduce codes that do "
     "so"},
};
static const struct calx_element contact = {
    "contact",
    "contact",
    "A law of contact forces. Several act together; their order does not matter. Further "
    "attributes are the plugin's parameters. "
    "Inside a stage, the contact elements there replace all contact laws from then on.",
    ATTRIBUTES(contact_attributes),
    CHILDREN(model_children),
    CALX_TAKES_RUN_AND_PAIR};

static const struct calx_attribute conductance_attributes[] = {
    {"plugin", NAME, NULL, NULL, NULL, NEEDED, "name of a conductance; `calx plugins` lists them"},
};
static const struct calx_element conductance = {
    "conductance",
    "conductance",
    "How heat flows through contacts. Without it and without heat from dissipation there is no "
    "temperature. If no integrator of temperature is "
    "named, heat-euler is taken. Further attributes are the plugin's parameters.",
    ATTRIBUTES(conductance_attributes),
    CHILDREN(model_children),
    CALX_TAKES_RUN_AND_PAIR};

static const struct calx_attribute integrator_attributes[] = {
    {"plugin", NAME, NULL, NULL, NULL, NEEDED, "name of an integrator; `calx plugins` lists them"},
    {"of", WORD, NULL, "motion|temperature", "motion", NO_RANGE, "what it advances in time"},
    {"dt", CALX_FORM_AUTO, "s", NULL, "auto", POSITIVE,
     "time step; auto: a share of the critical step, shorter while the contacts ask for it"},
    {"dt-fraction", QUANTITY, "1", NULL, "0.1", 0, 1, CALX_ATTRIBUTE_OPEN_MIN,
     "share of the critical step, when dt is auto"},
    {"safety", QUANTITY, "1", NULL, "0.5", 0, 1, CALX_ATTRIBUTE_OPEN_MIN,
     "share of the stability limit of all contacts there are that the step keeps to, when dt is "
     "auto"},
    {"force", SWITCH, NULL, NULL, "no", NO_RANGE,
     "yes: of motion, run with a step that is too long to be stable or to resolve contacts"},
};
static const struct calx_element integrator = {
    "integrator", "integrator",
    "How motion or temperature advance in time. Without an integrator of motion bodies do not "
    "move. Further attributes are the plugin's parameters.",
    ATTRIBUTES(integrator_attributes), .parameters = CALX_TAKES_RUN_AND_PAIR};

/* ---- surroundings
 * -------------------------------------------------------------------------------------- */

static const struct calx_attribute gravity_attributes[] = {
    {"", VARYING_VECTOR, "m/s2", "t", NULL, ANY, "the acceleration, instead of x, y, z"},
    {"x", VARIES, "m/s2", "t", "0", ANY, "component"},
    {"y", VARIES, "m/s2", "t", "0", ANY, "component"},
    {"z", VARIES, "m/s2", "t", "0", ANY, "component, in 3D"},
    {"where", TEXT, NULL, NULL, NULL, NO_RANGE,
     "constants for the expressions: \"a = 1; b = 2*a\""},
};
static const struct calx_element gravity = {
    "gravity", "gravity",
    "Acceleration of all bodies, as text (`0 -9.81 m/s2`) or by component. None if not given.",
    ATTRIBUTES(gravity_attributes)};

static const struct calx_attribute domain_attributes[] = {
    {"low", VECTOR, "m", NULL, NULL, A_PLACE, "lower corner; given together with high"},
    {"high", VECTOR, "m", NULL, NULL, A_PLACE, "upper corner"},
    {"x", CALX_FORM_LIST, "m", NULL, NULL, A_PLACE, "extent along x alone: two numbers"},
    {"y", CALX_FORM_LIST, "m", NULL, NULL, A_PLACE, "extent along y alone: two numbers"},
    {"z", CALX_FORM_LIST, "m", NULL, NULL, A_PLACE, "extent along z alone: two numbers"},
    {"periodic", WORDS, NULL, "x|y|z", NULL, NO_RANGE,
     "axes along which the domain repeats; they need an extent"},
};
static const struct calx_element domain = {
    "domain", "domain",
    "Extent of space. A body that leaves it where it is not periodic is an error.",
    ATTRIBUTES(domain_attributes)};

static const struct calx_attribute heat_attributes[] = {
    {"from-dissipation", QUANTITY, "1", NULL, "1", 0, 1, 0,
     "share of the dissipated work that becomes heat"},
    {"split", WORD, NULL, "equal|effusivity", "equal", NO_RANGE, "how two bodies share it"},
};
static const struct calx_element heat = {
    "heat", "heat", "Heat from friction and damping. Without this element dissipated work is lost.",
    ATTRIBUTES(heat_attributes)};

static const struct calx_attribute numerics_attributes[] = {
    {"skin", CALX_FORM_AUTO, "m", NULL, "auto", POSITIVE,
     "reach of the neighbour list beyond touch"},
    {"seed", WHOLE, NULL, NULL, "1", NO_RANGE, "of random numbers, where particles name no seed"},
};
static const struct calx_element numerics = {"numerics", "numerics",
                                             "Settings that change how, not what, is computed.",
                                             ATTRIBUTES(numerics_attributes)};

/* ---- stages
 * -------------------------------------------------------------------------------------------- */

static const struct calx_attribute move_attributes[] = {
    {"walls", TEXT, NULL, NULL, NULL, NEEDED, "names of walls and of rigid groups"},
    {"rotate", VARIES, "rad/s", "t", "0", ANY,
     "angular velocity, as in \"10 rpm\"; counter-clockwise in 2D"},
    {"about", VECTOR, "m", NULL, "0 0 0", A_PLACE, "a point on the axis of rotation"},
    {"axis", VECTOR, "1", NULL, NULL, ANY, "direction of the axis of rotation; needed in 3D"},
    {"velocity", VARYING_VECTOR, "m/s", "t", NULL, ANY,
     "each component may be an expression of t, the time of the run"},
    {"amplitude", VECTOR, "m", NULL, NULL, A_PLACE,
     "of an oscillation about the place where the stage begins"},
    {"frequency", QUANTITY, "1/s", NULL, NULL, NOT_NEGATIVE, "of the oscillation"},
    {"phase", QUANTITY, "rad", NULL, "0", ANY, "of the oscillation when the stage begins"},
    {"displacement", VARYING_VECTOR, "m", "t", NULL, ANY,
     "as expressions of t; counted from its value when the stage begins"},
    {"free", WORD, NULL, "x|y|z", NULL, NO_RANGE,
     "a loaded plate: along this axis each of the walls moves as a body, by contacts, load and gravity; the other parts of the motion "
     "then have nothing along it, and the walls do not rotate"},
    {"mass", QUANTITY, "kg", NULL, NULL, POSITIVE, "of a plate; needed with free"},
    {"load", VARIES, "N", "t", "0", ANY, "force on a plate along its free axis"},
    {"damping", QUANTITY, "N s/m", NULL, "0", NOT_NEGATIVE, "of a plate's speed along its free axis"},
    {"where", TEXT, NULL, NULL, NULL, NO_RANGE,
     "constants for the expressions: \"a = 1; b = 2*a\""},
};
static const struct calx_element move = {
    "move", "move",
    "Motion of walls during this stage and the next ones, until another move of the same walls. "
    "The parts add up; `velocity=\"0 0\"` stops. A wall that becomes free starts with the speed that it has.",
    ATTRIBUTES(move_attributes)};

static const struct calx_attribute stage_walls_attributes[] = {
    {"name", NAME, NULL, NULL, NULL, NEEDED, "of walls that have a temperature, or an isothermal group"},
    {"temperature", VARIES, "K", "txyz", NULL, 0, INFINITY, REQUIRED, "from this stage on"},
};
static const struct calx_element stage_walls = {
    "walls", "stage-walls", "A new temperature of walls.", ATTRIBUTES(stage_walls_attributes)};

static const struct calx_attribute stage_output_attributes[] = {
    {"every", QUANTITY, "s", NULL, NULL, 0, INFINITY, REQUIRED | CALX_ATTRIBUTE_OPEN_MIN,
     "time between frames from this stage on"},
};
static const struct calx_element stage_output = {
    "output", "stage-output", "A new interval of output.", ATTRIBUTES(stage_output_attributes)};

static const struct calx_attribute stage_attributes[] = {
    {"name", NAME, NULL, NULL, NULL, NO_RANGE,
     "by which expectations and --set refer to it; its number from 1 if not given"},
    {"for", QUANTITY, "s", NULL, NULL, POSITIVE, "its length"},
    {"until", CALX_FORM_CONDITION, "s", NULL, NULL, POSITIVE,
     "its end: a time of the run, or a condition as in \"kinetic-energy &lt; 1e-9 J\" (in XML, `<` "
     "is written `&lt;`)"},
    {"hold", QUANTITY, "s", NULL, "0", NOT_NEGATIVE,
     "how long the condition must hold without a break: a bouncing bed has moments of little "
     "energy"},
    {"at-most", QUANTITY, "s", NULL, NULL, POSITIVE,
     "its length if the condition does not come true before"},
};
static const struct calx_child stage_children[] = {
    {&move, '*'},       {&gravity, '?'},     {&contact, '*'},     {&conductance, '?'},
    {&integrator, '*'}, {&stage_walls, '*'}, {&stage_output, '?'}};
static const struct calx_element stage = {
    "stage", "stage",
    "A stretch of time. Stages follow each other; what a stage does not change stays as it was.",
    ATTRIBUTES(stage_attributes), CHILDREN(stage_children)};

/* ---- results
 * ------------------------------------------------------------------------------------------- */

static const struct calx_attribute output_attributes[] = {
    {"every", QUANTITY, "s", NULL, NULL, POSITIVE,
     "time between frames; only start and end of each stage if not given"},
    {"fields", WORDS, NULL, "velocity|spin|temperature|material|contacts|force|mass|heat|group|all",
     "velocity spin temperature material contacts group", NO_RANGE,
     "of particles, besides id and radius; those that the scene does not have are left out"},
    {"network", SWITCH, NULL, NULL, "no", NO_RANGE, "write the contacts too"},
    {"precision", WORD, NULL, "double|single", "double", NO_RANGE, "of numbers in the files"},
    {"compression", WHOLE, NULL, NULL, "6", 0, 9, 0, "0 (none, fastest) to 9 (smallest files)"},
    {"csv-every", QUANTITY, "s", NULL, NULL, POSITIVE,
     "time between lines of the CSV; as frames if not given"},
};
static const struct calx_element output = {"output", "output", "What is written, and when.",
                                           ATTRIBUTES(output_attributes)};

static const struct calx_attribute probe_attributes[] = {
    {"name", NAME, NULL, NULL, NULL, NEEDED, "of the column"},
    {"of", NAME, NULL, NULL, NULL, NEEDED, "a quantity of the list below"},
    {"particle", WHOLE, NULL, NULL, NULL, NO_RANGE, "id of one particle"},
    {"material", NAME, NULL, NULL, NULL, NO_RANGE, "only particles of this material"},
    {"wall", NAME, NULL, NULL, NULL, NO_RANGE, "name of the walls or of a rigid group, for quantities of walls"},
    {"profile", NAME, NULL, NULL, NULL, NO_RANGE, "name of a profile, for quantities of layers"},
    {"layer", WHOLE, NULL, NULL, NULL, 1, 100000, 0, "of that profile, from 1, the lowest"},
    {"component", WORD, NULL, "x|y|z|magnitude", NULL, NO_RANGE, "of a vector"},
    {"reduce", WORD, NULL, "mean|min|max|sum|std", NULL, NO_RANGE,
     "how many particles give one number"},
    {"classes", TEXT, NULL, NULL, NULL, NO_RANGE,
     "for a mixing index: what divides the grains into two kinds"},
    {"cell", QUANTITY, "m", NULL, NULL, POSITIVE,
     "for a mixing index: size of the cells in which grains are counted"},
    {"since", NAME, NULL, NULL, NULL, NO_RANGE,
     "for a mixing index: the stage at whose start the grains are divided; the first if not given"},
};
static const struct calx_element probe = {"probe", "probe", "A column of the CSV.",
                                          ATTRIBUTES(probe_attributes)};

static const struct calx_attribute profile_attributes[] = {
    {"name", NAME, NULL, NULL, NULL, NEEDED, "of its files, NAME_profile_name"},
    {"axis", WORD, NULL, "x|y|z", NULL, NEEDED, "across which the layers lie"},
    {"layers", WHOLE, NULL, NULL, NULL, 1, 100000, REQUIRED, "how many, of equal thickness"},
    {"from", QUANTITY, "m", NULL, NULL, A_PLACE, "where the first begins; the end of the domain if not given"},
    {"to", QUANTITY, "m", NULL, NULL, A_PLACE, "where the last ends; the end of the domain if not given"},
    {"across", CALX_FORM_LIST, "m", NULL, NULL, POSITIVE,
     "extent of a layer along the other axes, in their order; that of the domain if not given"},
    {"over", QUANTITY, "s", NULL, NULL, 0, INFINITY, REQUIRED | CALX_ATTRIBUTE_OPEN_MIN,
     "length of a window: each gives one profile"},
    {"every", QUANTITY, "s", NULL, NULL, POSITIVE,
     "time between the samples that a window averages; a hundredth of it if not given"},
    {"after", QUANTITY, "s", NULL, "0", NOT_NEGATIVE, "when the first window begins"},
    {"groups", SWITCH, NULL, NULL, "no", NO_RANGE, "yes: the bodies of rigid groups count too"},
};
static const struct calx_element profile = {
    "profile", "profile",
    "Layers across an axis and, in each, means over windows of time: solid fraction, velocity and its fluctuation, temperature, "
    "coordination number, stress of contacts and of fluctuations. A body counts in each layer with the volume of its slice there, the force "
    "of a contact with the part of the line between the centres that runs there. In 2D a layer is as deep as discs are long, or as the "
    "largest sphere is thick.",
    ATTRIBUTES(profile_attributes)};

static const struct calx_attribute steady_attributes[] = {
    {"name", NAME, NULL, NULL, NULL, NEEDED, "of its columns of the CSV, NAME_drift and NAME_since"},
    {"of", NAME, NULL, NULL, NULL, NEEDED,
     "a probe, a column of the CSV, a quantity of the whole scene, or with `profile` a quantity of layers"},
    {"profile", NAME, NULL, NULL, NULL, NO_RANGE, "name of a profile: each of its layers is watched, and the worst counts"},
    {"component", WORD, NULL, "x|y|z", NULL, NO_RANGE, "of a vector, with profile"},
    {"over", QUANTITY, "s", NULL, NULL, 0, INFINITY, REQUIRED | CALX_ATTRIBUTE_OPEN_MIN,
     "length of a block: longer than the signal remembers, and no shorter than the profile's window"},
    {"every", QUANTITY, "s", NULL, NULL, POSITIVE, "time between the samples that a block averages; a twentieth of it if not given"},
    {"after", QUANTITY, "s", NULL, "0", NOT_NEGATIVE, "when the first block begins"},
    {"blocks", WHOLE, NULL, NULL, "10", 4, CALX_STEADY_MOST, 0, "of the window that is looked at: an even number"},
    {"within", QUANTITY, NULL, NULL, NULL, 0, INFINITY, REQUIRED | CALX_ATTRIBUTE_OPEN_MIN | CALX_ATTRIBUTE_DIFFERENCE,
     "the change that counts as none, in the unit of the quantity"},
};
static const struct calx_element steady = {
    "steady", "steady",
    "Says when a quantity has become stationary. A window of the last blocks slides along; the difference of the means of its halves, with "
    "the 95 % confidence interval of Student's t over its block means, must be within the given change. What is too noisy to say is not called "
    "steady. Two columns of the CSV, NAME_drift (at most 1: steady) and NAME_since, and a line at the end of the run say so.",
    ATTRIBUTES(steady_attributes)};

static const struct calx_attribute expect_attributes[] = {
    {"of", NAME, NULL, NULL, NULL, NO_RANGE,
     "a probe, a column of the CSV or a quantity of the whole scene"},
    {"refusal", TEXT, NULL, NULL, NULL, NO_RANGE,
     "instead of `of`: the case must be refused, or its run must stop, with a message that has "
     "this text in it"},
    {"at", TEXT, NULL, NULL, NULL, NO_RANGE, "`end` (the default) or a time"},
    {"always", RESULT, NULL, "t", NULL, NO_RANGE,
     "the value at every line of the CSV, or yes with above or below"},
    {"min", RESULT, NULL, "t", NULL, NO_RANGE, "the least value, or yes with above or below"},
    {"max", RESULT, NULL, "t", NULL, NO_RANGE, "the largest value, or yes with above or below"},
    {"change", RESULT, NULL, "t", NULL, NO_RANGE,
     "the last value minus the first, or yes with above or below"},
    {"value", VARIES, NULL, "t", NULL, ANY, "the value, a number or an expression of t"},
    {"above", QUANTITY, NULL, NULL, NULL, ANY, "a lower bound"},
    {"below", QUANTITY, NULL, NULL, NULL, ANY, "an upper bound"},
    {"rtol", QUANTITY, "1", NULL, "0", NOT_NEGATIVE,
     "tolerance relative to the value; of a change, to the larger of the first and the last value"},
    {"atol", QUANTITY, NULL, NULL, "0", 0, INFINITY, CALX_ATTRIBUTE_DIFFERENCE,
     "tolerance in the unit of the quantity"},
    {"where", TEXT, NULL, NULL, NULL, NO_RANGE,
     "constants for the expressions: \"a = 1; b = 2*a\""},
    {"stage", NAME, NULL, NULL, NULL, NO_RANGE, "only during this stage, or at its end"},
    {"source", TEXT, NULL, NULL, NULL, NO_RANGE, "where the value comes from"},
};
static const struct calx_element expect = {"expect", "expect",
                                           "What must come out; `calx verify` compares. Tolerances "
                                           "add up: |got - value| <= rtol |value| + atol.",
                                           ATTRIBUTES(expect_attributes)};

static const struct calx_attribute exact_attributes[] = {
    {"of", NAME, NULL, NULL, NULL, NEEDED,
     "a probe, a column of the CSV or a quantity of the whole scene"},
    {"value", VARIES, NULL, "t", NULL, -INFINITY, INFINITY, REQUIRED,
     "the solution, a number or an expression of t"},
    {"from", QUANTITY, "s", NULL, "0", NOT_NEGATIVE,
     "the solution holds from this time on, as after a collision"},
    {"rtol", QUANTITY, "1", NULL, NULL, NOT_NEGATIVE,
     "with rtol or atol it is an expectation too: at every line of the CSV, or at the end if "
     "`from` is given"},
    {"atol", QUANTITY, NULL, NULL, NULL, 0, INFINITY, CALX_ATTRIBUTE_DIFFERENCE,
     "tolerance in the unit of the quantity"},
    {"where", TEXT, NULL, NULL, NULL, NO_RANGE,
     "constants for the expression: \"a = 1; b = 2*a\""},
    {"source", TEXT, NULL, NULL, NULL, NO_RANGE, "where the solution comes from"},
};
static const struct calx_element exact = {
    "exact", "exact",
    "A solution that is known. `calx report` measures the error of every integrator and time step "
    "against it.",
    ATTRIBUTES(exact_attributes)};

/* ---- the whole
 * ----------------------------------------------------------------------------------------- */

static const struct calx_attribute case_attributes[] = {
    {"title", TEXT, NULL, NULL, "", NO_RANGE, "one line"},
    {"dimension", WORD, NULL, "2|3", "3", NO_RANGE, "of space"},
    {"bodies", WORD, NULL, "spheres|discs", "spheres", NO_RANGE,
     "in 2D: spheres whose centres stay in the plane, or discs"},
    {"thickness", QUANTITY, "m", NULL, NULL, POSITIVE, "length of discs; 1 m if not given"},
};
static const struct calx_child case_children[] = {{&material, '+'},
                                                  {&contact, '*'},
                                                  {&conductance, '?'},
                                                  {&integrator, '*'},
                                                  {&gravity, '?'},
                                                  {&domain, '?'},
                                                  {&heat, '?'},
                                                  {&numerics, '?'},
                                                  {&calx_element_particles, '+'},
                                                  {&calx_element_walls, '*'},
                                                  {&stage, '+'},
                                                  {&output, '?'},
                                                  {&probe, '*'},
                                                  {&profile, '*'},
                                                  {&steady, '*'},
                                                  {&expect, '*'},
                                                  {&exact, '*'}};
static const struct calx_element case_element = {
    "case", "case",
    "The whole case. The order of the elements inside does not matter, except among stages and "
    "among particles.",
    ATTRIBUTES(case_attributes), CHILDREN(case_children)};

const struct calx_element *calx_elements_root(void)
{
    return &case_element;
}
