/* An FS-Master stack for IO-Link Safety, V1.1 and IEC 61139-2:2022, with two ports: SMI services, port start with Ready
 * pulse and FSP_VerifyRecord, SCL, process data, OSSDe and qualifiers.
 *
 * It knows no clock and no wire: the owner tells it what time it is and what happened, and hands it an environment for
 * what the stack does by itself. Nothing is allocated and nothing is stored: a port is configured anew after each
 * power-on, so no test configuration outlives its tool. Of the base standard, bits, M-sequences and Data Storage are
 * not here: Validation&Backup 3 and 4 check the type of the Device and copy nothing.
 *
 *     fs_master_init(&master, &setup, &environment, now);
 *     for (;;) {
 *         fs_master_run(&master, now);
 *         ... fs_master_cycle(), fs_master_smi(), fs_master_line(), ...
 *     }
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_MASTER_H
#define FS_MASTER_H

#include "fs_master_config.h"
#include "fs_master_ossde.h"
#include "fs_master_scl.h"

#define FS_PORTS 2u
#define FS_PORT_PD_MAX 32u
#define FS_RECORD_MAX 232u
#define FS_DIAGS_MAX 8u
#define FS_BLOCK_MAX 80u

enum fs_mode { FS_INACTIVE = 0, FS_STARTUP = 1, FS_PREOPERATE = 2, FS_OPERATE = 3 };
enum fs_event_source { FS_OF_DEVICE = 1, FS_OF_PORT = 2 };

/* Outputs to the gateway. */
enum fs_output { FS_PDin_M, FS_SDset_S, FS_ChFAckReq_S, FS_FAULTS_S, FS_qualifier };

/* Inputs from the gateway. */
enum fs_input { FS_setSD_C, FS_ChFAck_C };

/* On-request data for a Device. */
struct fs_request {
    uint8_t write, subindex;
    uint16_t index, length;
    uint8_t octets[FS_RECORD_MAX];
};

/* What the stack does by itself. Each is called with the port, from 1. */
struct fs_environment {
    void *self;
    void (*supply)(void *self, uint8_t port, int on); /* L+ */
    void (*wake_up)(void *self, uint8_t port);
    void (*mode)(void *self, uint8_t port, uint8_t mode);
    void (*request)(void *self, uint8_t port, const struct fs_request *request);
    void (*event)(void *self, uint8_t port, uint8_t source, uint8_t qualifier, uint16_t code);
    void (*output)(void *self, uint8_t port, uint8_t output, const uint8_t *octets, size_t length);
};

/* A Device as identification finds it. */
struct fs_device {
    uint8_t revision_id, com, min_cycle_time;
    uint8_t pd_in, pd_out; /* octets of process data, SPDU included */
    uint16_t vendor_id;
    uint32_t device_id;
};

enum fs_port_state {
    FS_PORT_OFF,        /* not configured or DEACTIVATED */
    FS_PORT_POWER_OFF,  /* L+ off for a time, then started again */
    FS_PORT_DOWN,       /* L+ off until it is switched on */
    FS_PORT_DELAY,      /* Device without safety powers up, or a wake-up sequence is over */
    FS_PORT_WAIT_READY, /* WaitOnReadyPulse_10 */
    FS_PORT_WAKE_UP,    /* EstablishCom_1 */
    FS_PORT_STARTUP,
    FS_PORT_PREOPERATE,
    FS_PORT_OPERATE,
    FS_PORT_FAULT,      /* PortFault_3 */
    FS_PORT_SIO,        /* DI_C/Q, DO_C/Q */
    FS_PORT_OSSDE
};

struct fs_diag {
    uint8_t qualifier;
    uint16_t code;
};

/* What the gateway was told last. */
struct fs_told {
    uint8_t valid, pd_length;
    uint8_t PDin_M[FS_PD_MAX];
    uint8_t flags[FS_qualifier + 1]; /* by enum fs_output */
};

struct fs_master;

