/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Finds plugins as <folder>/<kind>-<name>.so, opens them with dlopen, checks prefix, kind, name and
 * table, and keeps them until the registry is freed. Folders: those of the caller, of
 * $CALX_PLUGINS, and the first that exists of the program's own. Each failure has a message of its
 * own; what makes a descriptor valid is in loader_check.c.
 */
#include "core/loader.h"

#include <dirent.h>
#include <dlfcn.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/loader_check.h"

#ifndef CALX_PLUGIN_DIR
#define CALX_PLUGIN_DIR "/usr/local/lib/calx/plugins"
#endif

/* By enum calx_kind; the second word is that of a case file. */
static const struct {
    const char *prefix, *name;
} kinds[] = {
    [0] = {"", "unknown kind"},
    [CALX_CONTACT] = {"contact", "contact"},
    [CALX_CONDUCTANCE] = {"conductance", "conductance"},
    [CALX_MOTION] = {"motion", "integrator (motion)"},
    [CALX_TEMPERATURE] = {"temperature", "integrator (temperature)"},
};

struct loaded {
    char *path;
    void *handle;
    const struct calx_plugin *plugin;
};

struct calx_registry {
    size_t folder_count, loaded_count;
    char **folders;
    struct loaded *loaded;
};

const char *calx_kind_name(enum calx_kind kind)
{
    return kinds[kind <= CALX_TEMPERATURE ? kind : 0].name;
}

/* ---- folders ---- */

static bool is_folder(const char *path)
{
    struct stat s;
    return stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

static int registry_add_folder(struct calx_registry *r, const char *folder, size_t length)
{
    for (size_t k = 0; k < r->folder_count; k++)
        if (strlen(r->folders[k]) == length && strncmp(r->folders[k], folder, length) == 0)
            return 0;
    char **folders = realloc(r->folders, (r->folder_count + 1) * sizeof *folders);
    if (!folders)
        return CALX_ERROR_MEMORY;
    r->folders = folders;
    char *copy = strndup(folder, length);
    if (!copy)
        return CALX_ERROR_MEMORY;
    r->folders[r->folder_count++] = copy;
    return 0;
}

static int registry_add_list(struct calx_registry *r, const char *list)
{
    for (const char *p = list; p && *p;) {
        size_t length = strcspn(p, ":");
        if (length > 0)
            CALX_TRY(registry_add_folder(r, p, length));
        p += length + (p[length] == ':');
    }
    return 0;
}

/* Only the first that exists: an installed calx must not clash with the one that is being built. */
static int registry_add_own(struct calx_registry *r)
{
    static const char *const places[] = {"/plugins", "/../plugins", "/../lib/calx/plugins"};
    char program[PATH_MAX], folder[PATH_MAX + 32];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = 0;
    char *slash = strrchr(program, '/');
    for (size_t k = 0; slash && k < sizeof places / sizeof *places; k++) {
        snprintf(folder, sizeof folder, "%.*s%s", (int)(slash - program), program, places[k]);
        if (is_folder(folder))
            return registry_add_folder(r, folder, strlen(folder));
    }
    return registry_add_folder(r, CALX_PLUGIN_DIR, strlen(CALX_PLUGIN_DIR));
}

struct calx_registry *calx_registry_create(const char *paths)
{
    struct calx_registry *r = calloc(1, sizeof *r);
    if (!r || registry_add_list(r, paths) || registry_add_list(r, getenv("CALX_PLUGINS")) ||
        registry_add_own(r)) {
        calx_registry_free(r);
        return NULL;
    }
    return r;
}

void calx_registry_free(struct calx_registry *r)
{
    if (!r)
        return;
    for (size_t k = r->loaded_count; k-- > 0;) {
        free(r->loaded[k].path);
        dlclose(r->loaded[k].handle);
    }
    for (size_t k = 0; k < r->folder_count; k++)
        free(r->folders[k]);
    free(r->loaded);
    free(r->folders);
    free(r);
}

/* The kind and the name in <kind>-<name>.so; false for other files. */
static bool file_is_plugin(const char *file, enum calx_kind *kind, char *name, size_t name_size)
{
    size_t length = strlen(file);
    if (length < 4 || strcmp(file + length - 3, ".so") != 0)
        return false;
    for (int k = CALX_CONTACT; k <= CALX_TEMPERATURE; k++) {
        size_t prefix = strlen(kinds[k].prefix);
        if (strncmp(file, kinds[k].prefix, prefix) != 0 || file[prefix] != '-' ||
            length < prefix + 5)
            continue;
        *kind = (enum calx_kind)k;
        snprintf(name, name_size, "%.*s", (int)(length - prefix - 4), file + prefix + 1);
        return true;
    }
    return false;
}

/* Equal byte for byte, or the same file. A file that cannot be read differs from every other. */
static bool file_equals(const char *a, const char *b)
{
    struct stat sa, sb;
    if (stat(a, &sa) || stat(b, &sb) || sa.st_size != sb.st_size)
        return false;
    if (sa.st_dev == sb.st_dev && sa.st_ino == sb.st_ino)
        return true;
    FILE *fa = fopen(a, "rb"), *fb = fopen(b, "rb");
    bool equal = fa && fb;
    char ba[4096], bb[4096];
    for (size_t got = 1; equal && got > 0;) {
        got = fread(ba, 1, sizeof ba, fa);
        equal = fread(bb, 1, sizeof bb, fb) == got && memcmp(ba, bb, got) == 0;
    }
    if (fa)
        fclose(fa);
    if (fb)
        fclose(fb);
    return equal;
}

static int set_duplicate(struct calx_error *error, enum calx_kind kind, const char *name,
                         const char *a, const char *b)
{
    return calx_error_set(
        error, CALX_ERROR_INPUT,
        "two different plugins are called %s \"%s\": %s and %s; remove one of them",
        calx_kind_name(kind), name, a, b);
}

static int plugin_open(const char *path, void **handle, const struct calx_plugin **plugin,
                       struct calx_error *error)
{
    /* a name without a slash would be looked for in the system's folders */
    char local[PATH_MAX];
    snprintf(local, sizeof local, "%s%s", strchr(path, '/') ? "" : "./", path);
    *handle = dlopen(local, RTLD_NOW | RTLD_LOCAL);
    if (!*handle)
        return calx_error_set(error, CALX_ERROR_INPUT, "cannot load the plugin %s: %s", path,
                              dlerror());
    *plugin = dlsym(*handle, CALX_PLUGIN_SYMBOL);
    int code = calx_loader_check(path, *plugin, error);
    if (code)
        dlclose(*handle);
    return code;
}

static int check_identity(const struct calx_plugin *p, enum calx_kind kind, const char *name,
                          const char *path, struct calx_error *error)
{
    if (p->kind != kind)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "the plugin %s is of the wrong kind: %s, expected %s", path,
                              calx_kind_name((enum calx_kind)p->kind), calx_kind_name(kind));
    if (strcmp(p->name, name) != 0)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "the plugin %s calls itself \"%s\": rename it to %s-%s.so", path,
                              p->name, kinds[kind].prefix, p->name);
    return 0;
}

