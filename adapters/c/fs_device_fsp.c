/* See fs_device_fsp.h. All signatures of parameters start from 0; the field of the signature is not part of it.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_device_fsp.h"

#include <string.h>

#include "fs_crc.h"

/* Where the parameters are in their records, Table A.1. */
enum { AUTH_1 = 0, AUTH_2 = 4, PORT = 8, AUTHENTCRC = 9 };
enum { VERSION = 0, MODE = 1, WATCHDOG = 2, IO_STRUCTCRC = 4, TECHPARCRC = 6, PROTPARCRC = 10 };

#define PROT_VERSION 0x01u
#define DEFAULT_WATCHDOG 100u      /* ms */
#define FACTORY_TECHPARCRC 1u      /* a production value, so not 0 */
#define TIME_TO_READY 20u          /* 200 ms */
#define MIN_SHUT_DOWN_TIME 100u    /* 1 s */
#define WCDT 10u                   /* ms */
#define OFDT 20u                   /* ms; greater than FSP_WCDT (H.6) */

static uint16_t get16(const uint8_t *octets)
{
    return (uint16_t)(octets[0] << 8 | octets[1]);
}

static uint8_t *put(uint8_t *to, uint32_t number, size_t length)
{
    for (size_t i = length; i-- > 0; number >>= 8)
        to[i] = (uint8_t)number;
    return to + length;
}

static int right(const uint8_t *record, size_t signature_at)
{
    return fs_crc16(FS_CRC_SEED_PARAMETER, record, signature_at) == get16(record + signature_at);
}

/* FSP_IO_StructCRC over Table A.4. The data this stack offers are Boolean octets without padding. */
static uint16_t io_struct_crc(const struct fs_device_type *type)
{
    uint8_t safety_code = type->mode == FS_MODE_CRC16 ? 4 : 6;
    uint8_t items[11] = {0};
    items[0] = 0x01; /* IO_DescVersion */
    items[1] = (uint8_t)(type->pd_in + safety_code), items[2] = (uint8_t)(8 * type->pd_in), items[3] = type->pd_in;
    items[6] = (uint8_t)(type->pd_out + safety_code), items[7] = (uint8_t)(8 * type->pd_out), items[8] = type->pd_out;
    return fs_crc16(FS_CRC_SEED_PARAMETER, items, sizeof items);
}

void fs_fsp_factory(struct fs_fsp *fsp, const struct fs_device_type *type)
{
    uint8_t *to = fsp->protocol;
    memset(fsp, 0, sizeof *fsp);
    to = put(to, PROT_VERSION, 1);
    to = put(to, type->mode, 1);
    to = put(to, DEFAULT_WATCHDOG, 2);
    to = put(to, io_struct_crc(type), 2);
    to = put(to, FACTORY_TECHPARCRC, 4);
    put(to, fs_crc16(FS_CRC_SEED_PARAMETER, fsp->protocol, PROTPARCRC), 2);
}

uint8_t fs_fsp_port(const struct fs_fsp *fsp)
{
    return fsp->authenticity[PORT];
}

int fs_fsp_back_to_box(const struct fs_fsp *fsp)
{
    static const uint8_t unassigned[AUTHENTCRC] = {0};
    return memcmp(fsp->authenticity, unassigned, AUTHENTCRC) == 0;
}

int fs_fsp_armed(const struct fs_fsp *fsp)
{
    return (get16(fsp->protocol + TECHPARCRC) | get16(fsp->protocol + TECHPARCRC + 2)) != 0;
}

uint16_t fs_fsp_watchdog(const struct fs_fsp *fsp)
{
    return get16(fsp->protocol + WATCHDOG);
}

/* One item of Figure E.1: Subindex, bitOffset, and its default, which says its type by its length (1, 2, 3 for 8, 16, 32
 * bits). */
static uint8_t *describe_item(uint8_t *to, uint8_t subindex, uint16_t bit_offset, uint32_t value, size_t octets)
{
    to = put(put(to, subindex, 1), bit_offset, 2);
    to = put(to, octets == 4 ? 3 : (uint32_t)octets, 1);
    return put(to, value, octets);
}

