/* Safety communication layer of one FS-Master port: states and transitions T1 to T14 of 11.5.2 (Table 38), in both
 * protocol modes. Knows SPDUs, services and the time it is told; knows nothing of ports, gateways or clocks.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_MASTER_SCL_H
#define FS_MASTER_SCL_H

#include <stddef.h>
#include <stdint.h>

#define FS_NEVER UINT64_MAX        /* an instant that does not come */
#define FS_MS UINT64_C(1000000)    /* all times are in ns */

#define FS_PD_MAX 25u              /* octets of FS process data, FSP_ProtMode 2 */
#define FS_SPDU_MAX 31u

enum fs_prot_mode { FS_CRC16 = 1, FS_CRC32 = 2 };

/* The waiting states; those in between last no time. */
enum fs_scl_state { FS_SCL_INACTIVE = 0, FS_SCL_FIRST = 2, FS_SCL_REGULAR = 5, FS_SCL_EXCEPTIONAL = 7 };

/* What the FAULTS of Table 37 were made of. */
enum fs_scl_fault {
    FS_FAULT_CRC = 1,
    FS_FAULT_PORT = 2,
    FS_FAULT_COUNTER = 4,
    FS_FAULT_TIMEOUT = 8,
    FS_FAULT_DEVICE = 16 /* DTimeout or DCommErr of the FS-Device */
};

/* FSP parameters an SCL instance runs with. */
struct fs_scl_parameters {
    uint8_t prot_mode; /* enum fs_prot_mode */
    uint8_t port;      /* FSP_Port */
    uint8_t pd_in, pd_out; /* octets of FS process data */
    uint64_t watchdog;     /* FSP_Watchdog in ns */
};

struct fs_scl {
    /* Services of the gateway towards the SCL, Table 28; not touched by a start. */
    uint8_t setSD_C, ChFAck_C;
    uint8_t PDout_M[FS_PD_MAX];
    /* Services towards the gateway. */
    uint8_t SDset_S, ChFAckReq_S, FAULTS_S;
    uint8_t PDin_M[FS_PD_MAX];
    /* The machine. */
    struct fs_scl_parameters parameters;
    enum fs_scl_state state;
    uint8_t MCount, setSD, ChFAckReq;
    uint8_t ChFAck_C_e;    /* acknowledgment armed by a released ChFAck_C */
    uint8_t DCount_i_prev; /* counter of the answer checked last */
    uint8_t faults;        /* enum fs_scl_fault: of the last T7, T8, T12 or T14 */
    uint64_t MTimer;       /* instant of expiry */
    uint8_t spdu[FS_SPDU_MAX]; /* stands until the next one */
};

/* Octets of PortNum, Control&MCnt and signature. */
size_t fs_scl_code_length(uint8_t prot_mode);
size_t fs_scl_in_length(const struct fs_scl *scl);

void fs_scl_stop(struct fs_scl *scl);
void fs_scl_start(struct fs_scl *scl, const struct fs_scl_parameters *parameters);

/* An SPDU of the FS-Device, fs_scl_in_length() octets. */
void fs_scl_received(struct fs_scl *scl, const uint8_t *spdu, uint64_t now);

/* MTimer has expired. */
void fs_scl_expired(struct fs_scl *scl, uint64_t now);

#endif
