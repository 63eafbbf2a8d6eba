// SPDX-License-Identifier: Apache-2.0
// The parameters of a card, in three lists: their meaning, the parameters of a top (for -G), and the structure
// config_pkg::config_t. Modules below the top use the structure. Its fields are in the order of CARD_CONFIG.
// Add each new parameter to all three lists, and read CONFIG where it is needed.
//
//   EXP, MAN      Number format.
//   LANES         Power of two that divides PRIMARIES.
//   PRIMARIES     64, 128, 192 or 256.
//   PAIRS         Bit p: the card has the pipe of pair p (pairs_pkg::PAIR_*).
//   ALGORITHM     Algorithm of ray-triangle (pairs_pkg::ALGORITHM_*).
//   BOX           1: a hit of ray-triangle must lie in the triangle's box. Signed distances of pairs in BOUND_PAIRS
//                 are at least the distance of their boxes.
//   SWAP          A command can exchange the roles of primary and secondary.
//   NORMALS       A command can ask for normals.
//   PARALLEL      Two pipes can work on the same secondaries at a time.
//   SAT_II        Pairs with candidate axes: cycles from one row to the next, 1 or 3.
//   FILTER_EXP    0, or with FILTER_MAN the narrow format of certified filters (filter_pair.sv). Pairs of
//                 config_pkg::FILTER_PAIRS then have narrow lanes, and one lane of the card's format behind them.
//   TRANSFORM     Objects move by a rigid transform: pairs_pkg::TRANSFORM_*.
//   OBJECTS       Entries of the object table of secondaries, 2 to 2,048. PRIM_OBJECTS: of the table of primaries.
//   TRAVERSAL_UNITS  Traversal units of a BVH: 0 (no BVH), 1, 2 or 4. NODES: nodes of their memory, a power of two.
//   NODE_CYCLES   Cycles per node of a traversal unit that tests rays, 1, 2 or 4. Above 1, operators are shared.
//   NODE_CACHE    0: all nodes and slots are on chip. Else the nodes in the cache of each traversal unit, a power of
//                 two. The first PINNED_NODES nodes, a power of two, are on chip, and others and slots are in DDR.
//   NODE_WAYS     Ways of the cache, a power of two from 2.
//   CONTEXTS      Primaries that traverse a BVH at a time, a power of two from 16 to 256.
//   SHARED_LANE   0, or 1, 2, 4 or 8: brute-force passes and leaves share one lane, which takes a row per so many
//                 cycles (ray_triangle_shared.sv). It needs LANES = 1, BOX = 1, and ray-triangle as the only pair.
//   RAY_PLACES    Places of the queue of primaries of BVH passes, a power of two from 64.
//   ECC           1: words in DDR have check bits; single wrong bits are corrected.
//   LAT_*         Cycles of the operators; in the structure `lat`.
//   ARITH         Gates ("rtl") or the simulating processor's arithmetic ("host"); field `host`, 0 or 1.
//   DDR_SLOTS     Beats of DDR; the default fits two 1 GB modules of 36-byte beats.
//   SRAM_RECORDS  Records of SRAM, a power of two. The default fits seven 2 MB chips, one per word of a record.
//   CONFIG_HASH   Hash of parameters and RTL sources.
`ifndef CDE_CONFIG_SVH
`define CDE_CONFIG_SVH
`define CARD_PARAMETERS \
    parameter int EXP = 8, \
    parameter int MAN = 23, \
    parameter int LANES = 16, \
    parameter int PRIMARIES = 256, \
    parameter int PAIRS = 1, \
    parameter int ALGORITHM = 0, \
    parameter int BOX = 0, \
    parameter int SWAP = 0, \
    parameter int NORMALS = 0, \
    parameter int PARALLEL = 0, \
    parameter int SAT_II = 1, \
    parameter int FILTER_EXP = 0, \
    parameter int FILTER_MAN = 0, \
    parameter int TRANSFORM = 0, \
    parameter int OBJECTS = 1024, \
    parameter int PRIM_OBJECTS = 64, \
    parameter int TRAVERSAL_UNITS = 0, \
    parameter int NODES = 65536, \
    parameter int NODE_CYCLES = 1, \
    parameter int NODE_CACHE = 0, \
    parameter int NODE_WAYS = 4, \
    parameter int PINNED_NODES = 4096, \
    parameter int CONTEXTS = 256, \
    parameter int SHARED_LANE = 0, \
    parameter int RAY_PLACES = 4096, \
    parameter int ECC = 0, \
    parameter int LAT_ADD = 1, \
    parameter int LAT_MUL = 1, \
    parameter int LAT_DIV = 1, \
    parameter int LAT_SQRT = 1, \
    parameter int LAT_CMP = 1, \
    parameter ARITH = "rtl", \
    parameter int DDR_SLOTS = 55555555, \
    parameter int SRAM_RECORDS = 524288

`define CARD_CONFIG {EXP, MAN, LANES, PRIMARIES, PAIRS, ALGORITHM, BOX, SWAP, NORMALS, PARALLEL, SAT_II, \
    FILTER_EXP, FILTER_MAN, TRANSFORM, OBJECTS, PRIM_OBJECTS, TRAVERSAL_UNITS, NODES, NODE_CYCLES, NODE_CACHE, \
    NODE_WAYS, PINNED_NODES, CONTEXTS, SHARED_LANE, RAY_PLACES, ECC, LAT_ADD, LAT_MUL, LAT_DIV, LAT_SQRT, LAT_CMP, \
    32'(ARITH != "rtl"), DDR_SLOTS, SRAM_RECORDS, CONFIG_HASH}

`define CARD_FIELDS \
    int exp; \
    int man; \
    int lanes; \
    int primaries; \
    int pairs; \
    int algorithm; \
    int box; \
    int swap; \
    int normals; \
    int parallel; \
    int sat_ii; \
    int filter_exp; \
    int filter_man; \
    int transform; \
    int objects; \
    int prim_objects; \
    int traversal_units; \
    int nodes; \
    int node_cycles; \
    int node_cache; \
    int node_ways; \
    int pinned_nodes; \
    int contexts; \
    int shared_lane; \
    int ray_places; \
    int ecc; \
    latency_pkg::latency_t lat; \
    int host; \
    int ddr_slots; \
    int sram_records; \
    logic [63:0] config_hash;
`endif
