/* The SCL machine of fs_master_scl.h. Each action block names its transition of Table 38.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_master_scl.h"

#include <string.h>

#include "fs_crc.h"

/* Control&MCnt, Table 31, and Status&DCnt, Table 32. */
#define COUNTER_SHIFT 5
#define CONTROL_SETSD 0x02u
#define CONTROL_CHFACKREQ 0x01u
#define STATUS_SDSET 0x04u
#define STATUS_DCOMMERR 0x02u
#define STATUS_DTIMEOUT 0x01u

/* An answer of the FS-Device, field by field. */
struct answer {
    const uint8_t *pd;
    uint8_t DCount_i, SDset;
    uint8_t faults; /* enum fs_scl_fault */
};

static size_t signature_length(uint8_t prot_mode)
{
    return prot_mode == FS_CRC32 ? FS_CRC32_OCTETS : FS_CRC16_OCTETS;
}

size_t fs_scl_code_length(uint8_t prot_mode)
{
    return 2 + signature_length(prot_mode);
}

size_t fs_scl_in_length(const struct fs_scl *scl)
{
    return scl->parameters.pd_in + fs_scl_code_length(scl->parameters.prot_mode);
}

/* The mirror of a counter, Table 33. */
static uint8_t inverse(uint8_t counter)
{
    return (uint8_t)(7u - counter);
}

static void next_MCount(struct fs_scl *scl)
{
    scl->MCount = (uint8_t)(scl->MCount == 7 ? 1 : scl->MCount + 1);
}

static void build_spdu(struct fs_scl *scl, const uint8_t *PDout)
{
    size_t length = scl->parameters.pd_out;
    memset(scl->spdu, 0, sizeof scl->spdu);
    if (PDout != NULL)
        memcpy(scl->spdu, PDout, length);
    scl->spdu[length++] = scl->parameters.port;
    scl->spdu[length++] = (uint8_t)(scl->MCount << COUNTER_SHIFT | (scl->setSD ? CONTROL_SETSD : 0) |
                                    (scl->ChFAckReq ? CONTROL_CHFACKREQ : 0));
    fs_spdu_sign(scl->spdu, length, signature_length(scl->parameters.prot_mode));
}

static void use_SDin(struct fs_scl *scl)
{
    memset(scl->PDin_M, 0, sizeof scl->PDin_M);
    scl->SDset_S = 1;
}

static void use_PDin(struct fs_scl *scl, const uint8_t *PDin)
{
    memcpy(scl->PDin_M, PDin, scl->parameters.pd_in);
    scl->SDset_S = 0;
}

/* T5, T9 */
static void send(struct fs_scl *scl, enum fs_scl_state state, const uint8_t *PDout, uint64_t now)
{
    build_spdu(scl, PDout);
    scl->MTimer = now + scl->parameters.watchdog;
    scl->state = state;
}

/* The common part of T4 and T11: process data, or safe data where one side asks for them. */
static void go_on_regularly(struct fs_scl *scl, const struct answer *answer, uint64_t now)
{
    next_MCount(scl);
    scl->FAULTS_S = 0;
    scl->setSD = scl->setSD_C;
    if (answer->SDset || scl->setSD_C)
        use_SDin(scl);
    else
        use_PDin(scl, answer->pd);
    send(scl, FS_SCL_REGULAR, scl->setSD_C ? NULL : scl->PDout_M, now);
}

/* The common part of T7, T8, T12, T13 and T14: safe data both ways. */
static void go_on_exceptionally(struct fs_scl *scl, uint64_t now)
{
    use_SDin(scl);
    scl->setSD = 1;
    send(scl, FS_SCL_EXCEPTIONAL, NULL, now);
}

static void request_acknowledgment(struct fs_scl *scl, uint8_t value)
{
    scl->ChFAckReq = value;
    scl->ChFAckReq_S = value;
}

static void fault(struct fs_scl *scl, uint8_t faults)
{
    scl->faults = faults;
    scl->FAULTS_S = 1;
}

/* State 3 */
static void check_regular(struct fs_scl *scl, const struct answer *answer, uint64_t now)
{
    if (answer->faults == 0) { /* T4 */
        go_on_regularly(scl, answer, now);
    } else { /* T7 */
        fault(scl, answer->faults);
        next_MCount(scl);
        go_on_exceptionally(scl, now);
    }
}