/* FSP_ParamDescCRC over the description of both records in the IODD (E.5): CRC-16 in V1.1, CRC-32 in IEC 61139-2. */
static size_t param_desc_crc(const struct fs_device_type *type, uint8_t *signature)
{
    uint8_t stream[77], *at = stream;
    at = put(put(at, 0x4200, 2), 8 * FS_AUTHENTICITY_OCTETS, 2);
    at = describe_item(at, 1, 56, 0, 4);
    at = describe_item(at, 2, 24, 0, 4);
    at = describe_item(at, 3, 16, 0, 1);
    at = describe_item(at, 4, 0, 0, 2);
    at = put(put(at, 0x4201, 2), 8 * FS_PROTOCOL_OCTETS, 2);
    at = put(describe_item(at, 1, 88, PROT_VERSION, 1), PROT_VERSION, 1);
    at = put(describe_item(at, 2, 80, type->mode, 1), type->mode, 1);
    at = put(put(describe_item(at, 3, 64, DEFAULT_WATCHDOG, 2), 1, 2), 65535, 2);
    at = describe_item(at, 4, 48, io_struct_crc(type), 2);
    at = describe_item(at, 5, 16, 0, 4);
    at = describe_item(at, 6, 0, 0, 2);
    if (type->edition == FS_V1_1)
        return (size_t)(put(signature, fs_crc16(FS_CRC_SEED_PARAMETER, stream, (size_t)(at - stream)), 2) - signature);
    return (size_t)(put(signature, fs_crc32(FS_CRC_SEED_PARAMETER, stream, (size_t)(at - stream)), 4) - signature);
}

/* A record or one of its items; `ends` are the offsets behind Subindex 1, 2, and so on. */
static enum fs_error_type read_record(const uint8_t *record, const uint8_t *ends, uint8_t items, uint8_t subindex,
                                      uint8_t *to, size_t *length)
{
    size_t start = subindex > 1 && subindex <= items ? ends[subindex - 2] : 0;
    if (subindex > items)
        return FS_SUBINDEX_NOT_AVAILABLE;
    *length = ends[subindex == 0 ? items - 1 : subindex - 1] - start;
    memcpy(to, record + start, *length);
    return FS_NO_ERROR;
}

/* FS_Password and Reset_FS_Password of V1.1, up to 32 octets, write only. They stand in front of FST parameters; how is
 * the maker's choice (A.2.11), and this stack has no FST parameters, so nothing is kept. */
static int is_password(const struct fs_device_type *type, uint16_t index)
{
    return type->edition == FS_V1_1 && (index == 0x4210 || index == 0x4211);
}

/* Auxiliary parameters. */
static enum fs_error_type read_auxiliary(const struct fs_device_type *type, uint16_t index, uint8_t subindex, uint8_t *to,
                                         size_t *length)
{
    uint16_t value;
    switch (index) {
    case 0x4210: value = TIME_TO_READY; break;
    case 0x4211: value = MIN_SHUT_DOWN_TIME; break;
    case 0x4212: value = 0; break;
    case 0x4213: value = WCDT; break;
    case 0x4214: value = OFDT; break;
    default: return FS_INDEX_NOT_AVAILABLE;
    }
    if (is_password(type, index))
        return FS_ACCESS_DENIED;
    if (type->edition == FS_V1_1 && index != 0x4212)
        return FS_INDEX_NOT_AVAILABLE;
    if (subindex != 0)
        return FS_SUBINDEX_NOT_AVAILABLE;
    *length = index == 0x4212 ? param_desc_crc(type, to) : (size_t)(put(to, value, 2) - to);
    return FS_NO_ERROR;
}

enum fs_error_type fs_fsp_read(const struct fs_fsp *fsp, const struct fs_device_type *type, uint16_t index,
                               uint8_t subindex, uint8_t *to, size_t *length)
{
    static const uint8_t authenticity_ends[] = {4, 8, 9, 11}, protocol_ends[] = {1, 2, 4, 6, 10, 12};
    switch (index) {
    case 0x4200: return read_record(fsp->authenticity, authenticity_ends, 4, subindex, to, length);
    case 0x4201: return read_record(fsp->protocol, protocol_ends, 6, subindex, to, length);
    case 0x4202: return FS_ACCESS_DENIED; /* write only */
    default: return read_auxiliary(type, index, subindex, to, length);
    }
}

