/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the files that place particles share (io/case_particles.c, case_pack.c, case_csv.c); nobody
 * else includes it.
 */
#ifndef CALX_CASE_BODIES_H
#define CALX_CASE_BODIES_H

#include "core/pack.h"
#include "core/random.h"
#include "io/case_reader.h"

/* More from one element is taken for a mistake in a number. */
#define CALX_MOST_BODIES 20000000

/* Radii and coordinates that a distribution or a table may give, m; the tables of elements say the
 * same. */
#define CALX_LEAST_RADIUS 1e-12
#define CALX_LARGEST_RADIUS 1e6
#define CALX_FARTHEST_PLACE 1e9

/* A start velocity or spin: given, or random within plus and minus `random` on the axes that exist.
 */
struct calx_start {
    bool given;
    double value[3], random;
};

/* What the bodies of one element have in common, with what it inherits from <particles>. */
struct calx_group {
    const xmlNode *node;
    int material;
    int carrier; /* the wall that a rigid group is in the scene, or -1 */
    bool fixed, has_temperature;
    struct calx_function temperature;
    struct calx_start velocity, spin;
    struct calx_random random;
    uint64_t seed;
};

/* Radii of several sizes; the lists are those of `sizes`. */
#define CALX_MOST_CLASSES 32
struct calx_radii {
    struct calx_sizes sizes;
    double list[CALX_MOST_CLASSES], weight[CALX_MOST_CLASSES];
};

/* The bodies so far: scene->particles with all its arrays, and which of them say something. */
struct calx_bed {
    struct calx_reader *reader;
    struct calx_particles *particles;
    size_t capacity;
    bool any_velocity, any_spin, any_temperature, any_fixed, any_carrier;
};

/* Where the attribute stands: on the element, else on <group> or <particles> around it, else NULL.
 */
const xmlNode *calx_case_bearer(const xmlNode *, const char *name);

/* The one radius of the element's bodies; NaN and a problem if there is none. */
double calx_case_radius(struct calx_reader *, const xmlNode *);

/* The attribute radius; false and a problem if it is wrong or missing. */
bool calx_case_read_radii(struct calx_reader *, const xmlNode *, struct calx_radii *);

/* Appends a body. Returns its index, or -1 without memory. */
int64_t calx_case_place_body(struct calx_bed *, struct calx_group *, const double position[3],
                             double radius);

void calx_case_read_grid(struct calx_bed *, struct calx_group *);
void calx_case_read_pack(struct calx_bed *, struct calx_group *);
void calx_case_read_csv(struct calx_bed *, struct calx_group *);
void calx_case_read_row(struct calx_bed *, struct calx_group *);
void calx_case_read_ring(struct calx_bed *, struct calx_group *);

#endif
