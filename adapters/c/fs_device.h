/* An example FS-Device of IO-Link Safety: what is above the base system, in C99, without allocation or operating system.
 * Written from the documents of both editions; not a certified product and not meant to become one.
 *
 *     base system --> fs_device_read, fs_device_write, fs_device_exchange
 *     timer       --> fs_device_run
 *     technology  <-> inputs and outputs in fs_device.scl
 *
 * Compiled with -DFAULT=1 to 3 it has a mistake that a maker could make, so that fsct has something to find:
 *
 *     | FAULT | mistake                                                    | against                            |
 *     |-------|------------------------------------------------------------|------------------------------------|
 *     | 1     | Counter_check is missing: a jump of MCount is taken        | 11.5.3, Table 40, states 22 and 27 |
 *     | 2     | two SD cycles after a fault instead of three               | 11.5.3, Table 40, SDcycles         |
 *     | 3     | DTimer runs for twice FSP_Watchdog                         | 11.5.5, A.2.6                      |
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_DEVICE_H
#define FS_DEVICE_H

#include "fs_device_fsp.h"
#include "fs_device_scl.h"

#ifdef __cplusplus
extern "C" {
#endif

enum fs_device_state { FS_DEVICE_OFF, FS_DEVICE_PREOPERATE, FS_DEVICE_OPERATE };

/* Data Storage of the base standard: what DS_Command has begun. */
enum fs_device_transfer { FS_NO_TRANSFER, FS_UPLOAD, FS_DOWNLOAD };

struct fs_device {
    struct fs_device_type type;
    struct fs_fsp fsp; /* kept without supply */
    enum fs_device_transfer transfer;
    struct fs_fsp downloaded; /* what DownloadEnd makes of fsp */
    enum fs_device_state state;
    fs_events active; /* Events that have appeared and not yet disappeared */
    struct fs_device_scl scl;
};

/* Events of one call: which have appeared and which have disappeared. */
struct fs_device_events {
    fs_events appeared, disappeared;
};

/* As fresh from the factory, without supply. */
void fs_device_build(struct fs_device *device, const struct fs_device_type *type);

void fs_device_power_on(struct fs_device *device);
void fs_device_power_off(struct fs_device *device);

enum fs_error_type fs_device_read(const struct fs_device *device, uint16_t index, uint8_t subindex, uint8_t *to,
                                  size_t *length);
enum fs_error_type fs_device_write(struct fs_device *device, uint16_t index, uint8_t subindex, const uint8_t *octets,
                                   size_t length, struct fs_device_events *events);

/* One cycle of process data; the first is the change to OPERATE. `received` is null when nothing came. The answer is in
 * scl.answer, fs_device_scl_spdu_in() octets. */
struct fs_device_events fs_device_exchange(struct fs_device *device, const uint8_t *received, uint64_t now);

/* Time has come to `now`. 0 when nothing was due; otherwise what was due first has been done, at the time in `at`, and it
 * is to be called again. */
int fs_device_run(struct fs_device *device, uint64_t now, uint64_t *at);

#ifdef __cplusplus
}
#endif

#endif
