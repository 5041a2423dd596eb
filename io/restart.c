/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The restart file. Input and output: named blocks of bytes. Layout, in the machine's own byte
 * order: head, then per block a label and its bytes padded to 16, then a tail. Every part carries
 * its own CRC-32 (zlib) and the tail one of all that is before it, so that any damage is found and
 * named before a byte is used. Written by io/file.h.
 */
#include "io/restart.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "io/file.h"

enum { FORMAT = 1, ALIGNMENT = 16 };
static const uint32_t byte_order = 0x01020304u, swapped_order = 0x04030201u;
static const char magic[8] = "calxrst", end_magic[8] = "calxend";

/* No member leaves a gap, so that no byte of the file is undefined. */
struct head {
    char magic[8];
    uint32_t byte_order, format;
    char version[32];
    uint64_t case_hash, blocks;
    uint32_t zero[3], crc; /* of what is before */
};

struct label {
    char name[32];
    uint64_t bytes;
    uint32_t crc;       /* of the data */
    uint32_t label_crc; /* of what is before */
};

struct tail {
    char magic[8];
    uint32_t zero, crc; /* of the whole file up to the tail */
};

_Static_assert(sizeof(struct head) == 80 && sizeof(struct label) == 48 && sizeof(struct tail) == 16,
               "no gaps, aligned");

static uint32_t crc(uint32_t start, const void *data, size_t bytes)
{
    return bytes ? (uint32_t)crc32_z(start, data, bytes) : start; /* zlib starts anew at a NULL */
}

static size_t padding(uint64_t bytes)
{
    return (size_t)(-bytes % ALIGNMENT);
}

/* ---- writing ---- */

/* Adds bytes to the file and to the checksum of the whole. */
static int put(struct calx_file *file, uint32_t *total, const void *data, size_t bytes,
               struct calx_error *e)
{
    *total = crc(*total, data, bytes);
    return calx_file_write(file, data, bytes, e);
}

static int put_head(struct calx_file *file, uint32_t *total, uint64_t case_hash, size_t count,
                    struct calx_error *e)
{
    struct head head = {.byte_order = byte_order,
                        .format = FORMAT,
                        .version = CALX_VERSION,
                        .case_hash = case_hash,
                        .blocks = count};
    memcpy(head.magic, magic, sizeof magic);
    head.crc = crc(0, &head, offsetof(struct head, crc));
    return put(file, total, &head, sizeof head, e);
}

static int put_block(struct calx_file *file, uint32_t *total, const struct calx_block *block,
                     struct calx_error *e)
{
    static const char zeros[ALIGNMENT];
    struct label label = {.bytes = block->bytes, .crc = crc(0, block->data, block->bytes)};
    memcpy(label.name, block->name, strnlen(block->name, sizeof label.name - 1));
    label.label_crc = crc(0, &label, offsetof(struct label, label_crc));
    CALX_TRY(put(file, total, &label, sizeof label, e));
    CALX_TRY(put(file, total, block->data, block->bytes, e));
    return put(file, total, zeros, padding(block->bytes), e);
}

static int put_all(struct calx_file *file, uint64_t case_hash, const struct calx_block *blocks,
                   size_t count, struct calx_error *e)
{
    uint32_t total = 0;
    CALX_TRY(put_head(file, &total, case_hash, count, e));
    for (size_t i = 0; i < count; i++)
        CALX_TRY(put_block(file, &total, &blocks[i], e));
    struct tail tail = {.crc = total};
    memcpy(tail.magic, end_magic, sizeof end_magic);
    return calx_file_write(file, &tail, sizeof tail, e);
}

int calx_restart_write(const char *path, uint64_t case_hash, const struct calx_block *blocks,
                       size_t count, struct calx_error *e)
{
    struct calx_file file;
    char *backup;
    if (asprintf(&backup, "%s.bak", path) < 0)
        return calx_error_set(e, CALX_ERROR_MEMORY, "out of memory before writing %s", path);
    int code = calx_file_create(&file, path, e);
    code = code ? code : put_all(&file, case_hash, blocks, count, e);
    if (!code) {
        unlink(backup);
        link(path, backup); /* a second name: `path` itself is never missing. Fails if there was no
                               file before, or no links */
        code = calx_file_commit(&file, e);
        unlink(backup); /* after a failure too: then `path` is still the file before */
    }
    free(backup);
    return code;
}

/* ---- reading ---- */

/* The file while it is checked. */
struct reader {
    const char *path;
    unsigned char *memory;
    size_t size, at;
};

static int bad(const struct reader *r, struct calx_error *e, const char *text)
{
    return calx_error_at(e, CALX_ERROR_INPUT, (struct calx_place){r->path, 0}, "%s", text);
}

static int cut_short(const struct reader *r, struct calx_error *e)
{
    return calx_error_at(e, CALX_ERROR_INPUT, (struct calx_place){r->path, 0},
                         "the restart file is cut short: it ends after %zu bytes", r->size);
}

/* Copies the next bytes into `part`. */
static int take(struct reader *r, void *part, size_t bytes, struct calx_error *e)
{
    if (r->size - r->at < bytes)
        return cut_short(r, e);
    memcpy(part, r->memory + r->at, bytes);
    r->at += bytes;
    return CALX_OK;
}

