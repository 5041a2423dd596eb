/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The runs of a report on disk, so that an interrupted one goes on where it stopped.
 * FOLDER/report.runs: the fingerprint, then records {bytes, kind, checksum, content}, each written
 * by one call when its run has ended. A record cut short by a kill is dropped; so is everything if
 * the fingerprint is another. A file of one machine: plain bytes of this program's structs.
 */
#include "io/report_parts.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/file.h"

enum { KIND_RUN = 1, KIND_NOTE = 2 };
static const uint64_t magic = 0x3173746f70657263; /* "creports", first layout */

struct header {
    uint64_t bytes, kind, checksum; /* of the content */
};

static int out_of_memory(struct calx_error *error)
{
    return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
}

static uint64_t checksum_of(const void *content, size_t bytes)
{
    return calx_report_hash(magic, content, bytes);
}

/* ---- records ---- */

static bool grow_runs(struct calx_report_store *store, const struct calx_report_run *run)
{
    struct calx_report_run *grown = realloc(store->runs, (store->count + 1) * sizeof *grown);
    if (!grown)
        return false;
    store->runs = grown;
    grown[store->count++] = *run;
    return true;
}

static bool grow_notes(struct calx_report_store *store, const struct calx_report_note *note)
{
    struct calx_report_note *grown = realloc(store->notes, (store->note_count + 1) * sizeof *grown);
    if (!grown)
        return false;
    store->notes = grown;
    grown[store->note_count++] = *note;
    return true;
}

static bool take_run(struct calx_report_store *store, const char *content, size_t bytes)
{
    struct calx_report_run run;
    if (bytes < sizeof run)
        return false;
    memcpy(&run, content, sizeof run);
    size_t times = run.count * sizeof *run.times, values = run.count * run.width * sizeof *run.values;
    if (bytes != sizeof run + times + values)
        return false;
    run.times = malloc(times + 1);
    run.values = malloc(values + 1);
    if (!run.times || !run.values || !grow_runs(store, &run)) {
        free(run.times);
        free(run.values);
        return false;
    }
    memcpy(run.times, content + sizeof run, times);
    memcpy(run.values, content + sizeof run + times, values);
    return true;
}

static bool take_note(struct calx_report_store *store, const char *content, size_t bytes)
{
    struct calx_report_note note;
    if (bytes != sizeof note)
        return false;
    memcpy(&note, content, sizeof note);
    return grow_notes(store, &note);
}

/* ---- reading ---- */

/* Reads one record at `at`; false at the end or at what is not whole. */
static bool read_record(struct calx_report_store *store, off_t at, off_t size, off_t *next)
{
    struct header h;
    if (at + (off_t)sizeof h > size || pread(store->file, &h, sizeof h, at) != (ssize_t)sizeof h)
        return false;
    if (h.bytes > (uint64_t)(size - at) - sizeof h)
        return false;
    char *content = malloc(h.bytes + 1);
    bool whole = content &&
                 pread(store->file, content, h.bytes, at + (off_t)sizeof h) == (ssize_t)h.bytes &&
                 h.checksum == checksum_of(content, h.bytes) &&
                 (h.kind == KIND_RUN    ? take_run(store, content, h.bytes)
                  : h.kind == KIND_NOTE ? take_note(store, content, h.bytes)
                                        : false);
    free(content);
    *next = at + (off_t)sizeof h + (off_t)h.bytes;
    return whole;
}

static int fail(const char *path, struct calx_error *error)
{
    return calx_error_set(error, CALX_ERROR_IO, "%s: %s", path, strerror(errno));
}

static int read_records(struct calx_report_store *store, const struct calx_report_study *s,
                        const char *path, struct calx_error *error)
{
    const uint64_t mine[3] = {magic, s->fingerprint, sizeof(struct calx_report_run)};
    uint64_t found[3] = {0};
    off_t size = lseek(store->file, 0, SEEK_END), at = sizeof mine, next;
    if (size < 0)
        return fail(path, error);
    if (size >= at && pread(store->file, found, sizeof found, 0) == (ssize_t)sizeof found &&
        memcmp(found, mine, sizeof mine) == 0) {
        while (read_record(store, at, size, &next))
            at = next;
        store->found = store->count;
    } else {
        at = 0;
    }
    if (ftruncate(store->file, at) || lseek(store->file, at, SEEK_SET) < 0 ||
        (at == 0 && write(store->file, mine, sizeof mine) != (ssize_t)sizeof mine))
        return fail(path, error);
    return CALX_OK;
}

