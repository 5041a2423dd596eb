/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The time series of a run. Input: frames; output: .vtu files and the three .pvd collections that
 * list them. Method: the .vtu of a frame are complete on the disk before a .pvd names them, and a
 * .pvd is replaced as a whole (io/file.h), so that what a .pvd lists exists at every instant. Going
 * on: the .pvd is read back and cut at the restart time.
 */
#include "io/series.h"

#include <errno.h>
#include <libxml/parser.h>
#include <libxml/xmlwriter.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "io/file.h"
#include "io/vtk.h"

#define X(s) ((const xmlChar *)(s))

/* The parts of frames are the lists of a series of frames; a series of meshes has one list. */
static const char *const suffixes[CALX_VTK_PARTS] = {
    [CALX_VTK_PARTICLES] = "", [CALX_VTK_WALLS] = "_walls", [CALX_VTK_CONTACTS] = "_contacts"};

/* One line of a .pvd: the file of frame `number`, which several lines may share. */
struct entry {
    double time;
    unsigned long number;
};

struct list {
    char suffix[112];              /* between the name of the series and a number */
    struct entry *entries;         /* times and numbers never fall */
    size_t count, capacity, stale; /* stale: entries after `count` that are listed no more */
};

struct calx_series {
    char *stem;       /* FOLDER/NAME */
    char *path;       /* of the first list's .pvd */
    const char *name; /* in stem */
    struct calx_output output;
    bool walls_known; /* the last wall file is of this run */
    uLong walls;      /* checksum of what it holds */
    size_t list_count;
    struct list lists[CALX_VTK_PARTS];
};

/* ---- names and entries ---- */

static int no_memory(const struct calx_series *s, struct calx_error *e)
{
    return calx_error_set(e, CALX_ERROR_MEMORY, "out of memory for the series %s",
                          s && s->stem ? s->stem : "");
}

/* START and the list's suffix, then _NUMBER.vtu, or .pvd if number is NULL. The caller frees it;
 * NULL without memory. */
static char *name_of(const char *start, const struct list *l, const unsigned long *number)
{
    char *text = NULL;
    int n = number ? asprintf(&text, "%s%s_%06lu.vtu", start, l->suffix, *number)
                   : asprintf(&text, "%s%s.pvd", start, l->suffix);
    return n < 0 ? NULL : text;
}

static bool append(struct list *l, double time, unsigned long number)
{
    if (l->count == l->capacity) {
        size_t capacity = l->capacity ? 2 * l->capacity : 64;
        struct entry *entries = realloc(l->entries, capacity * sizeof *entries);
        if (!entries)
            return false;
        l->entries = entries;
        l->capacity = capacity;
    }
    l->entries[l->count++] = (struct entry){time, number};
    return true;
}

static const struct entry *last(const struct list *l)
{
    return l->count ? &l->entries[l->count - 1] : NULL;
}

static unsigned long next_number(const struct calx_series *s)
{
    unsigned long next = 0;
    for (size_t p = 0; p < s->list_count; p++) {
        const struct entry *l = last(&s->lists[p]);
        next = l && l->number >= next ? l->number + 1 : next;
    }
    return next;
}

/* ---- writing a .pvd ---- */

static int write_entry(xmlTextWriter *w, const struct calx_series *s, const struct list *l,
                       const struct entry *n)
{
    char *file = name_of(s->name, l, &n->number);
    if (!file)
        return CALX_ERROR_MEMORY;
    xmlTextWriterStartElement(w, X("DataSet"));
    xmlTextWriterWriteFormatAttribute(w, X("timestep"), "%.17g", n->time);
    xmlTextWriterWriteAttribute(w, X("part"), X("0"));
    xmlTextWriterWriteAttribute(w, X("file"), X(file));
    xmlTextWriterEndElement(w);
    free(file);
    return CALX_OK;
}

