// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <iterator>

#include "cde/contract/field.hpp"
#include "cde/contract/pairs.hpp"

/// @file
/// The local bus and the card's registers: rtl/contract/registers_pkg.sv in C++, under the same
/// names. The two are compared by tests/board.
namespace cde::card {

/// Spaces of the local bus. A beat has 64 bits.
enum Space : std::uint32_t {
  kSpaceReg = 0,    ///< registers, 64 bits at 8-byte offsets
  kSpacePrim = 1,   ///< primary register file, kPrimWords words per slot, write only
  kSpaceDdr = 2,    ///< secondary memory, packed slots, write only
  kSpaceSram = 3,   ///< record stream: each beat read takes the next words of the SRAM ring
  kSpaceNodes = 4,  ///< BVH nodes: words 0 to 15 of node n at byte 64 n, words 16 and 17 at byte 64
                    ///< N + 8 n, with N nodes on chip
  kSpaceSlots = 5,  ///< secondary index per slot of the BVH's leaves, one word each; with a
                    ///< transformer, the object index of every slot follows. With a node cache,
                    ///< nodes from N on and all slots are in kSpaceDdr instead
  kSpaceRays = 6,   ///< primaries of a BVH pass: a ring of kRays places
};
inline constexpr unsigned kSpaces = 7;     ///< the card refuses space numbers from here on
inline constexpr unsigned kSpaceBits = 3;  ///< of a space number

/// Register offsets in bytes.
enum Register : std::uint32_t {
  kRegId = 0x000,          ///< [63:32] kIdMagic, [31:0] kInterfaceVersion
  kRegCaps = 0x008,        ///< kCaps* fields
  kRegConfigHash = 0x010,  ///< hash of parameters and RTL sources
  kRegCaps2 = 0x018,       ///< kCaps2* fields
  kRegCapacity = 0x020,    ///< bytes of DDR
  kRegControl = 0x028,     ///< write: kControl* bits
  kRegStatus = 0x030,      ///< kStatus* bits
  kRegCommand = 0x038,     ///< kCommand* fields
  kRegPrimCount = 0x040,   ///< primaries in the register file
  kRegSecFirst = 0x048,    ///< first secondary slot
  kRegSecCount = 0x050,    ///< number of secondaries
  kRegRecords = 0x058,     ///< records waiting in the SRAM ring
  kRegFaultAddr = 0x060,   ///< first refused access: kFault* fields
  kRegWriteback = 0x068,   ///< cycles that wrote the kept records back to SRAM
  kRegCaps3 = 0x070,       ///< kCaps3* fields
  kRegPrimSplit = 0x078,   ///< with a second pair: number of its first primary
  kRegStencil = 0x080,     ///< primaries/64 registers; a 1 masks a primary
  kRegIterations = 0x0A0,  ///< iterations for a cylinder pair: kIterations* fields
  kRegEcc = 0x0B8,  ///< words of secondaries with bit errors read from DDR in a pass: kEcc* fields
  /// Objects of secondaries in the pass; 0: use kRegSecFirst and kRegSecCount.
  kRegObjectCount = 0x0A8,
  kRegPrimObjectCount = 0x0B0,  ///< objects of primaries; 0: primaries as they were written
  kRegCycles = 0x0C0,           ///< cycles from go to done, without kRegWriteback
  kRegRows = 0x0C8,             ///< rows issued to the pipe (one row is `lanes` pairs)
  kRegStalls = 0x0D0,  ///< cycles in which the input port waited for output space, for a slot of an
                       ///< iterative pipeline, or for the interval of a SAT pipe
  kRegBubbles = 0x0D8,      ///< cycles in which the input port waited for a secondary
  kRegBadPrim = 0x0E0,      ///< primaries refused as bad input
  kRegBadSec = 0x0E8,       ///< secondaries refused as bad input
  kRegSecondaries = 0x0F0,  ///< secondaries streamed
  kRegWritten = 0x0F8,      ///< records written to SRAM
  kRegUncertain =
      0x100,             ///< pairs that the certified filter left uncertain (`BoardConfig::filter`)
  kRegNodes = 0x108,     ///< BVH: nodes read
  kRegLeaves = 0x110,    ///< BVH: leaves visited
  kRegTested = 0x118,    ///< BVH: secondaries of leaves that were tested
  kRegRoot = 0x120,      ///< 4 registers: lower corner of the root's box, upper corner, 16 u W, 0
  kRegNodeCaps = 0x140,  ///< kNodeCaps* fields
  kRegNodeCount = 0x148,  ///< nodes of the BVH
  kRegRayCount = 0x150,   ///< rays of the pass, none of which has been provided yet
  kRegRays = 0x158,       ///< kRays* fields; write the number of rays provided so far
  kRegDeepest = 0x160,    ///< most groups on a stack at a time
  kRegNodeFault = 0x168,  ///< kNodeFault* fields
  kRegNewRoot = 0x180,    ///< 9 registers: the root's words after a refit
  kRegNodeFlip = 0x1c8,   ///< kNodeFlip* fields: with check bits, injects bit errors for tests
  kRegSlotCount = 0x1d0,  ///< slots of the BVH
  kRegNodeFirst = 0x1d8,  ///< refit: nodes before this one stay as they are
  kRegPairs = 0x1e0,      ///< bit p: pair p is in the card
  kRegCached = 0x1e8,     ///< BVH: nodes read that are not on chip
  kRegFetched = 0x1f0,    ///< BVH: nodes that a cache fetched from DDR
  kRegNodeBase = 0x1f8,   ///< with a node cache: word of node 0 in DDR
  kRegSlotBase = 0x200,   ///< kSlotBase* fields
  kRegEnd = 0x208,
};

/// Registers of the counters of a pass, unit by unit, in the order in which a unit delivers them.
inline constexpr Register kCounterRegisters[] = {
    kRegCycles,  kRegWriteback, kRegRows,  kRegStalls, kRegBubbles, kRegSecondaries, kRegBadSec,
    kRegWritten, kRegUncertain, kRegNodes, kRegLeaves, kRegTested,  kRegCached,      kRegFetched,
};
inline constexpr unsigned kCounters = std::size(kCounterRegisters);
inline constexpr unsigned kEngineCounters = 9;  ///< the first counters

/// Object tables, in kSpaceReg above the registers, write only. Entries have kObjectWords words
/// (records.hpp).
inline constexpr std::uint32_t kObjectTable = 0x40000;      ///< of secondaries
inline constexpr std::uint32_t kPrimObjectTable = 0x80000;  ///< of primaries

inline constexpr std::uint32_t kIdMagic = 0x43444531;
inline constexpr std::uint32_t kInterfaceVersion = 7;

/// Bits of kRegControl.
inline constexpr std::uint64_t kControlGo = 1;
inline constexpr std::uint64_t kControlAbort = 2;
inline constexpr std::uint64_t kControlClear = 4;  ///< clears errors and done

/// Bit numbers of kRegStatus.
enum Status : unsigned {
  kStatusBusy = 0,
  kStatusDone = 1,
  kStatusCommandError = 2,  ///< go refused: mode, pair, count or range out of bounds
  kStatusBusError = 3,      ///< access outside a space, to a read-only register, or while busy
  kStatusSramWait = 4,      ///< the SRAM ring is full and the engine waits for the host
  kStatusIrq = 5,           ///< done, an error, or a full ring needs the host
  kStatusEccError = 6,      ///< words with uncorrectable errors were read from DDR in this pass
  kStatusNodeError = 7,     ///< the pass read invalid BVH nodes: kRegNodeFault
};

/// What is wrong with BVH nodes: kNodeFaultKind. kNodeFaultPlace holds the number named here.
enum NodeFault : unsigned {
  kNodeFaultNode = 1,       ///< node number out of range: the node
  kNodeFaultSlot = 2,       ///< slot number out of range: the slot
  kNodeFaultIndex = 3,      ///< secondary index out of range: its slot
  kNodeFaultDepth = 4,      ///< more levels than the stack holds: the first node of the level below
  kNodeFaultEndless = 5,    ///< a traversal or refit that does not end: the node read last
  kNodeFaultSecondary = 6,  ///< refit: a secondary beyond 2^40 or not a number: its slot
  kNodeFaultNodeBits = 7,   ///< uncorrectable error in a node's word (with check bits)
  kNodeFaultSlotBits = 8,   ///< uncorrectable error in a slot's word (with check bits)
  kNodeFaultObject = 9,     ///< object index out of range: its slot
};

/// Result modes, kRegCommand[2:0].
enum ModeCode : std::uint32_t {
  kModeNearest = 0,
  kModeFarthest = 1,
  kModeAny = 2,
  kModeAll = 3,
  kModeHits = 4,
  kModeOccluded = 5,  ///< BVH only
  kModeRefit = 6,     ///< BVH only, without rays: refits the boxes of all nodes
};

/// Fields of registers.
inline constexpr Field kIdVersion{0, 32}, kIdMagicField{32, 32};
inline constexpr Field kCapsLanes{0, 16}, kCapsPrimaries{16, 16}, kCapsExp{32, 8}, kCapsMan{40, 8},
    kCapsAlgorithm{48, 8};
inline constexpr Field kCaps2Latency{0, 16}, kCaps2SramRecords{16, 32}, kCaps2Container{48, 8},
    kCaps2TraversalUnits{56, 8};
inline constexpr Field kCaps3Swap{16}, kCaps3Normals{17}, kCaps3Parallel{18},
    kCaps3Transform{19, 2}, kCaps3Ecc{21}, kCaps3Box{22}, kCaps3Filter{23}, kCaps3PrimWords{24, 8},
    kCaps3Objects{32, 16}, kCaps3PrimObjects{48, 16};
inline constexpr Field kNodeCapsNodes{0, 32}, kNodeCapsRays{32, 16}, kNodeCapsSlotsPerNode{48, 8},
    kNodeCapsPinnedBits{56, 8};  ///< with a node cache 2^this nodes are on chip; else all ones
inline constexpr unsigned kNoNodeCache = 0xff;  ///< of kNodeCapsPinnedBits
inline constexpr Field kSlotBaseSlots{0, 32}, kSlotBaseObjects{32, 32};
inline constexpr Field kRaysProvided{0, 32}, kRaysTaken{32, 32};
inline constexpr Field kNodeFaultPlace{0, 32}, kNodeFaultKind{32, 4};
inline constexpr Field kNodeFlipBits{0, 32}, kNodeFlipWord{32, 5};
inline constexpr Field kFaultAddr{0, 32}, kFaultSpace{32, kSpaceBits};
inline constexpr Field kIterationsM{0, 8}, kIterationsK1{8, 8}, kIterationsK2{16, 8};
inline constexpr std::uint32_t kIterationsReset = 0x080808;
inline constexpr unsigned kIterationsMost = 64;                   ///< of K1 and K2
inline constexpr Field kEccCorrected{0, 32}, kEccFailed{32, 32};  ///< words
inline constexpr Field kCommandMode{0, 3}, kCommandPair{8, kPairBits},
    kCommandSecondPair{16, kPairBits};
/// Bits of kRegCommand other than mode and pair codes.
inline constexpr std::uint64_t kCommandSwap = 1 << 4;
inline constexpr std::uint64_t kCommandNormals = 1 << 5;
inline constexpr std::uint64_t kCommandBvh = 1 << 6;
inline constexpr std::uint64_t kCommandSecond = 1 << 14;
inline constexpr std::uint64_t kCommandSecondSwap = 1 << 15;
inline constexpr std::uint64_t kCommandBits = 0x3FFF77;  ///< bits that a field uses

}  // namespace cde::card