int calx_report_store_open(struct calx_report_store *store, const struct calx_report_study *s,
                           struct calx_error *error)
{
    char *path = NULL;
    *store = (struct calx_report_store){.file = -1};
    CALX_TRY(calx_file_create_folder(s->folder, error));
    if (asprintf(&path, "%s/report.runs", s->folder) < 0)
        return out_of_memory(error);
    store->file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    int code = store->file < 0 ? fail(path, error) : read_records(store, s, path, error);
    free(path);
    return code;
}

void calx_report_store_close(struct calx_report_store *store)
{
    for (size_t k = 0; k < store->count; k++)
        calx_report_run_clear(&store->runs[k]);
    free(store->runs);
    free(store->notes);
    if (store->file >= 0)
        close(store->file);
    *store = (struct calx_report_store){.file = -1};
}

/* ---- looking up and writing ---- */

static bool same_recipe(const struct calx_report_recipe *a, const struct calx_report_recipe *b)
{
    return a->candidate == b->candidate && a->dt == b->dt && a->heat_dt == b->heat_dt && a->tolerance == b->tolerance &&
           a->stiffness == b->stiffness && a->damping == b->damping && a->perturb == b->perturb &&
           a->draw == b->draw && a->forced == b->forced && a->window == b->window && a->samples == b->samples;
}

const struct calx_report_run *calx_report_store_find(const struct calx_report_store *store,
                                                     const struct calx_report_recipe *recipe,
                                                     size_t width)
{
    for (size_t k = 0; k < store->count; k++)
        if (store->runs[k].width == width && same_recipe(&store->runs[k].recipe, recipe))
            return &store->runs[k];
    return NULL;
}

/* One call of write for the whole record, so that a kill leaves it whole or cut at the end. */
static int write_record(struct calx_report_store *store, uint64_t kind, const char *content, size_t bytes,
                        struct calx_error *error)
{
    struct header h = {bytes, kind, checksum_of(content, bytes)};
    char *record = malloc(sizeof h + bytes);
    if (!record)
        return out_of_memory(error);
    memcpy(record, &h, sizeof h);
    memcpy(record + sizeof h, content, bytes);
    bool written = write(store->file, record, sizeof h + bytes) == (ssize_t)(sizeof h + bytes);
    free(record);
    return written ? CALX_OK : fail("report.runs", error);
}

int calx_report_store_add(struct calx_report_store *store, struct calx_report_run *run,
                          struct calx_error *error)
{
    size_t times = run->count * sizeof *run->times, values = run->count * run->width * sizeof *run->values,
           bytes = sizeof *run + times + values;
    char *content = malloc(bytes);
    if (!content || !grow_runs(store, run)) {
        free(content);
        return out_of_memory(error);
    }
    memcpy(content, run, sizeof *run);
    memcpy(content + sizeof *run, run->times, times);
    memcpy(content + sizeof *run + times, run->values, values);
    *run = (struct calx_report_run){0};
    int code = write_record(store, KIND_RUN, content, bytes, error);
    free(content);
    return code;
}

const double *calx_report_store_noted(const struct calx_report_store *store, const char *key)
{
    for (size_t k = 0; k < store->note_count; k++)
        if (strcmp(store->notes[k].key, key) == 0)
            return store->notes[k].values;
    return NULL;
}

int calx_report_store_note(struct calx_report_store *store, const char *key, const double values[8],
                           struct calx_error *error)
{
    struct calx_report_note note = {0};
    snprintf(note.key, sizeof note.key, "%s", key);
    memcpy(note.values, values, sizeof note.values);
    if (!grow_notes(store, &note))
        return out_of_memory(error);
    return write_record(store, KIND_NOTE, (const char *)&note, sizeof note, error);
}
