/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Writes one part of a frame as .vtu. Input: struct calx_frame; output: a file. Method: every array
 * is encoded in memory first (so that offsets are known), libxml2 writes the XML, the raw bytes
 * follow the underscore of AppendedData. Format: VTK file formats, XML, "appended raw" with
 * vtkZLibDataCompressor: the header of an array is {blocks, bytes of a block, bytes of the last
 * block if it is shorter, compressed bytes of each block}, uncompressed {bytes}, all UInt64.
 */
#include "io/vtk.h"

#include <inttypes.h>
#include <libxml/xmlwriter.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "io/file.h"

/* Larger than VTK's own 32 KiB: fewer restarts of the dictionary; small enough to read a part of a
 * big array. */
enum { BLOCK = 1 << 17 };

enum kind { REAL, INT32, INT64, BYTE };
enum section { POINT_DATA, CELL_DATA, POINTS, CELLS, SECTIONS };

static const struct {
    const char *name;
    size_t bytes;
} kinds[] = {
    [REAL] = {"Float64", 8}, [INT32] = {"Int32", 4}, [INT64] = {"Int64", 8}, [BYTE] = {"UInt8", 1}};

static const char *const sections[] = {
    [POINT_DATA] = "PointData", [CELL_DATA] = "CellData", [POINTS] = "Points", [CELLS] = "Cells"};

/* Arrays that are copied from the frame (unit NULL: a pure number): the pointer at `offset` of
 * struct calx_frame, NULL if the frame has none. */
struct field {
    enum calx_vtk_part part;
    enum section section;
    const char *name, *unit;
    uint32_t flag; /* enum calx_field; 0: always written */
    enum kind kind;
    size_t components, offset;
};

#define AT(member) offsetof(struct calx_frame, member)
static const struct field fields[] = {
    {CALX_VTK_PARTICLES, POINT_DATA, "id", NULL, 0, INT64, 1, AT(id)},
    {CALX_VTK_PARTICLES, POINT_DATA, "radius", "m", 0, REAL, 1, AT(radius)},
    {CALX_VTK_PARTICLES, POINT_DATA, "velocity", "m/s", CALX_FIELD_VELOCITY, REAL, 3, AT(velocity)},
    {CALX_VTK_PARTICLES, POINT_DATA, "spin", "rad/s", CALX_FIELD_SPIN, REAL, 3, AT(spin)},
    {CALX_VTK_PARTICLES, POINT_DATA, "temperature", "K", CALX_FIELD_TEMPERATURE, REAL, 1,
     AT(temperature)},
    {CALX_VTK_PARTICLES, POINT_DATA, "heat", "W", CALX_FIELD_HEAT, REAL, 1, AT(heat)},
    {CALX_VTK_PARTICLES, POINT_DATA, "force", "N", CALX_FIELD_FORCE, REAL, 3, AT(force)},
    {CALX_VTK_PARTICLES, POINT_DATA, "mass", "kg", CALX_FIELD_MASS, REAL, 1, AT(mass)},
    {CALX_VTK_PARTICLES, POINT_DATA, "material", NULL, CALX_FIELD_MATERIAL, INT32, 1, AT(material)},
    {CALX_VTK_PARTICLES, POINT_DATA, "contacts", NULL, CALX_FIELD_CONTACTS, INT32, 1, AT(contacts)},
    {CALX_VTK_PARTICLES, POINT_DATA, "group", NULL, CALX_FIELD_GROUP, INT32, 1, AT(group)},
    {CALX_VTK_PARTICLES, POINTS, "position", "m", 0, REAL, 3, AT(position)},
    {CALX_VTK_WALLS, POINT_DATA, "velocity", "m/s", 0, REAL, 3, AT(wall_velocity)},
    {CALX_VTK_WALLS, CELL_DATA, "wall", NULL, 0, INT32, 1, AT(wall_of_cell)},
    {CALX_VTK_WALLS, CELL_DATA, "temperature", "K", 0, REAL, 1, AT(wall_temperature)},
    {CALX_VTK_WALLS, CELL_DATA, "force", "N", 0, REAL, 3, AT(wall_force)},
    {CALX_VTK_WALLS, POINTS, "position", "m", 0, REAL, 3, AT(wall_position)},
    {CALX_VTK_CONTACTS, CELL_DATA, "pair", NULL, 0, INT64, 2, AT(pair)},
    {CALX_VTK_CONTACTS, CELL_DATA, "normal_force", "N", 0, REAL, 1, AT(normal_force)},
    {CALX_VTK_CONTACTS, CELL_DATA, "tangential_force", "N", 0, REAL, 1, AT(tangential_force)},
    {CALX_VTK_CONTACTS, CELL_DATA, "heat_flow", "W", 0, REAL, 1, AT(heat_flow)},
    {CALX_VTK_CONTACTS, CELL_DATA, "overlap", "m", 0, REAL, 1, AT(overlap)},
    {CALX_VTK_CONTACTS, CELL_DATA, "status", NULL, 0, INT32, 1, AT(status)},
    {CALX_VTK_CONTACTS, POINTS, "position", "m", 0, REAL, 3, AT(pair_position)},
};

