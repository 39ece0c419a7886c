/* The contract of fsct with a device under test, in C99: what a DUT is asked to do, and how it tells what it saw.
 *
 * The same DUT serves two ways:
 *   - as a shared library: export `fsct_dut`, then `fsct run --dut lib:./libyours.so`;
 *   - behind any stream of octets (UART, socket, pipe): hand it to the client, fsct_client.h.
 *
 * Words and numbers are those of PROTOCOL.md, which says what each stimulus and each observation means. Everything is
 * called from one thread, one call at a time. Nothing is allocated; pointers hold until the call returns.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FSCT_DUT_H
#define FSCT_DUT_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of everything in this file; goes up when a layout or a meaning changes. */
#define FSCT_ABI 1u

/* The most octets of process data one way, and of on-request data. */
#define FSCT_MAX_PD 32u
#define FSCT_MAX_RECORD 232u

enum fsct_role { FSCT_DEVICE = 1, FSCT_MASTER = 2 };
enum fsct_edition { FSCT_V1_1 = 1, FSCT_IEC2022 = 2 };
enum fsct_mode { FSCT_CRC16 = 1, FSCT_CRC32 = 2 };
enum fsct_clock { FSCT_VIRTUAL = 1, FSCT_REAL = 2 };

/* Points of control and observation: bits of fsct_description.pcos. */
enum fsct_pco {
    FSCT_PCO_POWER = 1,
    FSCT_PCO_LINK = 2,
    FSCT_PCO_ACYCLIC = 4,
    FSCT_PCO_APP = 8,
    FSCT_PCO_LINE = 16,
    FSCT_PCO_CLOCK = 32
};

/* One edition and mode the DUT implements, and the process data it can have there, in octets. */
struct fsct_offer {
    uint8_t edition; /* enum fsct_edition */
    uint8_t mode;    /* enum fsct_mode: FSP_ProtMode */
    uint8_t pd_out_min, pd_out_max;
    uint8_t pd_in_min, pd_in_max;
};

/* What the DUT says of itself. Texts are UTF-8 of at most 255 octets and end with 0; a null pointer is an empty text. */
struct fsct_description {
    uint8_t role;       /* enum fsct_role */
    uint8_t ports;      /* 1 for an FS-Device */
    uint8_t pcos;       /* enum fsct_pco: what is really served */
    uint8_t clock;      /* enum fsct_clock */
    uint64_t resolution_ns;
    uint64_t uncertainty_ns; /* how far a time stamp may be off, either way */
    const char *vendor, *product, *version;
    const struct fsct_offer *offers;
    size_t offer_count; /* 1 or more */
};

enum fsct_stimulus_kind {
    FSCT_CONFIGURE = 1, /* variant: be this from the next power-on, as if fresh from the factory */
    FSCT_POWER = 2,     /* flag: 1 = on, 0 = off */
    FSCT_EXCHANGE = 3,  /* port; flag 1: octets, length = what is received; flag 0: nothing is received */
    FSCT_READ = 4,      /* index, subindex */
    FSCT_WRITE = 5,     /* index, subindex, octets, length */
    FSCT_SET = 6,       /* port, number = service, octets, length = its value */
    FSCT_ADVANCE = 7,   /* ns */
    FSCT_PLUG = 8,      /* port; flag 1: identity; flag 0: nothing is connected */
    FSCT_RESPOND = 9,   /* port, number = response; value: octets, length; refused: code */
    FSCT_RAISE = 10,    /* port, code = EventCode, number = EventQualifier */
    FSCT_DRIVE = 11,    /* port, number = line, flag = level */
    FSCT_SMI = 12       /* number = service, port, client_id, block_id = ExpArgBlockID, octets, length = ArgBlock */
};

/* What is connected to a port of an FS-Master. */
struct fsct_identity {
    uint8_t revision_id, com, min_cycle_time;
    uint8_t pd_in, pd_out; /* octets of process data, SPDU included */
    uint16_t vendor_id;
    uint32_t device_id; /* three octets */
};

/* Something to be done. Of the fields only those named at the kind have a meaning; the others are 0. A kind that is not
 * in the list above comes with its value in `octets` and `length`. */
struct fsct_stimulus {
    uint8_t kind; /* enum fsct_stimulus_kind, or one you do not know */
    uint8_t port; /* from 1; 0 = the whole FS-Master */
    uint8_t number;
    uint8_t flag;
    uint8_t subindex;
    uint16_t index;
    uint16_t code;
    uint16_t client_id;
    uint16_t block_id;
    uint16_t length;
    const uint8_t *octets;
    uint64_t ns;
    struct fsct_offer variant; /* least and greatest are the same */
    struct fsct_identity identity;
};