/* The text of the .pvd, or NULL without memory. */
static xmlBuffer *compose(const struct calx_series *s, const struct list *l)
{
    xmlBuffer *text = xmlBufferCreate();
    xmlTextWriter *w = text ? xmlNewTextWriterMemory(text, 0) : NULL;
    int failed = !w;
    if (w) {
        xmlTextWriterSetIndent(w, 1);
        xmlTextWriterStartDocument(w, NULL, NULL, NULL);
        xmlTextWriterStartElement(w, X("VTKFile"));
        xmlTextWriterWriteAttribute(w, X("type"), X("Collection"));
        xmlTextWriterWriteAttribute(w, X("version"), X("1.0"));
        xmlTextWriterStartElement(w, X("Collection"));
        for (size_t i = 0; !failed && i < l->count; i++)
            failed = write_entry(w, s, l, &l->entries[i]);
        failed = failed || xmlTextWriterEndDocument(w) < 0;
        xmlFreeTextWriter(w);
    }
    if (failed && text)
        xmlBufferFree(text);
    return failed ? NULL : text;
}

static int write_pvd(const struct calx_series *s, const struct list *l, struct calx_error *e)
{
    struct calx_file file = {0};
    xmlBuffer *text = compose(s, l);
    char *path = name_of(s->stem, l, NULL);
    int code = text && path ? calx_file_create(&file, path, e) : no_memory(s, e);
    code = code ? code
                : calx_file_write(&file, xmlBufferContent(text), (size_t)xmlBufferLength(text), e);
    code = code ? code : calx_file_commit(&file, e);
    if (text)
        xmlBufferFree(text);
    free(path);
    return code;
}

/* ---- reading a .pvd ---- */

/* Whether `file` is the name of a .vtu of this list, and its number: nothing else may ever be
 * opened or removed. */
static bool parse_name(const struct calx_series *s, const struct list *l, const char *file,
                       unsigned long *number)
{
    size_t n = strlen(s->name), m = strlen(l->suffix);
    if (strncmp(file, s->name, n) || strncmp(file + n, l->suffix, m) || file[n + m] != '_')
        return false;
    *number = strtoul(file + n + m + 1, NULL, 10);
    char *expected = name_of(s->name, l, number);
    bool same = expected && !strcmp(expected, file);
    free(expected);
    return same;
}

static bool parse_entry(const struct calx_series *s, const struct list *l, xmlNode *node,
                        struct entry *entry)
{
    xmlChar *time = xmlGetProp(node, X("timestep")), *file = xmlGetProp(node, X("file"));
    char *end = NULL;
    entry->time = time ? strtod((const char *)time, &end) : NAN;
    bool good = file && end && end != (char *)time && !*end && isfinite(entry->time) &&
                parse_name(s, l, (const char *)file, &entry->number);
    xmlFree(time);
    xmlFree(file);
    return good;
}

static xmlNode *first_element(xmlNode *node, const char *name)
{
    while (node && !(node->type == XML_ELEMENT_NODE && !xmlStrcmp(node->name, X(name))))
        node = node->next;
    return node;
}

/* Reads the entries; false if this is not a .pvd of this series. */
static bool parse(struct calx_series *s, struct list *l, xmlDoc *doc)
{
    xmlNode *root = first_element(xmlDocGetRootElement(doc), "VTKFile");
    xmlNode *collection = root ? first_element(root->children, "Collection") : NULL;
    if (!collection)
        return false;
    for (xmlNode *n = first_element(collection->children, "DataSet"); n;
         n = first_element(n->next, "DataSet")) {
        struct entry entry;
        if (!parse_entry(s, l, n, &entry) || (l->count && entry.time <= last(l)->time) ||
            !append(l, entry.time, entry.number))
            return false;
    }
    return true;
}

/* Keeps the entries up to `time`. */
static void cut(struct list *l, double time)
{
    while (l->count && last(l)->time > time) {
        l->count--;
        l->stale++;
    }
}