/* State 8 */
static void check_exceptional(struct fs_scl *scl, const struct answer *answer, uint64_t now)
{
    if (answer->faults != 0) { /* T12 */
        fault(scl, answer->faults);
        request_acknowledgment(scl, 0);
        scl->ChFAck_C_e = 0;
        next_MCount(scl);
        go_on_exceptionally(scl, now);
    } else if (scl->ChFAck_C && scl->ChFAck_C_e) { /* T11 */
        request_acknowledgment(scl, 0);
        scl->ChFAck_C_e = 0;
        go_on_regularly(scl, answer, now);
    } else { /* T13 */
        scl->FAULTS_S = 0;
        request_acknowledgment(scl, 1);
        if (!scl->ChFAck_C)
            scl->ChFAck_C_e = 1;
        next_MCount(scl);
        go_on_exceptionally(scl, now);
    }
}

/* What states 3 and 8 look at: signature, PortNum (inverted by the FS-Device), counter, what the FS-Device reports. */
static struct answer parse(const struct fs_scl *scl, const uint8_t *spdu)
{
    size_t signed_length = scl->parameters.pd_in + 2u;
    uint8_t port = spdu[scl->parameters.pd_in], status = spdu[scl->parameters.pd_in + 1];
    struct answer answer = {spdu, (uint8_t)(status >> COUNTER_SHIFT), (status & STATUS_SDSET) != 0, 0};
    if (!fs_spdu_signed(spdu, signed_length, signature_length(scl->parameters.prot_mode)))
        answer.faults |= FS_FAULT_CRC;
    if ((port ^ scl->parameters.port) != 0xFF)
        answer.faults |= FS_FAULT_PORT;
    if (answer.DCount_i != inverse(scl->MCount))
        answer.faults |= FS_FAULT_COUNTER;
    if (status & (STATUS_DCOMMERR | STATUS_DTIMEOUT))
        answer.faults |= FS_FAULT_DEVICE;
    return answer;
}

static int all_zero(const uint8_t *octets, size_t length)
{
    while (length > 0 && octets[length - 1] == 0)
        length--;
    return length == 0;
}

void fs_scl_stop(struct fs_scl *scl)
{
    use_SDin(scl);
    request_acknowledgment(scl, 0);
    scl->FAULTS_S = 0;
    scl->MTimer = FS_NEVER;
    scl->state = FS_SCL_INACTIVE;
}

void fs_scl_start(struct fs_scl *scl, const struct fs_scl_parameters *parameters)
{
    fs_scl_stop(scl);
    scl->parameters = *parameters;
    scl->ChFAck_C_e = 0;
    scl->faults = 0;
    scl->setSD = 1; /* T1 */
    scl->MCount = 0;
    build_spdu(scl, NULL); /* T2, which starts no timer */
    scl->state = FS_SCL_FIRST;
}

void fs_scl_received(struct fs_scl *scl, const uint8_t *spdu, uint64_t now)
{
    struct answer answer;
    if (scl->state == FS_SCL_INACTIVE || all_zero(spdu, fs_scl_in_length(scl)))
        return;
    answer = parse(scl, spdu);
    if (scl->state == FS_SCL_FIRST) { /* T3: whatever its counter */
        scl->DCount_i_prev = answer.DCount_i;
        check_regular(scl, &answer, now);
    } else if (scl->state == FS_SCL_REGULAR && answer.DCount_i != scl->DCount_i_prev) { /* T6: not old */
        scl->DCount_i_prev = answer.DCount_i;
        check_regular(scl, &answer, now);
    } else if (scl->state == FS_SCL_EXCEPTIONAL && answer.DCount_i == inverse(scl->MCount)) { /* T10: expected */
        scl->DCount_i_prev = answer.DCount_i;
        check_exceptional(scl, &answer, now);
    }
}

void fs_scl_expired(struct fs_scl *scl, uint64_t now)
{
    fault(scl, FS_FAULT_TIMEOUT);
    if (scl->state == FS_SCL_EXCEPTIONAL) { /* T14; T8 leaves these alone */
        request_acknowledgment(scl, 0);
        scl->ChFAck_C_e = 0;
    }
    scl->MCount = 0; /* T8, T14 */
    go_on_exceptionally(scl, now);
}