/* name: what the file must hold, with `kind`, or NULL for anything. */
static const struct calx_plugin *registry_load(struct calx_registry *r, const char *path,
                                               enum calx_kind kind, const char *name,
                                               struct calx_error *error)
{
    void *handle;
    const struct calx_plugin *plugin;
    if (plugin_open(path, &handle, &plugin, error))
        return NULL;
    if (name && check_identity(plugin, kind, name, path, error)) {
        dlclose(handle);
        return NULL;
    }
    for (size_t k = 0; k < r->loaded_count; k++) {
        const struct loaded *l = &r->loaded[k];
        if (l->plugin->kind != plugin->kind || strcmp(l->plugin->name, plugin->name) != 0)
            continue;
        const struct calx_plugin *same = file_equals(l->path, path) ? l->plugin : NULL;
        if (!same)
            set_duplicate(error, (enum calx_kind)plugin->kind, plugin->name, l->path, path);
        dlclose(handle);
        return same;
    }
    struct loaded *grown = realloc(r->loaded, (r->loaded_count + 1) * sizeof *grown);
    char *copy = strdup(path);
    if (grown)
        r->loaded = grown;
    if (!grown || !copy) {
        free(copy);
        dlclose(handle);
        calx_error_set(error, CALX_ERROR_MEMORY, "no memory for the plugin %s", path);
        return NULL;
    }
    r->loaded[r->loaded_count++] = (struct loaded){copy, handle, plugin};
    return plugin;
}

const struct calx_plugin *calx_registry_load(struct calx_registry *r, const char *path,
                                             struct calx_error *error)
{
    return registry_load(r, path, CALX_CONTACT, NULL, error);
}

/* ---- by name ---- */

/* Calls visit(context, path, kind, name) for each file of a folder that is named as a plugin, in
 * order of name. */
static void folder_visit(const char *folder,
                         void (*visit)(void *, const char *, enum calx_kind, const char *),
                         void *context)
{
    struct dirent **files;
    int count = scandir(folder, &files, NULL, alphasort);
    for (int k = 0; k < count; k++) {
        enum calx_kind kind;
        char name[NAME_MAX + 1], path[PATH_MAX];
        if (file_is_plugin(files[k]->d_name, &kind, name, sizeof name) &&
            snprintf(path, sizeof path, "%s/%s", folder, files[k]->d_name) < (int)sizeof path)
            visit(context, path, kind, name);
        free(files[k]);
    }
    if (count >= 0)
        free(files);
}