static int take_head(struct reader *r, uint64_t case_hash, struct head *head, struct calx_error *e)
{
    if (r->size < sizeof magic || memcmp(r->memory, magic, sizeof magic))
        return bad(r, e, "this is not a calx restart file");
    CALX_TRY(take(r, head, sizeof *head, e));
    if (head->byte_order == swapped_order)
        return bad(r, e, "the restart file was written on a machine of the other byte order");
    if (head->crc != crc(0, head, offsetof(struct head, crc)))
        return bad(r, e, "the restart file is damaged: wrong checksum of its head");
    struct calx_place place = {r->path, 0};
    if (head->format != FORMAT || strncmp(head->version, CALX_VERSION, sizeof head->version))
        return calx_error_at(e, CALX_ERROR_INPUT, place,
                             "the restart file is of another version: format %" PRIu32
                             " of calx %.31s, this is format %d of calx %s",
                             head->format, head->version, FORMAT, CALX_VERSION);
    if (head->case_hash != case_hash)
        return calx_error_at(
            e, CALX_ERROR_INPUT, place,
            "the restart file is of another case, or the case was changed since (%016" PRIx64
            ", this case is %016" PRIx64 ")",
            head->case_hash, case_hash);
    return CALX_OK;
}

static int take_block(struct reader *r, struct calx_block *block, struct calx_error *e)
{
    struct label label;
    CALX_TRY(take(r, &label, sizeof label, e));
    if (label.label_crc != crc(0, &label, offsetof(struct label, label_crc)) ||
        label.name[sizeof label.name - 1])
        return bad(r, e, "the restart file is damaged: wrong checksum between two blocks");
    if (r->size - r->at < label.bytes || r->size - r->at - label.bytes < padding(label.bytes))
        return cut_short(r, e);
    block->data = r->memory + r->at;
    block->bytes = (size_t)label.bytes;
    memcpy(block->name, label.name, sizeof block->name);
    if (label.crc != crc(0, block->data, block->bytes))
        return calx_error_at(e, CALX_ERROR_INPUT, (struct calx_place){r->path, 0},
                             "the restart file is damaged: wrong checksum of the block '%s'",
                             label.name);
    r->at += block->bytes + padding(label.bytes);
    return CALX_OK;
}

static int take_tail(struct reader *r, struct calx_error *e)
{
    uint32_t total = crc(0, r->memory, r->at);
    struct tail tail;
    CALX_TRY(take(r, &tail, sizeof tail, e));
    if (memcmp(tail.magic, end_magic, sizeof end_magic) || tail.zero || tail.crc != total)
        return bad(r, e, "the restart file is damaged: wrong checksum of the whole");
    return r->at == r->size ? CALX_OK
                            : bad(r, e, "the restart file is damaged: bytes follow its end");
}

static int take_all(struct reader *r, uint64_t case_hash, struct calx_restart *out,
                    struct calx_error *e)
{
    struct head head;
    CALX_TRY(take_head(r, case_hash, &head, e));
    if (head.blocks > (r->size - r->at) / sizeof(struct label)) /* also bounds the allocation */
        return cut_short(r, e);
    out->count = (size_t)head.blocks;
    out->blocks = calloc(out->count + 1, sizeof *out->blocks);
    if (!out->blocks)
        return calx_error_set(e, CALX_ERROR_MEMORY, "out of memory while reading %s", r->path);
    for (size_t i = 0; i < out->count; i++)
        CALX_TRY(take_block(r, &out->blocks[i], e));
    return take_tail(r, e);
}

static int fail(const struct reader *r, struct calx_error *e)
{
    return calx_error_set(e, CALX_ERROR_IO, "cannot read %s: %s", r->path, strerror(errno));
}

/* Reads the stream to its end into r->memory. */
static int load(struct reader *r, FILE *stream, struct calx_error *e)
{
    struct stat status;
    if (fstat(fileno(stream), &status))
        return fail(r, e);
    if (!S_ISREG(status.st_mode))
        return bad(r, e, "this is not a calx restart file");
    r->size = (size_t)status.st_size;
    r->memory = malloc(r->size + 1);
    if (!r->memory)
        return calx_error_set(e, CALX_ERROR_MEMORY, "out of memory while reading %s (%zu bytes)",
                              r->path, r->size);
    return fread(r->memory, 1, r->size, stream) == r->size ? CALX_OK : fail(r, e);
}

int calx_restart_read(const char *path, uint64_t case_hash, struct calx_restart *out,
                      struct calx_error *e)
{
    *out = (struct calx_restart){0};
    char *backup;
    if (asprintf(&backup, "%s.bak", path) < 0)
        return calx_error_set(e, CALX_ERROR_MEMORY, "out of memory while reading %s", path);
    struct reader r = {.path = access(path, F_OK) && !access(backup, F_OK) ? backup : path};
    FILE *stream = fopen(r.path, "rbe");
    int code;
    if (!stream && errno == ENOENT)
        code = bad(&r, e, "there is no restart file to resume from");
    else
        code = stream ? load(&r, stream, e) : fail(&r, e);
    if (stream)
        fclose(stream);
    out->memory = r.memory;
    code = code ? code : take_all(&r, case_hash, out, e);
    free(backup);
    if (code)
        calx_restart_clear(out);
    return code;
}

void calx_restart_clear(struct calx_restart *r)
{
    free(r->blocks);
    free(r->memory);
    *r = (struct calx_restart){0};
}

const struct calx_block *calx_restart_find(const struct calx_restart *r, const char *name)
{
    for (size_t i = 0; i < r->count; i++)
        if (!strcmp(r->blocks[i].name, name))
            return &r->blocks[i];
    return NULL;
}