/* Removes the .vtu files that were cut off; the .pvd names them no more. */
static void remove_stale(const struct calx_series *s, const struct list *l)
{
    for (const struct entry *n = l->entries + l->count; n < l->entries + l->count + l->stale; n++) {
        bool shared = l->count && n->number <= last(l)->number;
        char *file = shared ? NULL : name_of(s->stem, l, &n->number);
        if (file)
            unlink(file);
        free(file);
    }
}

/* Takes over what is in the folder up to `time`. */
static int take_over(struct calx_series *s, struct list *l, double time, struct calx_error *e)
{
    bool fresh = time == -INFINITY;
    char *path = name_of(s->stem, l, NULL);
    if (!path)
        return no_memory(s, e);
    int code = CALX_OK;
    if (!access(path, F_OK)) {
        xmlDoc *doc =
            xmlReadFile(path, NULL, XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING);
        bool good = doc && parse(s, l, doc);
        xmlFreeDoc(doc);
        cut(l, time);
        if (!good && !fresh)
            code = calx_error_set(e, CALX_ERROR_IO, "%s is damaged: move it away to resume", path);
        else if (fresh && unlink(path))
            code = calx_error_set(e, CALX_ERROR_IO, "cannot remove %s of the run before: %s", path,
                                  strerror(errno));
        else if (!fresh && l->stale)
            code = write_pvd(s, l, e);
        if (!code)
            remove_stale(s, l);
    }
    free(path);
    return code;
}

/* ---- the series ---- */

void calx_series_free(struct calx_series *s)
{
    if (!s)
        return;
    for (size_t p = 0; p < s->list_count; p++)
        free(s->lists[p].entries);
    free(s->stem);
    free(s->path);
    free(s);
}

static struct calx_series *open_lists(const char *folder, const char *name,
                                      const struct calx_output *output,
                                      const char *const *list_suffixes, size_t count, double time,
                                      struct calx_error *e)
{
    if (calx_file_create_folder(folder, e))
        return NULL;
    struct calx_series *s = calloc(1, sizeof *s);
    int code = s ? CALX_OK : no_memory(s, e);
    if (s && asprintf(&s->stem, "%s/%s", folder, name) < 0)
        s->stem = NULL;
    if (s && s->stem) {
        s->name = s->stem + strlen(folder) + 1;
        s->output = *output;
        s->list_count = count;
        for (size_t p = 0; p < count; p++)
            snprintf(s->lists[p].suffix, sizeof s->lists[p].suffix, "%s", list_suffixes[p]);
        s->path = name_of(s->stem, &s->lists[0], NULL);
    }
    if (s && !s->path)
        code = no_memory(s, e);
    for (size_t p = 0; !code && p < count; p++)
        code = take_over(s, &s->lists[p], time, e);
    if (!code)
        return s;
    calx_series_free(s);
    return NULL;
}

struct calx_series *calx_series_resume(const char *folder, const char *name,
                                       const struct calx_output *output, double time,
                                       struct calx_error *e)
{
    return open_lists(folder, name, output, suffixes, CALX_VTK_PARTS, time, e);
}

struct calx_series *calx_series_of_meshes(const char *folder, const char *name, const char *suffix,
                                          const struct calx_output *output, double time,
                                          struct calx_error *e)
{
    return open_lists(folder, name, output, &suffix, 1, time, e);
}

struct calx_series *calx_series_create(const char *folder, const char *name,
                                       const struct calx_output *output, struct calx_error *e)
{
    return calx_series_resume(folder, name, output, -INFINITY, e);
}

size_t calx_series_count(const struct calx_series *s)
{
    return s->lists[0].count;
}

double calx_series_last(const struct calx_series *s)
{
    const struct entry *l = last(&s->lists[0]);
    return l ? l->time : -INFINITY;
}

const char *calx_series_path(const struct calx_series *s)
{
    return s->path;
}

static bool wanted(const struct calx_series *s, enum calx_vtk_part part, const struct calx_frame *f)
{
    bool has[CALX_VTK_PARTS] = {true, f->wall_cells > 0, s->output.network};
    return has[part];
}

