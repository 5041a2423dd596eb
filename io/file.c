/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Files that appear whole or not at all. Input: bytes; output: a file under its final name. Method:
 * write beside the name, rename (atomic in POSIX, IEEE Std 1003.1). That is safe against a kill at any
 * instant. Against a power cut all files of a folder are brought to the disk together, now and then:
 * an fsync for each of a dozen files per frame took three quarters of the time of a small run.
 */
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void clear(struct calx_file *f)
{
    free(f->path);
    free(f->temporary);
    *f = (struct calx_file){0};
}

void calx_file_abandon(struct calx_file *f)
{
    if (f->stream) {
        fclose(f->stream);
        unlink(f->temporary);
    }
    clear(f);
}

static int fail(struct calx_file *f, const char *what, struct calx_error *e)
{
    int code = calx_error_set(e, CALX_ERROR_IO, "cannot %s %s: %s", what, f->path, strerror(errno));
    calx_file_abandon(f);
    return code;
}

int calx_file_create(struct calx_file *f, const char *path, struct calx_error *e)
{
    *f = (struct calx_file){.path = strdup(path)};
    if (!f->path || asprintf(&f->temporary, "%s.tmp", path) < 0) {
        f->temporary = NULL; /* its content is undefined after a failed asprintf */
        clear(f);
        return calx_error_set(e, CALX_ERROR_MEMORY, "out of memory before writing %s", path);
    }
    f->stream = fopen(f->temporary, "wbe");
    return f->stream ? CALX_OK : fail(f, "write", e);
}

int calx_file_write(struct calx_file *f, const void *data, size_t bytes, struct calx_error *e)
{
    if (bytes && fwrite(data, 1, bytes, f->stream) != bytes)
        return fail(f, "write", e);
    return CALX_OK;
}

int calx_file_commit(struct calx_file *f, struct calx_error *e)
{
    if (fflush(f->stream))
        return fail(f, "write", e);
    if (rename(f->temporary, f->path))
        return fail(f, "rename the new file to", e);
    fclose(f->stream); /* nothing is left to flush */
    clear(f);
    return CALX_OK;
}

void calx_file_sync(const char *folder)
{
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd >= 0) {
        syncfs(fd);
        close(fd);
    }
}

/* mkdir() of every prefix that ends before a slash, then of the whole. */
int calx_file_create_folder(const char *path, struct calx_error *e)
{
    char *prefix = strdup(path);
    if (!prefix)
        return calx_error_set(e, CALX_ERROR_MEMORY, "out of memory before making the folder %s",
                              path);
    for (char *slash = strchr(prefix + (*prefix == '/'), '/'); slash;
         slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(prefix, 0777); /* what matters is whether the last one succeeds */
        *slash = '/';
    }
    struct stat status;
    int failed = mkdir(prefix, 0777) && errno != EEXIST;
    int reason = errno;
    free(prefix);
    if (!failed && (stat(path, &status) || !S_ISDIR(status.st_mode))) {
        failed = 1;
        reason = ENOTDIR;
    }
    if (failed)
        return calx_error_set(e, CALX_ERROR_IO, "cannot make the folder %s: %s", path,
                              strerror(reason));
    return CALX_OK;
}
