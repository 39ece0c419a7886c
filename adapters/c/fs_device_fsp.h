/* FSP parameters of an FS-Device, Annex A: the records in its non-volatile memory, and what it makes of the verify record.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_DEVICE_FSP_H
#define FS_DEVICE_FSP_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { FS_V1_1 = 1, FS_IEC2022 = 2 };    /* edition */
enum { FS_MODE_CRC16 = 1, FS_MODE_CRC32 = 2 }; /* FSP_ProtMode, Table A.3 */

#define FS_AUTHENTICITY_OCTETS 11u
#define FS_PROTOCOL_OCTETS 12u
#define FS_VERIFY_OCTETS 23u

/* What the maker has built. */
struct fs_device_type {
    uint8_t edition, mode;
    uint8_t pd_out, pd_in; /* octets of FS-PDout and FS-PDin */
};

/* Records 0x4200 and 0x4201 as they are transferred. */
struct fs_fsp {
    uint8_t authenticity[FS_AUTHENTICITY_OCTETS];
    uint8_t protocol[FS_PROTOCOL_OCTETS];
};

/* ErrorTypes of the base standard. */
enum fs_error_type {
    FS_NO_ERROR = 0,
    FS_INDEX_NOT_AVAILABLE = 0x8011,
    FS_SUBINDEX_NOT_AVAILABLE = 0x8012,
    FS_NOT_NOW = 0x8022, /* temporarily not available, device control */
    FS_ACCESS_DENIED = 0x8023,
    FS_OUT_OF_RANGE = 0x8030,
    FS_LENGTH_OVERRUN = 0x8033,
    FS_LENGTH_UNDERRUN = 0x8034,
    FS_NO_FUNCTION = 0x8035,
    FS_NO_FUNCTION_NOW = 0x8036,
    FS_INVALID_SET = 0x8040
};

/* Set of EventCodes 0xB000 to 0xB00A, Table B.1: bit n is 0xB000 + n. */
typedef uint16_t fs_events;
enum {
    FS_EVENT_AUTHENTICITY = 1u << 3,
    FS_EVENT_PORT = 1u << 4,
    FS_EVENT_AUTHENTCRC = 1u << 5,
    FS_EVENT_PROTPARCRC = 1u << 6,
    FS_EVENT_TECHPARCRC = 1u << 7,
    FS_EVENT_IO_STRUCTCRC = 1u << 8,
    FS_EVENT_WATCHDOG = 1u << 9,
    FS_EVENT_NO_RECORD = 1u << 10
};

/* Factory setting, Table G.1: no authenticity, no port, FSP_TechParCRC not 0. */
void fs_fsp_factory(struct fs_fsp *fsp, const struct fs_device_type *type);

int fs_fsp_back_to_box(const struct fs_fsp *fsp); /* authenticity and port are 0: nobody has assigned it yet */
int fs_fsp_armed(const struct fs_fsp *fsp);       /* FSP_TechParCRC is not 0 */

/* On-request data 0x4200 to 0x42FF. A read gives up to 32 octets. */
enum fs_error_type fs_fsp_read(const struct fs_fsp *fsp, const struct fs_device_type *type, uint16_t index,
                               uint8_t subindex, uint8_t *to, size_t *length);
enum fs_error_type fs_fsp_write(struct fs_fsp *fsp, const struct fs_device_type *type, uint16_t index, uint8_t subindex,
                                const uint8_t *octets, size_t length);

/* Compares an FSP_VerifyRecord with what is stored and what is built. `deviates`: the SCL must not start; some deviations
 * have no EventCode of their own. */
fs_events fs_fsp_verify(const struct fs_fsp *fsp, const struct fs_device_type *type, const uint8_t *record, int *deviates);

uint8_t fs_fsp_port(const struct fs_fsp *fsp);
uint16_t fs_fsp_watchdog(const struct fs_fsp *fsp); /* ms */

#ifdef __cplusplus
}
#endif

#endif