struct fs_port {
    struct fs_master *master;
    uint8_t number;
    struct fs_port_config config; /* length 0: none */
    enum fs_port_state state;
    uint8_t mode; /* enum fs_mode */
    uint8_t supplied, switched_off;
    uint8_t cq, iq;          /* levels at the pins */
    uint64_t due;            /* when the state ends by itself */
    uint64_t off_since;
    uint64_t pulse_since;    /* rising edge of a Ready pulse */
    uint8_t retry;
    uint8_t plugged;
    struct fs_device device; /* on the line */
    uint8_t identified;      /* it has been found in STARTUP */
    enum { FS_NO_REQUEST, FS_VERIFY_RECORD, FS_CLIENT_REQUEST } open; /* request that waits for its answer */
    uint64_t given_up;       /* when it is waited for no longer */
    struct fs_scl scl;
    struct fs_ossde ossde;
    /* Process data (10.5). */
    uint8_t nsr_in_length, nsr_out_length;
    uint8_t spdu_in[FS_PORT_PD_MAX];
    uint8_t nsr_in[FS_PORT_PD_MAX], nsr_out[FS_PORT_PD_MAX];
    struct fs_diag diags[FS_DIAGS_MAX];
    uint8_t diag_count;
    struct fs_told told;
};

/* The variant: edition, and octets of FS process data the gateway has room for on each port. */
struct fs_setup {
    uint8_t edition; /* enum fs_edition */
    uint8_t pd_in, pd_out;
};

struct fs_master {
    struct fs_setup setup;
    struct fs_environment environment;
    uint64_t now;
    uint32_t authenticity[2]; /* of the upper-level FSCP */
    struct fs_port ports[FS_PORTS];
};

/* Power-on. */
void fs_master_init(struct fs_master *master, const struct fs_setup *setup, const struct fs_environment *environment,
                    uint64_t now);

/* Next instant at which something happens by itself; all that happens up to `now`. */
uint64_t fs_master_due(const struct fs_master *master);
void fs_master_run(struct fs_master *master, uint64_t now);

/* The functions below take place at the time told last. Ports are 1 to FS_PORTS. */

/* One cycle of process data: what came (null: nothing) and what goes. Returns the octets that go into `out`, which has
 * room for FS_PORT_PD_MAX; negative: no process data. */
int fs_master_cycle(struct fs_master *master, uint8_t port, const uint8_t *in, size_t length, uint8_t *out);

/* A Device is connected, or none (null). */
void fs_master_plug(struct fs_master *master, uint8_t port, const struct fs_device *device);

/* The Device answers the request that is open: done, or refused. */
void fs_master_answer(struct fs_master *master, uint8_t port, int done);

/* The Device raises an Event. */
void fs_master_event(struct fs_master *master, uint8_t port, uint8_t qualifier, uint16_t code);

/* A line is driven from outside: FS_OSSDE_CQ or FS_OSSDE_IQ. */
void fs_master_line(struct fs_master *master, uint8_t port, uint8_t line, uint8_t level);

/* Services of the gateway. PDout_M has to have the length of the FS process data, else it is not taken (0). */
void fs_master_authenticity(struct fs_master *master, uint32_t a_code, uint32_t extended);
void fs_master_input(struct fs_master *master, uint8_t port, uint8_t input, uint8_t value);
int fs_master_PDout(struct fs_master *master, uint8_t port, const uint8_t *octets, size_t length);

/* SMI services, Table 15. */
enum fs_smi_service {
    FS_SMI_MasterIdentification = 1, FS_SMI_FSMasterAccess, FS_SMI_PortConfiguration,
    FS_SMI_ReadbackPortConfiguration, FS_SMI_PortStatus, FS_SMI_DSToParServ, FS_SMI_ParServToDS, FS_SMI_DeviceWrite,
    FS_SMI_DeviceRead, FS_SMI_PortPowerOffOn, FS_SMI_PDIn, FS_SMI_PDOut, FS_SMI_PDInOut, FS_SMI_SPDUIn,
    FS_SMI_SPDUOut, FS_SMI_FSPDInOut, FS_SMI_PDInIQ, FS_SMI_PDOutIQ
};

/* ErrorInfo of v1.1, which has no numbers in the standard. */
enum fs_error_info { FS_OUT_OF_RANGE = 1, FS_STATE_CONFLICT = 2, FS_NO_COM = 3 };

struct fs_smi_request {
    uint8_t service, port;
    uint16_t exp_block_id; /* IEC 61139-2 */
    const uint8_t *block;
    size_t length;
};

struct fs_smi_result {
    uint8_t positive;
    uint16_t ref_block_id; /* IEC 61139-2 */
    uint16_t block_length; /* ArgBlockLength, 0 where the edition gives none */
    size_t length;
    uint8_t block[FS_BLOCK_MAX];
};

void fs_master_smi(struct fs_master *master, const struct fs_smi_request *request, struct fs_smi_result *result);

#endif