static enum fs_error_type write_auxiliary(const struct fs_device_type *type, uint16_t index, uint8_t subindex,
                                          size_t length)
{
    uint8_t value[4];
    size_t ignored;
    enum fs_error_type error;
    if (is_password(type, index) && subindex == 0)
        return length > 32 ? FS_LENGTH_OVERRUN : FS_NO_ERROR;
    error = read_auxiliary(type, index, subindex, value, &ignored);
    return error == FS_NO_ERROR ? FS_ACCESS_DENIED : error; /* those that can be read are read only */
}

static enum fs_error_type check_authenticity(const uint8_t *record)
{
    if (!right(record, AUTHENTCRC))
        return FS_INVALID_SET;
    return record[PORT] == 0 ? FS_OUT_OF_RANGE : FS_NO_ERROR; /* A.2.2 */
}

static enum fs_error_type check_protocol(const struct fs_device_type *type, const uint8_t *record)
{
    if (!right(record, PROTPARCRC))
        return FS_INVALID_SET;
    if (record[VERSION] != PROT_VERSION || record[MODE] != type->mode || get16(record + WATCHDOG) == 0
        || get16(record + IO_STRUCTCRC) != io_struct_crc(type))
        return FS_OUT_OF_RANGE;
    return FS_NO_ERROR;
}

/* Only entire records are taken (A.2.1, A.2.9), so that a signature always covers what it came with. */
enum fs_error_type fs_fsp_write(struct fs_fsp *fsp, const struct fs_device_type *type, uint16_t index, uint8_t subindex,
                                const uint8_t *octets, size_t length)
{
    size_t octets_of = index == 0x4200 ? FS_AUTHENTICITY_OCTETS : FS_PROTOCOL_OCTETS;
    enum fs_error_type error;
    if (index != 0x4200 && index != 0x4201)
        return write_auxiliary(type, index, subindex, length);
    if (subindex != 0)
        return subindex > (index == 0x4200 ? 4 : 6) ? FS_SUBINDEX_NOT_AVAILABLE : FS_ACCESS_DENIED;
    if (length != octets_of)
        return length > octets_of ? FS_LENGTH_OVERRUN : FS_LENGTH_UNDERRUN;
    error = index == 0x4200 ? check_authenticity(octets) : check_protocol(type, octets);
    if (error == FS_NO_ERROR)
        memcpy(index == 0x4200 ? fsp->authenticity : fsp->protocol, octets, length);
    return error;
}

fs_events fs_fsp_verify(const struct fs_fsp *fsp, const struct fs_device_type *type, const uint8_t *record, int *deviates)
{
    const uint8_t *authenticity = record, *protocol = record + FS_AUTHENTICITY_OCTETS;
    fs_events events = 0;
    static const uint8_t by_default[PORT] = {0}; /* no SCL with it, E.5.2 */
    if (memcmp(authenticity + AUTH_1, fsp->authenticity + AUTH_1, PORT - AUTH_1) != 0
        || memcmp(authenticity + AUTH_1, by_default, PORT - AUTH_1) == 0)
        events |= FS_EVENT_AUTHENTICITY;
    if (authenticity[PORT] == 0 || authenticity[PORT] != fsp->authenticity[PORT])
        events |= FS_EVENT_PORT;
    if (!right(authenticity, AUTHENTCRC))
        events |= FS_EVENT_AUTHENTCRC;
    if (!right(protocol, PROTPARCRC))
        events |= FS_EVENT_PROTPARCRC;
    if (memcmp(protocol + TECHPARCRC, fsp->protocol + TECHPARCRC, PROTPARCRC - TECHPARCRC) != 0)
        events |= FS_EVENT_TECHPARCRC;
    if (get16(protocol + IO_STRUCTCRC) != io_struct_crc(type))
        events |= FS_EVENT_IO_STRUCTCRC;
    if (get16(protocol + WATCHDOG) == 0)
        events |= FS_EVENT_WATCHDOG;
    /* Version, mode and another valid watchdog have no code of their own; any deviating signature keeps the SCL from
     * starting (11.5.7). */
    *deviates = events != 0 || memcmp(authenticity, fsp->authenticity, FS_AUTHENTICITY_OCTETS) != 0
                || memcmp(protocol, fsp->protocol, FS_PROTOCOL_OCTETS) != 0;
    if (*deviates && events == 0)
        events = FS_EVENT_PROTPARCRC;
    return events;
}
