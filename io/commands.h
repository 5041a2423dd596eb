/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The subcommands of the program, one file each.
 */
#ifndef CALX_IO_COMMANDS_H
#define CALX_IO_COMMANDS_H

#include "io/options.h"

extern const struct calx_command calx_command_run, calx_command_check, calx_command_verify,
    calx_command_bench, calx_command_plugins, calx_command_report, calx_command_schema;

#endif
