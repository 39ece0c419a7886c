/* Signatures of IO-Link Safety, Annex D: CRC-16 with generator 4EAB and CRC-32 with generator F4ACFB13, most significant
 * bit first, neither reflected nor inverted. Knows nothing of SPDUs but where their signature starts and ends.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef FS_CRC_H
#define FS_CRC_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Signatures of FSP parameter blocks start from 0 (A.2), those of SPDUs from 1 (11.4.7). */
#define FS_CRC_SEED_PARAMETER 0u
#define FS_CRC_SEED_SPDU 1u

/* The register after `octets`, which started as `seed`. To go on with more octets, hand the result in as the seed. */
uint16_t fs_crc16(uint16_t seed, const uint8_t *octets, size_t length);
uint32_t fs_crc32(uint32_t seed, const uint8_t *octets, size_t length);

/* Octets of signature in an SPDU: 2 with FSP_ProtMode 1, 4 with FSP_ProtMode 2. */
#define FS_CRC16_OCTETS 2u
#define FS_CRC32_OCTETS 4u

/* The signature of an SPDU over the `length` octets in front of it, and where it goes: the `size` octets (2 or 4) behind
 * them. A result of 0 becomes 1, so that an SPDU of zeros is never valid (11.4.7). */
uint32_t fs_spdu_signature(const uint8_t *octets, size_t length, size_t size);
void fs_spdu_sign(uint8_t *octets, size_t length, size_t size);
int fs_spdu_signed(const uint8_t *octets, size_t length, size_t size); /* 1 = the signature there is right */

#ifdef __cplusplus
}
#endif

#endif
