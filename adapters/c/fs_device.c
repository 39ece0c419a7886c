/* See fs_device.h: start-up, on-request data and process data of the FS-Device around its SCL.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_device.h"

#include <string.h>

#include "fs_crc.h"

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
    device->transfer = FS_NO_TRANSFER;
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

/* Index 0x0003: State_Property, Data_Storage_Size, Parameter_Checksum and Index_List of both records. */
static enum fs_error_type read_storage(const struct fs_device *device, uint8_t subindex, uint8_t *to, size_t *length)
{
    static const uint8_t size[4] = {0, 0, 0, 2 * 4 + FS_AUTHENTICITY_OCTETS + FS_PROTOCOL_OCTETS};
    static const uint8_t list[8] = {0x42, 0x00, 0, 0x42, 0x01, 0, 0, 0};
    uint8_t kept[FS_AUTHENTICITY_OCTETS + FS_PROTOCOL_OCTETS];
    uint32_t checksum;
    switch (subindex) {
    case 1: return FS_ACCESS_DENIED;
    case 2: to[0] = (uint8_t)(device->transfer << 1), *length = 1; return FS_NO_ERROR;
    case 3: memcpy(to, size, sizeof size), *length = sizeof size; return FS_NO_ERROR;
    case 4:
        memcpy(kept, device->fsp.authenticity, FS_AUTHENTICITY_OCTETS);
        memcpy(kept + FS_AUTHENTICITY_OCTETS, device->fsp.protocol, FS_PROTOCOL_OCTETS);
        checksum = fs_crc32(FS_CRC_SEED_PARAMETER, kept, sizeof kept);
        for (size_t n = 0; n < 4; n++)
            to[n] = (uint8_t)(checksum >> (24 - 8 * n));
        *length = 4;
        return FS_NO_ERROR;
    case 5: memcpy(to, list, sizeof list), *length = sizeof list; return FS_NO_ERROR;
    default: return FS_SUBINDEX_NOT_AVAILABLE;
    }
}

/* DS_Command. A device in use takes no download; 0x8022 is the answer of iec2022, and V1.1 names none. */
static enum fs_error_type storage_command(struct fs_device *device, uint8_t subindex, const uint8_t *octets, size_t length)
{
    if (subindex != 1)
        return subindex > 1 && subindex <= 5 ? FS_ACCESS_DENIED : FS_SUBINDEX_NOT_AVAILABLE;
    if (length != 1)
        return length > 1 ? FS_LENGTH_OVERRUN : FS_LENGTH_UNDERRUN;
    switch (octets[0]) {
    case 0x01: device->transfer = FS_UPLOAD; return FS_NO_ERROR;
    case 0x03:
        if (!fs_fsp_back_to_box(&device->fsp))
            return FS_NOT_NOW;
        device->transfer = FS_DOWNLOAD, device->downloaded = device->fsp;
        return FS_NO_ERROR;
    case 0x02:
    case 0x04:
        if (device->transfer != (octets[0] == 0x02 ? FS_UPLOAD : FS_DOWNLOAD))
            return FS_NO_FUNCTION_NOW;
        if (device->transfer == FS_DOWNLOAD)
            device->fsp = device->downloaded;
        device->transfer = FS_NO_TRANSFER;
        return FS_NO_ERROR;
    case 0x05: device->transfer = FS_NO_TRANSFER; return FS_NO_ERROR;
    default: return FS_OUT_OF_RANGE;
    }
}

/* Resets: 0x82 of V1.1; 0x81, which finds nothing of the application here, and 0x83 of IEC 61139-2. None while armed. */
static enum fs_error_type system_command(struct fs_device *device, uint8_t subindex, const uint8_t *octets, size_t length)
{
    int to_the_box = length == 1 && octets[0] == (device->type.edition == FS_V1_1 ? 0x82 : 0x83);
    if (subindex != 0)
        return FS_SUBINDEX_NOT_AVAILABLE;
    if (length != 1)
        return length > 1 ? FS_LENGTH_OVERRUN : FS_LENGTH_UNDERRUN;
    if (!to_the_box && !(device->type.edition == FS_IEC2022 && octets[0] == 0x81))
        return FS_NO_FUNCTION;
    if (fs_fsp_armed(&device->fsp) || device->scl.state != FS_DEVICE_SCL_OFF)
        return FS_NO_FUNCTION_NOW;
    if (to_the_box)
        fs_fsp_factory(&device->fsp, &device->type);
    return FS_NO_ERROR;
}

enum fs_error_type fs_device_read(const struct fs_device *device, uint16_t index, uint8_t subindex, uint8_t *to,
                                  size_t *length)
{
    switch (index) {
    case 0x0002: return FS_ACCESS_DENIED;
    case 0x0003: return read_storage(device, subindex, to, length);
    case 0x000C: /* Device Access Lock: nothing is locked */
    case 0x000D: /* ProfileCharacteristic: IO-Link Safety */
        if (subindex > (index == 0x000D))
            return FS_SUBINDEX_NOT_AVAILABLE;
        to[0] = index == 0x000D ? 0x40 : 0, to[1] = index == 0x000D ? 0x01 : 0, *length = 2;
        return FS_NO_ERROR;
    default: break;
    }
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
    switch (index) {
    case 0x0002: return system_command(device, subindex, octets, length);
    case 0x0003: return storage_command(device, subindex, octets, length);
    case 0x000C:
    case 0x000D: return FS_ACCESS_DENIED;
    case 0x4202: return verify(device, subindex, octets, length, events);
    default: break;
    }
    if ((index == 0x4200 || index == 0x4201) && device->scl.state != FS_DEVICE_SCL_OFF)
        return FS_NOT_NOW; /* the SCL lives by what is stored */
    return fs_fsp_write(device->transfer == FS_DOWNLOAD ? &device->downloaded : &device->fsp, &device->type, index,
                        subindex, octets, length);
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
