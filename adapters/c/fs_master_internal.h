/* What the files of the FS-Master stack share with each other and with nobody else.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_MASTER_INTERNAL_H
#define FS_MASTER_INTERNAL_H

#include "fs_master.h"

static inline struct fs_port *fs_port_of(struct fs_master *master, uint8_t port)
{
    return &master->ports[port - 1];
}

/* fs_master_port.c: configuration has changed; L+ by service; time. */
void fs_port_configured(struct fs_port *port);
void fs_port_switch_off(struct fs_port *port, uint64_t time); /* FS_NEVER: until it is switched on */
void fs_port_switch_on(struct fs_port *port);
uint64_t fs_port_due(const struct fs_port *port);
void fs_port_run(struct fs_port *port);
int fs_port_request(struct fs_port *port, const struct fs_request *request); /* 0: another one is open */

/* fs_master_gateway.c */
void fs_gateway_lay_out(struct fs_port *port); /* lengths of process data of the Device found */
void fs_gateway_publish(struct fs_port *port); /* outputs that have changed */
size_t fs_gateway_spdu_in(const struct fs_port *port);
size_t fs_gateway_spdu_out(const struct fs_port *port);
int fs_gateway_valid(const struct fs_port *port); /* process data are exchanged */

/* fs_master_event.c */
void fs_event(struct fs_port *port, uint8_t source, uint8_t qualifier, uint16_t code);
void fs_event_of_port(struct fs_port *port, uint8_t mode, uint8_t type, uint16_t code);
void fs_event_of_scl(struct fs_port *port, uint8_t FAULTS_S_before);
void fs_event_of_ossde(struct fs_port *port, enum fs_ossde_state before);
void fs_event_of_deviations(struct fs_port *port, unsigned deviations);

/* fs_master_status.c: FSPortStatusList; returns its octets. */
size_t fs_port_status(const struct fs_port *port, uint8_t *block);

/* Fields of EventQualifier (base standard). */
enum { FS_SINGLE_SHOT = 1, FS_DISAPPEARS = 2, FS_APPEARS = 3 };
enum { FS_NOTIFICATION = 1, FS_WARNING = 2, FS_ERROR = 3 };

/* Port Events of the base standard. */
enum { FS_EVENT_STARTUP = 0x1801, FS_EVENT_VENDOR = 0x1802, FS_EVENT_DEVICE = 0x1803, FS_EVENT_CYCLE_TIME = 0x6000 };

#endif
