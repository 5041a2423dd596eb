/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The tables of particles and walls, with all elements inside them.
 */
#include "io/element_tables.h"

/* ---- particles
 * ----------------------------------------------------------------------------------------- */

#define TEMPERATURE_DOC "start temperature: a number or an expression of x, y, z"
#define VELOCITY_ROW                                                                               \
    {                                                                                              \
        "velocity", CALX_FORM_RANDOM_VECTOR, "m/s", NULL, NULL, ANY,                               \
            "start velocity, or \"random 0.1 m/s\": each component uniform between minus and "     \
            "plus that"                                                                            \
    }
#define SPIN_ROW                                                                                   \
    {                                                                                              \
        "spin", CALX_FORM_RANDOM_VECTOR, "rad/s", NULL, NULL, ANY,                                 \
            "start spin (in 2D one number, about z), or \"random 5 rad/s\""                        \
    }
#define FIXED_ROW                                                                                  \
    {                                                                                              \
        "fixed", SWITCH, NULL, NULL, NULL, NO_RANGE,                                               \
            "yes: held in place, but it has contacts and temperature"                              \
    }
#define TEMPERATURE_ROW                                                                            \
    {                                                                                              \
        "temperature", VARIES, "K", "xyz", NULL, 0, INFINITY, 0, TEMPERATURE_DOC                   \
    }
#define MATERIAL_ROW                                                                               \
    {                                                                                              \
        "material", NAME, NULL, NULL, NULL, NO_RANGE, "name of a material"                         \
    }
#define COMMON_ROWS MATERIAL_ROW, TEMPERATURE_ROW, VELOCITY_ROW, SPIN_ROW, FIXED_ROW
#define RADIUS_ROW                                                                                 \
    {                                                                                              \
        "radius", QUANTITY, "m", NULL, NULL, A_RADIUS, "radius"                                    \
    }

#define SEED_ROW                                                                                   \
    {                                                                                              \
        "seed", WHOLE, NULL, NULL, NULL, NO_RANGE,                                                 \
            "of random numbers; that of particles if not given"                                    \
    }
#define SIZES_ROW                                                                                  \
    {                                                                                              \
        "radius", CALX_FORM_SIZES, "m", NULL, NULL, A_RADIUS,                                      \
            "`2 mm`, `uniform 1 mm 2 mm` (least, largest), `normal 2 mm 0.1 mm 1 mm 3 mm` (mean, " \
            "standard deviation, then, if wanted, least and largest), `lognormal` likewise, "      \
            "`masses 2 mm 0.3 4 mm 0.7` (diameters and their shares of the mass), `numbers` "      \
            "likewise (shares of the number)"                                                      \
    }

static const struct calx_attribute particle_attributes[] = {
    {"at", VECTOR, "m", NULL, NULL, A_NEEDED_PLACE, "centre"}, RADIUS_ROW, COMMON_ROWS};
static const struct calx_element particle = {"particle", "particle", "One body.",
                                             ATTRIBUTES(particle_attributes)};

static const struct calx_attribute csv_attributes[] = {
    {"file", FILE_PATH, NULL, NULL, NULL, 0, 0, REQUIRED | CALX_ATTRIBUTE_EXISTS,
     "numbers separated by commas, semicolons or blanks; the first line names the columns: x y z "
     "radius vx vy vz wx wy wz temperature fixed"},
    {"columns", TEXT, NULL, NULL, NULL, NO_RANGE,
     "names of the columns, if the file has no such line"},
    {"scale", QUANTITY, "1", NULL, "1", POSITIVE, "metres per unit of the lengths x, y, z, radius"},
    RADIUS_ROW,
    COMMON_ROWS};
static const struct calx_element csv = {"csv", "csv", "Bodies from a table in a file, in SI units.",
                                        ATTRIBUTES(csv_attributes)};

