#pragma once
#include <cstdint>

/// What software and hardware share: the C++ side of rtl/cde_pkg.sv, under the same names.
/// tests/board parses that file and holds every constant here against it.
namespace cde::card {

/// Spaces of the local bus; a beat is 64 bits.
enum Space : std::uint32_t {
  kSpaceReg = 0,   ///< registers, 64 bits at 8-byte offsets
  kSpacePrim = 1,  ///< primary register file, kPrimWords words a slot, write only
  kSpaceDdr = 2,   ///< secondary memory, packed slots, write only
  kSpaceSram = 3,  ///< record stream: every beat read takes the next words of the ring
};

/// Register offsets in bytes.
enum Register : std::uint32_t {
  kRegId = 0x000,          ///< [63:32] kIdMagic, [31:0] kInterfaceVersion
  kRegCaps = 0x008,        ///< [15:0] lanes, [31:16] primaries, [39:32] exponent bits, [47:40]
                           ///< fraction bits, [55:48] algorithm
  kRegConfigHash = 0x010,  ///< hash of parameters and RTL sources
  kRegCaps2 = 0x018,       ///< [15:0] pipe latency, [47:16] SRAM records, [55:48] container bits
  kRegCapacity = 0x020,    ///< bytes of DDR
  kRegControl = 0x028,     ///< write: kControl* bits
  kRegStatus = 0x030,      ///< kStatus* bits
  kRegCommand = 0x038,     ///< [2:0] result mode, kCommand* bits, [11:8] pair code, [19:16] code of
                           ///< the second pair
  kRegPrimCount = 0x040,   ///< primaries in the register file
  kRegSecFirst = 0x048,    ///< first secondary slot
  kRegSecCount = 0x050,    ///< number of secondaries
  kRegRecords = 0x058,     ///< records waiting in the SRAM ring
  kRegFaultAddr = 0x060,   ///< [33:32] space, [31:0] offset of the first refused access
  kRegWriteback = 0x068,   ///< clocks that wrote the kept records back to SRAM
  kRegCaps3 = 0x070,       ///< [12:0] pairs in the card, [16] roles can be swapped, [17] normals,
                           ///< [18] two pairs at a time, [20:19] kTransform*, [21] check bits,
                           ///< [22] box rule of ray-triangle, [31:24] words of a primary slot,
                           ///< [47:32] and [63:48] entries of the object tables
  kRegPrimSplit = 0x078,   ///< with a second pair: the first of its primaries
  kRegStencil = 0x080,     ///< primaries/64 registers: 1 masks a primary
  kRegBudget = 0x0A0,      ///< work for a cylinder pair: [7:0] M, [15:8] K1, [23:16] K2
  kRegEcc = 0x0B8,  ///< words read from DDR in a pass: [31:0] corrected, [63:32] with more errors
  kRegObjectCount = 0x0A8,      ///< objects to sweep; 0: the slots of kRegSecFirst and kRegSecCount
  kRegPrimObjectCount = 0x0B0,  ///< objects of primaries; 0: primaries as they were written
  kRegCycles = 0x0C0,           ///< clocks from go to done, without kRegWriteback
  kRegRows = 0x0C8,             ///< rows issued to the pipe (one row is `lanes` pairs)
  kRegStalls = 0x0D0,       ///< clocks the pipe mouth waited for output space, or for a slot of a
                            ///< cylinder pipe
  kRegBubbles = 0x0D8,      ///< clocks the pipe mouth waited for a secondary
  kRegBadPrim = 0x0E0,      ///< primaries refused as bad input
  kRegBadSec = 0x0E8,       ///< secondaries refused as bad input
  kRegSecondaries = 0x0F0,  ///< secondaries swept
  kRegWritten = 0x0F8,      ///< records written to SRAM
};

/// Object tables, in kSpaceReg above the registers, write only: an entry is a range and a
/// transform. The range takes effect with its second word, the transform with its last; both are
/// written in ascending order.
inline constexpr std::uint32_t kObjectTable = 0x40000;      ///< of secondaries
inline constexpr std::uint32_t kPrimObjectTable = 0x80000;  ///< of primaries
inline constexpr unsigned kObjectWords = 16;                ///< from entry to entry
inline constexpr unsigned kObjectFirst = 0;                 ///< first slot
inline constexpr unsigned kObjectCount = 1;                 ///< slots
inline constexpr unsigned kObjectRotation = 2;              ///< 9 words, row by row
inline constexpr unsigned kObjectTranslation = 11;          ///< 3 words
inline constexpr unsigned kObjectEnd = 14;                  ///< words in use
inline constexpr unsigned kTransformNone = 0;
inline constexpr unsigned kTransformSecondaries = 1;
inline constexpr unsigned kTransformBoth = 2;

inline constexpr std::uint32_t kIdMagic = 0x43444531;
inline constexpr std::uint32_t kInterfaceVersion = 4;

/// Bits of kRegControl.
inline constexpr std::uint64_t kControlGo = 1;
inline constexpr std::uint64_t kControlAbort = 2;
inline constexpr std::uint64_t kControlClear = 4;  ///< errors and done

/// Bit numbers of kRegStatus.
enum Status : unsigned {
  kStatusBusy = 0,
  kStatusDone = 1,
  kStatusCommandError = 2,  ///< go refused: mode, pair, count or range out of bounds
  kStatusBusError = 3,      ///< access outside a space, to a read-only register, or while busy
  kStatusSramWait = 4,      ///< the SRAM ring is full and the engine waits for the host
  kStatusIrq = 5,           ///< done, an error, or a full ring wants the host
  kStatusEccError = 6,      ///< words of DDR with errors that cannot be corrected were read in this
                            ///< pass
};

/// Result modes, kRegCommand[2:0].
enum ModeCode : std::uint32_t {
  kModeNearest = 0,
  kModeFarthest = 1,
  kModeAny = 2,
  kModeAll = 3,
  kModeHits = 4,
};

/// Bits of kRegCommand beside mode and pair code (pair.hpp has those).
inline constexpr std::uint64_t kCommandSwap = 1 << 4;
inline constexpr std::uint64_t kCommandNormals = 1 << 5;
inline constexpr unsigned kNoPair = 15;  ///< no pair's code
inline constexpr std::uint64_t kCommandSecond = 1 << 12;
inline constexpr std::uint64_t kCommandSecondSwap = 1 << 13;

/// A slot is the words of its shape, packed in DDR, and padded to whole beats in the primary
/// register file; a card's primary slot has the words of its largest primary.
inline constexpr unsigned kDdrWords = 9;  ///< words of a DDR beat

/// Records, in words of the container width. On the bus a record takes one word more.
inline constexpr unsigned kRecordWords = 7;
inline constexpr unsigned kRecordCp = 0;  ///< 3 words
inline constexpr unsigned kRecordFlags = 3;
inline constexpr unsigned kRecordIndex = 4;  ///< secondary index, all ones if none
inline constexpr unsigned kRecordT = 5;
inline constexpr unsigned kRecordPrimary = 6;

/// Bit numbers of the flags word.
inline constexpr unsigned kFlagF = 0;
inline constexpr unsigned kFlagBad = 1;
inline constexpr unsigned kFlagNormal = 2;  ///< second record: n in CP's words, the signed gap in T

}  // namespace cde::card
