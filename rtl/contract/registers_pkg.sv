// SPDX-License-Identifier: Apache-2.0
// The local bus and the card's registers: spaces, offsets, fields. host/include/cde/contract/registers.hpp is the same
// in C++.
package registers_pkg;

  // ---- Local bus: one 64-bit beat per cycle into one of these spaces. Numbers from SPACES on are unassigned. The card
  // refuses them like any other bad access; masters pass them on ----
  localparam int SPACE_BITS = 3;
  localparam logic [2:0] SPACE_REG = 3'd0;   // register file, 64-bit registers at 8-byte offsets
  localparam logic [2:0] SPACE_PRIM = 3'd1;  // primary register file, whole beats per slot, write only
  localparam logic [2:0] SPACE_DDR = 3'd2;   // secondary memory, packed slots, write only
  localparam logic [2:0] SPACE_SRAM = 3'd3;  // record stream: each beat read takes the next words of the ring
  // Spaces of a BVH, written between passes, except primaries. Nodes: words 0 to 15 of node n at byte 64 n, words 16
  // and 17 at 64 N + 8 n, with N nodes on chip. Slots: the secondary of each leaf slot, one word per slot. With a
  // transformer, their objects follow, also one word per slot. Primaries (`rays` in names): a ring with 32 bytes per
  // place. With a node cache, nodes from N on and all slots are in SPACE_DDR instead (REG_NODE_BASE, REG_SLOT_BASE).
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
    logic rvalid;  // rdata belongs to the oldest unanswered read
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
  localparam logic [11:0] REG_PRIM_COUNT = 12'h040;   // number of primaries in the register file
  localparam logic [11:0] REG_SEC_FIRST = 12'h048;    // first secondary slot
  localparam logic [11:0] REG_SEC_COUNT = 12'h050;    // number of secondaries
  localparam logic [11:0] REG_RECORDS = 12'h058;      // records waiting in the SRAM ring
  localparam logic [11:0] REG_FAULT_ADDR = 12'h060;   // fault_t
  localparam logic [11:0] REG_WRITEBACK = 12'h068;    // cycles that wrote kept records back to SRAM
  localparam logic [11:0] REG_CAPS3 = 12'h070;        // caps3_t
  // with a second pair: its first primary, a multiple of the lanes
  localparam logic [11:0] REG_PRIM_SPLIT = 12'h078;
  localparam logic [11:0] REG_STENCIL = 12'h080;      // primaries/64 registers: a 1 masks the primary
  localparam logic [11:0] REG_ITERATIONS = 12'h0A0;   // iterations_t
  // objects of the pass; 0: the slots of REG_SEC_FIRST and REG_SEC_COUNT
  localparam logic [11:0] REG_OBJECT_COUNT = 12'h0A8;
  localparam logic [11:0] REG_PRIM_OBJECT_COUNT = 12'h0B0;  // objects of primaries; 0: primaries are not transformed
  localparam logic [11:0] REG_ECC = 12'h0B8;          // ecc_t
  localparam logic [11:0] REG_CYCLES = 12'h0C0;       // cycles from go to done, without REG_WRITEBACK
  localparam logic [11:0] REG_ROWS = 12'h0C8;         // rows issued to the pipe (one row = LANES pairs)
  // Cycles that the input port waited: for output space, for a slot of an iterative pipeline, or for the interval
  // SAT_II.
  localparam logic [11:0] REG_STALLS = 12'h0D0;
  localparam logic [11:0] REG_BUBBLES = 12'h0D8;      // cycles that the input port waited for a secondary
  localparam logic [11:0] REG_BAD_PRIM = 12'h0E0;     // primaries refused as bad input
  localparam logic [11:0] REG_BAD_SEC = 12'h0E8;      // secondaries refused as bad input
  localparam logic [11:0] REG_SECONDARIES = 12'h0F0;  // secondaries processed
  localparam logic [11:0] REG_WRITTEN = 12'h0F8;      // records written to SRAM
  localparam logic [11:0] REG_UNCERTAIN = 12'h100;    // pairs that certified filters left uncertain (filter_pair.sv)
  // Registers of a BVH. Without a BVH they read 0 and cannot be written.
  localparam logic [11:0] REG_NODES = 12'h108;        // nodes read
  localparam logic [11:0] REG_LEAVES = 12'h110;       // leaves visited
  localparam logic [11:0] REG_TESTED = 12'h118;       // secondaries of leaves tested
  // 4 registers: root's box, lower corner x y z, upper corner x y z, then 16 u W (ray_front.sv), 0; one word each
  localparam logic [11:0] REG_ROOT = 12'h120;
  localparam logic [11:0] REG_NODE_CAPS = 12'h140;    // node_caps_t
  localparam logic [11:0] REG_NODE_COUNT = 12'h148;   // nodes of the BVH
  localparam logic [11:0] REG_RAY_COUNT = 12'h150;    // primaries of the pass; none is provided yet
  // rays_t; primaries provided so far, also written while the pass runs
  localparam logic [11:0] REG_RAYS = 12'h158;
  localparam logic [11:0] REG_DEEPEST = 12'h160;      // deepest stack, in groups
  localparam logic [11:0] REG_NODE_FAULT = 12'h168;   // node_fault_t
  localparam logic [11:0] REG_NEW_ROOT = 12'h180;     // 9 registers: the words of the root after a refit
  localparam logic [11:0] REG_NODE_FLIP = 12'h1C8;    // node_flip_t: with check bits, injects bit errors for tests
  localparam logic [11:0] REG_SLOT_COUNT = 12'h1D0;   // slots of the BVH
  localparam logic [11:0] REG_NODE_FIRST = 12'h1D8;   // refit: nodes before this one stay as they are
  localparam logic [11:0] REG_PAIRS = 12'h1E0;        // bit p: the card has pair p
  localparam logic [11:0] REG_CACHED = 12'h1E8;       // nodes read that are not on chip
  localparam logic [11:0] REG_FETCHED = 12'h1F0;      // nodes that a cache fetched from DDR
  localparam logic [11:0] REG_NODE_BASE = 12'h1F8;    // with a node cache: word of node 0 in DDR
  localparam logic [11:0] REG_SLOT_BASE = 12'h200;    // slot_base_t
  localparam logic [31:0] REG_END = 32'h00000208;

  // ---- Counters of a pass: their registers, 64 bits each, unit by unit. The engine's counters are in card_registers.
  // Other units have their own (pass_counters.sv), in this order, behind the other registers and below REG_END ----
  localparam int COUNTERS = 14;
  localparam logic [0:12*COUNTERS-1] COUNTER_REGISTERS = {
    REG_CYCLES, REG_WRITEBACK, REG_ROWS, REG_STALLS, REG_BUBBLES, REG_SECONDARIES, REG_BAD_SEC, REG_WRITTEN,
    REG_UNCERTAIN, REG_NODES, REG_LEAVES, REG_TESTED, REG_CACHED, REG_FETCHED};
  localparam int ENGINE_COUNTERS = 9;  // number of the engine's counters, which come first
  function automatic logic [11:0] counter_register(input int counter);
    counter_register = COUNTER_REGISTERS[12*counter+:12];
  endfunction

  // Object tables, in SPACE_REG above the registers, write only. An entry has records_pkg::OBJECT_WORDS words.
  localparam logic [31:0] OBJECT_TABLE = 32'h00040000;       // objects of secondaries: ranges of slots in DDR
  // objects of primaries: ranges of numbers in the register file
  localparam logic [31:0] PRIM_OBJECT_TABLE = 32'h00080000;

  localparam logic [31:0] ID_MAGIC = 32'h43444531;  // "CDE1"
  localparam logic [31:0] INTERFACE_VERSION = 32'd7;

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
    logic [7:0] traversal_units;  // traversal units; 0: no BVH
    logic [7:0] container;        // bits
    logic [31:0] sram_records;
    logic [15:0] latency;         // latency of the pipe
  } caps2_t;
  typedef struct packed {
    logic [15:0] prim_objects;  // entries of the object tables
    logic [15:0] objects;
    logic [7:0] prim_words;     // words of a primary slot
    logic filter;               // certified filters (config_pkg::FILTER_PAIRS) prove misses
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
    logic clear;  // clears errors and done
    logic stop;   // ends the pass and drops rows in flight
    logic go;
  } control_t;
  typedef struct packed {
    logic [55:0] reserved;
    logic node_error;     // the pass met an invalid BVH: REG_NODE_FAULT
    logic ecc_error;      // the pass read DDR words with uncorrectable errors
    logic irq;            // interrupt: done, an error, or a full ring
    logic sram_wait;      // the SRAM ring is full; the engine waits for the host
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
    logic bvh;                // traverse the BVH with the primaries of SPACE_RAYS
    logic normals;
    logic swap;               // role swap
    logic reserved0;
    logic [2:0] mode;         // MODE_*
  } command_t;
  localparam logic [63:0] COMMAND_BITS = 64'h00000000003FFF77;  // bits in use
  typedef struct packed {
    logic [7:0] pinned_bits;     // with a node cache: 2^this nodes are on chip; else all ones
    logic [7:0] slots_per_node;  // entries of the slot memory, per node
    logic [15:0] rays;         // places of the queue of primaries
    logic [31:0] nodes;        // nodes that the memory holds
  } node_caps_t;
  typedef struct packed {
    logic [31:0] objects;  // with a node cache: word of slot 0's object in DDR,
    logic [31:0] slots;    // and of its secondary
  } slot_base_t;
  typedef struct packed {
    logic [26:0] reserved;
    logic [4:0] word;   // word of a node write, or from 18 on of a slot beat,
    logic [31:0] bits;  // whose bits are flipped after the check bits are made
  } node_flip_t;
  typedef struct packed {
    logic [31:0] taken;     // primaries that the pass has taken: their places are free
    logic [31:0] provided;  // primaries provided so far, counted from the first of the pass
  } rays_t;
  typedef struct packed {
    logic [27:0] reserved;
    logic [3:0] kind;    // NODE_FAULT_*; 0: none
    logic [31:0] place;  // node or slot
  } node_fault_t;
  typedef struct packed {
    logic [39:0] reserved;
    logic [7:0] k2;  // cylinder pairs: steps on each free track,
    logic [7:0] k1;  // steps on each circle,
    logic [7:0] m;   // sampled directions
  } iterations_t;
  localparam logic [23:0] ITERATIONS_RESET = 24'h080808;
  localparam logic [7:0] ITERATIONS_MOST = 8'd64;  // most of K1 and K2
  typedef struct packed {
    logic [28:0] reserved;
    logic [2:0] space;
    logic [31:0] addr;  // offset of the first refused access
  } fault_t;
  typedef struct packed {
    logic [31:0] failed;     // words of secondaries with uncorrectable errors, read in a pass
    logic [31:0] corrected;  // words with one corrected error
  } ecc_t;

  // ---- Faults of nodes in memory: node_fault_t.kind ----
  localparam logic [3:0] NODE_FAULT_NODE = 1;  // a node beyond the last; place: its number
  localparam logic [3:0] NODE_FAULT_SLOT = 2;  // a slot beyond the last; place: its number
  localparam logic [3:0] NODE_FAULT_INDEX = 3;  // a slot with a secondary beyond the last; place: the slot
  localparam logic [3:0] NODE_FAULT_DEPTH = 4;  // more levels than the stack has; place: first node of the level below
  localparam logic [3:0] NODE_FAULT_ENDLESS = 5;  // primaries or a refit that never end; place: the last node read
  localparam logic [3:0] NODE_FAULT_SECONDARY = 6;  // refit: a secondary beyond 2^40 or with a NaN; place: its slot
  localparam logic [3:0] NODE_FAULT_NODE_BITS = 7;  // with check bits: a node word with an uncorrectable error
  localparam logic [3:0] NODE_FAULT_SLOT_BITS = 8;  // with check bits: a slot word with an uncorrectable error
  localparam logic [3:0] NODE_FAULT_OBJECT = 9;  // a slot with an object beyond the last; place: the slot

  // ---- Result modes ----
  localparam logic [2:0] MODE_NEAREST = 3'd0;   // smallest (T, index) per primary
  localparam logic [2:0] MODE_FARTHEST = 3'd1;  // largest T, then smallest index
  localparam logic [2:0] MODE_ANY = 3'd2;       // first hit in stream order; stops when every primary has one
  localparam logic [2:0] MODE_ALL = 3'd3;       // every pair's record
  localparam logic [2:0] MODE_HITS = 3'd4;      // records with F = 1 only
  // BVH passes only.
  localparam logic [2:0] MODE_OCCLUDED = 3'd5;  // F of a primary and nothing else; stops at the first hit
  localparam logic [2:0] MODE_REFIT = 3'd6;  // no primaries: refits the boxes of all nodes to the current secondaries
endpackage
