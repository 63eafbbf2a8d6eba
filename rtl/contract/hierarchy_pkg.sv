// SPDX-License-Identifier: Apache-2.0
// A hierarchy of boxes: nodes of eight children (words: host/include/cde/hierarchy/node.hpp), and what a ray, or a
// solid, keeps on its way through them.
package hierarchy_pkg;
  localparam int CHILDREN = 8;
  localparam int NODE_WORDS = 18;
  localparam int PLACE = 28;  // bits of the number of a node or a slot
  localparam int LEVELS = 16;  // of nodes at most: Hierarchy::kMostDepth
  localparam int MOST_NODES = 1 << 22;  // of a card's memory
  localparam int SLOTS_A_NODE = 8;  // places of the memory that says what is in each slot, a node
  localparam int RAYS = 4096;  // places for rays on their way into a pass; an OBB takes two
  localparam int PLACE_WORDS = 8;
  localparam int CONTEXTS = 256;  // rays in a card's hierarchy at a time
  localparam int AHEAD = 16;  // as many in a pass at most do not wait for their leaves

  // What a child is.
  localparam logic [1:0] KIND_NONE = 0;
  localparam logic [1:0] KIND_NODE = 1;
  localparam logic [1:0] KIND_ONE = 2;  // a leaf of one secondary
  localparam logic [1:0] KIND_TWO = 3;

  // What a ray asks.
  localparam logic [2:0] GOAL_NEAREST = 0;
  localparam logic [2:0] GOAL_FARTHEST = 1;
  localparam logic [2:0] GOAL_ANY = 2;       // the hit of the least index
  localparam logic [2:0] GOAL_OCCLUDED = 3;  // whether there is a hit: ends at the first
  localparam logic [2:0] GOAL_HITS = 4;      // all of them

  // A way through: pair p is way 2 p, and with its roles swapped, so that shape A is in the tree, 2 p + 1. A set of
  // ways has a bit for each.
  localparam int WAYS = 2 * pairs_pkg::PAIRS;
  localparam int WAY_BITS = pairs_pkg::PAIR_BITS + 1;
  typedef logic [WAYS-1:0] ways_t;
  // Pairs that meet spheres as they are: their own roundings are small enough (docs/background/bvh.md). The
  // others need the box rule.
  localparam int PLAIN_PAIRS = 1 << pairs_pkg::PAIR_RAY_SPHERE | 1 << pairs_pkg::PAIR_SPHERE_SPHERE;
  // Those of a card.
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
  // What is in the tree, and the primary's shape.
  function automatic int leaf_shape(input int way);
    leaf_shape = ((way & 1) != 0) ? pairs_pkg::primary_shape(way >> 1) : pairs_pkg::secondary_shape(way >> 1);
  endfunction
  function automatic int walked_shape(input int way);
    walked_shape = ((way & 1) != 0) ? pairs_pkg::secondary_shape(way >> 1) : pairs_pkg::primary_shape(way >> 1);
  endfunction
  function automatic bit solid(input int way);  // T is a signed gap on its way
    solid = walked_shape(way) != pairs_pkg::SHAPE_RAY;
  endfunction
  function automatic bit wide(input int way);  // the primary takes two places
    wide = pairs_pkg::shape_words(walked_shape(way)) > PLACE_WORDS;
  endfunction
  // Whether some way of a set is one of primaries of this shape, or has signed gaps.
  function automatic bit walks(input ways_t ways, input int shape);
    walks = 0;
    for (int w = 0; w < WAYS; w++) if (has_way(ways, w) && walked_shape(w) == shape) walks = 1;
  endfunction
  function automatic bit has_solids(input ways_t ways);
    has_solids = 0;
    for (int w = 0; w < WAYS; w++) if (has_way(ways, w) && solid(w)) has_solids = 1;
  endfunction
  // Words that are kept of a primary of any of these ways, and of a secondary.
  function automatic int walked_words(input ways_t ways);
    walked_words = PLACE_WORDS;
    for (int w = 0; w < WAYS; w++)
      if (has_way(ways, w) && pairs_pkg::shape_words(walked_shape(w)) > walked_words)
        walked_words = pairs_pkg::shape_words(walked_shape(w));
  endfunction
  function automatic int leaf_words(input ways_t ways);
    leaf_words = pairs_pkg::shape_words(pairs_pkg::SHAPE_TRIANGLE);  // of which the card refits its tree
    for (int w = 0; w < WAYS; w++)
      if (has_way(ways, w) && pairs_pkg::shape_words(leaf_shape(w)) > leaf_words)
        leaf_words = pairs_pkg::shape_words(leaf_shape(w));
  endfunction

  // What a primary is for nodes (ray_front.sv, solid_front.sv): its shape, but that rays which meet spheres are a kind
  // of their own.
  localparam int FRONT_RAY_SPHERE = pairs_pkg::SHAPES;
  localparam int FRONTS = pairs_pkg::SHAPES + 1;
  function automatic int front_kind(input int way);
    front_kind = (!solid(way) && leaf_shape(way) == pairs_pkg::SHAPE_SPHERE) ? FRONT_RAY_SPHERE : walked_shape(way);
  endfunction
  function automatic bit has_front(input ways_t ways, input int kind);
    has_front = 0;
    for (int w = 0; w < WAYS; w++) if (has_way(ways, w) && front_kind(w) == kind) has_front = 1;
  endfunction

  // What happens in a clock, to be counted.
  typedef struct packed {
    logic [3:0] nodes;        // read
    logic [3:0] leaves;       // asked for
    logic [3:0] secondaries;  // tested
  } events_t;

  // Children of a node that a ray meets, in the order in which they are visited.
  typedef struct packed {
    logic [PLACE-1:0] node;  // of its first child that is a node
    logic [PLACE-1:0] slot;  // of its first child's secondary
    logic [CHILDREN-1:0][1:0] kinds;
    logic [3:0] count;  // how many are met
    logic [CHILDREN-1:0][2:0] order;
    logic [CHILDREN-1:0][15:0] keys;  // what each is left out by, rounded so that it is not too early
  } group_t;

  // A number's place in their order: words compare as numbers do.
  function automatic logic [31:0] placed(input logic [31:0] x);
    placed = x ^ {1'b1, {31{x[31]}}};
  endfunction
  // The same, but the two zeros are one.
  function automatic logic [31:0] ordered(input logic [31:0] x);
    ordered = (x[30:0] == 0) ? 32'h8000_0000 : placed(x);
  endfunction

  // The upper half of a word, a number that is not above it, or not below.
  function automatic logic [15:0] half(input logic [31:0] x, input logic up);
    half = x[31:16] + 16'(x[15:0] != 0 && x[31] != up);
  endfunction

  // How many nodes, or secondaries of leaves, the children before i have: its place behind the first one's. Without
  // those of nodes kinds have as many bits as there are secondaries.
  function automatic logic [3:0] ahead(input logic [CHILDREN-1:0][1:0] kinds, input logic [2:0] i);
    logic [2*CHILDREN-1:0] low, high, counted;
    low = kinds & {CHILDREN{2'b01}};
    high = (kinds >> 1) & {CHILDREN{2'b01}};
    counted = (kinds[i] == KIND_NODE) ? low & ~high : kinds & {high[2*CHILDREN-2:0], 1'b0} | low & high;
    ahead = 4'($countones(counted & ~('1 << {i, 1'b0})));
  endfunction
endpackage
