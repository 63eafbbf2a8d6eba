// SPDX-License-Identifier: Apache-2.0
// A BVH: nodes with eight children (words: host/include/cde/bvh/node.hpp), and the state of a ray or solid during
// the traversal.
package bvh_pkg;
  localparam int CHILDREN = 8;
  localparam int NODE_WORDS = 18;
  localparam int PLACE = 28;  // bits of the number of a node or a slot
  localparam int LEVELS = 16;  // most levels of nodes: Bvh::kMostDepth
  localparam int MOST_NODES = 1 << 22;  // limit of a card's node memory
  localparam int SLOTS_A_NODE = 8;  // entries of the slot memory per node
  localparam int RAYS = 4096;  // places of the queue of primaries; an OBB or a triangle takes two
  localparam int PLACE_WORDS = 8;
  localparam int CONTEXTS = 256;  // primaries under way at a time
  localparam int AHEAD = 16;  // in a pass of at most this many primaries, contexts do not wait for their leaves

  // Kinds of children.
  localparam logic [1:0] KIND_NONE = 0;
  localparam logic [1:0] KIND_NODE = 1;
  localparam logic [1:0] KIND_ONE = 2;  // a leaf of one secondary
  localparam logic [1:0] KIND_TWO = 3;

  // Goals of a query.
  localparam logic [2:0] GOAL_NEAREST = 0;
  localparam logic [2:0] GOAL_FARTHEST = 1;
  localparam logic [2:0] GOAL_ANY = 2;       // the hit with the least index
  localparam logic [2:0] GOAL_OCCLUDED = 3;  // whether there is a hit; stops at the first
  localparam logic [2:0] GOAL_HITS = 4;      // all hits

  // A traversal kind (`way`): pair p has number 2 p. With its roles swapped, so that shape A is in the BVH, it has 2 p
  // + 1.
  // A set of traversal kinds has one bit for each.
  localparam int WAYS = 2 * pairs_pkg::PAIRS;
  localparam int WAY_BITS = pairs_pkg::PAIR_BITS + 1;
  typedef logic [WAYS-1:0] ways_t;
  // Pairs that need no box rule when they meet spheres: their own roundings are small enough (docs/background/bvh.md).
  // Other pairs need the rule.
  localparam int PLAIN_PAIRS = 1 << pairs_pkg::PAIR_RAY_SPHERE | 1 << pairs_pkg::PAIR_SPHERE_SPHERE;
  // Traversal kinds of a card.
  function automatic ways_t card_ways(input config_pkg::config_t card);
    int walked;
    walked = ((card.box != 0) ? card.pairs & (1 << pairs_pkg::PAIR_RAY_TRIANGLE) : 0) |
        config_pkg::bound_pairs(card) | (card.pairs & PLAIN_PAIRS & ~config_pkg::verdict_pairs(card));
    card_ways = '0;
    for (int p = 0; p < pairs_pkg::PAIRS; p++)
      if (pairs_pkg::has(walked, p)) begin
        card_ways = card_ways | (WAYS'(1) << (2 * p));
        if (card.swap != 0 && pairs_pkg::has(config_pkg::BOUND_PAIRS, p) &&
            pairs_pkg::primary_shape(p) != pairs_pkg::secondary_shape(p))
          card_ways = card_ways | (WAYS'(1) << (2 * p + 1));
      end
  endfunction
  function automatic bit has_way(input ways_t ways, input int way);
    has_way = ((ways >> way) & 1) != 0;
  endfunction
  // Shape of the secondaries in the BVH, and shape of the primary.
  function automatic int leaf_shape(input int way);
    leaf_shape = ((way & 1) != 0) ? pairs_pkg::primary_shape(way >> 1) : pairs_pkg::secondary_shape(way >> 1);
  endfunction
  function automatic int walked_shape(input int way);
    walked_shape = ((way & 1) != 0) ? pairs_pkg::secondary_shape(way >> 1) : pairs_pkg::primary_shape(way >> 1);
  endfunction
  function automatic bit solid(input int way);  // T is a signed distance until the record
    solid = walked_shape(way) != pairs_pkg::SHAPE_RAY;
  endfunction
  function automatic bit wide(input int way);  // the primary takes two places
    wide = pairs_pkg::shape_words(walked_shape(way)) > PLACE_WORDS;
  endfunction
  // Whether a set has a traversal kind with primaries of this shape, or one with signed distances.
  function automatic bit walks(input ways_t ways, input int shape);
    walks = 0;
    for (int w = 0; w < WAYS; w++) if (has_way(ways, w) && walked_shape(w) == shape) walks = 1;
  endfunction
  function automatic bit has_solids(input ways_t ways);
    has_solids = 0;
    for (int w = 0; w < WAYS; w++) if (has_way(ways, w) && solid(w)) has_solids = 1;
  endfunction
  // Words stored per primary, for any of these traversal kinds, and per secondary.
  function automatic int walked_words(input ways_t ways);
    walked_words = PLACE_WORDS;
    for (int w = 0; w < WAYS; w++)
      if (has_way(ways, w) && pairs_pkg::shape_words(walked_shape(w)) > walked_words)
        walked_words = pairs_pkg::shape_words(walked_shape(w));
  endfunction
  function automatic int leaf_words(input ways_t ways);
    leaf_words = pairs_pkg::shape_words(pairs_pkg::SHAPE_TRIANGLE);  // triangles, from which the card refits its BVH
    for (int w = 0; w < WAYS; w++)
      if (has_way(ways, w) && pairs_pkg::shape_words(leaf_shape(w)) > leaf_words)
        leaf_words = pairs_pkg::shape_words(leaf_shape(w));
  endfunction

  // Kind of a primary at the nodes (ray_front.sv, solid_front.sv): its shape. Rays that meet spheres are a separate
  // kind.
  localparam int FRONT_RAY_SPHERE = pairs_pkg::SHAPES;
  localparam int FRONTS = pairs_pkg::SHAPES + 1;
  function automatic int front_kind(input int way);
    front_kind = (!solid(way) && leaf_shape(way) == pairs_pkg::SHAPE_SPHERE) ? FRONT_RAY_SPHERE : walked_shape(way);
  endfunction
  function automatic bit has_front(input ways_t ways, input int kind);
    has_front = 0;
    for (int w = 0; w < WAYS; w++) if (has_way(ways, w) && front_kind(w) == kind) has_front = 1;
  endfunction

  // Events in a cycle, for the counters.
  typedef struct packed {
    logic [3:0] nodes;        // read
    logic [3:0] leaves;       // requested
    logic [3:0] secondaries;  // tested
  } events_t;

  // Children of a node that a ray hits, in the order of visits.
  typedef struct packed {
    logic [PLACE-1:0] node;  // place of the first child that is a node
    logic [PLACE-1:0] slot;  // slot of the first child's secondary
    logic [CHILDREN-1:0][1:0] kinds;
    logic [3:0] count;  // number of hit children
    logic [CHILDREN-1:0][2:0] order;
    logic [CHILDREN-1:0][15:0] keys;  // culling key of each child, rounded so that no child is culled too early
  } group_t;

  // Maps a number to an unsigned word of the same order.
  function automatic logic [31:0] placed(input logic [31:0] x);
    placed = x ^ {1'b1, {31{x[31]}}};
  endfunction
  // The same, but both zeros map to one word.
  function automatic logic [31:0] ordered(input logic [31:0] x);
    ordered = (x[30:0] == 0) ? 32'h8000_0000 : placed(x);
  endfunction

  // The upper half of a word: a number that is not above it, or with `up` not below it.
  function automatic logic [15:0] half(input logic [31:0] x, input logic up);
    half = x[31:16] + 16'(x[15:0] != 0 && x[31] != up);
  endfunction

  // Number of nodes, or of leaf secondaries, that the children before i have: the offset from the first one. With nodes
  // cleared, a kind has as many bits set as the leaf has secondaries.
  function automatic logic [3:0] ahead(input logic [CHILDREN-1:0][1:0] kinds, input logic [2:0] i);
    logic [2*CHILDREN-1:0] low, high, counted;
    low = kinds & {CHILDREN{2'b01}};
    high = (kinds >> 1) & {CHILDREN{2'b01}};
    counted = (kinds[i] == KIND_NODE) ? low & ~high : kinds & {high[2*CHILDREN-2:0], 1'b0} | low & high;
    ahead = 4'($countones(counted & ~('1 << {i, 1'b0})));
  endfunction
endpackage
