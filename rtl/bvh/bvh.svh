// SPDX-License-Identifier: Apache-2.0
// Shared by primaries and nodes of a BVH: stage times and widths of words.
`ifndef CDE_BVH_SVH
`define CDE_BVH_SVH
`include "distance_bound.svh"

// Outputs of ray_front.sv: o, the T of the margin, and 1 / d.
`define RAY_T_REACH (LAT.add + 3 * LAT.cmp)
`define RAY_T_IN_RANGE(LEAF) \
  ((LEAF == pairs_pkg::SHAPE_SPHERE) ? `DF_MAX2(`RAY_T_REACH, 2 * LAT.cmp + LAT.mul) + LAT.cmp : 0)
`define RAY_T_MARGIN(LEAF) `DF_MAX2(`RAY_T_REACH + LAT.mul + LAT.add, `RAY_T_IN_RANGE(LEAF))
`define RAY_T_FRONT(LEAF) (`DF_MAX2(`RAY_T_MARGIN(LEAF), LAT.cmp + LAT.div) + LAT.mul)
// ray_front_shared.sv: phases; the reach; the sum that gives the margin; the margin; M' |1 / d| of the first axis; the
// outputs. FRONT_FIRST is the first time from TIME on that is at most SPAN - 1 phases after the phase of FROM.
// An axis follows another in FRONT_AXIS phases: the divider takes a row per FRONT_AXIS cycles.
`define FRONT_CYCLES 8
`define FRONT_AXIS 2
`define FRONT_FIRST(TIME, FROM, SPAN) \
  ((TIME) + (((((TIME) - (FROM)) & 7) < SPAN) ? 0 : 8 - (((TIME) - (FROM)) & 7)))
`define FRONT_T_REACH (7 + LAT.add)
`define FRONT_T_SUM `FRONT_FIRST(`FRONT_T_REACH + `NODE_LAT_MUL + 2, 7, 2)
`define FRONT_T_MARGIN `DF_MAX2(`FRONT_T_SUM + LAT.add, LAT.div)
`define FRONT_T_TIMES `FRONT_FIRST(`FRONT_T_MARGIN + 1, `FRONT_T_REACH + 2, 6 - 2 * `FRONT_AXIS)
`define FRONT_T_SHARED (`FRONT_T_TIMES + `NODE_LAT_MUL + 1 + 2 * `FRONT_AXIS)
// Outputs of solid_front.sv: the corners of its box, widened.
`define SOLID_T_FRONT(SHAPE) \
  (`DF_MAX2(`SHAPE_T_HULL(SHAPE) + `RAY_T_REACH, `SOLID_T_HALF(SHAPE) + 2 * LAT.cmp) + 3 * LAT.add + LAT.mul)
// Outputs of node_boxes.sv, for solids, and of node_distances.sv.
`define NODE_T_AXES (2 * LAT.add)
`define NODE_T_DISTANCES (`NODE_T_AXES + 2 * LAT.cmp + `DF_MAX2(2 * LAT.cmp, `DF_LAT_DOT))
// Output of time_steps.sv; output sizes_o of node_scale.sv; outputs of node_boxes_int.sv, for rays. CYCLES is the
// number of cycles per node, 1, 2 or 4. With 4, the second half of a node's words follows two cycles after the first.
// NODE_TURNS is the number of cycles in which a node's axes are prepared. A multiplier of 10 cycles takes four
// multiplier blocks. One of 11 cycles takes one block and adders (fp_mul_lane.sv), for lanes that need many. A node
// needs few.
`define TIME_T_STEPS 5
`define NODE_T_SIZES(CYCLES) ((CYCLES == 1) ? 5 : 6)
`define NODE_TURNS(CYCLES) ((CYCLES == 4) ? 3 : CYCLES)
`define NODE_T_SECOND(CYCLES) ((CYCLES == 4) ? 2 : 0)
`define NODE_LAT_MUL ((LAT.mul > 10) ? 10 : LAT.mul)
`define NODE_T_INT(CYCLES) \
  (`DF_MAX2(LAT.add + `NODE_LAT_MUL + `NODE_TURNS(CYCLES) - 1, `NODE_T_SECOND(CYCLES) + 3) + `TIME_T_STEPS + 3 + \
   `NODE_TURNS(CYCLES) + CYCLES)
// Bits of the bounds of node_boxes_int.sv, and sizes of an axis from node_scale.sv.
`define NODE_BOUND_BITS(UNIT_BITS) (UNIT_BITS + 11)
`define NODE_SIZES_BITS(UNIT_BITS) (5 + (UNIT_BITS + 1) + (UNIT_BITS + 8))
`define NODE_SIZES(UNIT_BITS) \
  typedef struct packed { \
    logic lo;        /* axis lo */ \
    logic slow;      /* the axis has longer steps */ \
    logic negative;  /* the ray's direction */ \
    logic infinite;  /* the margin is infinite */ \
    logic inexact;   /* a byte is more than `unit` steps */ \
    logic [UNIT_BITS:0] unit; \
    logic [UNIT_BITS+7:0] margin;  /* steps, rounded down */ \
  } sizes_t;
// Latency of node_order.sv.
`define NODE_T_ORDER 3
// Outputs of traversal_unit.sv: the children hit, in order. With rays and solids, each kind has its own latency.
`define NODE_T_RAY(CYCLES) (`NODE_T_INT(CYCLES) + `NODE_T_ORDER)
`define NODE_T_SOLID (`NODE_T_DISTANCES + 1 + `NODE_T_ORDER)
// Output of key_limit.sv.
`define NODE_T_LIMIT (`TIME_T_STEPS + 2)

// The children of a node that a primary hits, in the order of visits. Rays have keys of 12 bits, relative to a T of the
// node. Solids have keys of 16 bits, the upper half of a number.
`define NODE_KEY(SOLIDS) ((SOLIDS != 0) ? 16 : bvh_pkg::RAY_KEY)
`define GROUP_BITS(KEY) \
  (32 + 8 + 2 * bvh_pkg::PLACE + 2 * bvh_pkg::CHILDREN + 4 + bvh_pkg::CHILDREN * (3 + KEY))
`define BVH_GROUP(KEY) \
  typedef struct packed { \
    logic [31:0] t_ref;      /* of a ray's keys */ \
    logic [7:0] scale;       /* biased exponent of their steps */ \
    logic [PLACE-1:0] node;  /* place of the first child that is a node */ \
    logic [PLACE-1:0] slot;  /* slot of the first child's secondary */ \
    logic [CHILDREN-1:0][1:0] kinds; \
    logic [3:0] count;  /* number of hit children */ \
    logic [CHILDREN-1:0][2:0] order; \
    logic [CHILDREN-1:0][KEY-1:0] keys;  /* by child, rounded so that no child is culled too early */ \
  } group_t;

// State of a context: its number (CX bits), the number of groups on its stack, and a bit per group. The bit is set
// while only the group's first child has been visited. A visit adds the node or leaf that the context goes to.
`define AT_BITS(CX) (CX + $clog2(bvh_pkg::LEVELS + 1) + bvh_pkg::LEVELS)
`define VISIT_BITS(CX) (`AT_BITS(CX) + bvh_pkg::PLACE + 1)
`define BVH_TYPES(CX) \
  typedef struct packed { \
    logic [CX-1:0] context_; \
    logic [$clog2(LEVELS+1)-1:0] level; \
    logic [LEVELS-1:0] fresh; \
  } at_t; \
  typedef struct packed { \
    at_t at; \
    logic [PLACE-1:0] place; \
    logic two; \
  } visit_t;
`endif
