// SPDX-License-Identifier: Apache-2.0
// The configuration of a card as one structure, with the fields of config.svh. Also the derived values that several
// modules need.
`include "config.svh"
package config_pkg;
  typedef struct packed {
    `CARD_FIELDS
  } config_t;

  // The parameter ARITH of units.
  function automatic logic [31:0] arith(input int host);
    arith = (host != 0) ? "host" : {8'b0, "rtl"};
  endfunction
  // Cycles of a check of the input contract (shape_check.sv).
  function automatic int check_latency(input latency_pkg::latency_t lat);
    check_latency = lat.mul + 3 * lat.add + lat.cmp;
  endfunction
  // Pairs whose misses a certified filter can prove (filter_pair.sv).
  localparam int FILTER_PAIRS = 1 << pairs_pkg::PAIR_SPHERE_SPHERE | 1 << pairs_pkg::PAIR_SPHERE_OBB |
      1 << pairs_pkg::PAIR_TRIANGLE_SPHERE | 1 << pairs_pkg::PAIR_TRIANGLE_AABB | 1 << pairs_pkg::PAIR_TRIANGLE_OBB |
      1 << pairs_pkg::PAIR_OBB_OBB;
  // Pairs whose signed distance, with BOX, is at least the distance of their boxes (bounded_pipe.sv).
  localparam int BOUND_PAIRS = 1 << pairs_pkg::PAIR_TRIANGLE_SPHERE | 1 << pairs_pkg::PAIR_TRIANGLE_AABB |
      1 << pairs_pkg::PAIR_TRIANGLE_OBB | 1 << pairs_pkg::PAIR_TRIANGLE_TRIANGLE | 1 << pairs_pkg::PAIR_SPHERE_OBB |
      1 << pairs_pkg::PAIR_OBB_OBB;
  // Pairs of the card with certified filters: narrow lanes, and one wide lane behind them (filter_pair.sv).
  function automatic int filter_pairs(input config_t card);
    filter_pairs = (card.filter_exp != 0) ? card.pairs & FILTER_PAIRS : 0;
  endfunction
  // Pairs of the card with the box rule on signed distances. Pairs with certified filters do not have it.
  function automatic int bound_pairs(input config_t card);
    bound_pairs = (card.box != 0) ? card.pairs & BOUND_PAIRS & ~filter_pairs(card) : 0;
  endfunction
  // Pairs whose pipe keeps the order of rows, but not the time.
  function automatic int ordered_pairs(input config_t card);
    ordered_pairs = (card.pairs & pairs_pkg::ITERATIVE_PAIRS) | filter_pairs(card);
  endfunction
  // A power of two above the latency of any pipe, except iterative pipelines. With certified filters, above the
  // latency of narrow lanes, proof and wide pipe together.
  function automatic int pipe_depth(input config_t card);
    int slowest;
    slowest = latency_pkg::mean(card.lat);
    pipe_depth = (filter_pairs(card) != 0) ? 512 : ((card.pairs & ~pairs_pkg::SHORT_PAIRS) != 0) ? 256 : 64;
    pipe_depth = pipe_depth << $clog2(slowest);
  endfunction
  // Rows are so far apart that the update buffers are read one cycle before a row.
  function automatic bit early_rows(input config_t card);
    early_rows = card.shared_lane >= 2;
  endfunction
  // Rows of the output FIFO, and so rows in flight in the streaming modes. More than the cycles of a pipe, or of narrow
  // lanes and the wide pipe behind them.
  function automatic int fifo_depth(input config_t card);
    fifo_depth = (filter_pairs(card) != 0) ? pipe_depth(card) : 128;
  endfunction
  // Nodes that are on chip, and readers of DDR for a BVH: leaves, and with a cache slots and each traversal unit.
  function automatic int chip_nodes(input config_t card);
    chip_nodes = (card.node_cache != 0) ? card.pinned_nodes : card.nodes;
  endfunction
  function automatic int bvh_readers(input config_t card);
    bvh_readers = (card.traversal_units == 0) ? 0 : (card.node_cache != 0) ? 2 + card.traversal_units : 1;
  endfunction
  // The lane of brute-force passes is also the leaves' lane. Host arithmetic has a pipe for each.
  function automatic bit shares_lane(input config_t card);
    shares_lane = card.shared_lane != 0 && card.host == 0;
  endfunction
  function automatic int index_bits(input int n);  // bits that distinguish n values, at least one
    index_bits = (n > 1) ? $clog2(n) : 1;
  endfunction
endpackage
