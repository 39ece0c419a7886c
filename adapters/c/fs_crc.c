/* Signatures of IO-Link Safety, bit by bit: no table that could hold a misprint of the standard's (Tables D.6, D.7).
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include "fs_crc.h"

uint16_t fs_crc16(uint16_t seed, const uint8_t *octets, size_t length)
{
    uint32_t crc = seed;
    while (length--) {
        crc ^= (uint32_t)*octets++ << 8;
        for (int bit = 0; bit < 8; bit++)
            crc = (crc << 1 ^ (crc & 0x8000u ? 0x4EABu : 0u)) & 0xFFFFu;
    }
    return (uint16_t)crc;
}

uint32_t fs_crc32(uint32_t seed, const uint8_t *octets, size_t length)
{
    uint32_t crc = seed;
    while (length--) {
        crc ^= (uint32_t)*octets++ << 24;
        for (int bit = 0; bit < 8; bit++)
            crc = (crc << 1 ^ (crc & 0x80000000u ? 0xF4ACFB13u : 0u)) & 0xFFFFFFFFu;
    }
    return crc;
}

uint32_t fs_spdu_signature(const uint8_t *octets, size_t length, size_t size)
{
    uint32_t crc = size == FS_CRC16_OCTETS ? fs_crc16(FS_CRC_SEED_SPDU, octets, length)
                                           : fs_crc32(FS_CRC_SEED_SPDU, octets, length);
    return crc != 0 ? crc : 1;
}

void fs_spdu_sign(uint8_t *octets, size_t length, size_t size)
{
    uint32_t crc = fs_spdu_signature(octets, length, size);
    for (size_t i = 0; i < size; i++)
        octets[length + i] = (uint8_t)(crc >> 8 * (size - 1 - i));
}

int fs_spdu_signed(const uint8_t *octets, size_t length, size_t size)
{
    uint32_t received = 0;
    for (size_t i = 0; i < size; i++)
        received = received << 8 | octets[length + i];
    return received == fs_spdu_signature(octets, length, size);
}