enum { CELL_ARRAYS = 3, MOST_ARRAYS = sizeof fields / sizeof *fields + CELL_ARRAYS };

/* One array of the file, encoded. */
struct array {
    enum section section;
    const char *name, *type, *unit;
    size_t components;
    unsigned char *bytes; /* owned */
    size_t size;
};

struct grid {
    size_t points, cells;
    bool single;
    int level; /* of zlib; 0: as it is */
    size_t count;
    struct array arrays[MOST_ARRAYS];
};

/* ---- encoding ---- */

/* {bytes} data. NULL without memory. */
static unsigned char *encode_raw(const void *data, size_t bytes, size_t *size)
{
    uint64_t header = bytes;
    unsigned char *out = malloc(sizeof header + bytes);
    if (!out)
        return NULL;
    memcpy(out, &header, sizeof header);
    if (bytes)
        memcpy(out + sizeof header, data, bytes);
    *size = sizeof header + bytes;
    return out;
}

/* {blocks, BLOCK, rest, compressed sizes} compressed blocks. NULL without memory. */
static unsigned char *encode_blocks(const unsigned char *data, size_t bytes, int level,
                                    size_t *size)
{
    size_t blocks = (bytes + BLOCK - 1) / BLOCK, head = (3 + blocks) * sizeof(uint64_t);
    uint64_t *header = malloc(head);
    unsigned char *out = malloc(head + blocks * compressBound(BLOCK));
    size_t end = head;
    for (size_t b = 0; header && out && b < blocks; b++) {
        size_t from = b * BLOCK, n = bytes - from < BLOCK ? bytes - from : BLOCK;
        uLongf packed = compressBound(BLOCK);
        if (compress2(out + end, &packed, data + from, n, level) !=
            Z_OK) { /* only for lack of memory */
            free(out);
            out = NULL;
            break;
        }
        header[3 + b] = packed;
        end += packed;
    }
    if (header && out) {
        header[0] = blocks;
        header[1] = BLOCK;
        header[2] = bytes % BLOCK;
        memcpy(out, header, head);
    } else {
        free(out);
        out = NULL;
    }
    free(header);
    *size = end;
    return out;
}

static void *narrow(const double *data, size_t n)
{
    float *out = malloc((n + 1) * sizeof *out);
    for (size_t i = 0; out && i < n; i++)
        out[i] = (float)data[i];
    return out;
}

/* Encodes n values of that kind as the next array of the grid. CALX_ERROR_MEMORY without text: the
 * caller knows the file. */
static int add(struct grid *g, enum section section, const char *name, const char *unit,
               enum kind kind, size_t components, const void *data, size_t n)
{
    struct array *a = &g->arrays[g->count];
    bool thin = kind == REAL && g->single;
    size_t bytes = n * (thin ? sizeof(float) : kinds[kind].bytes);
    void *copy = thin ? narrow(data, n) : NULL;
    if (thin && !copy)
        return CALX_ERROR_MEMORY;
    const void *values = thin ? copy : data;
    *a = (struct array){section, name, thin ? "Float32" : kinds[kind].name, unit, components,
                        NULL,    0};
    a->bytes = g->level ? encode_blocks(values, bytes, g->level, &a->size)
                        : encode_raw(values, bytes, &a->size);
    free(copy);
    if (!a->bytes)
        return CALX_ERROR_MEMORY;
    g->count++;
    return CALX_OK;
}

