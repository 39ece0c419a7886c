/* FSPortStatusList of both editions (v1.1 Table 23, IEC 61139-2 Table 22).
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_master_internal.h"

/* PortStatusInfo */
enum {
    NO_DEVICE = 0, DEACTIVATED = 1, PORT_DIAG = 2, PREOPERATE = 3, OPERATE = 4, DI_CQ = 5, DO_CQ = 6, OSSDE = 7,
    SCL_ENABLED = 8, PORT_POWER_OFF = 254, NOT_AVAILABLE = 255
};

/* PortQualityInfo: 1 = invalid */
#define PDIN_INVALID 0x01u
#define PDOUT_INVALID 0x02u

static uint8_t port_status_info(const struct fs_port *port)
{
    int v1_1 = port->master->setup.edition == FS_V1_1;
    switch (port->state) {
    case FS_PORT_OFF:
        return DEACTIVATED;
    case FS_PORT_POWER_OFF:
    case FS_PORT_DOWN:
        return port->switched_off && !v1_1 ? PORT_POWER_OFF : NO_DEVICE;
    case FS_PORT_STARTUP:
        return NOT_AVAILABLE;
    case FS_PORT_PREOPERATE:
        return v1_1 ? PREOPERATE : NOT_AVAILABLE; /* reserved in IEC 61139-2 */
    case FS_PORT_OPERATE:
        return port->scl.state != FS_SCL_INACTIVE ? SCL_ENABLED : OPERATE;
    case FS_PORT_FAULT:
        return PORT_DIAG;
    case FS_PORT_SIO:
        return port->config.port_mode == FS_DO_CQ ? DO_CQ : DI_CQ;
    case FS_PORT_OSSDE:
        return OSSDE;
    default:
        return NO_DEVICE;
    }
}

static uint8_t *put16(uint8_t *at, uint16_t value)
{
    *at++ = (uint8_t)(value >> 8);
    *at++ = (uint8_t)value;
    return at;
}

static uint8_t *put32(uint8_t *at, uint32_t value)
{
    return put16(put16(at, (uint16_t)(value >> 16)), (uint16_t)value);
}

/* Lengths of the data without safety relevance in IEC 61139-2, one reserved octet in v1.1. */
static uint8_t *put_lengths(uint8_t *at, const struct fs_port *port)
{
    int valid = fs_gateway_valid(port);
    if (port->master->setup.edition == FS_V1_1) {
        *at++ = 0;
    } else {
        *at++ = valid ? port->nsr_in_length : 0;
        *at++ = valid ? port->nsr_out_length : 0;
    }
    return at;
}

static uint8_t master_cycle_time(const struct fs_port *port)
{
    if (!port->identified)
        return 0;
    return port->config.port_cycle_time != 0 ? port->config.port_cycle_time : port->device.min_cycle_time;
}

size_t fs_port_status(const struct fs_port *port, uint8_t *block)
{
    const struct fs_device none = {0, 0, 0, 0, 0, 0, 0}, *device = port->identified ? &port->device : &none;
    uint8_t *at = put16(block, port->master->setup.edition == FS_V1_1 ? 0x9001 : 0x9100);
    *at++ = port_status_info(port);
    *at++ = fs_gateway_valid(port) ? 0 : PDIN_INVALID | PDOUT_INVALID;
    *at++ = device->revision_id;
    *at++ = device->com;
    *at++ = master_cycle_time(port);
    at = put_lengths(at, port);
    at = put16(at, device->vendor_id);
    at = put32(at, device->device_id);
    *at++ = port->diag_count;
    for (uint8_t i = 0; i < port->diag_count; i++) {
        *at++ = port->diags[i].qualifier;
        at = put16(at, port->diags[i].code);
    }
    return (size_t)(at - block);
}
