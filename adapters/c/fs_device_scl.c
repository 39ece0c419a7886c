/* See fs_device_scl.h. Each transition of Table 40 is a function, its actions in the order of the table.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_device_scl.h"

#include <string.h>

/* SDcycles, at start and after each fault. */
#define SDCYCLES_START 3u
#if FAULT == 2
#define SDCYCLES_FAULT 2u
#else
#define SDCYCLES_FAULT 3u
#endif

/* Control&MCnt and Status&DCnt, Tables 31 and 32. */
enum { MCOUNT = 5, SETSD = 0x02, CHFACKREQ = 0x01, DCOUNT = 5, SDSET = 0x04, DCOMMERR = 0x02, DTIMEOUT = 0x01 };

/* Octets behind the data: PortNum, control or status, signature. */
static size_t safety_code(const struct fs_device_scl_setup *setup)
{
    return 2u + setup->signature_octets;
}

size_t fs_device_scl_spdu_out(const struct fs_device_scl_setup *setup)
{
    return setup->pd_out + safety_code(setup);
}

size_t fs_device_scl_spdu_in(const struct fs_device_scl_setup *setup)
{
    return setup->pd_in + safety_code(setup);
}

/* The SPDU being checked. */
struct received {
    const uint8_t *octets;
    uint8_t PortNum, MCount, setSD, ChFAckReq;
};

static struct received look_at(const struct fs_device_scl *scl, const uint8_t *spdu)
{
    struct received rx;
    const uint8_t *code = spdu + scl->setup.pd_out;
    rx.octets = spdu;
    rx.PortNum = code[0];
    rx.MCount = code[1] >> MCOUNT;
    rx.setSD = (code[1] & SETSD) != 0;
    rx.ChFAckReq = (code[1] & CHFACKREQ) != 0;
    return rx;
}

/* Counter_check. MCount 0 is always right: the FS-Master starts from it after a timeout. Before the first SPDU no counter
 * is expected but that; V1.1 does not say so, but taking 1 would hide a power cycle shorter than FSP_Watchdog. */
static int counter_right(const struct fs_device_scl *scl, const struct received *rx)
{
#if FAULT == 1
    (void)scl, (void)rx;
    return 1;
#else
    if (rx->MCount == 0)
        return 1;
    return scl->state != FS_DEVICE_SCL_FIRST && rx->MCount == (scl->MCount_prev == 7 ? 1 : scl->MCount_prev + 1);
#endif
}

/* CRC_check, PortNum_check and Counter_check of states 22 and 27. */
static int CommErr(const struct fs_device_scl *scl, const struct received *rx)
{
    return !fs_spdu_signed(rx->octets, scl->setup.pd_out + 2u, scl->setup.signature_octets)
           || rx->PortNum != scl->setup.FSP_Port || !counter_right(scl, rx);
}

static void restart_DTimer(struct fs_device_scl *scl, uint64_t now)
{
    uint64_t ms = scl->setup.FSP_Watchdog;
#if FAULT == 3
    ms *= 2;
#endif
    scl->DTimer_end = now + ms * 1000000u;
}

static void use_SDout(struct fs_device_scl *scl)
{
    memset(scl->PDout_D, 0, sizeof scl->PDout_D);
}

static void use_PDout(struct fs_device_scl *scl, const struct received *rx)
{
    memcpy(scl->PDout_D, rx->octets, scl->setup.pd_out);
}

/* MCount_inv: also of an SPDU that was hit; of the last one when there is none (T30, T31). */
static void invert_MCount(struct fs_device_scl *scl)
{
    scl->DCount_i = 7u - scl->MCount_prev;
}

/* T23 and T26, Send_SPDU: the answer stands from here on. "use PDin_D" of the transitions before it is done here. */
static void send_SPDU(struct fs_device_scl *scl)
{
    uint8_t *code = scl->answer + scl->setup.pd_in;
    memcpy(scl->answer, scl->PDin_D, scl->setup.pd_in);
    code[0] = (uint8_t)~scl->setup.FSP_Port;
    code[1] = (uint8_t)(scl->DCount_i << DCOUNT | (scl->SDset ? SDSET : 0) | (scl->DCommErr ? DCOMMERR : 0)
                        | (scl->DTimeout ? DTIMEOUT : 0));
    fs_spdu_sign(scl->answer, scl->setup.pd_in + 2u, scl->setup.signature_octets);
}

static void T22(struct fs_device_scl *scl, const struct received *rx, uint64_t now)
{
    scl->DCommErr = 0;
    scl->DTimeout = 0;
    invert_MCount(scl);
    restart_DTimer(scl, now);
    if (scl->SDcycles != 0) {
        use_SDout(scl), scl->setSD_DC = 1, scl->SDset = 1;
        scl->SDcycles--;
    } else {
        use_PDout(scl, rx), scl->setSD_DC = 0, scl->SDset = 0;
    }
    if (rx->setSD)
        use_SDout(scl), scl->setSD_DC = 1;
}

static void T25(struct fs_device_scl *scl, uint64_t now)
{
    use_SDout(scl), scl->setSD_DC = 1, scl->SDset = 1;
    scl->DCommErr = 1;
    scl->CommErrCount = 1;
    invert_MCount(scl);
    scl->SDcycles = SDCYCLES_FAULT;
    restart_DTimer(scl, now);
}