/* ---- the parts of a frame ---- */

/* Number of corners of cell c, and their points. */
static size_t corners_vertex(const struct calx_frame *f, size_t c, int64_t point[4])
{
    (void)f;
    point[0] = (int64_t)c;
    return 1;
}

static size_t corners_wall(const struct calx_frame *f, size_t c, int64_t point[4])
{
    size_t n = 0;
    while (n < 4 && f->wall_cell[c][n] >= 0) {
        point[n] = f->wall_cell[c][n];
        n++;
    }
    return n;
}

static size_t corners_contact(const struct calx_frame *f, size_t c, int64_t point[4])
{
    (void)f;
    point[0] = (int64_t)(2 * c);
    point[1] = (int64_t)(2 * c) + 1;
    return 2;
}

static const struct {
    size_t cells, points, points_per_count; /* offsets of the counts in the frame */
    size_t (*corners)(const struct calx_frame *, size_t c, int64_t point[4]);
} parts[] = {
    [CALX_VTK_PARTICLES] = {AT(n), AT(n), 1, corners_vertex},
    [CALX_VTK_WALLS] = {AT(wall_cells), AT(wall_points), 1, corners_wall},
    [CALX_VTK_CONTACTS] = {AT(contact_count), AT(contact_count), 2, corners_contact},
};

/* VTK_VERTEX, VTK_LINE, VTK_TRIANGLE, VTK_QUAD, VTK_HEXAHEDRON by number of corners; VTK_EMPTY_CELL for none. */
static const uint8_t cell_type[] = {0, 1, 3, 5, 9, 0, 0, 0, 12};

static size_t count_at(const struct calx_frame *f, size_t offset)
{
    size_t n;
    memcpy(&n, (const char *)f + offset, sizeof n);
    return n;
}

static const void *pointer_at(const struct calx_frame *f, size_t offset)
{
    const void *p;
    memcpy(&p, (const char *)f + offset, sizeof p);
    return p;
}

static int add_cells(struct grid *g, enum calx_vtk_part part, const struct calx_frame *f)
{
    int64_t *connectivity = malloc((g->cells + 1) * 4 * sizeof *connectivity);
    int64_t *offsets = malloc((g->cells + 1) * sizeof *offsets);
    uint8_t *types = malloc(g->cells + 1);
    int code = connectivity && offsets && types ? CALX_OK : CALX_ERROR_MEMORY;
    size_t end = 0;
    for (size_t c = 0; !code && c < g->cells; c++) {
        size_t n = parts[part].corners(f, c, connectivity + end);
        end += n;
        offsets[c] = (int64_t)end;
        types[c] = cell_type[n];
    }
    code = code ? code : add(g, CELLS, "connectivity", NULL, INT64, 1, connectivity, end);
    code = code ? code : add(g, CELLS, "offsets", NULL, INT64, 1, offsets, g->cells);
    code = code ? code : add(g, CELLS, "types", NULL, BYTE, 1, types, g->cells);
    free(connectivity);
    free(offsets);
    free(types);
    return code;
}

static int fill(struct grid *g, enum calx_vtk_part part, const struct calx_frame *f,
                const struct calx_output *output)
{
    g->points = count_at(f, parts[part].points) * parts[part].points_per_count;
    g->cells = count_at(f, parts[part].cells);
    g->single = output->single;
    g->level = output->compression;
    for (const struct field *d = fields; d < fields + sizeof fields / sizeof *fields; d++) {
        const void *data = pointer_at(f, d->offset);
        size_t tuples = d->section == CELL_DATA ? g->cells : g->points;
        /* an array of a frame without particles may well be NULL: Points must be there all the same
         */
        bool asked = d->part == part && (!d->flag || output->fields & d->flag);
        if (asked && (data || (d->section == POINTS && !tuples)))
            CALX_TRY(add(g, d->section, d->name, d->unit, d->kind, d->components, data,
                         tuples * d->components));
    }
    return add_cells(g, part, f);
}

/* ---- the file ---- */

