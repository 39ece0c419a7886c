/* FSPortConfigList of fs_master_config.h.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_master_config.h"

#include <string.h>

#include "fs_crc.h"
#include "fs_master_scl.h"

/* Offsets that are the same in both editions. */
enum { AT_MODE = 2, AT_BACKUP = 3, AT_IQ = 4, AT_CYCLE = 5, AT_VENDOR = 6, AT_DEVICE = 8, AT_EDITION = 12 };

/* Offsets in the FSP_VerifyRecord. */
enum {
    VR_AUTH1 = 0, VR_AUTH2 = 4, VR_PORT = 8, VR_AUTHENT_CRC = 9, VR_VERSION = 11, VR_MODE = 12, VR_WATCHDOG = 13,
    VR_IO_STRUCT_CRC = 15, VR_TECH_PAR_CRC = 17, VR_PROT_PAR_CRC = 21
};

/* Offsets in the I/O structure description, which follows the record. */
enum { IO_SPDU_IN = 1, IO_SPDU_OUT = 6, IO_LENGTH = 11 };

#define PD_MAX 32u /* octets of process data in one direction */
#define V1_1_TIME_TO_READY 500u /* 5 s */
#define V1_1_SHUT_DOWN 100u     /* 1 s, Annex G */

static uint16_t u16(const uint8_t *at)
{
    return (uint16_t)(at[0] << 8 | at[1]);
}

static uint32_t u32(const uint8_t *at)
{
    return (uint32_t)u16(at) << 16 | u16(at + 2);
}

/* IEC 61139-2 puts FSP_TimeToReady and FSP_MinShutDownTime, 4 octets, where v1.1 has two lengths of 1 octet. */
static size_t record_offset(uint8_t edition)
{
    return AT_EDITION + (edition == FS_V1_1 ? 2u : 4u);
}

size_t fs_config_length(uint8_t edition)
{
    return record_offset(edition) + FS_VERIFY_RECORD_LENGTH + IO_LENGTH;
}

uint16_t fs_config_id(uint8_t edition)
{
    return edition == FS_V1_1 ? 0x8001 : 0x8100;
}

int fs_config_is_safety(const struct fs_port_config *config)
{
    return config->port_mode == FS_SAFETYCOM || config->port_mode == FS_MIXEDSAFETYCOM;
}

int fs_config_is_iolink(const struct fs_port_config *config)
{
    return fs_config_is_safety(config) || config->port_mode == FS_IOL_MANUAL || config->port_mode == FS_IOL_AUTOSTART;
}

int fs_config_validates(const struct fs_port_config *config)
{
    return config->validation_backup != 0 && config->port_mode != FS_IOL_AUTOSTART;
}

static void parse_record(struct fs_port_config *config, const uint8_t *record)
{
    memcpy(config->record, record, FS_VERIFY_RECORD_LENGTH);
    config->authenticity1 = u32(record + VR_AUTH1);
    config->authenticity2 = u32(record + VR_AUTH2);
    config->port = record[VR_PORT];
    config->authent_crc = u16(record + VR_AUTHENT_CRC);
    config->prot_version = record[VR_VERSION];
    config->prot_mode = record[VR_MODE];
    config->watchdog = u16(record + VR_WATCHDOG);
    config->io_struct_crc = u16(record + VR_IO_STRUCT_CRC);
    config->tech_par_crc = u32(record + VR_TECH_PAR_CRC);
    config->prot_par_crc = u16(record + VR_PROT_PAR_CRC);
}

static void parse_edition(struct fs_port_config *config, const uint8_t *at, uint8_t edition)
{
    if (edition == FS_V1_1) {
        config->input_length = at[0];
        config->output_length = at[1];
        config->time_to_ready = V1_1_TIME_TO_READY;
        config->min_shut_down_time = V1_1_SHUT_DOWN;
    } else {
        config->time_to_ready = u16(at);
        config->min_shut_down_time = u16(at + 2);
    }
}

static int port_mode_is_known(uint8_t mode, uint8_t edition)
{
    if (mode == FS_DO_CQ)
        return edition == FS_IEC2022; /* 10.4.2 of v1.1 forbids it */
    return mode <= FS_DI_CQ || (mode >= FS_SAFETYCOM && mode <= FS_OSSDE);
}

/* Ports are of class A: no Power 2. A digital input at I/Q is for IEC 61139-2 only. */
static int iq_behavior_is_known(uint8_t iq_behavior, uint8_t edition)
{
    return iq_behavior == 0 || (iq_behavior == 1 && edition == FS_IEC2022);
}

