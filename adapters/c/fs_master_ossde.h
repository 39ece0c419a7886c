/* A port in FS_PortMode OSSDe: the two lines with their filter, the port diagnosis, and the qualifier handler of
 * 11.11.5 (Table 43). Knows levels and times, nothing of ports or gateways.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_MASTER_OSSDE_H
#define FS_MASTER_OSSDE_H

#include <stdint.h>

enum fs_ossde_state {
    FS_OSSDE_INACTIVE = 0,
    FS_OSSDE_CHECK = 1,     /* Port_OSSDe_Check */
    FS_OSSDE_GOOD = 2,      /* OSSDe_OK_GOOD */
    FS_OSSDE_BAD = 3,       /* OSSDe_Fault_BAD */
    FS_OSSDE_AWAIT_ACKQ = 4 /* NoFault_AwaitAckQ */
};

/* OSSDe1 is C/Q, OSSDe2 is I/Q. */
enum { FS_OSSDE_CQ = 0, FS_OSSDE_IQ = 1 };

struct fs_ossde {
    enum fs_ossde_state state;
    uint8_t level[2];     /* as it is at the pins */
    uint8_t filtered[2];  /* without test pulses and Ready pulse */
    uint64_t settled[2];  /* instant at which the level passes the filter */
    uint64_t tolerated;   /* instant at which the discrepancy is a fault */
    uint64_t checked;     /* instant of the first port diagnosis */
    uint8_t faulty;
};

void fs_ossde_stop(struct fs_ossde *ossde);
void fs_ossde_start(struct fs_ossde *ossde, uint8_t cq, uint8_t iq, uint64_t now);

/* A line has this level now. */
void fs_ossde_drive(struct fs_ossde *ossde, uint8_t line, uint8_t level, uint64_t now);

/* AckQ has risen. */
void fs_ossde_acknowledge(struct fs_ossde *ossde);

/* Next instant at which something happens by itself, and what happens up to now. */
uint64_t fs_ossde_due(const struct fs_ossde *ossde);
void fs_ossde_run(struct fs_ossde *ossde, uint64_t now);

/* FSInBuffer: bit 0 = C/Q, bit 1 = I/Q (10.5). */
uint8_t fs_ossde_lines(const struct fs_ossde *ossde);

/* PDin_M: both lines when they are ON and no fault stands, else safe data. */
uint8_t fs_ossde_PDin(const struct fs_ossde *ossde);

#endif
