// SPDX-License-Identifier: Apache-2.0
// Shared by primaries and nodes of a BVH: stage times and widths of words.
`ifndef CDE_BVH_SVH
`define CDE_BVH_SVH
`include "distance_bound.svh"

// Outputs of ray_front.sv: o +- M, and 1 / d.
`define RAY_T_REACH (LAT.add + 3 * LAT.cmp)
`define RAY_T_IN_RANGE(LEAF) \
  ((LEAF == pairs_pkg::SHAPE_SPHERE) ? `DF_MAX2(`RAY_T_REACH, 2 * LAT.cmp + LAT.mul) + LAT.cmp : 0)
`define RAY_T_MARGIN(LEAF) `DF_MAX2(`RAY_T_REACH + LAT.mul + LAT.add, `RAY_T_IN_RANGE(LEAF))
`define RAY_T_FRONT(LEAF) `DF_MAX2(`RAY_T_MARGIN(LEAF) + LAT.add, LAT.cmp + LAT.div)
// Outputs of solid_front.sv: the corners of its box, widened.
`define SOLID_T_FRONT(SHAPE) \
  (`DF_MAX2(`SHAPE_T_HULL(SHAPE) + `RAY_T_REACH, `SOLID_T_HALF(SHAPE) + 2 * LAT.cmp) + 3 * LAT.add + LAT.mul)
// Outputs of node_boxes.sv, near and far of all children: per axis, then combined. Then node_distances.sv, for solids.
`define NODE_T_AXES (LAT.add + 2 * LAT.mul + LAT.add)
`define NODE_T_BOXES (`NODE_T_AXES + 2 * LAT.cmp)
`define NODE_T_DISTANCES (`NODE_T_AXES + 2 * LAT.cmp + `DF_MAX2(2 * LAT.cmp, `DF_LAT_DOT))
// Outputs of node_boxes_int.sv.
`define NODE_T_INT (`DF_MAX2(LAT.add + LAT.mul, 2) + 9)
// Outputs of traversal_unit.sv: the children hit, in order.
`define NODE_T_UNIT(SOLIDS) (((SOLIDS != 0) ? `NODE_T_DISTANCES : `NODE_T_BOXES) + 2)

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
