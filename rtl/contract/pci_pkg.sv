// SPDX-License-Identifier: Apache-2.0
// The card's PCI side: registers and memory structures that a driver uses (docs/reference/pci.md).
// host/include/cde/contract/pci.hpp is the same in C++.
package pci_pkg;

  localparam logic [15:0] PCI_VENDOR_ID = 16'hCDE1;           // not assigned by the PCI-SIG
  localparam logic [15:0] PCI_DEVICE_ID = 16'h0001;
  localparam logic [31:0] PCI_CLASS = 32'h0B400001;           // class code and revision: co-processor
  localparam logic [31:0] PCI_SUBSYSTEM = 32'h0001CDE1;       // subsystem id, subsystem vendor id
  localparam int PCI_BAR_BITS = 16;                           // BAR0: 64 KB of memory
  // SPACE_REG is below this offset, the bridge's registers begin here
  localparam logic [15:0] PCI_REGISTERS = 16'h1000;
  localparam logic [15:0] PCI_REGISTERS_END = 16'h2000;
  localparam logic [15:0] PCI_PAGE_TABLE = 16'h8000;          // 64-bit entries up to the end of BAR0
  localparam int PCI_PAGES = 4096;                            // entries of the page table
  localparam int PCI_PAGE_BITS = 12;                          // a page is 4 KB; mapped address = entry << 12 | offset
  localparam int PCI_PAGE_VALID = 0;                          // bits of an entry: valid,
  localparam int PCI_PAGE_WRITABLE = 1;                       // device to host allowed,
  localparam int PCI_PAGE_FRAME = 12;                         // [31:12] bus address of the page

  // Bus commands: C/BE# of an address phase (PCI 3.0, 3.1.1). The card issues or answers these.
  localparam logic [3:0] PCI_MEMORY_READ = 4'h6;
  localparam logic [3:0] PCI_MEMORY_WRITE = 4'h7;
  localparam logic [3:0] PCI_CONFIG_READ = 4'hA;
  localparam logic [3:0] PCI_CONFIG_WRITE = 4'hB;
  localparam logic [3:0] PCI_READ_MULTIPLE = 4'hC;
  localparam logic [3:0] PCI_READ_LINE = 4'hE;
  localparam logic [3:0] PCI_WRITE_INVALIDATE = 4'hF;

  // Registers of the bridge (byte offsets in BAR0, 64 bits each)
  localparam logic [15:0] PCI_REG_CONTROL = 16'h1000;         // write: PCI_CONTROL_* bits; reads 0
  // PCI_STATUS_* bits; [15:8] code that halted the ring, [23:16] where
  localparam logic [15:0] PCI_REG_STATUS = 16'h1008;
  localparam logic [15:0] PCI_REG_IRQ_STATUS = 16'h1010;      // PCI_IRQ_* bits; writing 1 clears all but PCI_IRQ_CARD
  localparam logic [15:0] PCI_REG_IRQ_MASK = 16'h1018;        // 1: the cause drives INTA#
  localparam logic [15:0] PCI_REG_RING_BASE = 16'h1020;       // mapped address of the descriptors, a multiple of 32
  localparam logic [15:0] PCI_REG_RING_SIZE = 16'h1028;       // number of descriptors, 2 to 32,768
  localparam logic [15:0] PCI_REG_RING_HEAD = 16'h1030;       // next descriptor to serve; read only
  localparam logic [15:0] PCI_REG_RING_TAIL = 16'h1038;       // end of the descriptors to serve
  // mapped address of the completion records, a multiple of 16
  localparam logic [15:0] PCI_REG_COMPLETION_BASE = 16'h1040;
  localparam logic [15:0] PCI_REG_BURST = 16'h1048;           // most bytes of a burst, 64 to 4,096, a multiple of 8
  localparam logic [15:0] PCI_REG_RETRY_LIMIT = 16'h1050;     // consecutive retries until a transfer fails; 0: never
  // address of the first fault: mapped if refused, bus address if failed
  localparam logic [15:0] PCI_REG_FAULT_ADDR = 16'h1058;
  localparam logic [15:0] PCI_REG_BURSTS = 16'h1080;          // transactions with the card as master
  localparam logic [15:0] PCI_REG_BEATS = 16'h1088;           // their data phases
  localparam logic [15:0] PCI_REG_WAITS = 16'h1090;           // cycles of these transactions without data
  localparam logic [15:0] PCI_REG_RETRIES = 16'h1098;
  localparam logic [15:0] PCI_REG_DISCONNECTS = 16'h10A0;
  localparam logic [15:0] PCI_REG_PARITY_ERRORS = 16'h10A8;   // detected as master or as target
  localparam logic [15:0] PCI_REG_ABORTS = 16'h10B0;          // master aborts and target aborts received
  // cycles in which FRAME# or IRDY# of any master was asserted
  localparam logic [15:0] PCI_REG_BUSY = 16'h10B8;

  localparam int PCI_CONTROL_RUN = 0;    // serve the ring; refused while it is halted
  localparam int PCI_CONTROL_STOP = 1;   // halt after the current descriptor
  localparam int PCI_CONTROL_CLEAR = 2;  // leave the halted state, clear the fault; the head returns to 0
  localparam int PCI_CONTROL_COUNT = 3;  // reset the counters
  localparam int PCI_STATUS_RUN = 0;
  localparam int PCI_STATUS_HALTED = 1;    // until PCI_CONTROL_CLEAR
  localparam int PCI_STATUS_BUSY = 2;      // a descriptor is in progress
  localparam int PCI_STATUS_CLEARING = 3;  // the page table is being cleared after reset; accesses wait
  localparam int PCI_STATUS_CODE = 8;
  localparam int PCI_STATUS_WHERE = 16;    // PCI_WHERE_*
  localparam int PCI_IRQ_COMPLETION = 0;   // a descriptor that asked for an interrupt is done
  localparam int PCI_IRQ_HALTED = 1;
  localparam int PCI_IRQ_CARD = 2;         // STATUS_IRQ of the card, its current level

  // Descriptor, 4 words of 64 bits. Word 0: [31:0] mapped address, [63:32] bytes. Word 1: [31:0] offset in the local
  // space, then flags. The others are unused. Addresses and bytes are multiples of 8.
  localparam int PCI_DESCRIPTOR_BYTES = 32;
  localparam int PCI_DESCRIPTOR_SPACE = 32;   // in word 1: registers_pkg::SPACE_BITS bits, SPACE_*
  localparam int PCI_DESCRIPTOR_TO_HOST = 40;
  localparam int PCI_DESCRIPTOR_IRQ = 41;     // interrupt on completion
  // Completion record, 2 words. Word 0: [31:0] fault address, [63:35] bytes done / 8. Word 1: the fields below. Each
  // word has a lap bit that shows that the word is new: 1 in the first lap of the ring, then 0, and so on.
  localparam int PCI_COMPLETION_BYTES = 16;
  localparam int PCI_COMPLETION_NUMBER = 0;  // 16 bits: descriptor; the record has the same place in its ring
  localparam int PCI_COMPLETION_PCI = 16;    // 16 bits: PCI status register
  localparam int PCI_COMPLETION_CODE = 32;   // 8 bits: PCI_CODE_*
  localparam int PCI_COMPLETION_LAP_FIRST = 32;  // of word 0
  localparam int PCI_COMPLETION_LAP = 63;        // of word 1
  localparam logic [7:0] PCI_CODE_OK = 8'd0;
  localparam logic [7:0] PCI_CODE_LENGTH = 8'd1;        // 0 or not a multiple of 8
  // host address or local offset not a multiple of 8, unknown flags
  localparam logic [7:0] PCI_CODE_ALIGNMENT = 8'd2;
  localparam logic [7:0] PCI_CODE_UNMAPPED = 8'd3;      // no valid page
  localparam logic [7:0] PCI_CODE_READ_ONLY = 8'd4;     // to a page that is not writable
  localparam logic [7:0] PCI_CODE_MASTER_ABORT = 8'd5;  // no target answers
  localparam logic [7:0] PCI_CODE_TARGET_ABORT = 8'd6;
  localparam logic [7:0] PCI_CODE_PARITY = 8'd7;
  localparam logic [7:0] PCI_CODE_RETRY_LIMIT = 8'd8;
  localparam logic [7:0] PCI_CODE_SETTINGS = 8'd9;      // ring registers out of range, or written while it runs
  localparam logic [7:0] PCI_CODE_STOPPED = 8'd10;      // by the driver
  localparam logic [7:0] PCI_CODE_DISABLED = 8'd11;     // bus mastering is off in the command register
  localparam logic [7:0] PCI_WHERE_DATA = 8'd0;
  localparam logic [7:0] PCI_WHERE_DESCRIPTOR = 8'd1;   // reading it
  localparam logic [7:0] PCI_WHERE_COMPLETION = 8'd2;   // writing it; the driver gets no record
  localparam logic [7:0] PCI_WHERE_SETTINGS = 8'd3;
endpackage
