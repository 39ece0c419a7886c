/* Events: SMI_DeviceEvent and SMI_PortEvent with the codes of Table B.2, and the list of what is pending.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_master_internal.h"

/* EventQualifier (base standard): MODE, TYPE, SOURCE = port, INSTANCE = application. */
#define MODE_SHIFT 6
#define TYPE_SHIFT 4
#define SOURCE_PORT 0x08u
#define INSTANCE_APPLICATION 0x04u

/* Table B.2: offsets from 0xB000 (v1.1) or 0x2000 (IEC 61139-2). */
enum {
    EVENT_CRC = 0x00, EVENT_COUNTER = 0x01, EVENT_TIMEOUT = 0x02, EVENT_AUTHENTICITY = 0x03, EVENT_PORT = 0x04,
    EVENT_AUTHENT_CRC = 0x05, EVENT_PROT_PAR_CRC = 0x06, EVENT_WATCHDOG = 0x09,
    EVENT_OSSD_LOCKED = 0xF0 /* IEC 61139-2 only */
};

static uint16_t code_of(const struct fs_port *port, uint16_t offset)
{
    return (uint16_t)((port->master->setup.edition == FS_V1_1 ? 0xB000 : 0x2000) + offset);
}

static void forget(struct fs_port *port, uint16_t code)
{
    uint8_t kept = 0;
    for (uint8_t i = 0; i < port->diag_count; i++)
        if (port->diags[i].code != code)
            port->diags[kept++] = port->diags[i];
    port->diag_count = kept;
}

void fs_event(struct fs_port *port, uint8_t source, uint8_t qualifier, uint16_t code)
{
    const struct fs_environment *environment = &port->master->environment;
    uint8_t mode = qualifier >> MODE_SHIFT;
    if (mode == FS_APPEARS || mode == FS_DISAPPEARS)
        forget(port, code);
    if (mode == FS_APPEARS && port->diag_count < FS_DIAGS_MAX) {
        port->diags[port->diag_count].qualifier = qualifier;
        port->diags[port->diag_count++].code = code;
    }
    environment->event(environment->self, port->number, source, qualifier, code);
}

void fs_event_of_port(struct fs_port *port, uint8_t mode, uint8_t type, uint16_t code)
{
    uint8_t qualifier = (uint8_t)(mode << MODE_SHIFT | type << TYPE_SHIFT | SOURCE_PORT | INSTANCE_APPLICATION);
    fs_event(port, FS_OF_PORT, qualifier, code);
}

/* The SCL has run: a fault that has just come is told once. What the FS-Device reports it has told itself. */
void fs_event_of_scl(struct fs_port *port, uint8_t FAULTS_S_before)
{
    uint8_t faults = port->scl.faults, mild = port->master->setup.edition == FS_V1_1 ? FS_WARNING : FS_NOTIFICATION;
    if (FAULTS_S_before || !port->scl.FAULTS_S)
        return;
    if (faults & FS_FAULT_TIMEOUT)
        fs_event_of_port(port, FS_SINGLE_SHOT, FS_ERROR, code_of(port, EVENT_TIMEOUT));
    else if (faults & FS_FAULT_CRC)
        fs_event_of_port(port, FS_SINGLE_SHOT, mild, code_of(port, EVENT_CRC));
    else if (faults & FS_FAULT_COUNTER)
        fs_event_of_port(port, FS_SINGLE_SHOT, mild, code_of(port, EVENT_COUNTER));
}

/* A discrepancy beyond its time is pending while it lasts. */
void fs_event_of_ossde(struct fs_port *port, enum fs_ossde_state before)
{
    enum fs_ossde_state now = port->ossde.state;
    if (port->master->setup.edition == FS_V1_1 || (before == FS_OSSDE_BAD) == (now == FS_OSSDE_BAD))
        return;
    fs_event_of_port(port, now == FS_OSSDE_BAD ? FS_APPEARS : FS_DISAPPEARS, FS_ERROR,
                     code_of(port, EVENT_OSSD_LOCKED));
}

/* The SCL does not start: all that deviates is pending until the next configuration. */
void fs_event_of_deviations(struct fs_port *port, unsigned deviations)
{
    static const struct {
        unsigned deviation;
        uint16_t offset;
    } table[] = {
        {FS_DEV_AUTHENTICITY, EVENT_AUTHENTICITY}, {FS_DEV_PORT, EVENT_PORT},
        {FS_DEV_AUTHENT_CRC, EVENT_AUTHENT_CRC},   {FS_DEV_PROT_PAR_CRC, EVENT_PROT_PAR_CRC},
        {FS_DEV_WATCHDOG, EVENT_WATCHDOG},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (!(deviations & table[i].deviation))
            continue;
        if (table[i].offset == EVENT_PORT && port->master->setup.edition == FS_IEC2022)
            continue; /* 0x2004 is reserved */
        fs_event_of_port(port, FS_APPEARS, FS_ERROR, code_of(port, table[i].offset));
    }
}