static const struct calx_attribute grid_attributes[] = {
    {"from", VECTOR, "m", NULL, NULL, A_NEEDED_PLACE, "centre of the first body"},
    {"to", VECTOR, "m", NULL, NULL, A_PLACE, "no centre lies beyond this corner; instead of count"},
    {"count", CALX_FORM_WHOLES, NULL, NULL, NULL, 1, INFINITY, 0,
     "bodies along each axis: \"10 5\""},
    {"spacing", CALX_FORM_LIST, "m", NULL, NULL, POSITIVE,
     "distance of centres, one number or one per axis; twice the largest radius if not given"},
    {"fill", QUANTITY, "1", NULL, NULL, 0, 1, CALX_ATTRIBUTE_OPEN_MIN,
     "solid fraction of the grid's area (in 3D volume): as many of its first places are taken; all "
     "if not given"},
    SEED_ROW,
    SIZES_ROW,
    COMMON_ROWS};
static const struct calx_element grid = {"grid", "grid", "Bodies on a rectangular grid, x fastest.",
                                         ATTRIBUTES(grid_attributes)};

#define ALONG_ROWS                                                                                 \
    {"count", WHOLE, NULL, NULL, NULL, 1, INFINITY, 0, "number of bodies"},                        \
    {                                                                                              \
        "spacing", QUANTITY, "m", NULL, NULL, POSITIVE,                                            \
            "centres of neighbours are no farther apart, instead of count; with neither, twice "   \
            "the "                                                                                 \
            "radius"                                                                               \
    }

static const struct calx_attribute row_attributes[] = {
    {"from", VECTOR, "m", NULL, NULL, A_NEEDED_PLACE, "centre of the first body"},
    {"to", VECTOR, "m", NULL, NULL, A_NEEDED_PLACE, "centre of the last body"},
    ALONG_ROWS,
    RADIUS_ROW,
    COMMON_ROWS};
static const struct calx_element row = {
    "row", "row", "Bodies on a straight line, at equal distances.", ATTRIBUTES(row_attributes)};

static const struct calx_attribute ring_attributes[] = {
    {"center", VECTOR, "m", NULL, "0 0 0", A_PLACE, "middle of the circle"},
    {"distance", QUANTITY, "m", NULL, NULL, 0, FARTHEST, REQUIRED | CALX_ATTRIBUTE_OPEN_MIN,
     "of the bodies' centres from the middle"},
    {"axis", VECTOR, "1", NULL, "0 0 1", ANY, "of the circle, in 3D"},
    {"from", QUANTITY, "rad", NULL, NULL, ANY,
     "angle of the first body of an arc, counted from x (in 3D from the direction across the axis "
     "that is nearest to x, or to y if the axis is x); a whole circle if not given"},
    {"to", QUANTITY, "rad", NULL, NULL, ANY, "angle of the last body of an arc"},
    ALONG_ROWS,
    RADIUS_ROW,
    COMMON_ROWS};
static const struct calx_element ring = {"ring", "ring",
                                         "Bodies on a circle or an arc, at equal distances.",
                                         ATTRIBUTES(ring_attributes)};

static const struct calx_attribute pack_attributes[] = {
    {"box", CALX_FORM_LIST, "m", NULL, NULL, A_PLACE,
     "region: lower and upper corner, \"0 0 20 10 mm\" in 2D"},
    {"rectangle", CALX_FORM_LIST, "m", NULL, NULL, A_PLACE, "the same as box, in 2D"},
    {"circle", CALX_FORM_LIST, "m", NULL, NULL, A_PLACE, "region: x y radius, in 2D"},
    {"sphere", CALX_FORM_LIST, "m", NULL, NULL, A_PLACE, "region: x y z radius, in 3D"},
    {"cylinder", CALX_FORM_LIST, "m", NULL, NULL, A_PLACE,
     "region: x y z of its middle, radius, length (0: as far as the domain goes), in 3D"},
    {"axis", VECTOR, "1", NULL, "0 0 1", ANY, "direction of the cylinder"},
    {"inside", NAME, NULL, NULL, NULL, NO_RANGE, "region: the inside of the walls of this name"},
    {"level", QUANTITY, "m", NULL, NULL, ANY,
     "the region is used only up to this coordinate, along the axis that gravity points down (y in "
     "2D, z in 3D without gravity)"},
    {"count", WHOLE, NULL, NULL, NULL, 1, INFINITY, 0, "number of bodies"},
    {"fill", QUANTITY, "1", NULL, NULL, 0, 1, CALX_ATTRIBUTE_OPEN_MIN,
     "solid fraction of the region (area in 2D), instead of count; with neither, as many as fit at "
     "random"},
    {"gap", QUANTITY, "m", NULL, "0", NOT_NEGATIVE, "room kept free around each body"},
    SEED_ROW,
    SIZES_ROW,
    COMMON_ROWS};
