/* Safety communication layer of an FS-Device, 11.5.3: states and transitions T20 to T31 of Table 40. It knows SPDUs and
 * time, which is handed to it; parameters, the base system and the technology are elsewhere.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_DEVICE_SCL_H
#define FS_DEVICE_SCL_H

#include "fs_crc.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FS_MAX_FS_PD 25u /* octets of FS-PDout or FS-PDin with FSP_ProtMode 2 */
#define FS_MAX_SPDU 31u

/* What FSP parameters and the product itself say of the SPDUs; the same as long as the SCL runs. */
struct fs_device_scl_setup {
    uint8_t signature_octets; /* 2 with FSP_ProtMode 1, 4 with FSP_ProtMode 2 */
    uint8_t pd_out, pd_in;    /* octets of FS-PDout and FS-PDin */
    uint8_t FSP_Port;
    uint16_t FSP_Watchdog; /* ms */
};

/* Waiting states of Figure 47 (46 in IEC 61139-2). States 20, 22, 23, 25 and 27 begin and end within one call. */
enum fs_device_scl_state {
    FS_DEVICE_SCL_OFF = 0,
    FS_DEVICE_SCL_FIRST = 21,
    FS_DEVICE_SCL_REGULAR = 24,
    FS_DEVICE_SCL_FAULT = 26
};

struct fs_device_scl {
    struct fs_device_scl_setup setup;
    enum fs_device_scl_state state;

    /* Internal items of Table 40. */
    uint8_t MCount_prev; /* of the SPDU processed last, whatever its check said; none before T21 */
    uint8_t SDcycles, CommErrCount, TimeoutCount;
    uint64_t DTimer_end; /* ns; runs in states 24 and 26 */

    /* Status&DCnt. */
    uint8_t DCount_i, SDset, DCommErr, DTimeout;

    /* Services of the technology: SDset_DS and PDin_D are its inputs to the SCL, the others are outputs. */
    uint8_t SDset_DS, PDin_D[FS_MAX_FS_PD];
    uint8_t PDout_D[FS_MAX_FS_PD], setSD_DC, ChFAckReq_DC;

    uint8_t answer[FS_MAX_SPDU]; /* the SPDU being sent, all 0 until the first has been received */
};

size_t fs_device_scl_spdu_out(const struct fs_device_scl_setup *setup); /* octets of the SPDU from the FS-Master */
size_t fs_device_scl_spdu_in(const struct fs_device_scl_setup *setup);  /* and to it */

/* Power-on: initial values, "0" is sent, nothing runs. The inputs are 0 as well until the technology sets them. */
void fs_device_scl_initialize(struct fs_device_scl *scl, const struct fs_device_scl_setup *setup);

/* FSP parameterization is done: T20; it has failed: initial values again. Both leave the inputs alone. */
void fs_device_scl_start(struct fs_device_scl *scl, const struct fs_device_scl_setup *setup);
void fs_device_scl_stop(struct fs_device_scl *scl, const struct fs_device_scl_setup *setup);

/* The octets of the SPDU from the FS-Master as they stand at `now`, fs_device_scl_spdu_out() of them. */
void fs_device_scl_receive(struct fs_device_scl *scl, const uint8_t *spdu, uint64_t now);

/* When DTimer expires next, UINT64_MAX if it does not run; and that this has happened by `now`: T30 or T31. */
uint64_t fs_device_scl_next_expiry(const struct fs_device_scl *scl);
void fs_device_scl_expire(struct fs_device_scl *scl, uint64_t now);

#ifdef __cplusplus
}
#endif

#endif
