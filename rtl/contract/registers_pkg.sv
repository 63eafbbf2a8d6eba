// SPDX-License-Identifier: Apache-2.0
// The local bus and the card's registers: spaces, offsets, fields. host/include/cde/contract/registers.hpp is the same
// in C++.
package registers_pkg;

  // ---- Local bus: one 64-bit beat a clock into one of these spaces. Numbers from SPACES on are nobody's: the card
  // refuses them like any other bad access, whatever is in front of it hands them on ----
  localparam int SPACE_BITS = 3;
  localparam logic [2:0] SPACE_REG = 3'd0;   // register file, 64-bit registers at 8-byte offsets
  localparam logic [2:0] SPACE_PRIM = 3'd1;  // primary register file, whole beats a slot, write only
  localparam logic [2:0] SPACE_DDR = 3'd2;   // secondary memory, packed slots, write only
  localparam logic [2:0] SPACE_SRAM = 3'd3;  // record stream: every beat read takes the next words of the ring
  // Of a hierarchy, written between passes (but rays): nodes, words 0 to 15 of node n at byte 64 n, 16 and 17 at 64
  // NODES + 8 n; what is in the slots of its leaves, a word a slot, and with a transformer behind all of these the
  // objects that they are of, likewise; and rays on their way into a pass, 32 bytes each in a ring.
  localparam logic [2:0] SPACE_NODES = 3'd4;
  localparam logic [2:0] SPACE_SLOTS = 3'd5;
  localparam logic [2:0] SPACE_RAYS = 3'd6;
  localparam int SPACES = 7;
  typedef struct packed {
    logic valid;
    logic write;
    logic [2:0] space;  // SPACE_*
    logic [31:0] addr;  // byte offset
    logic [63:0] wdata;
  } bus_request_t;
  typedef struct packed {
    logic ready;   // the request is taken
    logic rvalid;  // rdata is that of the oldest read not yet answered
    logic [63:0] rdata;
  } bus_response_t;

  // ---- Registers (byte offsets) ----
  localparam logic [11:0] REG_ID = 12'h000;           // id_t
  localparam logic [11:0] REG_CAPS = 12'h008;         // caps_t
  localparam logic [11:0] REG_CONFIG_HASH = 12'h010;  // hash of parameters and RTL sources
  localparam logic [11:0] REG_CAPS2 = 12'h018;        // caps2_t
  localparam logic [11:0] REG_CAPACITY = 12'h020;     // bytes of DDR
  localparam logic [11:0] REG_CONTROL = 12'h028;      // control_t, write only
  localparam logic [11:0] REG_STATUS = 12'h030;       // status_t
  localparam logic [11:0] REG_COMMAND = 12'h038;      // command_t
  localparam logic [11:0] REG_PRIM_COUNT = 12'h040;   // counter register: primaries in the register file
  localparam logic [11:0] REG_SEC_FIRST = 12'h048;    // first secondary slot
  localparam logic [11:0] REG_SEC_COUNT = 12'h050;    // counter register: number of secondaries
  localparam logic [11:0] REG_RECORDS = 12'h058;      // records waiting in the SRAM ring
  localparam logic [11:0] REG_FAULT_ADDR = 12'h060;   // fault_t
  localparam logic [11:0] REG_WRITEBACK = 12'h068;    // cycles that wrote the kept records back to SRAM
  localparam logic [11:0] REG_CAPS3 = 12'h070;        // caps3_t
  // with a second pair: the first of its primaries, a multiple of the lanes
  localparam logic [11:0] REG_PRIM_SPLIT = 12'h078;
  localparam logic [11:0] REG_STENCIL = 12'h080;      // primaries/64 registers: 1 masks a primary
  localparam logic [11:0] REG_BUDGET = 12'h0A0;       // budget_t
  // objects to sweep; 0: the slots of REG_SEC_FIRST and REG_SEC_COUNT
  localparam logic [11:0] REG_OBJECT_COUNT = 12'h0A8;
  localparam logic [11:0] REG_PRIM_OBJECT_COUNT = 12'h0B0;  // objects of primaries; 0: primaries as they were written
  localparam logic [11:0] REG_ECC = 12'h0B8;          // ecc_t
  localparam logic [11:0] REG_CYCLES = 12'h0C0;       // cycles from go to done, without REG_WRITEBACK
  localparam logic [11:0] REG_ROWS = 12'h0C8;         // rows issued to the pipe (one row = LANES pairs)
  // Clocks the pipe mouth waited for output space, for a slot of a cylinder pipe, or for a facet pipe's interval.
  localparam logic [11:0] REG_STALLS = 12'h0D0;
  localparam logic [11:0] REG_BUBBLES = 12'h0D8;      // cycles the pipe mouth waited for a secondary
  localparam logic [11:0] REG_BAD_PRIM = 12'h0E0;     // primaries refused as bad input
  localparam logic [11:0] REG_BAD_SEC = 12'h0E8;      // secondaries refused as bad input
  localparam logic [11:0] REG_SECONDARIES = 12'h0F0;  // secondaries swept
  localparam logic [11:0] REG_WRITTEN = 12'h0F8;      // records written to SRAM
  localparam logic [11:0] REG_OPEN = 12'h100;         // pairs that narrow lanes left open (verdict_pair.sv)
  // Of a hierarchy; without, they read 0 and are not written.
  localparam logic [11:0] REG_NODES = 12'h108;        // nodes read
  localparam logic [11:0] REG_LEAVES = 12'h110;       // leaves visited
  localparam logic [11:0] REG_TESTED = 12'h118;       // secondaries of leaves that were tested
  // 4 registers: of the root's box the lower corner x y z, the upper one, 16 u W (ray_front.sv), 0; a word each
  localparam logic [11:0] REG_ROOT = 12'h120;
  localparam logic [11:0] REG_NODE_CAPS = 12'h140;    // node_caps_t
  localparam logic [11:0] REG_NODE_COUNT = 12'h148;   // nodes of the tree
  localparam logic [11:0] REG_RAY_COUNT = 12'h150;    // rays of the pass; none of them is there yet
  // rays_t; written, as far as they are there, also while the pass runs
  localparam logic [11:0] REG_RAYS = 12'h158;
  localparam logic [11:0] REG_DEEPEST = 12'h160;      // groups on a stack at a time, at most
  localparam logic [11:0] REG_NODE_FAULT = 12'h168;   // node_fault_t
  localparam logic [11:0] REG_NEW_ROOT = 12'h180;     // 9 registers: the words of the root, as a refit made it
  localparam logic [11:0] REG_NODE_FLIP = 12'h1C8;    // node_flip_t: with check bits, wrong ones, to test them
  localparam logic [11:0] REG_SLOT_COUNT = 12'h1D0;   // slots of the tree
  localparam logic [11:0] REG_NODE_FIRST = 12'h1D8;   // of a refit: nodes before it stay as they are
  localparam logic [11:0] REG_PAIRS = 12'h1E0;        // bit p: pair p is in the card
  localparam logic [31:0] REG_END = 32'h000001E8;

  // ---- Counters of a pass: their registers, 64 bits each, unit by unit. Those of the engine are in card_registers; a
  // further unit brings its own (pass_counters.sv), in this order and behind the other registers, below REG_END ----
  localparam int COUNTERS = 12;
  localparam logic [0:12*COUNTERS-1] COUNTER_REGISTERS = {
    REG_CYCLES, REG_WRITEBACK, REG_ROWS, REG_STALLS, REG_BUBBLES, REG_SECONDARIES, REG_BAD_SEC, REG_WRITTEN,
    REG_OPEN, REG_NODES, REG_LEAVES, REG_TESTED};
  localparam int ENGINE_COUNTERS = 9;  // the first ones
  function automatic logic [11:0] counter_register(input int counter);
    counter_register = COUNTER_REGISTERS[12*counter+:12];
  endfunction

  // Object tables, in SPACE_REG above the registers, write only: entries of records_pkg::OBJECT_WORDS words.
  localparam logic [31:0] OBJECT_TABLE = 32'h00040000;       // of secondaries: ranges of slots in DDR
  // of primaries: ranges of their numbers in the register file
  localparam logic [31:0] PRIM_OBJECT_TABLE = 32'h00080000;

  localparam logic [31:0] ID_MAGIC = 32'h43444531;  // "CDE1"
  localparam logic [31:0] INTERFACE_VERSION = 32'd5;

  // ---- Fields, from bit 63 down ----
  typedef struct packed {
    logic [31:0] magic;    // ID_MAGIC
    logic [31:0] version;  // INTERFACE_VERSION
  } id_t;
  typedef struct packed {
    logic [7:0] reserved;
    logic [7:0] algorithm;  // of ray-triangle
    logic [7:0] man;
    logic [7:0] exp;
    logic [15:0] primaries;
    logic [15:0] lanes;
  } caps_t;
  typedef struct packed {
    logic [7:0] node_units;     // of a hierarchy; 0: none
    logic [7:0] container;      // bits
    logic [31:0] sram_records;
    logic [15:0] latency;       // of the pipe
  } caps2_t;
  typedef struct packed {
    logic [15:0] prim_objects;  // entries of the object tables
    logic [15:0] objects;
    logic [7:0] prim_words;     // words of a primary slot
    logic verdicts;             // narrow lanes prove misses of pairs of solids
    logic box;                  // box rule of ray-triangle
    logic ecc;                  // check bits in DDR
    logic [1:0] transform;      // pairs_pkg::TRANSFORM_*
    logic parallel;             // two pairs at a time
    logic normals;
    logic swap;                 // roles can be swapped
    logic [15:0] reserved;
  } caps3_t;
  typedef struct packed {
    logic [60:0] reserved;
    logic clear;  // errors and done
    logic stop;   // ends the pass, what is in flight is dropped
    logic go;
  } control_t;
  typedef struct packed {
    logic [55:0] reserved;
    logic node_error;     // the pass met nodes that are no tree's: REG_NODE_FAULT
    logic ecc_error;      // words of DDR with errors that cannot be corrected were read in this pass
    logic irq;            // done, an error, or a full ring wants the host
    logic sram_wait;      // the SRAM ring is full and the engine waits for the host
    logic bus_error;      // access outside a space, to a read-only register, or while busy
    logic command_error;  // go refused: mode, pair, count or range out of bounds
    logic done;
    logic busy;
  } status_t;
  typedef struct packed {
    logic [41:0] reserved2;
    pairs_pkg::pair_t second_pair;
    logic second_swap;
    logic second;             // there is a second pair
    pairs_pkg::pair_t pair;
    logic reserved1;
    logic hierarchy;          // rays of SPACE_RAYS through the hierarchy
    logic normals;
    logic swap;               // of roles
    logic reserved0;
    logic [2:0] mode;         // MODE_*
  } command_t;
  localparam logic [63:0] COMMAND_BITS = 64'h00000000003FFF77;  // bits that a field uses
  typedef struct packed {
    logic [7:0] reserved;
    logic [7:0] slots_a_node;  // that the memory of slots has places for
    logic [15:0] rays;         // places of the ring of rays
    logic [31:0] nodes;        // that there is memory for
  } node_caps_t;
  typedef struct packed {
    logic [26:0] reserved;
    logic [4:0] word;   // of nodes that are written, from 18 on of beats of slots,
    logic [31:0] bits;  // these are flipped behind the making of check bits
  } node_flip_t;
  typedef struct packed {
    logic [31:0] taken;     // rays that the pass has taken: their places are free
    logic [31:0] provided;  // rays that are there, from the first of the pass on
  } rays_t;
  typedef struct packed {
    logic [27:0] reserved;
    logic [3:0] kind;    // NODE_FAULT_*; 0: none
    logic [31:0] place;  // of a node or a slot
  } node_fault_t;
  typedef struct packed {
    logic [39:0] reserved;
    logic [7:0] k2;  // work for a cylinder pair: steps on each free track,
    logic [7:0] k1;  // steps on each circle,
    logic [7:0] m;   // directions sampled
  } budget_t;
  localparam logic [23:0] BUDGET_RESET = 24'h080808;
  localparam logic [7:0] BUDGET_MOST = 8'd64;  // of K1 and K2
  typedef struct packed {
    logic [28:0] reserved;
    logic [2:0] space;
    logic [31:0] addr;  // offset of the first refused access
  } fault_t;
  typedef struct packed {
    logic [31:0] failed;     // words of secondaries read from DDR in a pass with more errors than can be corrected
    logic [31:0] corrected;  // words with one
  } ecc_t;

  // ---- What is wrong with nodes in memory: node_fault_t.kind ----
  localparam logic [3:0] NODE_FAULT_NODE = 1;  // a node beyond the last one: its number
  localparam logic [3:0] NODE_FAULT_SLOT = 2;  // a slot beyond the last one: its number
  localparam logic [3:0] NODE_FAULT_INDEX = 3;  // a slot with a secondary beyond the last one: the slot
  localparam logic [3:0] NODE_FAULT_DEPTH = 4;  // more levels than the stack has: the first node of the level below
  localparam logic [3:0] NODE_FAULT_ENDLESS = 5;  // rays that come to no end, or a refit: the node read last
  localparam logic [3:0] NODE_FAULT_SECONDARY = 6;  // of a refit, a secondary beyond 2^40 or no number: its slot
  localparam logic [3:0] NODE_FAULT_NODE_BITS = 7;  // with check bits, more wrong bits of a word than can be corrected
  localparam logic [3:0] NODE_FAULT_SLOT_BITS = 8;  // the same of what is in a slot
  localparam logic [3:0] NODE_FAULT_OBJECT = 9;  // a slot of an object beyond the last one: the slot

  // ---- Result modes ----
  localparam logic [2:0] MODE_NEAREST = 3'd0;   // smallest (T, index) a primary
  localparam logic [2:0] MODE_FARTHEST = 3'd1;  // largest T, then smallest index
  localparam logic [2:0] MODE_ANY = 3'd2;       // first hit in stream order; stops when every primary has one
  localparam logic [2:0] MODE_ALL = 3'd3;       // every pair's record
  localparam logic [2:0] MODE_HITS = 3'd4;      // records with F = 1 only
  // Of a hierarchy.
  localparam logic [2:0] MODE_OCCLUDED = 3'd5;  // F of a primary and no more; ends at the first hit
  localparam logic [2:0] MODE_REFIT = 3'd6;     // no rays: boxes of all nodes anew, from the secondaries as they are
endpackage