static const struct calx_element pack = {"pack", "pack", "Bodies at random places without overlap.",
                                         ATTRIBUTES(pack_attributes)};

static const struct calx_attribute group_attributes[] = {
    {"name", NAME, NULL, NULL, NULL, NEEDED,
     "by which stages, probes and expectations refer to it, as to walls"},
    MATERIAL_ROW,
    TEMPERATURE_ROW,
    {"isothermal", SWITCH, NULL, NULL, "no", NO_RANGE,
     "yes: its temperature is given, as that of walls, and stages may change it; no: each of its "
     "bodies has one of its own, and a capacity for heat"},
    RADIUS_ROW};
static const struct calx_child group_children[] = {{&particle, '*'}, {&csv, '*'}, {&grid, '*'},
                                                   {&pack, '*'},     {&row, '*'}, {&ring, '*'}};
static const struct calx_element group = {
    "group", "group",
    "A rigid group: its bodies serve as a wall. They keep their places to each other, stand still "
    "or move as <move> of a stage says, whatever meets them; velocity, spin and fixed are not for "
    "them. The attributes hold for all elements inside that do not say otherwise.",
    ATTRIBUTES(group_attributes), CHILDREN(group_children)};

static const struct calx_attribute particles_attributes[] = {
    {"seed", WHOLE, NULL, NULL, NULL, NO_RANGE, "of random numbers"},
    {"radius", CALX_FORM_SIZES, "m", NULL, NULL, A_RADIUS, "radius, as in pack"},
    COMMON_ROWS};
static const struct calx_child particles_children[] = {{&particle, '*'}, {&csv, '*'}, {&grid, '*'},
                                                       {&pack, '*'},     {&row, '*'}, {&ring, '*'},
                                                       {&group, '*'}};
const struct calx_element calx_element_particles = {
    "particles", "particles",
    "Bodies. The attributes hold for all elements inside that do not say otherwise. Ids count from "
    "0 in the order of the file.",
    ATTRIBUTES(particles_attributes), CHILDREN(particles_children)};

/* ---- walls
 * --------------------------------------------------------------------------------------------- */

static const struct calx_attribute segment_attributes[] = {
    {"from", CALX_FORM_LIST, "m", NULL, NULL, A_NEEDED_PLACE,
     "one end, x y; in 3D the wall is a strip along z"},
    {"to", CALX_FORM_LIST, "m", NULL, NULL, A_NEEDED_PLACE, "other end"},
};
static const struct calx_element segment = {"segment", "segment",
                                            "A straight wall with ends, felt from both sides.",
                                            ATTRIBUTES(segment_attributes)};

static const struct calx_attribute polyline_attributes[] = {
    {"points", CALX_FORM_LIST, "m", NULL, NULL, A_NEEDED_PLACE, "x y of each corner"},
    {"closed", SWITCH, NULL, NULL, "no", NO_RANGE, "yes: the last corner is joined to the first"},
};
static const struct calx_element polyline = {"polyline", "polyline",
                                             "Straight walls from corner to corner.",
                                             ATTRIBUTES(polyline_attributes)};

static const struct calx_attribute plane_attributes[] = {
    {"point", VECTOR, "m", NULL, "0 0 0", A_PLACE, "a point on it"},
    {"normal", VECTOR, "1", NULL, NULL, -INFINITY, INFINITY, REQUIRED,
     "direction to the side where the grains are, of any length"},
};
static const struct calx_element plane = {"plane", "plane",
                                          "An endless plane (in 2D a line), felt from one side.",
                                          ATTRIBUTES(plane_attributes)};

#define SIDE_ROW                                                                                   \
    {                                                                                              \
        "side", WORD, NULL, "inside|outside", "inside", NO_RANGE, "where the grains are"           \
    }
#define NEEDED_RADIUS_ROW                                                                          \
    {                                                                                              \
        "radius", QUANTITY, "m", NULL, NULL, 0, FARTHEST, REQUIRED | CALX_ATTRIBUTE_OPEN_MIN,      \
            "radius"                                                                               \
    }
