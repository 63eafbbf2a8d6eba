// SPDX-License-Identifier: Apache-2.0
// Shapes and pairs of shapes: tables, in the order of their codes, and derived values.
// The C++ version is host/include/cde/contract/pairs.hpp. A table is a flat vector with one read function. In a
// constant function, Yosys takes an index of a packed array for a bit index.
package pairs_pkg;

  // ---- Codes: up to 64 shapes and 63 pairs. Every port and field with a code has one of these types ----
  typedef logic [5:0] shape_t;
  typedef logic [5:0] pair_t;
  typedef logic [5:0] words_t;  // number of words of a shape
  localparam int SHAPE_BITS = $bits(shape_t);
  localparam int PAIR_BITS = $bits(pair_t);
  localparam int WORDS_BITS = $bits(words_t);
  localparam int SHAPE_CODES = 1 << SHAPE_BITS;
  localparam int PAIR_CODES = 1 << PAIR_BITS;
  localparam pair_t NO_PAIR = '1;

  // ---- Shapes ----
  localparam int SHAPE_RAY = 0;       // o x y z, d x y z, tmin, tmax
  localparam int SHAPE_TRIANGLE = 1;  // v0 x y z, v1, v2
  localparam int SHAPE_SPHERE = 2;    // c x y z, r
  localparam int SHAPE_AABB = 3;      // min x y z, max
  localparam int SHAPE_PLANE = 4;     // n x y z, d
  localparam int SHAPE_CYLINDER = 5;  // c x y z, axis x y z, half height, radius
  localparam int SHAPE_OBB = 6;       // c x y z, half extents, rotation by rows (columns are the axes)
  localparam int SHAPES = 7;
  localparam int SHAPE_INDEX = $clog2(SHAPES);  // bits that distinguish the existing shapes
  localparam int SHAPE_MOST_WORDS = 15;  // words of the largest shape
  localparam int SHAPE_PLACES = 1 << SHAPE_INDEX;
  localparam logic [0:WORDS_BITS*SHAPE_PLACES-1] SHAPE_WORDS = {
    6'd8, 6'd9, 6'd4, 6'd6, 6'd4, 6'd8, 6'd15, {SHAPE_PLACES-SHAPES{6'd0}}};

  // Kind of a word of a shape.
  localparam int WORD_COORDINATE = 0;  // a length of either sign
  localparam int WORD_SIZE = 1;        // a length above zero
  localparam int WORD_DIRECTION = 2;   // component of a ray's direction: a length in a separate unit
  localparam int WORD_INTERVAL = 3;    // tmin or tmax: lengths in that unit
  localparam int WORD_PURE = 4;        // component of a unit vector or rotation
  localparam int WORD_NONE = 7;        // the shape has no such word
  localparam logic [0:3*SHAPE_MOST_WORDS*SHAPES-1] WORD_KINDS = {
    {{3{3'(WORD_COORDINATE)}}, {3{3'(WORD_DIRECTION)}}, {2{3'(WORD_INTERVAL)}}, {7{3'(WORD_NONE)}}},  // ray
    {{9{3'(WORD_COORDINATE)}}, {6{3'(WORD_NONE)}}},                                                   // triangle
    {{3{3'(WORD_COORDINATE)}}, {1{3'(WORD_SIZE)}}, {11{3'(WORD_NONE)}}},                              // sphere
    {{6{3'(WORD_COORDINATE)}}, {9{3'(WORD_NONE)}}},                                                   // aabb
    {{3{3'(WORD_PURE)}}, {1{3'(WORD_COORDINATE)}}, {11{3'(WORD_NONE)}}},                              // plane
    {{3{3'(WORD_COORDINATE)}}, {3{3'(WORD_PURE)}}, {2{3'(WORD_SIZE)}}, {7{3'(WORD_NONE)}}},           // cylinder
    {{3{3'(WORD_COORDINATE)}}, {3{3'(WORD_SIZE)}}, {9{3'(WORD_PURE)}}}};                              // obb

  // ---- Pairs: the number is the code in the command register and the bit in a card's parameter PAIRS. PAIRS is an int
  // above zero, so a card can have pairs 0 to 30 (config_check.sv) ----
  localparam pair_t PAIR_RAY_TRIANGLE = 0;
  localparam pair_t PAIR_OBB_OBB = 1;
  localparam pair_t PAIR_TRIANGLE_AABB = 2;
  localparam pair_t PAIR_TRIANGLE_OBB = 3;
  localparam pair_t PAIR_SPHERE_SPHERE = 4;
  localparam pair_t PAIR_TRIANGLE_SPHERE = 5;
  localparam pair_t PAIR_RAY_CYLINDER = 6;
  localparam pair_t PAIR_TRIANGLE_CYLINDER = 7;
  localparam pair_t PAIR_CYLINDER_CYLINDER = 8;
  localparam pair_t PAIR_OBB_CYLINDER = 9;
  localparam pair_t PAIR_OBB_PLANE = 10;
  localparam pair_t PAIR_RAY_SPHERE = 11;
  localparam pair_t PAIR_SPHERE_OBB = 12;
  localparam pair_t PAIR_SPHERE_PLANE = 13;
  localparam pair_t PAIR_TRIANGLE_TRIANGLE = 14;
  localparam int PAIRS = 15;
  localparam int PAIR_INDEX = $clog2(PAIRS);  // bits that distinguish the existing pairs

  // Shapes A and B of the pairs. Unused codes are filled up, and the last place is for NO_PAIR. The tables are as short
  // as possible, because a running card reads them.
  localparam int PAIR_PLACES = 1 << $clog2(PAIRS + 1);
  localparam logic [0:SHAPE_INDEX*PAIR_PLACES-1] PRIMARY_SHAPES = {
    SHAPE_INDEX'(SHAPE_RAY),       // ray-triangle
    SHAPE_INDEX'(SHAPE_OBB),       // obb-obb
    SHAPE_INDEX'(SHAPE_TRIANGLE),  // triangle-aabb
    SHAPE_INDEX'(SHAPE_TRIANGLE),  // triangle-obb
    SHAPE_INDEX'(SHAPE_SPHERE),    // sphere-sphere
    SHAPE_INDEX'(SHAPE_TRIANGLE),  // triangle-sphere
    SHAPE_INDEX'(SHAPE_RAY),       // ray-cylinder
    SHAPE_INDEX'(SHAPE_TRIANGLE),  // triangle-cylinder
    SHAPE_INDEX'(SHAPE_CYLINDER),  // cylinder-cylinder
    SHAPE_INDEX'(SHAPE_OBB),       // obb-cylinder
    SHAPE_INDEX'(SHAPE_OBB),       // obb-plane
    SHAPE_INDEX'(SHAPE_RAY),       // ray-sphere
    SHAPE_INDEX'(SHAPE_SPHERE),    // sphere-obb
    SHAPE_INDEX'(SHAPE_SPHERE),    // sphere-plane
    SHAPE_INDEX'(SHAPE_TRIANGLE),  // triangle-triangle
    {PAIR_PLACES-PAIRS{SHAPE_INDEX'(SHAPE_TRIANGLE)}}};
  localparam logic [0:SHAPE_INDEX*PAIR_PLACES-1] SECONDARY_SHAPES = {
    SHAPE_INDEX'(SHAPE_TRIANGLE),  // ray-triangle
    SHAPE_INDEX'(SHAPE_OBB),       // obb-obb
    SHAPE_INDEX'(SHAPE_AABB),      // triangle-aabb
    SHAPE_INDEX'(SHAPE_OBB),       // triangle-obb
    SHAPE_INDEX'(SHAPE_SPHERE),    // sphere-sphere
    SHAPE_INDEX'(SHAPE_SPHERE),    // triangle-sphere
    SHAPE_INDEX'(SHAPE_CYLINDER),  // ray-cylinder
    SHAPE_INDEX'(SHAPE_CYLINDER),  // triangle-cylinder
    SHAPE_INDEX'(SHAPE_CYLINDER),  // cylinder-cylinder
    SHAPE_INDEX'(SHAPE_CYLINDER),  // obb-cylinder
    SHAPE_INDEX'(SHAPE_PLANE),     // obb-plane
    SHAPE_INDEX'(SHAPE_SPHERE),    // ray-sphere
    SHAPE_INDEX'(SHAPE_OBB),       // sphere-obb
    SHAPE_INDEX'(SHAPE_PLANE),     // sphere-plane
    SHAPE_INDEX'(SHAPE_TRIANGLE),  // triangle-triangle
    {PAIR_PLACES-PAIRS{SHAPE_INDEX'(SHAPE_CYLINDER)}}};
  // Sets of pairs (bit p: pair p), such as a card's parameter PAIRS. SET_NAME are the named configurations: the option
  // PAIRS=name of verilator/model_builder selects one.
  localparam int SET_EVERYTHING = (1 << PAIRS) - 1;
  localparam int SET_RAYS = 1 << PAIR_RAY_TRIANGLE | 1 << PAIR_RAY_CYLINDER | 1 << PAIR_RAY_SPHERE;
  localparam int SET_SOLIDS = SET_EVERYTHING & ~SET_RAYS;  // T is a signed distance
  localparam int SET_SPHERES =  // a sphere meets something
      1 << PAIR_SPHERE_SPHERE | 1 << PAIR_TRIANGLE_SPHERE | 1 << PAIR_RAY_SPHERE | 1 << PAIR_SPHERE_OBB |
      1 << PAIR_SPHERE_PLANE;
  localparam int ITERATIVE_ROWS = 1024;  // more rows than an iterative pipeline can have in flight
  // the pipe is iterative, with an input port (cylinder_pair.sv); iterations_t sets its iterations
  localparam int ITERATIVE_PAIRS =
      1 << PAIR_TRIANGLE_CYLINDER | 1 << PAIR_CYLINDER_CYLINDER | 1 << PAIR_OBB_CYLINDER;
  localparam int SAT_PAIRS =  // the pipe has units of candidate axes, which can be shared (pair_hold.sv)
      1 << PAIR_OBB_OBB | 1 << PAIR_TRIANGLE_AABB | 1 << PAIR_TRIANGLE_OBB;
  localparam int BOX_PAIRS = 1 << PAIR_RAY_TRIANGLE;  // BOX applies to its hits (ray_box.sv)
  localparam int SHORT_PAIRS =  // its pipe is short
      1 << PAIR_RAY_TRIANGLE | 1 << PAIR_RAY_CYLINDER | 1 << PAIR_RAY_SPHERE | 1 << PAIR_SPHERE_SPHERE |
      1 << PAIR_SPHERE_PLANE;
  // Pairs scaled to the size of one in every format (length_scale.sv), because they multiply four lengths.
  localparam int SCALED_PAIRS = 1 << PAIR_OBB_OBB | 1 << PAIR_TRIANGLE_AABB | 1 << PAIR_TRIANGLE_OBB |
      1 << PAIR_TRIANGLE_SPHERE | 1 << PAIR_TRIANGLE_TRIANGLE |
      1 << PAIR_TRIANGLE_CYLINDER | 1 << PAIR_CYLINDER_CYLINDER | 1 << PAIR_OBB_CYLINDER;

  // ---- Ray-triangle algorithms ----
  localparam logic [7:0] ALGORITHM_MOLLER = 8'd0;
  localparam logic [7:0] ALGORITHM_BADOUEL = 8'd1;
  localparam logic [7:0] ALGORITHM_PLUECKER = 8'd2;
  localparam logic [7:0] ALGORITHM_WATERTIGHT = 8'd3;
  localparam int ALGORITHMS = 4;

  // ---- Shapes that objects move (parameter TRANSFORM of a card) ----
  localparam int TRANSFORM_NONE = 0;         // no transformer
  localparam int TRANSFORM_SECONDARIES = 1;  // secondaries
  localparam int TRANSFORM_BOTH = 2;         // secondaries and primaries

  // ---- Properties of a shape ----
  function automatic int shape_words(input int shape);
    shape_words = int'(SHAPE_WORDS[WORDS_BITS*(shape&(SHAPE_PLACES-1))+:WORDS_BITS]);
  endfunction
  function automatic int word_kind(input int shape, input int k);
    word_kind = int'(WORD_KINDS[3*(SHAPE_MOST_WORDS*shape+k)+:3]);
  endfunction
  function automatic bit is_length(input int shape, input int k);
    is_length = word_kind(shape, k) == WORD_COORDINATE || word_kind(shape, k) == WORD_SIZE;
  endfunction
  function automatic int lengths(input int shape);  // number of words that are lengths
    lengths = 0;
    for (int k = 0; k < shape_words(shape); k++) if (is_length(shape, k)) lengths++;
  endfunction
  function automatic int length_word(input int shape, input int i);  // the i-th of them
    int left;
    left = i;
    length_word = 0;
    for (int k = 0; k < shape_words(shape); k++)
      if (is_length(shape, k)) begin
        if (left == 0) length_word = k;
        left--;
      end
  endfunction

  // ---- Properties of a pair ----
  function automatic bit has(input int pairs, input int pair);  // the set has the pair
    has = ((pairs >> pair) & 1) != 0;
  endfunction
  function automatic int primary_shape(input int pair);  // A
    primary_shape = int'(PRIMARY_SHAPES[SHAPE_INDEX*(pair&(PAIR_PLACES-1))+:SHAPE_INDEX]);
  endfunction
  function automatic int secondary_shape(input int pair);  // B
    secondary_shape = int'(SECONDARY_SHAPES[SHAPE_INDEX*(pair&(PAIR_PLACES-1))+:SHAPE_INDEX]);
  endfunction
  function automatic int primary_words(input int pair);
    primary_words = shape_words(primary_shape(pair));
  endfunction
  function automatic int secondary_words(input int pair);
    secondary_words = shape_words(secondary_shape(pair));
  endfunction
  // primary of an iterative pipeline: 0 cylinder, 1 box, 2 triangle (cylinder.svh)
  function automatic int cylinder_body(input int pair);
    cylinder_body = (primary_shape(pair) == SHAPE_CYLINDER) ? 0 : (primary_shape(pair) == SHAPE_OBB) ? 1 : 2;
  endfunction
  // formats with few exponent bits scale every pair
  function automatic bit scaled(input int pair, input int exp);
    scaled = exp < 8 || has(SCALED_PAIRS, pair);
  endfunction
  // Latencies are numbers here: Icarus does not accept functions of a structure of another package.
  function automatic int unscale_latency(input bit ray, input int lat_mul, input int lat_cmp);  // of length_unscale.sv
    unscale_latency = (ray && lat_mul > lat_cmp) ? lat_mul : lat_cmp;
  endfunction
  function automatic int scale_latency(input bit ray, input int lat_mul, input int lat_cmp);  // of length_scale.sv
    scale_latency = lat_cmp + unscale_latency(ray, lat_mul, lat_cmp);
  endfunction
  // cycles that an iterative pipeline needs for its operands
  function automatic int iterative_entry(input int lat_add, input int lat_mul, input int lat_cmp);
    iterative_entry = scale_latency(0, lat_mul, lat_cmp) + ((lat_add > lat_mul) ? lat_add : lat_mul);
  endfunction

  // ---- Properties of a set of pairs ----
  // Words of the largest slot of primaries or of secondaries; `swap`: either shape may have either role.
  function automatic int slot_words(input int pairs, input bit primary, input bit swap);
    slot_words = 0;
    for (int p = 0; p < PAIRS; p++)
      if (has(pairs, p)) begin
        if ((primary || swap) && primary_words(p) > slot_words) slot_words = primary_words(p);
        if ((!primary || swap) && secondary_words(p) > slot_words) slot_words = secondary_words(p);
      end
  endfunction
  // Whether some pair of the set has the shape in this role.
  function automatic bit uses_shape(input int pairs, input int shape, input bit primary, input bit swap);
    uses_shape = 0;
    for (int p = 0; p < PAIRS; p++)
      if (has(pairs, p)) begin
        if ((primary || swap) && primary_shape(p) == shape) uses_shape = 1;
        if ((!primary || swap) && secondary_shape(p) == shape) uses_shape = 1;
      end
  endfunction
  // Whether the card's transformer handles the shape, and its cycles. R x takes LAT_MUL + 2*LAT_ADD, and + t takes
  // LAT_ADD. For a plane, n'.t waits for R n.
  function automatic bit moves_shape(input int pairs, input int shape, input bit swap, input int transform);
    moves_shape = uses_shape(pairs, shape, 0, swap) || (transform == TRANSFORM_BOTH && uses_shape(pairs, shape, 1,
        swap));
  endfunction
  function automatic int transform_latency(
      input int pairs, input bit swap, input int transform, input int lat_add, input int lat_mul);
    transform_latency = moves_shape(pairs, SHAPE_PLANE, swap,
        transform) ? 2 * lat_mul + 5 * lat_add : lat_mul + 3 * lat_add;
  endfunction
endpackage
