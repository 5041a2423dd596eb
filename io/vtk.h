/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Writes one part of a frame as a VTK XML unstructured grid (.vtu) that ParaView opens. Names and
 * units of the arrays: paraview/README.md.
 */
#ifndef CALX_IO_VTK_H
#define CALX_IO_VTK_H

#include "core/calx.h"

enum calx_vtk_part {
    CALX_VTK_PARTICLES, /* one vertex per particle */
    CALX_VTK_WALLS,     /* lines, triangles and quadrilaterals */
    CALX_VTK_CONTACTS, /* one line per contact, from centre to centre or to the point of the wall */
    CALX_VTK_PARTS
};

/* Writes `part` of the frame to `path`, whole or not at all. Of `output` it reads fields (particle
 * arrays asked for; those the frame has not are left out), single (32-bit floats) and compression
 * (0 raw, 1 to 9 zlib blocks). CALX_ERROR_IO with the reason, or CALX_ERROR_MEMORY. */
int calx_vtk_write(const char *path, enum calx_vtk_part, const struct calx_frame *,
                   const struct calx_output *output, struct calx_error *);

/* The same for a mesh, with its arrays on cells. */
int calx_vtk_write_mesh(const char *path, const struct calx_mesh *, const struct calx_output *output,
                        struct calx_error *);

#endif