enum fsct_observation_kind {
    FSCT_IMAGE = 1,       /* port; flag 1: octets, length; flag 0: no process data */
    FSCT_SERVICE = 2,     /* port, number = service, octets, length = its value */
    FSCT_VALUE = 3,       /* octets, length */
    FSCT_WRITTEN = 4,
    FSCT_REFUSED = 5,     /* code = ErrorType */
    FSCT_EVENT = 6,       /* code = EventCode, number = EventQualifier */
    FSCT_UNSUPPORTED = 7,
    FSCT_MODE = 8,        /* port, number = mode */
    FSCT_REQUEST = 9,     /* port, flag 0 = read, 1 = write, index, subindex, octets, length */
    FSCT_LINE = 10,       /* port, number = line, flag = level */
    FSCT_RESULT = 11,     /* port, flag 1 = Result(+), client_id, block_id = RefArgBlockID, block_length, octets, length */
    FSCT_INDICATION = 12  /* port, flag = source: 1 Device, 2 port, number = EventQualifier, code = EventCode */
};

/* Something seen. Fields as with the stimuli. */
struct fsct_observation {
    uint8_t kind; /* enum fsct_observation_kind */
    uint8_t port;
    uint8_t number;
    uint8_t flag;
    uint8_t subindex;
    uint16_t index;
    uint16_t code;
    uint16_t client_id;
    uint16_t block_id;
    uint16_t block_length; /* ArgBlockLength as the FS-Master states it */
    uint16_t length;
    const uint8_t *octets; /* may be null when length is 0 */
    uint64_t ns;           /* when, on the clock of the DUT */
};

/* Where observations go. */
struct fsct_sink {
    void (*see)(struct fsct_sink *sink, const struct fsct_observation *observation);
    uint64_t now; /* time of what is seen next: yours to set, in ns on your clock */
};

/* A DUT. */
struct fsct_dut {
    uint32_t abi; /* FSCT_ABI */
    void *self;   /* handed to the functions below as it is */
    const struct fsct_description *(*hello)(void *self);
    /* Carries out one stimulus and hands what it leads to to `sink`, in order. What is not served gets
     * fsct_unsupported(), never nothing; an exchange gets its image all the same. */
    void (*apply)(void *self, const struct fsct_stimulus *stimulus, struct fsct_sink *sink);
};

/* What a shared library exports. `lib:` loads it in a process of its own, so that there is one DUT, in its first state. */
#if defined(_WIN32)
#define FSCT_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FSCT_EXPORT __attribute__((visibility("default")))
#else
#define FSCT_EXPORT
#endif
FSCT_EXPORT const struct fsct_dut *fsct_dut(void);

enum fsct_service {
    FSCT_PDin_D = 1, FSCT_SDset_DS = 2, FSCT_PDout_D = 3, FSCT_setSD_DC = 4, FSCT_ChFAckReq_DC = 5, FSCT_SCL_Fault = 6,
    FSCT_OSSDe_demand = 7,
    FSCT_PDout_M = 17, FSCT_setSD_C = 18, FSCT_ChFAck_C = 19, FSCT_PDin_M = 20, FSCT_SDset_S = 21,
    FSCT_ChFAckReq_S = 22, FSCT_FAULTS_S = 23, FSCT_qualifier = 24, FSCT_FSCP_Authenticity = 25
};
enum fsct_line { FSCT_LPLUS = 1, FSCT_CQ = 2, FSCT_IQ = 3, FSCT_WAKE_UP = 4 };
enum fsct_port_mode { FSCT_INACTIVE = 0, FSCT_STARTUP = 1, FSCT_PREOPERATE = 2, FSCT_OPERATE = 3 };
enum fsct_response { FSCT_RESPONSE_VALUE = 1, FSCT_RESPONSE_WRITTEN = 2, FSCT_RESPONSE_REFUSED = 3 };
enum fsct_smi {
    FSCT_SMI_MasterIdentification = 1, FSCT_SMI_FSMasterAccess = 2, FSCT_SMI_PortConfiguration = 3,
    FSCT_SMI_ReadbackPortConfiguration = 4, FSCT_SMI_PortStatus = 5, FSCT_SMI_DSToParServ = 6, FSCT_SMI_ParServToDS = 7,
    FSCT_SMI_DeviceWrite = 8, FSCT_SMI_DeviceRead = 9, FSCT_SMI_PortPowerOffOn = 10, FSCT_SMI_PDIn = 11,
    FSCT_SMI_PDOut = 12, FSCT_SMI_PDInOut = 13, FSCT_SMI_SPDUIn = 14, FSCT_SMI_SPDUOut = 15, FSCT_SMI_FSPDInOut = 16,
    FSCT_SMI_PDInIQ = 17, FSCT_SMI_PDOutIQ = 18
};

/* How a DUT tells what it saw: one function for each observation. */

static inline struct fsct_observation fsct_seen(uint8_t kind)
{
    struct fsct_observation seen;
    memset(&seen, 0, sizeof seen);
    seen.kind = kind;
    return seen;
}