enum { NAMES_MAX = 256 };
struct names {
    enum calx_kind kind;
    size_t count;
    char *at[NAMES_MAX];
};

static void names_visit(void *context, const char *path, enum calx_kind kind, const char *name)
{
    struct names *names = context;
    (void)path;
    if (kind != names->kind || names->count == NAMES_MAX)
        return;
    for (size_t k = 0; k < names->count; k++)
        if (strcmp(names->at[k], name) == 0)
            return;
    char *copy = strdup(name);
    if (copy)
        names->at[names->count++] = copy;
}

static void print_not_found(FILE *out, const struct calx_registry *r, enum calx_kind kind,
                            const char *name, const struct names *names)
{
    const char *nearest = calx_error_nearest(name, (const char *const *)names->at, names->count);
    fprintf(out, "no plugin \"%s\" of kind %s; ", name, calx_kind_name(kind));
    if (nearest)
        fprintf(out, "did you mean \"%s\"? ", nearest);
    fprintf(out, "there %s", names->count ? "are: " : "is none");
    for (size_t k = 0; k < names->count; k++)
        fprintf(out, "%s%s", k ? ", " : "", names->at[k]);
    fprintf(out, " (looked for %s-%s.so in ", kinds[kind].prefix, name);
    for (size_t k = 0; k < r->folder_count; k++)
        fprintf(out, "%s%s", k ? ", " : "", r->folders[k]);
    fprintf(out, ")");
}

static int set_not_found(const struct calx_registry *r, enum calx_kind kind, const char *name,
                         struct calx_error *error)
{
    struct names names = {.kind = kind};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return calx_error_set(error, CALX_ERROR_MEMORY, "no memory for an error message");
    for (size_t k = 0; k < r->folder_count; k++)
        folder_visit(r->folders[k], names_visit, &names);
    print_not_found(out, r, kind, name, &names);
    fclose(out);
    calx_error_set(error, CALX_ERROR_INPUT, "%s", text);
    free(text);
    for (size_t k = 0; k < names.count; k++)
        free(names.at[k]);
    return CALX_ERROR_INPUT;
}

/* The path of <kind>-<name>.so; it must be the same file wherever it stands. */
static int registry_locate(const struct calx_registry *r, enum calx_kind kind, const char *name,
                           char path[PATH_MAX], struct calx_error *error)
{
    char other[PATH_MAX];
    path[0] = 0;
    for (size_t k = 0; k < r->folder_count && !strchr(name, '/'); k++) {
        char *to = path[0] ? other : path;
        int n = snprintf(to, PATH_MAX, "%s/%s-%s.so", r->folders[k], kinds[kind].prefix, name);
        if (n >= PATH_MAX || access(to, F_OK) != 0)
            to[0] = 0;
        else if (to == other && !file_equals(path, other))
            return set_duplicate(error, kind, name, path, other);
    }
    return path[0] ? 0 : set_not_found(r, kind, name, error);
}

const struct calx_plugin *calx_registry_find(struct calx_registry *r, enum calx_kind kind,
                                             const char *name, struct calx_error *error)
{
    name = name ? name : "";
    for (size_t k = 0; k < r->loaded_count; k++)
        if (r->loaded[k].plugin->kind == kind && strcmp(r->loaded[k].plugin->name, name) == 0)
            return r->loaded[k].plugin;
    char path[PATH_MAX];
    if (registry_locate(r, kind, name, path, error))
        return NULL;
    return registry_load(r, path, kind, name, error);
}

struct load_all {
    struct calx_registry *registry;
    FILE *problems;
};

static void load_visit(void *context, const char *path, enum calx_kind kind, const char *name)
{
    struct load_all *all = context;
    struct calx_error error = {0};
    if (!registry_load(all->registry, path, kind, name, &error) && all->problems)
        fprintf(all->problems, "%s\n", error.text);
}

size_t calx_registry_load_all(struct calx_registry *r, FILE *problems)
{
    struct load_all all = {r, problems};
    for (size_t k = 0; k < r->folder_count; k++)
        folder_visit(r->folders[k], load_visit, &all);
    return r->loaded_count;
}

size_t calx_registry_count(const struct calx_registry *r)
{
    return r->loaded_count;
}

const struct calx_plugin *calx_registry_at(const struct calx_registry *r, size_t k)
{
    return k < r->loaded_count ? r->loaded[k].plugin : NULL;
}

const char *calx_registry_path(const struct calx_registry *r, const struct calx_plugin *plugin)
{
    for (size_t k = 0; k < r->loaded_count; k++)
        if (r->loaded[k].plugin == plugin)
            return r->loaded[k].path;
    return NULL;
}
