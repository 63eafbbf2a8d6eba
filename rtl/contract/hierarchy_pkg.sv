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

  // Pairs that meet spheres as they are: their own roundings are small enough (docs/hierarchy.md). The others need the
  // box rule.
  localparam int PLAIN_PAIRS = 1 << pairs_pkg::PAIR_RAY_SPHERE | 1 << pairs_pkg::PAIR_SPHERE_SPHERE;
  // The primary is shape B, so that shape A, a triangle, is in the tree.
  localparam int SWAPPED_PAIRS = 1 << pairs_pkg::PAIR_TRIANGLE_SPHERE | 1 << pairs_pkg::PAIR_TRIANGLE_OBB;
  // Pairs of a card whose primaries go through one.
  function automatic int walked_pairs(input config_pkg::config_t card);
    walked_pairs = ((card.box != 0) ? card.pairs & (1 << pairs_pkg::PAIR_RAY_TRIANGLE) : 0) |
        config_pkg::bound_pairs(card) | (card.pairs & PLAIN_PAIRS & ~config_pkg::verdict_pairs(card));
    if (card.swap == 0) walked_pairs = walked_pairs & ~SWAPPED_PAIRS;
  endfunction
  function automatic bit swapped(input int pair);
    swapped = pairs_pkg::has(SWAPPED_PAIRS, pair);
  endfunction
  // What is in the tree, and the primary's shape.
  function automatic int leaf_shape(input int pair);
    leaf_shape = swapped(pair) ? pairs_pkg::primary_shape(pair) : pairs_pkg::secondary_shape(pair);
  endfunction
  function automatic int walked_shape(input int pair);
    walked_shape = swapped(pair) ? pairs_pkg::secondary_shape(pair) : pairs_pkg::primary_shape(pair);
  endfunction
  function automatic bit solid(input int pair);  // T is a signed gap on its way
    solid = walked_shape(pair) != pairs_pkg::SHAPE_RAY;
  endfunction
  function automatic bit wide(input int pair);  // the primary takes two places
    wide = pairs_pkg::shape_words(walked_shape(pair)) > PLACE_WORDS;
  endfunction
  // Of these pairs, those whose primary is one.
  function automatic int walked_by(input int pairs, input int shape);
    walked_by = 0;
    for (int p = 0; p < pairs_pkg::PAIRS; p++)
      if (pairs_pkg::has(pairs, p) && walked_shape(p) == shape) walked_by = walked_by | (1 << p);
  endfunction
  // Those that have signed gaps.
  function automatic int walked_solids(input int pairs);
    walked_solids = pairs & ~walked_by(pairs, pairs_pkg::SHAPE_RAY);
  endfunction
  // Words that are kept of a primary of any of these pairs.
  function automatic int walked_words(input int pairs);
    walked_words = PLACE_WORDS;
    for (int p = 0; p < pairs_pkg::PAIRS; p++)
      if (pairs_pkg::has(pairs, p) && pairs_pkg::shape_words(walked_shape(p)) > walked_words)
        walked_words = pairs_pkg::shape_words(walked_shape(p));
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
