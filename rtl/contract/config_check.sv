// SPDX-License-Identifier: Apache-2.0
// Refuses invalid configurations, at elaboration only.
module config_check #(
    parameter config_pkg::config_t CONFIG
);
  if (CONFIG.primaries % 64 != 0 || CONFIG.primaries > records_pkg::MOST_PRIMARIES) begin : g_primaries
    $error("board: PRIMARIES must be 64, 128, 192 or 256");
  end
  if (CONFIG.primaries % CONFIG.lanes != 0 || (CONFIG.lanes & (CONFIG.lanes - 1)) != 0) begin : g_lanes
    $error("board: LANES must be a power of two that divides PRIMARIES");
  end
  if (pairs_pkg::PAIRS > 31) begin : g_codes
    $error("board: PAIRS is an int; expected at most 31 pairs, 0 to 30");
  end
  if (CONFIG.pairs <= 0 || CONFIG.pairs > pairs_pkg::SET_EVERYTHING) begin : g_pairs
    $error("board: PAIRS must be a set of pairs, 1 to %0d", pairs_pkg::SET_EVERYTHING);
  end
  if (CONFIG.box != 0 && (CONFIG.box != 1 || (CONFIG.pairs & (pairs_pkg::BOX_PAIRS |
      config_pkg::BOUND_PAIRS)) == 0)) begin : g_box
    $error("board: BOX must be 0 or 1; 1 needs ray-triangle or a pair of BOUND_PAIRS in PAIRS");
  end
  if (CONFIG.sat_ii != 1 && CONFIG.sat_ii != 3) begin : g_interval
    $error("board: SAT_II must be 1 or 3");
  end
  if (CONFIG.filter_exp != 0 && (config_pkg::filter_pairs(CONFIG) == 0 || CONFIG.sat_ii != 1 ||
      CONFIG.filter_exp > CONFIG.exp || CONFIG.filter_man >= CONFIG.man)) begin : g_filters
    $error("board: FILTER_EXP, FILTER_MAN must be a narrower format; they need SAT_II = 1 and FILTER_PAIRS");
  end
  if (CONFIG.traversal_units != 0 &&
      ((CONFIG.traversal_units != 1 && CONFIG.traversal_units != 2 && CONFIG.traversal_units != 4) ||
      CONFIG.exp != 8 || CONFIG.man != 23 || bvh_pkg::card_traversals(CONFIG) == 0)) begin :
      g_bvh
    $error("board: TRAVERSAL_UNITS must be 0, 1, 2 or 4; above 0 needs fp32 and a pair that can traverse a BVH");
  end
  if (CONFIG.node_cycles != 1 && CONFIG.node_cycles != 2 && CONFIG.node_cycles != 4) begin : g_node_cycles
    $error("board: NODE_CYCLES must be 1, 2 or 4");
  end
  if (CONFIG.node_cache != 0 && ((CONFIG.node_cache & (CONFIG.node_cache - 1)) != 0 || CONFIG.node_ways < 2 ||
      (CONFIG.node_ways & (CONFIG.node_ways - 1)) != 0 || CONFIG.node_cache < 2 * CONFIG.node_ways ||
      (CONFIG.pinned_nodes & (CONFIG.pinned_nodes - 1)) != 0 || CONFIG.pinned_nodes > CONFIG.nodes)) begin :
      g_node_cache
    $error("board: NODE_CACHE, NODE_WAYS and PINNED_NODES must be powers of two, see config.svh");
  end
  if (CONFIG.contexts < 16 || CONFIG.contexts > 256 || (CONFIG.contexts & (CONFIG.contexts - 1)) != 0) begin :
      g_contexts
    $error("board: CONTEXTS must be a power of two from 16 to 256");
  end
  if (CONFIG.shared_lane != 0 && (CONFIG.shared_lane > 8 || (CONFIG.shared_lane & (CONFIG.shared_lane - 1)) != 0 ||
      CONFIG.lanes != 1 || CONFIG.traversal_units == 0 || CONFIG.pairs != 1 << pairs_pkg::PAIR_RAY_TRIANGLE ||
      CONFIG.algorithm != 0 || CONFIG.box != 1 || CONFIG.swap != 0 || CONFIG.parallel != 0)) begin : g_shared_lane
    $error("board: SHARED_LANE must be 0, 1, 2, 4 or 8; it needs LANES = 1, traversal units and ray-triangle alone");
  end
  if (CONFIG.ray_places < 64 || CONFIG.ray_places > 4096 || (CONFIG.ray_places & (CONFIG.ray_places - 1)) != 0) begin :
      g_ray_places
    $error("board: RAY_PLACES must be a power of two from 64 to 4096");
  end
  if (CONFIG.transform < pairs_pkg::TRANSFORM_NONE || CONFIG.transform > pairs_pkg::TRANSFORM_BOTH ||
      (CONFIG.transform != pairs_pkg::TRANSFORM_NONE &&
       (CONFIG.objects < 2 || CONFIG.objects > 2048 || CONFIG.prim_objects < 2 ||
           CONFIG.prim_objects > 2048))) begin : g_objects
    $error("board: TRANSFORM must be 0 to 2, OBJECTS and PRIM_OBJECTS 2 to 2048");
  end
endmodule