/* A checksum of all that a wall file holds: forces and temperatures change on walls that stand
 * still. */
static uLong sum_walls(const struct calx_frame *f)
{
    size_t points = f->wall_points, cells = f->wall_cells;
    const struct {
        const void *data;
        size_t bytes;
    } columns[] = {
        {f->wall_position, points * sizeof *f->wall_position},
        {f->wall_velocity, points * sizeof *f->wall_velocity},
        {f->wall_cell, cells * sizeof *f->wall_cell},
        {f->wall_of_cell, cells * sizeof *f->wall_of_cell},
        {f->wall_temperature, cells * sizeof *f->wall_temperature},
        {f->wall_force, cells * sizeof *f->wall_force},
    };
    uLong sum = crc32_z(0, NULL, 0);
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++)
        if (columns[i].data)
            sum = crc32_z(sum, columns[i].data, columns[i].bytes);
    return sum;
}

/* Writes the .vtu of a part unless the file before still holds; *number: of the file to list. */
static int write_part(struct calx_series *s, enum calx_vtk_part part, const struct calx_frame *f,
                      unsigned long *number, struct calx_error *e)
{
    const struct entry *before = last(&s->lists[part]);
    bool same = s->walls_known && !f->walls_changed && sum_walls(f) == s->walls;
    if (part == CALX_VTK_WALLS && same && before) {
        *number = before->number;
        return CALX_OK;
    }
    char *path = name_of(s->stem, &s->lists[part], number);
    int code = path ? calx_vtk_write(path, part, f, &s->output, e) : no_memory(s, e);
    free(path);
    return code;
}

/* Lists the file in memory and on the disk; on an error neither has changed. */
static int list_file(struct calx_series *s, struct list *l, double time, unsigned long number,
                     struct calx_error *e)
{
    bool replaces = l->count && last(l)->time == time;
    unsigned long before = replaces ? last(l)->number : 0;
    if (!replaces && !append(l, time, number))
        return no_memory(s, e);
    l->entries[l->count - 1].number = number;
    int code = write_pvd(s, l, e);
    if (code && replaces)
        l->entries[l->count - 1].number = before;
    else if (code)
        l->count--;
    return code;
}

/* The number of the next file, if a file of that time may come next. */
static int next_file(const struct calx_series *s, double time, unsigned long *number,
                     struct calx_error *e)
{
    double before = calx_series_last(s);
    if (time < before)
        return calx_error_set(e, CALX_ERROR_IO,
                              "a frame of %.9g s cannot follow one of %.9g s in %s", time, before,
                              s->path);
    *number = time > before ? next_number(s) : last(&s->lists[0])->number;
    return CALX_OK;
}

int calx_series_write(struct calx_series *s, const struct calx_frame *f, struct calx_error *e)
{
    unsigned long next = 0, number[CALX_VTK_PARTS];
    CALX_TRY(next_file(s, f->time, &next, e));
    for (int p = 0; p < CALX_VTK_PARTS; p++) {
        number[p] = next;
        if (wanted(s, (enum calx_vtk_part)p, f))
            CALX_TRY(write_part(s, (enum calx_vtk_part)p, f, &number[p], e));
    }
    for (int p = 0; p < CALX_VTK_PARTS; p++)
        if (wanted(s, (enum calx_vtk_part)p, f))
            CALX_TRY(list_file(s, &s->lists[p], f->time, number[p], e));
    s->walls_known = s->walls_known || f->wall_cells > 0;
    s->walls = sum_walls(f);
    return CALX_OK;
}

int calx_series_write_mesh(struct calx_series *s, const struct calx_mesh *m, struct calx_error *e)
{
    unsigned long number = 0;
    CALX_TRY(next_file(s, m->time, &number, e));
    char *path = name_of(s->stem, &s->lists[0], &number);
    int code = path ? calx_vtk_write_mesh(path, m, &s->output, e) : no_memory(s, e);
    free(path);
    return code ? code : list_file(s, &s->lists[0], m->time, number, e);
}
