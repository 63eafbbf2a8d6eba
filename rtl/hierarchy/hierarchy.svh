// SPDX-License-Identifier: Apache-2.0
// What rays and nodes of a hierarchy share: stage times, and the places of words.
`ifndef CDE_HIERARCHY_SVH
`define CDE_HIERARCHY_SVH
`include "gap_bound.svh"

// Of ray_front.sv: o +- M, and 1 / d.
`define RAY_T_REACH (LAT_ADD + 3 * LAT_CMP)
`define RAY_T_IN_RANGE(LEAF) \
  ((LEAF == pairs_pkg::SHAPE_SPHERE) ? `DF_MAX2(`RAY_T_REACH, 2 * LAT_CMP + LAT_MUL) + LAT_CMP : 0)
`define RAY_T_MARGIN(LEAF) `DF_MAX2(`RAY_T_REACH + LAT_MUL + LAT_ADD, `RAY_T_IN_RANGE(LEAF))
`define RAY_T_FRONT(LEAF) `DF_MAX2(`RAY_T_MARGIN(LEAF) + LAT_ADD, LAT_CMP + LAT_DIV)
// Of solid_front.sv: the corners of its box, widened.
`define SOLID_T_FRONT(SHAPE) \
  (`DF_MAX2(`SHAPE_T_HULL(SHAPE) + `RAY_T_REACH, `SOLID_T_HALF(SHAPE) + 2 * LAT_CMP) + 3 * LAT_ADD + LAT_MUL)
// Of node_boxes.sv: near and far of all children, by axis and all in all; of node_gaps.sv behind it: of solids.
`define NODE_T_AXES (LAT_ADD + 2 * LAT_MUL + LAT_ADD)
`define NODE_T_BOXES (`NODE_T_AXES + 2 * LAT_CMP)
`define NODE_T_GAPS (`NODE_T_AXES + 2 * LAT_CMP + `DF_MAX2(2 * LAT_CMP, `DF_LAT_DOT))
// Of node_unit.sv: children that are met, in order.
`define NODE_T_UNIT(SOLIDS) (((SOLIDS != 0) ? `NODE_T_GAPS : `NODE_T_BOXES) + 2)

// A context on its way, CX bits of it: how many groups its stack has, and of which none but the first child has been
// visited; and a node or leaf that it goes to.
`define AT_BITS(CX) (CX + $clog2(hierarchy_pkg::LEVELS + 1) + hierarchy_pkg::LEVELS)
`define VISIT_BITS(CX) (`AT_BITS(CX) + hierarchy_pkg::PLACE + 1)
`define HIERARCHY_TYPES(CX) \
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
