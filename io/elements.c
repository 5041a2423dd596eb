/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Finds rows in the tables of elements and attributes.
 */
#include "io/elements.h"

#include <string.h>

const struct calx_attribute *calx_element_attribute(const struct calx_element *element,
                                                    const char *name)
{
    for (size_t k = 0; k < element->attribute_count; k++)
        if (strcmp(element->attributes[k].name, name) == 0)
            return &element->attributes[k];
    return NULL;
}

const struct calx_child *calx_element_child(const struct calx_element *element, const char *name)
{
    for (size_t k = 0; k < element->child_count; k++)
        if (strcmp(element->children[k].element->name, name) == 0)
            return &element->children[k];
    return NULL;
}

static size_t add_to_list(const struct calx_element *element, const struct calx_element **list,
                          size_t count, size_t max)
{
    for (size_t k = 0; k < count; k++)
        if (list[k] == element)
            return count;
    if (count == max)
        return count;
    list[count++] = element;
    for (size_t k = 0; k < element->child_count; k++)
        count = add_to_list(element->children[k].element, list, count, max);
    return count;
}

size_t calx_elements_list(const struct calx_element **list, size_t max)
{
    return add_to_list(calx_elements_root(), list, 0, max);
}