static inline void fsct_see(struct fsct_sink *sink, struct fsct_observation seen)
{
    seen.ns = sink->now;
    sink->see(sink, &seen);
}

/* The octets the DUT presents in this exchange; a null pointer: no process data. Last observation of an exchange. */
static inline void fsct_image(struct fsct_sink *sink, uint8_t port, const uint8_t *octets, size_t length)
{
    struct fsct_observation seen = fsct_seen(FSCT_IMAGE);
    seen.port = port, seen.flag = octets != NULL;
    seen.octets = octets, seen.length = (uint16_t)(octets != NULL ? length : 0);
    fsct_see(sink, seen);
}

/* An output of the application has this value now. */
static inline void fsct_service(struct fsct_sink *sink, uint8_t port, uint8_t service, const uint8_t *octets, size_t length)
{
    struct fsct_observation seen = fsct_seen(FSCT_SERVICE);
    seen.port = port, seen.number = service, seen.octets = octets, seen.length = (uint16_t)length;
    fsct_see(sink, seen);
}

/* The same for an output of one bit. */
static inline void fsct_service_bit(struct fsct_sink *sink, uint8_t port, uint8_t service, int value)
{
    uint8_t octet = value != 0;
    fsct_service(sink, port, service, &octet, 1);
}

/* Answer to a read. */
static inline void fsct_value(struct fsct_sink *sink, const uint8_t *octets, size_t length)
{
    struct fsct_observation seen = fsct_seen(FSCT_VALUE);
    seen.octets = octets, seen.length = (uint16_t)length;
    fsct_see(sink, seen);
}

/* Answer to a write that was carried out. */
static inline void fsct_written(struct fsct_sink *sink)
{
    struct fsct_observation seen = fsct_seen(FSCT_WRITTEN);
    fsct_see(sink, seen);
}

/* Answer to a read or write that was refused. */
static inline void fsct_refused(struct fsct_sink *sink, uint16_t error_type)
{
    struct fsct_observation seen = fsct_seen(FSCT_REFUSED);
    seen.code = error_type;
    fsct_see(sink, seen);
}

/* An Event of an FS-Device. */
static inline void fsct_event(struct fsct_sink *sink, uint16_t event_code, uint8_t qualifier)
{
    struct fsct_observation seen = fsct_seen(FSCT_EVENT);
    seen.code = event_code, seen.number = qualifier;
    fsct_see(sink, seen);
}

/* The stimulus is not served. */
static inline void fsct_unsupported(struct fsct_sink *sink)
{
    struct fsct_observation seen = fsct_seen(FSCT_UNSUPPORTED);
    fsct_see(sink, seen);
}

/* FS-Master: the mode commanded on a port is this now. */
static inline void fsct_mode(struct fsct_sink *sink, uint8_t port, uint8_t mode)
{
    struct fsct_observation seen = fsct_seen(FSCT_MODE);
    seen.port = port, seen.number = mode;
    fsct_see(sink, seen);
}

/* FS-Master: on-request data for the Device on a port; a null pointer: a read. */
static inline void fsct_request(struct fsct_sink *sink, uint8_t port, uint16_t index, uint8_t subindex,
                                const uint8_t *octets, size_t length)
{
    struct fsct_observation seen = fsct_seen(FSCT_REQUEST);
    seen.port = port, seen.flag = octets != NULL, seen.index = index, seen.subindex = subindex;
    seen.octets = octets, seen.length = (uint16_t)(octets != NULL ? length : 0);
    fsct_see(sink, seen);
}

/* The DUT has changed a line. */
static inline void fsct_line(struct fsct_sink *sink, uint8_t port, uint8_t line, int level)
{
    struct fsct_observation seen = fsct_seen(FSCT_LINE);
    seen.port = port, seen.number = line, seen.flag = level != 0;
    fsct_see(sink, seen);
}

/* FS-Master: result of a request through the SMI. */
static inline void fsct_result(struct fsct_sink *sink, uint8_t port, int positive, uint16_t client_id, uint16_t block_id,
                               uint16_t block_length, const uint8_t *octets, size_t length)
{
    struct fsct_observation seen = fsct_seen(FSCT_RESULT);
    seen.port = port, seen.flag = positive != 0, seen.client_id = client_id;
    seen.block_id = block_id, seen.block_length = block_length, seen.octets = octets, seen.length = (uint16_t)length;
    fsct_see(sink, seen);
}

/* FS-Master: SMI_DeviceEvent (source 1) or SMI_PortEvent (source 2). */
static inline void fsct_indication(struct fsct_sink *sink, uint8_t port, uint8_t source, uint8_t qualifier,
                                   uint16_t event_code)
{
    struct fsct_observation seen = fsct_seen(FSCT_INDICATION);
    seen.port = port, seen.flag = source, seen.number = qualifier, seen.code = event_code;
    fsct_see(sink, seen);
}

#ifdef __cplusplus
}
#endif

#endif
