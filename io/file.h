/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Files that appear whole or not at all: written beside their name, then renamed. A program killed at any instant leaves the old file or the new one, never a part.
 */
#ifndef CALX_IO_FILE_H
#define CALX_IO_FILE_H

#include <stdio.h>

#include "core/error.h"

/* A file being written; owns its stream and names until committed or abandoned. */
struct calx_file {
    FILE *stream;
    char *path;
    char *temporary; /* path.tmp, in the same folder, so that rename() cannot cross file systems */
};

/* Starts writing path.tmp. CALX_ERROR_IO with the reason (folder missing, not writable), or
 * CALX_ERROR_MEMORY. */
int calx_file_create(struct calx_file *, const char *path, struct calx_error *);

/* Adds bytes. CALX_ERROR_IO with the reason (disk full); the file is then abandoned and nothing is
 * left behind. */
int calx_file_write(struct calx_file *, const void *data, size_t bytes, struct calx_error *);

/* Writes what is buffered and gives the file its name. CALX_ERROR_IO, with the file abandoned. */
int calx_file_commit(struct calx_file *, struct calx_error *);

/* Removes what was written; the file that had the name before stays. Nothing happens after a
 * commit. */
void calx_file_abandon(struct calx_file *);

/* Brings everything written to the folder's file system to the disk: safe from a power cut from then
 * on. Where that cannot be done nothing happens. */
void calx_file_sync(const char *folder);

/* Makes the folder and those above it; one that exists is fine. CALX_ERROR_IO with the reason. */
int calx_file_create_folder(const char *path, struct calx_error *);

#endif
