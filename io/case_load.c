/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Loads an XML file that may be hostile. Method: the file is read here, with a bound on its size,
 * and parsed from memory by libxml2 without network, document types (hence without entities,
 * internal or external) and XInclude, within libxml2's bounds on depth and length of names and
 * texts.
 */
#include "io/case_load.h"

#include <errno.h>
#include <libxml/SAX2.h>
#include <libxml/parser.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define LARGEST_FILE (64 << 20)

struct load {
    const char *file;
    struct calx_problems *problems;
};

static void fail(const struct load *load, int line, const char *text)
{
    size_t length = strcspn(text, "\n");
    calx_problems_add(load->problems, (struct calx_place){load->file, line}, "%.*s", (int)length,
                      text);
}

/* ---- the file
 * ------------------------------------------------------------------------------------------ */

static char *read_stream(const struct load *load, FILE *stream, size_t size)
{
    char *text = malloc(size + 1);
    if (!text) {
        fail(load, 0, "no memory");
        return NULL;
    }
    if (fread(text, 1, size, stream) != size) {
        fail(load, 0, "the file changed while it was read");
        free(text);
        return NULL;
    }
    text[size] = '\0';
    return text;
}

static bool is_readable(const struct load *load, FILE *stream, size_t *size)
{
    struct stat status;
    if (!stream || fstat(fileno(stream), &status)) {
        fail(load, 0, strerror(errno));
        return false;
    }
    *size = (size_t)status.st_size;
    if (!S_ISREG(status.st_mode))
        fail(load, 0, "is not a file");
    else if (*size == 0)
        fail(load, 0, "the file is empty");
    else if (*size > LARGEST_FILE)
        fail(load, 0, "the file is larger than 64 MB");
    else
        return true;
    return false;
}

static bool is_text(const struct load *load, const char *text, size_t size)
{
    const char *zero = memchr(text, '\0', size);
    int line = 1;
    if (!zero)
        return true;
    for (const char *c = text; c < zero; c++)
        line += *c == '\n';
    fail(load, line, "a zero byte: the file is not UTF-8 text");
    return false;
}

/* ---- XML
 * -----------------------------------------------------------------------------------------------
 */

static void refuse_document_type(void *context, const xmlChar *name, const xmlChar *external,
                                 const xmlChar *system)
{
    xmlParserCtxt *parser = context;
    (void)name, (void)external, (void)system;
    fail(parser->_private, parser->input ? parser->input->line : 0,
         "a document type (<!DOCTYPE>) is not allowed here, remove it");
    xmlStopParser(parser);
}

/* libxml2 notes the line where a start tag ends; people look where it begins. Inside a tag there is
 * no other '<'. */
static void start_element(void *context, const xmlChar *name, const xmlChar *prefix,
                          const xmlChar *uri, int namespaces, const xmlChar **namespace,
                          int attributes, int defaulted, const xmlChar **attribute)
{
    xmlParserCtxt *parser = context;
    unsigned short lines = 0;
    xmlSAX2StartElementNs(context, name, prefix, uri, namespaces, namespace, attributes, defaulted,
                          attribute);
    const xmlChar *c = parser->input->cur;
    while (c > parser->input->base && *c != '<')
        lines = (unsigned short)(lines + (*--c == '\n'));
    if (*c == '<' && parser->node && parser->node->line > lines && parser->node->line < USHRT_MAX)
        parser->node->line = (unsigned short)(parser->node->line - lines);
}

/* Only the first error counts: the others follow from it. */
static void note_error(void *context, xmlError *error)
{
    xmlParserCtxt *parser = context;
    const struct load *load = parser->_private;
    char text[512];
    if (load->problems->count || error->level < XML_ERR_ERROR)
        return;
    snprintf(text, sizeof text, "XML: %s", error->message ? error->message : "not well-formed");
    fail(load, error->line, text);
}

static xmlDoc *parse(struct load *load, const char *text, size_t size)
{
    xmlParserCtxt *parser = xmlNewParserCtxt();
    if (!parser) {
        fail(load, 0, "no memory");
        return NULL;
    }
    parser->_private = load;
    parser->sax->internalSubset = refuse_document_type;
    parser->sax->startElementNs = start_element;
    parser->sax->serror = (xmlStructuredErrorFunc)note_error;
    xmlDoc *document = xmlCtxtReadMemory(parser, text, (int)size, load->file, NULL,
                                         XML_PARSE_NONET | XML_PARSE_NOCDATA | XML_PARSE_BIG_LINES |
                                             XML_PARSE_NOERROR | XML_PARSE_NOWARNING);
    xmlFreeParserCtxt(parser);
    if (!document && !load->problems->count)
        fail(load, 0, "XML: not well-formed");
    if (document && load->problems->count) { /* libxml2 keeps what came before some errors */
        xmlFreeDoc(document);
        document = NULL;
    }
    return document;
}

xmlDoc *calx_case_load(const char *file, struct calx_problems *problems)
{
    struct load load = {file, problems};
    size_t size = 0;
    FILE *stream = fopen(file, "rb");
    char *text = is_readable(&load, stream, &size) ? read_stream(&load, stream, size) : NULL;
    xmlDoc *document = text && is_text(&load, text, size) ? parse(&load, text, size) : NULL;
    free(text);
    if (stream)
        fclose(stream);
    return document;
}
