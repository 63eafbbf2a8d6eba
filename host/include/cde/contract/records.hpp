// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// @file
/// Slots and records, in words of the container width: rtl/contract/records_pkg.sv in C++, under
/// the same names.
namespace cde::card {

/// A slot holds the words of its shape. Slots are packed in DDR and padded to whole beats in the
/// primary register file. A card's primary slot has the size of its largest primary.
inline constexpr unsigned kDdrWords = 9;  ///< words of a DDR beat
inline constexpr std::uint64_t kMostPrimaries =
    256;  ///< slots of the primary register file, at most

/// On the bus a record of 32-bit words takes three and a half beats.
inline constexpr unsigned kRecordWords = 7;
inline constexpr unsigned kRecordCp = 0;  ///< 3 words
inline constexpr unsigned kRecordFlags = 3;
inline constexpr unsigned kRecordIndex = 4;  ///< secondary index, all ones if none
inline constexpr unsigned kRecordT = 5;
inline constexpr unsigned kRecordPrimary = 6;

/// Bit numbers of the flags word.
inline constexpr unsigned kFlagF = 0;
inline constexpr unsigned kFlagBad = 1;
/// Second record: n in CP's words, the signed distance in T.
inline constexpr unsigned kFlagNormal = 2;

/// An entry of an object table is a range and a transform. Words are written in ascending order.
/// The range takes effect with its second word, the transform with its last.
inline constexpr unsigned kObjectWords = 16;        ///< distance between entries
inline constexpr unsigned kObjectFirst = 0;         ///< first slot
inline constexpr unsigned kObjectCount = 1;         ///< slots
inline constexpr unsigned kObjectRotation = 2;      ///< 9 words, row by row
inline constexpr unsigned kObjectTranslation = 11;  ///< 3 words
inline constexpr unsigned kObjectEnd = 14;          ///< words in use

}  // namespace cde::card