/* SDout once more although setSD_DC and SDset are 0; setSD is not looked at. */
static void T28(struct fs_device_scl *scl, uint64_t now)
{
    use_SDout(scl), scl->setSD_DC = 0, scl->SDset = 0;
    invert_MCount(scl);
    scl->DCommErr = 0;
    scl->DTimeout = 0;
    restart_DTimer(scl, now);
}

/* The print has lost its indentation. Read as nested: the reports are worked off by SPDUs without error only, so that the
 * FS-Master hears of each error. */
static void T29(struct fs_device_scl *scl, int comm_err, uint64_t now)
{
    use_SDout(scl), scl->setSD_DC = 1, scl->SDset = 1;
    invert_MCount(scl);
    restart_DTimer(scl, now);
    if (comm_err) {
        scl->DCommErr = 1;
        scl->CommErrCount = 1;
        scl->SDcycles = SDCYCLES_FAULT;
        return;
    }
    scl->SDcycles--;
    scl->DCommErr = scl->CommErrCount, scl->CommErrCount = 0;
    scl->DTimeout = scl->TimeoutCount, scl->TimeoutCount = 0;
}

/* T30 from state 26 and T31 from state 24 do the same. No SPDU came, so DCount_i repeats the last. */
static void T30_T31(struct fs_device_scl *scl, uint64_t now)
{
    use_SDout(scl), scl->setSD_DC = 1, scl->SDset = 1;
    scl->DTimeout = 1;
    scl->TimeoutCount = 1;
    scl->SDcycles = SDCYCLES_FAULT;
    restart_DTimer(scl, now);
    invert_MCount(scl);
}

/* Into state 23 and by T23 to state 24. */
static void respond_regularly(struct fs_device_scl *scl)
{
    if (scl->SDset_DS)
        scl->SDset = 1;
    send_SPDU(scl);
    scl->state = FS_DEVICE_SCL_REGULAR;
}

/* Into state 25 and by T26 to state 26. */
static void respond_exceptionally(struct fs_device_scl *scl)
{
    send_SPDU(scl);
    scl->state = FS_DEVICE_SCL_FAULT;
}

/* States 22 and 27: the SPDU becomes the previous one, whatever its check says. */
static void check_SPDU(struct fs_device_scl *scl, const struct received *rx, uint64_t now)
{
    int comm_err = CommErr(scl, rx);
    scl->ChFAckReq_DC = rx->ChFAckReq;
    scl->MCount_prev = rx->MCount;
    if (scl->state != FS_DEVICE_SCL_FAULT) {
        if (!comm_err) {
            T22(scl, rx, now);
            respond_regularly(scl);
        } else {
            T25(scl, now);
            respond_exceptionally(scl);
        }
    } else if (!comm_err && scl->SDcycles == 0) {
        T28(scl, now);
        respond_regularly(scl);
    } else {
        T29(scl, comm_err, now);
        respond_exceptionally(scl);
    }
}

void fs_device_scl_initialize(struct fs_device_scl *scl, const struct fs_device_scl_setup *setup)
{
    memset(scl, 0, sizeof *scl);
    fs_device_scl_stop(scl, setup);
}

void fs_device_scl_stop(struct fs_device_scl *scl, const struct fs_device_scl_setup *setup)
{
    struct fs_device_scl was = *scl;
    memset(scl, 0, sizeof *scl);
    scl->setup = *setup;
    scl->SDcycles = SDCYCLES_START;
    scl->DTimeout = 1;
    scl->SDset_DS = was.SDset_DS;
    memcpy(scl->PDin_D, was.PDin_D, sizeof scl->PDin_D);
}

void fs_device_scl_start(struct fs_device_scl *scl, const struct fs_device_scl_setup *setup)
{
    fs_device_scl_stop(scl, setup);
    scl->state = FS_DEVICE_SCL_FIRST; /* T20 */
}

static int all_zero(const uint8_t *octets, size_t length)
{
    while (length > 0 && octets[length - 1] == 0)
        length--;
    return length == 0;
}

void fs_device_scl_receive(struct fs_device_scl *scl, const uint8_t *spdu, uint64_t now)
{
    struct received rx;
    if (scl->state == FS_DEVICE_SCL_OFF || all_zero(spdu, fs_device_scl_spdu_out(&scl->setup)))
        return;
    rx = look_at(scl, spdu);
    if (scl->state != FS_DEVICE_SCL_FIRST && rx.MCount == scl->MCount_prev)
        return; /* old: the black channel repeats it, DTimer goes on */
    check_SPDU(scl, &rx, now); /* T21, T24, T27 */
}

uint64_t fs_device_scl_next_expiry(const struct fs_device_scl *scl)
{
    int runs = scl->state == FS_DEVICE_SCL_REGULAR || scl->state == FS_DEVICE_SCL_FAULT;
    return runs ? scl->DTimer_end : UINT64_MAX;
}

void fs_device_scl_expire(struct fs_device_scl *scl, uint64_t now)
{
    uint64_t at = scl->DTimer_end, period;
    T30_T31(scl, at);
    respond_exceptionally(scl);
    period = scl->DTimer_end - at;
    scl->DTimer_end += (now - at) / period * period; /* the T30 in between would do the same once more */
}