static const struct calx_attribute cylinder_attributes[] = {
    {"center", VECTOR, "m", NULL, "0 0 0", A_PLACE,
     "a point on its axis; the middle if it has a length"},
    {"axis", VECTOR, "1", NULL, "0 0 1", ANY, "direction of the axis, in 3D"},
    NEEDED_RADIUS_ROW,
    {"length", QUANTITY, "m", NULL, NULL, POSITIVE, "endless if not given"},
    SIDE_ROW};
static const struct calx_element cylinder = {"cylinder", "cylinder",
                                             "A round wall (in 2D a circle), without ends.",
                                             ATTRIBUTES(cylinder_attributes)};

static const struct calx_attribute sphere_attributes[] = {
    {"center", VECTOR, "m", NULL, "0 0 0", A_PLACE, "its centre"}, NEEDED_RADIUS_ROW, SIDE_ROW};
static const struct calx_element sphere = {"sphere", "sphere",
                                           "A hollow or solid ball (in 2D a circle) as a wall.",
                                           ATTRIBUTES(sphere_attributes)};

static const struct calx_attribute slab_attributes[] = {
    {"depth", QUANTITY, "m", NULL, NULL, 0, FARTHEST, REQUIRED | CALX_ATTRIBUTE_OPEN_MIN, "how far it reaches behind the face"},
    {"cells", CALX_FORM_LIST, "1", NULL, NULL, 1, 100000, REQUIRED, "along the face and into the depth: \"40 20\""},
    {"temperature", QUANTITY, "K", NULL, NULL, 0, INFINITY, REQUIRED, "at the start"},
    {"far", WORD, NULL, "insulated|isothermal", "insulated", NO_RANGE, "the face opposite to the grains"},
    {"far-temperature", QUANTITY, "K", NULL, NULL, 0, INFINITY, 0, "of an isothermal far face; that at the start if not given"},
    {"along", WORD, NULL, "x|y|z", NULL, NO_RANGE,
     "behind a plane: the axis along which temperatures vary; the first that lies in the plane if not given"},
    {"theta", QUANTITY, "1", NULL, "0.5", 0.5, 1, 0, "of the scheme in time: 0.5 is of second order, 1 the most damped"},
};
static const struct calx_element slab = {
    "slab", "slab",
    "A solid behind walls of one plane or one segment, of their material, in which heat is conducted along the face and into the depth. Grains "
    "see the temperature of the cells of the face where they touch, and give it their heat. Along the face it is as long as the domain or the "
    "segment, and periodic if the scene is; across (in 3D) nothing varies. It moves with its walls. Behind a segment it is on the right, seen "
    "from its first end.",
    ATTRIBUTES(slab_attributes)};

static const struct calx_attribute walls_attributes[] = {
    {"name", NAME, NULL, NULL, NULL, NEEDED, "by which stages, packings and probes refer to it"},
    {"material", NAME, NULL, NULL, NULL, NEEDED, "name of a material"},
    {"temperature", VARIES, "K", "txyz", NULL, 0, INFINITY, 0,
     "a number or an expression of t (time) and x, y, z; insulated if not given"},
    {"svg", FILE_PATH, NULL, NULL, NULL, 0, 0, CALX_ATTRIBUTE_EXISTS,
     "a drawing whose lines are walls; its page is centred at 0 0, y up"},
    {"scale", QUANTITY, "m", NULL, NULL, POSITIVE,
     "length of one unit of the drawing; that of the file if not given"},
    {"tolerance", QUANTITY, "m", NULL, "10 um", POSITIVE,
     "largest distance between a curve and the segments that replace it"},
    {"id", TEXT, NULL, NULL, NULL, NO_RANGE, "only this element or layer of the drawing"},
};
static const struct calx_child walls_children[] = {
    {&segment, '*'}, {&polyline, '*'}, {&plane, '*'}, {&cylinder, '*'}, {&sphere, '*'}, {&slab, '?'}};
const struct calx_element calx_element_walls = {
    "walls", "walls",
    "Walls that belong together: from a drawing, from the elements inside, or both.",
    ATTRIBUTES(walls_attributes), CHILDREN(walls_children)};
