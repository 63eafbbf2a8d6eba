// SPDX-License-Identifier: Apache-2.0
// A BVH: nodes with eight children (words: host/include/cde/bvh/node.hpp), and the state of a ray or solid during
// the traversal.
package bvh_pkg;
  localparam int CHILDREN = 8;
  localparam int NODE_WORDS = 18;
  localparam int HALF = NODE_WORDS / 2;  // words of one half: three of the whole node, and the corners of four children
  localparam int PLACE = 28;  // bits of the number of a node or a slot
  localparam int LEVELS = 16;  // most levels of nodes: Bvh::kMostDepth
  localparam int MOST_NODES = 1 << 22;  // limit of a card's node memory
  localparam int SLOTS_PER_NODE = 8;  // entries of the slot memory per node
  localparam int PLACE_WORDS = 8;  // of a place of the queue of primaries; an OBB or a triangle takes two places
  localparam int RAY_KEY = 12;  // bits of a key by which rays order and cull children
  localparam int AHEAD = 16;  // in a pass of at most this many primaries, contexts do not wait for their leaves

  // Kinds of children.
  localparam logic [1:0] KIND_NONE = 0;
  localparam logic [1:0] KIND_NODE = 1;
  localparam logic [1:0] KIND_ONE = 2;  // a leaf of one secondary
  localparam logic [1:0] KIND_TWO = 3;

  // Parts of a node.
  typedef logic [NODE_WORDS-1:0][31:0] node_t;
  function automatic logic [2:0][7:0] exponents_of(input node_t node);
    exponents_of = node[HALF][23:0];
  endfunction
  function automatic logic [CHILDREN-1:0][1:0] kinds_of(input node_t node);
    kinds_of = {node[HALF+2][31:28], node[HALF+1][31:28], node[HALF][31:24]};
  endfunction
  function automatic logic [PLACE-1:0] first_node_of(input node_t node);
    first_node_of = node[HALF+1][PLACE-1:0];
  endfunction
  function automatic logic [PLACE-1:0] first_slot_of(input node_t node);
    first_slot_of = node[HALF+2][PLACE-1:0];
  endfunction
  function automatic logic [CHILDREN-1:0][7:0] lower_of(input node_t node, input int axis);
    lower_of = {node[HALF+3+axis], node[3+axis]};
  endfunction
  function automatic logic [CHILDREN-1:0][7:0] upper_of(input node_t node, input int axis);
    upper_of = {node[HALF+6+axis], node[6+axis]};
  endfunction

  // Goals of a query.
  localparam logic [2:0] GOAL_NEAREST = 0;
  localparam logic [2:0] GOAL_FARTHEST = 1;
  localparam logic [2:0] GOAL_ANY = 2;       // the hit with the least index
  localparam logic [2:0] GOAL_OCCLUDED = 3;  // whether there is a hit; stops at the first
  localparam logic [2:0] GOAL_HITS = 4;      // all hits

  // The number of a traversal kind: 2 p for pair p; 2 p + 1 with its roles swapped, so that shape A is in the BVH.
  // A set of traversal kinds has one bit for each.
  localparam int TRAVERSALS = 2 * pairs_pkg::PAIRS;
  localparam int TRAVERSAL_BITS = pairs_pkg::PAIR_BITS + 1;
  typedef logic [TRAVERSALS-1:0] traversals_t;
  // Pairs that need no box rule when they meet spheres: their own roundings are small enough (docs/background/bvh.md).
  // Other pairs need the rule.
  localparam int PLAIN_PAIRS = 1 << pairs_pkg::PAIR_RAY_SPHERE | 1 << pairs_pkg::PAIR_SPHERE_SPHERE;
  // Traversal kinds of a card.
  function automatic traversals_t card_traversals(input config_pkg::config_t card);
    int traversable;
    traversable = ((card.box != 0) ? card.pairs & (1 << pairs_pkg::PAIR_RAY_TRIANGLE) : 0) |
        config_pkg::bound_pairs(card) | (card.pairs & PLAIN_PAIRS & ~config_pkg::filter_pairs(card));
    card_traversals = '0;
    for (int p = 0; p < pairs_pkg::PAIRS; p++)
      if (pairs_pkg::has(traversable, p)) begin
        card_traversals = card_traversals | (TRAVERSALS'(1) << (2 * p));
        if (card.swap != 0 && pairs_pkg::has(config_pkg::BOUND_PAIRS, p) &&
            pairs_pkg::primary_shape(p) != pairs_pkg::secondary_shape(p))
          card_traversals = card_traversals | (TRAVERSALS'(1) << (2 * p + 1));
      end
  endfunction
  function automatic bit has_traversal(input traversals_t traversals, input int traversal);
    has_traversal = ((traversals >> traversal) & 1) != 0;
  endfunction
  // Shape of the secondaries in the BVH, and shape of the primary.
  function automatic int leaf_shape(input int traversal);
    leaf_shape = ((traversal & 1) != 0) ? pairs_pkg::primary_shape(traversal >> 1) :
        pairs_pkg::secondary_shape(traversal >> 1);
  endfunction
  function automatic int traverser_shape(input int traversal);
    traverser_shape = ((traversal & 1) != 0) ? pairs_pkg::secondary_shape(traversal >> 1) :
        pairs_pkg::primary_shape(traversal >> 1);
  endfunction
  function automatic bit solid(input int traversal);  // T is a signed distance until the record
    solid = traverser_shape(traversal) != pairs_pkg::SHAPE_RAY;
  endfunction
  function automatic bit wide(input int traversal);  // the primary takes two places
    wide = pairs_pkg::shape_words(traverser_shape(traversal)) > PLACE_WORDS;
  endfunction
  // Whether a set has a traversal kind with primaries of this shape, or one with signed distances.
  function automatic bit has_traverser(input traversals_t traversals, input int shape);
    has_traverser = 0;
    for (int t = 0; t < TRAVERSALS; t++)
      if (has_traversal(traversals, t) && traverser_shape(t) == shape) has_traverser = 1;
  endfunction
  function automatic bit has_rays(input traversals_t traversals);
    has_rays = has_traverser(traversals, pairs_pkg::SHAPE_RAY);
  endfunction
  function automatic bit has_solids(input traversals_t traversals);
    has_solids = 0;
    for (int t = 0; t < TRAVERSALS; t++)
      if (has_traversal(traversals, t) && solid(t)) has_solids = 1;
  endfunction
  // Words stored per primary, for any of these traversal kinds, and per secondary.
  function automatic int traverser_words(input traversals_t traversals);
    traverser_words = PLACE_WORDS;
    for (int t = 0; t < TRAVERSALS; t++)
      if (has_traversal(traversals, t) && pairs_pkg::shape_words(traverser_shape(t)) > traverser_words)
        traverser_words = pairs_pkg::shape_words(traverser_shape(t));
  endfunction
  function automatic int leaf_words(input traversals_t traversals);
    leaf_words = pairs_pkg::shape_words(pairs_pkg::SHAPE_TRIANGLE);  // triangles, from which the card refits its BVH
    for (int t = 0; t < TRAVERSALS; t++)
      if (has_traversal(traversals, t) && pairs_pkg::shape_words(leaf_shape(t)) > leaf_words)
        leaf_words = pairs_pkg::shape_words(leaf_shape(t));
  endfunction

  // Kind of a primary at the nodes (ray_front.sv, solid_front.sv): its shape. Rays that meet spheres are a separate
  // kind.
  localparam int FRONT_RAY_SPHERE = pairs_pkg::SHAPES;
  localparam int FRONTS = pairs_pkg::SHAPES + 1;
  function automatic int front_kind(input int traversal);
    front_kind = (!solid(traversal) && leaf_shape(traversal) == pairs_pkg::SHAPE_SPHERE) ?
        FRONT_RAY_SPHERE : traverser_shape(traversal);
  endfunction
  function automatic bit has_front(input traversals_t traversals, input int kind);
    has_front = 0;
    for (int t = 0; t < TRAVERSALS; t++)
      if (has_traversal(traversals, t) && front_kind(t) == kind) has_front = 1;
  endfunction

  // Events in a cycle, for the counters.
  typedef struct packed {
    logic [3:0] fetched;      // nodes requested from DDR
    logic [3:0] cached;       // nodes read that are in DDR
    logic [3:0] nodes;        // read
    logic [3:0] leaves;       // requested
    logic [3:0] secondaries;  // tested
  } events_t;

  // Maps a number to an unsigned word of the same order.
  function automatic logic [31:0] placed(input logic [31:0] x);
    placed = x ^ {1'b1, {31{x[31]}}};
  endfunction
  // The same, but both zeros map to one word.
  function automatic logic [31:0] ordered(input logic [31:0] x);
    ordered = (x[30:0] == 0) ? 32'h8000_0000 : placed(x);
  endfunction

  // The upper half of a word: a number that is not above it.
  function automatic logic [15:0] half(input logic [31:0] x);
    half = x[31:16] + 16'(x[15:0] != 0 && x[31]);
  endfunction

  // Number of nodes, or of leaf secondaries, that the children before i have: the offset from the first one. `node` is
  // whether child i is a node. With nodes cleared, a kind has as many bits set as the leaf has secondaries.
  function automatic logic [3:0] ahead(input logic [CHILDREN-1:0][1:0] kinds, input logic [2:0] i, input bit node);
    logic [2*CHILDREN-1:0] low, high, counted;
    low = kinds & {CHILDREN{2'b01}};
    high = (kinds >> 1) & {CHILDREN{2'b01}};
    counted = node ? low & ~high : kinds & {high[2*CHILDREN-2:0], 1'b0} | low & high;
    ahead = 4'($countones(counted & ~('1 << {i, 1'b0})));
  endfunction
endpackage
