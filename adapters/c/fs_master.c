/* The FS-Master as a whole: power-on, time, and what the owner tells it, port by port.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_master.h"

#include <string.h>

#include "fs_master_internal.h"

static void init_port(struct fs_master *master, uint8_t number)
{
    struct fs_port *port = fs_port_of(master, number);
    port->master = master;
    port->number = number;
    port->due = port->given_up = port->off_since = port->pulse_since = FS_NEVER;
    fs_scl_stop(&port->scl);
    fs_ossde_stop(&port->ossde);
    fs_gateway_publish(port);
}

void fs_master_init(struct fs_master *master, const struct fs_setup *setup, const struct fs_environment *environment,
                    uint64_t now)
{
    memset(master, 0, sizeof *master);
    master->setup = *setup;
    master->environment = *environment;
    master->now = now;
    for (uint8_t number = 1; number <= FS_PORTS; number++)
        init_port(master, number);
}

uint64_t fs_master_due(const struct fs_master *master)
{
    uint64_t due = FS_NEVER;
    for (size_t i = 0; i < FS_PORTS; i++)
        if (fs_port_due(&master->ports[i]) < due)
            due = fs_port_due(&master->ports[i]);
    return due;
}

void fs_master_run(struct fs_master *master, uint64_t now)
{
    uint64_t due;
    while ((due = fs_master_due(master)) <= now) {
        if (due > master->now)
            master->now = due;
        for (size_t i = 0; i < FS_PORTS; i++)
            if (fs_port_due(&master->ports[i]) <= master->now)
                fs_port_run(&master->ports[i]);
    }
    master->now = now;
}

void fs_master_event(struct fs_master *master, uint8_t number, uint8_t qualifier, uint16_t code)
{
    struct fs_port *port = fs_port_of(master, number);
    if (port->mode == FS_PREOPERATE || port->mode == FS_OPERATE)
        fs_event(port, FS_OF_DEVICE, qualifier, code);
}

void fs_master_authenticity(struct fs_master *master, uint32_t a_code, uint32_t extended)
{
    master->authenticity[0] = a_code;
    master->authenticity[1] = extended;
}

void fs_master_input(struct fs_master *master, uint8_t number, uint8_t input, uint8_t value)
{
    struct fs_port *port = fs_port_of(master, number);
    if (input == FS_setSD_C) {
        port->scl.setSD_C = value;
        return;
    }
    if (value && !port->scl.ChFAck_C) /* AckQ of an OSSDe port acts by its edge alone */
        fs_ossde_acknowledge(&port->ossde);
    port->scl.ChFAck_C = value;
    fs_gateway_publish(port);
}
