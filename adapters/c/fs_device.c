/* See fs_device.h: start-up, on-request data and process data of the FS-Device around its SCL.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_device.h"

#include <string.h>

static struct fs_device_scl_setup setup_of(const struct fs_device *device)
{
    struct fs_device_scl_setup setup;
    setup.signature_octets = device->type.mode == FS_MODE_CRC16 ? FS_CRC16_OCTETS : FS_CRC32_OCTETS;
    setup.pd_out = device->type.pd_out, setup.pd_in = device->type.pd_in;
    setup.FSP_Port = fs_fsp_port(&device->fsp);
    setup.FSP_Watchdog = fs_fsp_watchdog(&device->fsp);
    return setup;
}

/* PDout_D is 0 and "0" is sent from here on (Table 40, Initialization). */
static void initialize(struct fs_device *device)
{
    struct fs_device_scl_setup setup = setup_of(device);
    fs_device_scl_initialize(&device->scl, &setup);
    device->active = 0;
}

void fs_device_build(struct fs_device *device, const struct fs_device_type *type)
{
    memset(device, 0, sizeof *device);
    device->type = *type;
    fs_fsp_factory(&device->fsp, type);
    initialize(device);
}

void fs_device_power_on(struct fs_device *device)
{
    initialize(device);
    device->state = FS_DEVICE_PREOPERATE;
}

void fs_device_power_off(struct fs_device *device)
{
    initialize(device);
    device->state = FS_DEVICE_OFF;
}

enum fs_error_type fs_device_read(const struct fs_device *device, uint16_t index, uint8_t subindex, uint8_t *to,
                                  size_t *length)
{
    return fs_fsp_read(&device->fsp, &device->type, index, subindex, to, length);
}

static struct fs_device_events become_active(struct fs_device *device, fs_events active)
{
    struct fs_device_events events;
    events.appeared = active & ~device->active & 0xFFFFu;
    events.disappeared = device->active & ~active & 0xFFFFu;
    device->active = active;
    return events;
}

/* FSP_VerifyRecord: as a whole, in PREOPERATE (A.2.10). Taken even if it deviates; then the SCL does not start and Events
 * say why (10.4.3.1). */
static enum fs_error_type verify(struct fs_device *device, uint8_t subindex, const uint8_t *record, size_t length,
                                 struct fs_device_events *events)
{
    struct fs_device_scl_setup setup = setup_of(device);
    int deviates;
    if (subindex != 0)
        return FS_SUBINDEX_NOT_AVAILABLE;
    if (length != FS_VERIFY_OCTETS)
        return length > FS_VERIFY_OCTETS ? FS_LENGTH_OVERRUN : FS_LENGTH_UNDERRUN;
    if (device->state != FS_DEVICE_PREOPERATE)
        return FS_NOT_NOW;
    *events = become_active(device, fs_fsp_verify(&device->fsp, &device->type, record, &deviates));
    if (deviates)
        fs_device_scl_stop(&device->scl, &setup);
    else
        fs_device_scl_start(&device->scl, &setup);
    return FS_NO_ERROR;
}

enum fs_error_type fs_device_write(struct fs_device *device, uint16_t index, uint8_t subindex, const uint8_t *octets,
                                   size_t length, struct fs_device_events *events)
{
    events->appeared = events->disappeared = 0;
    if (index == 0x4202)
        return verify(device, subindex, octets, length, events);
    if ((index == 0x4200 || index == 0x4201) && device->scl.state != FS_DEVICE_SCL_OFF)
        return FS_NOT_NOW; /* the SCL lives by what is stored */
    return fs_fsp_write(&device->fsp, &device->type, index, subindex, octets, length);
}

struct fs_device_events fs_device_exchange(struct fs_device *device, const uint8_t *received, uint64_t now)
{
    struct fs_device_events events = {0, 0};
    if (device->state == FS_DEVICE_PREOPERATE) {
        device->state = FS_DEVICE_OPERATE;
        if (device->type.edition == FS_IEC2022 && device->scl.state == FS_DEVICE_SCL_OFF && device->active == 0)
            events = become_active(device, FS_EVENT_NO_RECORD); /* 0xB00A, Table B.1 of that edition */
    }
    if (received != NULL)
        fs_device_scl_receive(&device->scl, received, now);
    return events;
}

int fs_device_run(struct fs_device *device, uint64_t now, uint64_t *at)
{
    *at = fs_device_scl_next_expiry(&device->scl);
    if (*at > now)
        return 0;
    fs_device_scl_expire(&device->scl, *at);
    return 1;
}
