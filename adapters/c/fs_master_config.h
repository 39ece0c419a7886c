/* FSPortConfigList of both editions (v1.1 Table 22, IEC 61139-2 Table 21), the FSP_VerifyRecord in it, and the checks
 * the FS-Master makes on them. Knows octets and ranges, nothing of ports.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_MASTER_CONFIG_H
#define FS_MASTER_CONFIG_H

#include <stddef.h>
#include <stdint.h>

enum fs_edition { FS_V1_1 = 1, FS_IEC2022 = 2 };

enum fs_port_mode {
    FS_DEACTIVATED = 0, FS_IOL_MANUAL = 1, FS_IOL_AUTOSTART = 2, FS_DI_CQ = 3, FS_DO_CQ = 4,
    FS_SAFETYCOM = 49, FS_MIXEDSAFETYCOM = 50, FS_OSSDE = 51
};

#define FS_CONFIG_MAX 50u
#define FS_VERIFY_RECORD_LENGTH 23u
#define FS_VERIFY_RECORD_INDEX 0x4202u

struct fs_port_config {
    uint8_t octets[FS_CONFIG_MAX]; /* as it was written, ArgBlockID in front */
    uint8_t length;
    uint8_t port_mode, validation_backup, iq_behavior, port_cycle_time;
    uint16_t vendor_id;
    uint32_t device_id;
    uint8_t input_length, output_length; /* v1.1: octets of non-safety process data */
    uint16_t time_to_ready, min_shut_down_time; /* in units of 10 ms */
    /* FSP_VerifyRecord */
    uint32_t authenticity1, authenticity2;
    uint8_t port;
    uint16_t authent_crc;
    uint8_t prot_version, prot_mode;
    uint16_t watchdog; /* ms */
    uint16_t io_struct_crc;
    uint32_t tech_par_crc;
    uint16_t prot_par_crc;
    uint8_t record[FS_VERIFY_RECORD_LENGTH];
    /* I/O structure description */
    uint8_t spdu_in, spdu_out; /* octets */
};

/* Octets of FSPortConfigList and its ArgBlockID. */
size_t fs_config_length(uint8_t edition);
uint16_t fs_config_id(uint8_t edition);

/* Takes the fs_config_length() octets; 0 = a value outside its range. FSP parameters are not looked at here: what
 * deviates is found when the port starts, and reported (B.2). */
int fs_config_parse(struct fs_port_config *config, const uint8_t *octets, uint8_t edition);

int fs_config_is_safety(const struct fs_port_config *config); /* SAFETYCOM or MIXEDSAFETYCOM */
int fs_config_is_iolink(const struct fs_port_config *config); /* communicates, with or without SCL */
int fs_config_validates(const struct fs_port_config *config); /* VendorID and DeviceID are looked at */

/* What keeps the SCL from starting; 0 = nothing. */
enum fs_config_deviation {
    FS_DEV_AUTHENTICITY = 1,
    FS_DEV_PORT = 2,
    FS_DEV_AUTHENT_CRC = 4,
    FS_DEV_PROT_PAR_CRC = 8,
    FS_DEV_WATCHDOG = 16,
    FS_DEV_PROTOCOL = 32 /* version, mode or SPDU length: no EventCode is printed for it */
};
unsigned fs_config_deviations(const struct fs_port_config *config, uint8_t port, const uint32_t authenticity[2]);

/* A cycle time of the base standard in units of 0,1 ms. */
unsigned fs_cycle_time(uint8_t coded);

#endif