#define X(s) ((const xmlChar *)(s))

static void write_size(xmlTextWriter *w, const char *name, size_t n)
{
    xmlTextWriterWriteFormatAttribute(w, X(name), "%zu", n);
}

static void write_array(xmlTextWriter *w, const struct array *a, size_t offset)
{
    xmlTextWriterStartElement(w, X("DataArray"));
    xmlTextWriterWriteAttribute(w, X("type"), X(a->type));
    xmlTextWriterWriteAttribute(w, X("Name"), X(a->name));
    write_size(w, "NumberOfComponents", a->components);
    xmlTextWriterWriteAttribute(w, X("format"), X("appended"));
    write_size(w, "offset", offset);
    if (a->unit) {
        xmlTextWriterStartElement(w, X("InformationKey"));
        xmlTextWriterWriteAttribute(w, X("name"), X("UNITS_LABEL"));
        xmlTextWriterWriteAttribute(w, X("location"), X("vtkDataArray"));
        xmlTextWriterWriteString(w, X(a->unit));
        xmlTextWriterEndElement(w);
    }
    xmlTextWriterEndElement(w);
}

static void write_time(xmlTextWriter *w, double time)
{
    xmlTextWriterStartElement(w, X("FieldData"));
    xmlTextWriterStartElement(w, X("DataArray"));
    xmlTextWriterWriteAttribute(w, X("type"), X("Float64"));
    xmlTextWriterWriteAttribute(w, X("Name"), X("TimeValue"));
    xmlTextWriterWriteAttribute(w, X("NumberOfTuples"), X("1"));
    xmlTextWriterWriteAttribute(w, X("format"), X("ascii"));
    xmlTextWriterWriteFormatString(w, "%.17g", time);
    xmlTextWriterEndElement(w);
    xmlTextWriterEndElement(w);
}

static void write_piece(xmlTextWriter *w, const struct grid *g)
{
    xmlTextWriterStartElement(w, X("Piece"));
    write_size(w, "NumberOfPoints", g->points);
    write_size(w, "NumberOfCells", g->cells);
    for (enum section s = 0; s < SECTIONS; s++) {
        xmlTextWriterStartElement(w, X(sections[s]));
        size_t offset = 0;
        for (const struct array *a = g->arrays; a < g->arrays + g->count; offset += a->size, a++)
            if (a->section == s)
                write_array(w, a, offset);
        xmlTextWriterEndElement(w);
    }
    xmlTextWriterEndElement(w);
}

/* White space between the tag AppendedData and the data. VTK's reader (9.1, in Debian 12's ParaView) feeds its parser pieces of
 * 4096 bytes and stops at the first after that tag; an expat that defers incomplete tokens (2.6, and Debian's 2.5.0-1+deb12u2
 * on) sees the tag only with the next piece, which must then be harmless: white space, one whole piece of it wherever
 * the pieces begin. */
static void write_gap(xmlTextWriter *w)
{
    enum { PIECE = 4096 };
    char gap[2 * PIECE];
    memset(gap, ' ', sizeof gap);
    gap[sizeof gap - 1] = '\0';
    xmlTextWriterWriteString(w, X(gap));
}

static void write_head(xmlTextWriter *w, const struct grid *g, double time)
{
    const uint16_t one = 1;
    bool little = *(const uint8_t *)&one;
    xmlTextWriterSetIndent(w, 1);
    xmlTextWriterStartDocument(w, NULL, NULL, NULL);
    xmlTextWriterStartElement(w, X("VTKFile"));
    xmlTextWriterWriteAttribute(w, X("type"), X("UnstructuredGrid"));
    xmlTextWriterWriteAttribute(w, X("version"), X("1.0"));
    xmlTextWriterWriteAttribute(w, X("byte_order"), X(little ? "LittleEndian" : "BigEndian"));
    xmlTextWriterWriteAttribute(w, X("header_type"), X("UInt64"));
    if (g->level)
        xmlTextWriterWriteAttribute(w, X("compressor"), X("vtkZLibDataCompressor"));
    xmlTextWriterStartElement(w, X("UnstructuredGrid"));
    write_time(w, time);
    write_piece(w, g);
    xmlTextWriterEndElement(w);
    xmlTextWriterStartElement(w, X("AppendedData"));
    xmlTextWriterWriteAttribute(w, X("encoding"), X("raw"));
    write_gap(w);
    xmlTextWriterWriteString(w, X("_")); /* the data follow this character */
}

