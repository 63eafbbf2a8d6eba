// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// @file
/// The card's PCI side as a driver sees it: rtl/contract/pci_pkg.sv in C++, under the same names.
/// Every constant is compared with that file by tests/board. See docs/reference/pci.md for the
/// behaviour.
namespace cde::pci {

// Configuration space.
inline constexpr std::uint32_t kVendorId = 0xCDE1;  ///< not assigned by the PCI-SIG
inline constexpr std::uint32_t kDeviceId = 0x0001;
inline constexpr std::uint32_t kClass = 0x0B400001;      ///< class code and revision: co-processor
inline constexpr std::uint32_t kSubsystem = 0x0001CDE1;  ///< subsystem id, subsystem vendor id

// BAR0: the card's own registers (registers.hpp) below kRegisters, then the bridge's registers,
// then the page table.
inline constexpr unsigned kBarBits = 16;  ///< 64 KB of memory
inline constexpr std::uint32_t kRegisters = 0x1000;
inline constexpr std::uint32_t kRegistersEnd = 0x2000;
inline constexpr std::uint32_t kPageTable = 0x8000;  ///< 64-bit entries up to the end of BAR0

/// Mapped addresses: entry of the page table << 12 | offset in the page. Descriptors and rings use
/// only these.
inline constexpr unsigned kPages = 4096;
inline constexpr unsigned kPageBits = 12;
inline constexpr unsigned kPageValid = 0;     ///< bit of an entry
inline constexpr unsigned kPageWritable = 1;  ///< bit of an entry: device to host is allowed
inline constexpr unsigned kPageFrame = 12;    ///< [31:12] bus address of the page

/// Bus commands, C/BE# of an address phase (PCI 3.0, 3.1.1), that the card issues or answers.
enum Command : std::uint8_t {
  kMemoryRead = 0x6,
  kMemoryWrite = 0x7,
  kConfigRead = 0xA,
  kConfigWrite = 0xB,
  kReadMultiple = 0xC,
  kReadLine = 0xE,
  kWriteInvalidate = 0xF,
};

/// Registers of the bridge, offsets in BAR0, 64 bits each.
enum Register : std::uint32_t {
  kRegControl = 0x1000,         ///< write: kControl* bits; reads 0
  kRegStatus = 0x1008,          ///< kStatus* bits; [15:8] code that halted the ring, [23:16] where
  kRegIrqStatus = 0x1010,       ///< kIrq* bits; writing 1 clears all but kIrqCard
  kRegIrqMask = 0x1018,         ///< 1: the cause drives INTA#
  kRegRingBase = 0x1020,        ///< mapped address of the descriptors, a multiple of 32
  kRegRingSize = 0x1028,        ///< number of descriptors, 2 to 32,768
  kRegRingHead = 0x1030,        ///< next descriptor to serve; read only
  kRegRingTail = 0x1038,        ///< first descriptor not to serve
  kRegCompletionBase = 0x1040,  ///< mapped address of the completion records, a multiple of 16
  kRegBurst = 0x1048,           ///< most bytes of a burst: 64 to 4,096, a multiple of 8
  kRegRetryLimit = 0x1050,      ///< consecutive retries until a transfer fails; 0: unlimited
  kRegFaultAddr = 0x1058,       ///< first fault: mapped address (refused) or bus address (failed)
  kRegBursts = 0x1080,          ///< transactions with the card as master
  kRegBeats = 0x1088,           ///< data phases of these transactions
  kRegWaits = 0x1090,           ///< PCI cycles of these transactions in which no data moved
  kRegRetries = 0x1098,
  kRegDisconnects = 0x10A0,
  kRegParityErrors = 0x10A8,  ///< detected as master or target
  kRegAborts = 0x10B0,        ///< master aborts and target aborts received
  kRegBusy = 0x10B8,          ///< PCI cycles with FRAME# or IRDY# of any master asserted
};

// Bit numbers of kRegControl, kRegStatus and kRegIrqStatus.
inline constexpr unsigned kControlRun = 0;   ///< serve the ring; refused while it is halted
inline constexpr unsigned kControlStop = 1;  ///< halt after the current descriptor
/// Leave the halted state and clear the fault; the head returns to 0.
inline constexpr unsigned kControlClear = 2;
inline constexpr unsigned kControlCount = 3;  ///< counters to 0
inline constexpr unsigned kStatusRun = 0;
inline constexpr unsigned kStatusHalted = 1;    ///< until kControlClear
inline constexpr unsigned kStatusBusy = 2;      ///< a descriptor is being served
inline constexpr unsigned kStatusClearing = 3;  ///< after reset the page table is being cleared
inline constexpr unsigned kStatusCode = 8;
inline constexpr unsigned kStatusWhere = 16;
inline constexpr unsigned kIrqCompletion = 0;  ///< a descriptor that asked for it is done
inline constexpr unsigned kIrqHalted = 1;
inline constexpr unsigned kIrqCard = 2;  ///< level of the card's own interrupt

/// A descriptor in host memory: four words of 64 bits, `address` and `bytes` multiples of 8.
struct Descriptor {
  std::uint32_t address = 0;  ///< mapped
  std::uint32_t bytes = 0;    ///< above 0
  std::uint64_t local = 0;    ///< [31:0] offset in the local space, kDescriptor* bits
  std::uint64_t unused[2] = {0, 0};
};
inline constexpr unsigned kDescriptorBytes = 32;
inline constexpr unsigned kDescriptorSpace = 32;  ///< card::kSpaceBits bits, card::Space
inline constexpr unsigned kDescriptorToHost = 40;
inline constexpr unsigned kDescriptorIrq = 41;  ///< interrupt on completion

/// A completion record in host memory: two words of 64 bits.
struct Completion {
  std::uint32_t fault = 0;  ///< mapped (refused) or bus address (failed)
  std::uint32_t bytes = 0;  ///< [31:3] bytes moved, in units of 8; kCompletionLapFirst
  std::uint64_t state = 0;  ///< kCompletion* fields
};
inline constexpr unsigned kCompletionBytes = 16;
inline constexpr unsigned kCompletionNumber = 0;  ///< 16 bits: descriptor
inline constexpr unsigned kCompletionPci = 16;    ///< 16 bits: PCI status register
inline constexpr unsigned kCompletionCode = 32;   ///< 8 bits: Code.
/// Each word carries a lap bit, because a parity error can lose a word. The bit is 1 in the first
/// lap of the ring, 0 in the second, and so on.
inline constexpr unsigned kCompletionLapFirst = 0;  ///< of `bytes`
inline constexpr unsigned kCompletionLap = 63;      ///< of `state`

/// How a descriptor ended, or why the ring halted.
enum Code : std::uint32_t {
  kCodeOk = 0,
  kCodeLength = 1,       ///< 0 or not a multiple of 8
  kCodeAlignment = 2,    ///< host address or local offset not a multiple of 8, unknown flags
  kCodeUnmapped = 3,     ///< no valid page
  kCodeReadOnly = 4,     ///< to a page that is not writable
  kCodeMasterAbort = 5,  ///< no device answers
  kCodeTargetAbort = 6,
  kCodeParity = 7,
  kCodeRetryLimit = 8,
  kCodeSettings = 9,   ///< ring registers out of range, or written while it runs
  kCodeStopped = 10,   ///< by the driver
  kCodeDisabled = 11,  ///< bus mastering is off in the command register
};

/// What failed.
enum Where : std::uint32_t {
  kWhereData = 0,
  kWhereDescriptor = 1,  ///< reading it
  kWhereCompletion = 2,  ///< writing it; the driver gets no record
  kWhereSettings = 3,
};

}  // namespace cde::pci
