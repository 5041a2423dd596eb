/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A reader of .vtu and .pvd files for the tests, written from VTK's description of the format,
 * independent of io/vtk.c: the XML before the appended data goes through libxml2, the blocks
 * through zlib.
 */
#ifndef CALX_TESTS_VTU_H
#define CALX_TESTS_VTU_H

#include <check.h>
#include <libxml/parser.h>
#include <libxml/xpath.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define X(s) ((const xmlChar *)(s))

struct vtu {
    char *text;
    size_t size;
    const unsigned char *data; /* after the underscore */
    size_t data_size;
    xmlDoc *doc;
};

/* Bytes of a file with a zero after them; NULL if it cannot be read. */
static inline char *vtu_load(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    if (!f)
        return NULL;
    fseek(f, 0, SEEK_END);
    *size = (size_t)ftell(f);
    rewind(f);
    char *text = malloc(*size + 1);
    ck_assert_uint_eq(fread(text, 1, *size, f), *size);
    text[*size] = '\0';
    fclose(f);
    return text;
}

static inline struct vtu vtu_open(const char *path)
{
    struct vtu v = {0};
    v.text = vtu_load(path, &v.size);
    ck_assert_msg(v.text != NULL, "cannot read %s", path);
    static const char tag[] = "<AppendedData encoding=\"raw\">", end[] = "</AppendedData>";
    char *appended = memmem(v.text, v.size, tag, sizeof tag - 1);
    ck_assert_msg(appended != NULL, "no appended data in %s", path);
    char *mark = appended + sizeof tag - 1;
    mark += strspn(mark, " \n");
    ck_assert_msg(*mark == '_', "no underscore before the data of %s", path);
    /* one whole piece of 4096 bytes, wherever pieces begin, must be white space: see write_gap() in io/vtk.c */
    ck_assert_int_ge(mark - appended, 2 * 4096 - 1);
    v.data = (unsigned char *)mark + 1;
    char *stop = NULL; /* the last closing tag: the data may contain anything */
    for (char *p = appended; (p = memmem(p, v.size - (size_t)(p - v.text), end, sizeof end - 1));
         p++)
        stop = p;
    ck_assert_msg(stop && strstr(stop, "</VTKFile>"), "%s does not end", path);
    v.data_size = (size_t)((unsigned char *)stop - v.data);
    size_t head = (size_t)(appended - v.text);
    char *xml = malloc(head + 16);
    memcpy(xml, v.text, head);
    strcpy(xml + head, "</VTKFile>");
    v.doc = xmlReadMemory(xml, (int)strlen(xml), path, NULL, XML_PARSE_NONET);
    free(xml);
    ck_assert_msg(v.doc != NULL, "the XML of %s is not well-formed", path);
    return v;
}

static inline void vtu_close(struct vtu *v)
{
    xmlFreeDoc(v->doc);
    free(v->text);
}

/* The number of nodes, and into `value` (may be NULL) the text of the first. */
static inline size_t vtu_query(xmlDoc *doc, char *value, size_t value_size, const char *path)
{
    xmlXPathContext *context = xmlXPathNewContext(doc);
    xmlXPathObject *found = xmlXPathEvalExpression(X(path), context);
    ck_assert_ptr_nonnull(found);
    size_t n = found->nodesetval ? (size_t)found->nodesetval->nodeNr : 0;
    if (n && value) {
        xmlChar *text = xmlNodeGetContent(found->nodesetval->nodeTab[0]);
        snprintf(value, value_size, "%s", (char *)text);
        xmlFree(text);
    }
    xmlXPathFreeObject(found);
    xmlXPathFreeContext(context);
    return n;
}

static inline uint64_t vtu_word(const unsigned char *p)
{
    uint64_t word;
    memcpy(&word, p, sizeof word);
    return word;
}

/* The bytes at `offset` of the appended data. The caller frees them. */
static inline unsigned char *vtu_decode(const struct vtu *v, size_t offset, size_t *bytes)
{
    const unsigned char *p = v->data + offset;
    ck_assert_uint_le(offset + 8, v->data_size);
    if (!vtu_query(v->doc, NULL, 0, "/VTKFile/@compressor")) {
        *bytes = (size_t)vtu_word(p);
        ck_assert_uint_le(offset + 8 + *bytes, v->data_size);
        unsigned char *raw = malloc(*bytes + 1);
        memcpy(raw, p + 8, *bytes);
        return raw;
    }
    uint64_t blocks = vtu_word(p), block = vtu_word(p + 8), rest = vtu_word(p + 16);
    *bytes = (size_t)(blocks ? (blocks - (rest > 0)) * block + rest : 0);
    unsigned char *out = malloc(*bytes + 1);
    const unsigned char *packed = p + 24 + 8 * blocks;
    for (uint64_t b = 0, at = 0; b < blocks; b++) {
        uint64_t expected = b + 1 == blocks && rest ? rest : block,
                 length = vtu_word(p + 24 + 8 * b);
        uLongf n = (uLongf)expected;
        ck_assert_uint_le((size_t)(packed - v->data) + length, v->data_size);
        ck_assert_int_eq(uncompress(out + at, &n, packed, (uLong)length), Z_OK);
        ck_assert_uint_eq(n, expected);
        at += expected;
        packed += length;
    }
    return out;
}

/* The array of that section and name, its type, components and number of values; NULL if it is not
 * there. */
static inline unsigned char *vtu_array(const struct vtu *v, const char *section, const char *name,
                                       char type[16], size_t *components, size_t *bytes)
{
    char path[256], text[32];
    snprintf(path, sizeof path, "//Piece/%s/DataArray[@Name='%s']/@type", section, name);
    if (!vtu_query(v->doc, type, 16, path))
        return NULL;
    snprintf(path, sizeof path, "//Piece/%s/DataArray[@Name='%s']/@NumberOfComponents", section,
             name);
    ck_assert_uint_eq(vtu_query(v->doc, text, sizeof text, path), 1);
    *components = strtoul(text, NULL, 10);
    snprintf(path, sizeof path, "//Piece/%s/DataArray[@Name='%s']/@offset", section, name);
    ck_assert_uint_eq(vtu_query(v->doc, text, sizeof text, path), 1);
    return vtu_decode(v, strtoul(text, NULL, 10), bytes);
}

#endif