static int ids_are_in_range(const struct fs_port_config *config)
{
    return config->vendor_id != 0 && config->device_id != 0 && config->device_id <= 0xFFFFFF;
}

static int times_are_in_range(const struct fs_port_config *config)
{
    return config->time_to_ready >= 1 && config->time_to_ready <= 0x7FFF && config->min_shut_down_time >= 0x64 &&
           config->min_shut_down_time <= 0x3E8;
}

/* Only what the PortMode has a use for is looked at (10.3.4). */
static int is_in_range(const struct fs_port_config *config, uint8_t edition)
{
    if (!port_mode_is_known(config->port_mode, edition))
        return 0;
    if (!fs_config_is_iolink(config))
        return 1;
    if (!iq_behavior_is_known(config->iq_behavior, edition))
        return 0;
    if (config->port_mode == FS_IOL_AUTOSTART)
        return 1;
    if (config->validation_backup > 4 || !ids_are_in_range(config))
        return 0;
    return !fs_config_is_safety(config) ||
           (times_are_in_range(config) && config->spdu_in + config->input_length <= PD_MAX &&
            config->spdu_out + config->output_length <= PD_MAX);
}

int fs_config_parse(struct fs_port_config *config, const uint8_t *octets, uint8_t edition)
{
    const uint8_t *record = octets + record_offset(edition), *structure = record + FS_VERIFY_RECORD_LENGTH;
    memset(config, 0, sizeof *config);
    config->length = (uint8_t)fs_config_length(edition);
    memcpy(config->octets, octets, config->length);
    config->port_mode = octets[AT_MODE];
    config->validation_backup = octets[AT_BACKUP];
    config->iq_behavior = octets[AT_IQ];
    config->port_cycle_time = octets[AT_CYCLE];
    config->vendor_id = u16(octets + AT_VENDOR);
    config->device_id = u32(octets + AT_DEVICE);
    parse_edition(config, octets + AT_EDITION, edition);
    parse_record(config, record);
    config->spdu_in = structure[IO_SPDU_IN];
    config->spdu_out = structure[IO_SPDU_OUT];
    return is_in_range(config, edition);
}

/* An SPDU holds its safety code and 0 to 3, or 0 to 25, octets of FS process data. */
static int spdu_length_fits(uint8_t length, uint8_t prot_mode)
{
    size_t code = fs_scl_code_length(prot_mode);
    return length >= code && length <= code + (prot_mode == FS_CRC32 ? 25u : 3u);
}

static int protocol_is_known(const struct fs_port_config *config)
{
    uint8_t mode = config->prot_mode;
    return config->prot_version == 1 && (mode == FS_CRC16 || mode == FS_CRC32) &&
           spdu_length_fits(config->spdu_in, mode) && spdu_length_fits(config->spdu_out, mode);
}

unsigned fs_config_deviations(const struct fs_port_config *config, uint8_t port, const uint32_t authenticity[2])
{
    const uint8_t *record = config->record;
    unsigned deviations = 0;
    if (config->authenticity1 != authenticity[0] || config->authenticity2 != authenticity[1])
        deviations |= FS_DEV_AUTHENTICITY;
    if (config->port != port)
        deviations |= FS_DEV_PORT;
    if (config->authent_crc != fs_crc16(FS_CRC_SEED_PARAMETER, record, VR_AUTHENT_CRC))
        deviations |= FS_DEV_AUTHENT_CRC;
    if (config->prot_par_crc != fs_crc16(FS_CRC_SEED_PARAMETER, record + VR_VERSION, VR_PROT_PAR_CRC - VR_VERSION))
        deviations |= FS_DEV_PROT_PAR_CRC;
    if (config->watchdog == 0)
        deviations |= FS_DEV_WATCHDOG;
    if (!protocol_is_known(config))
        deviations |= FS_DEV_PROTOCOL;
    return deviations;
}

unsigned fs_cycle_time(uint8_t coded)
{
    unsigned multiplier = coded & 0x3Fu;
    switch (coded >> 6) {
    case 0:
        return multiplier; /* 0,1 ms each */
    case 1:
        return 64 + 4 * multiplier; /* 6,4 ms and 0,4 ms each */
    default:
        return 320 + 16 * multiplier; /* 32 ms and 1,6 ms each */
    }
}