/* The XML text; *split is where the data belong. NULL without memory. */
static xmlBuffer *compose(const struct grid *g, double time, size_t *split)
{
    xmlBuffer *text = xmlBufferCreate();
    xmlTextWriter *w = text ? xmlNewTextWriterMemory(text, 0) : NULL;
    if (w) {
        write_head(w, g, time);
        xmlTextWriterFlush(w);
        *split = (size_t)xmlBufferLength(text);
        /* a buffer that failed once goes on failing: it is enough to ask at the end */
        if (xmlTextWriterEndDocument(w) >= 0) {
            xmlFreeTextWriter(w);
            return text;
        }
        xmlFreeTextWriter(w);
    }
    if (text)
        xmlBufferFree(text);
    return NULL;
}

static int save(const char *path, const struct grid *g, const xmlBuffer *text, size_t split,
                struct calx_error *e)
{
    struct calx_file file;
    const xmlChar *start = xmlBufferContent(text);
    CALX_TRY(calx_file_create(&file, path, e));
    CALX_TRY(calx_file_write(&file, start, split, e));
    for (const struct array *a = g->arrays; a < g->arrays + g->count; a++)
        CALX_TRY(calx_file_write(&file, a->bytes, a->size, e));
    CALX_TRY(calx_file_write(&file, start + split, (size_t)xmlBufferLength(text) - split, e));
    return calx_file_commit(&file, e);
}

/* Writes what was filled in (unless `code` says that there was no memory), and frees it. */
static int finish(const char *path, struct grid *g, int code, double time, struct calx_error *e)
{
    size_t split = 0;
    xmlBuffer *text = code ? NULL : compose(g, time, &split);
    if (text) {
        code = save(path, g, text, split, e);
        xmlBufferFree(text);
    } else {
        code = calx_error_set(e, CALX_ERROR_MEMORY, "out of memory before writing %s", path);
    }
    for (size_t i = 0; i < g->count; i++)
        free(g->arrays[i].bytes);
    return code;
}

int calx_vtk_write(const char *path, enum calx_vtk_part part, const struct calx_frame *frame,
                   const struct calx_output *output, struct calx_error *e)
{
    struct grid g = {0};
    int code = fill(&g, part, frame, output);
    return finish(path, &g, code, frame->time, e);
}

static int fill_mesh(struct grid *g, const struct calx_mesh *m, const struct calx_output *output)
{
    *g = (struct grid){.points = m->points, .cells = m->cells, .single = output->single,
                       .level = output->compression};
    for (const struct calx_mesh_array *a = m->arrays; a < m->arrays + m->array_count; a++)
        CALX_TRY(add(g, CELL_DATA, a->name, a->unit, REAL, a->components, a->value,
                     m->cells * a->components));
    CALX_TRY(add(g, POINTS, "position", "m", REAL, 3, m->position, 3 * m->points));
    int64_t *offsets = malloc((m->cells + 1) * sizeof *offsets);
    uint8_t *types = malloc(m->cells + 1);
    int code = offsets && types ? CALX_OK : CALX_ERROR_MEMORY;
    for (size_t c = 0; !code && c < m->cells; c++) {
        offsets[c] = (int64_t)(m->corners * (c + 1));
        types[c] = cell_type[m->corners];
    }
    code = code ? code : add(g, CELLS, "connectivity", NULL, INT64, 1, m->corner, m->corners * m->cells);
    code = code ? code : add(g, CELLS, "offsets", NULL, INT64, 1, offsets, m->cells);
    code = code ? code : add(g, CELLS, "types", NULL, BYTE, 1, types, m->cells);
    free(offsets);
    free(types);
    return code;
}

int calx_vtk_write_mesh(const char *path, const struct calx_mesh *m, const struct calx_output *output,
                        struct calx_error *e)
{
    struct grid g = {0};
    int code = fill_mesh(&g, m, output);
    return finish(path, &g, code, m->time, e);
}
