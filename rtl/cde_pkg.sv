// The one source of truth for what software and hardware share: pair codes, result modes, record and slot layouts,
// local-bus spaces and the register map. tests/board holds the C++ side (host/include/cde/card.hpp) against this file.
package cde_pkg;

  // ---- Local bus: one 64-bit beat a clock into one of these spaces ----
  localparam logic [1:0] SPACE_REG = 2'd0;   // register file, 64-bit registers at 8-byte offsets
  localparam logic [1:0] SPACE_PRIM = 2'd1;  // primary register file, PRIM_WORDS words a slot, write only
  localparam logic [1:0] SPACE_DDR = 2'd2;   // secondary memory, packed slots, write only
  localparam logic [1:0] SPACE_SRAM = 2'd3;  // record stream: every beat read takes the next words of the ring

  // ---- Registers (byte offsets) ----
  localparam logic [11:0] REG_ID = 12'h000;            // [63:32] "CDE1", [31:0] interface version
  localparam logic [11:0] REG_CAPS = 12'h008;          // [15:0] lanes, [31:16] primaries, [39:32] EXP, [47:40] MAN, [55:48] algorithm
  localparam logic [11:0] REG_CONFIG_HASH = 12'h010;   // hash of parameters and RTL sources
  localparam logic [11:0] REG_CAPS2 = 12'h018;         // [15:0] pipe latency, [47:16] SRAM records, [55:48] container bits
  localparam logic [11:0] REG_CAPACITY = 12'h020;      // bytes of DDR
  localparam logic [11:0] REG_CONTROL = 12'h028;       // write: [0] go, [1] abort, [2] clear errors and done
  localparam logic [11:0] REG_STATUS = 12'h030;        // STATUS_* bits
  localparam logic [11:0] REG_COMMAND = 12'h038;       // [2:0] result mode, [4] swap roles, [5] normals, [11:8] pair code; [12] a second pair, [13] its swap, [19:16] its code
  localparam logic [11:0] REG_PRIM_COUNT = 12'h040;    // counter register: primaries in the register file
  localparam logic [11:0] REG_SEC_FIRST = 12'h048;     // first secondary slot
  localparam logic [11:0] REG_SEC_COUNT = 12'h050;     // counter register: number of secondaries
  localparam logic [11:0] REG_RECORDS = 12'h058;       // records waiting in the SRAM ring
  localparam logic [11:0] REG_FAULT_ADDR = 12'h060;    // [33:32] space, [31:0] offset of the first refused access
  localparam logic [11:0] REG_STENCIL = 12'h080;       // primaries/64 registers: 1 masks a primary
  localparam logic [11:0] REG_BUDGET = 12'h0A0;        // work for a cylinder pair: [7:0] M, [15:8] K1, [23:16] K2
  localparam logic [11:0] REG_CYCLES = 12'h0C0;        // clocks from go to done, without REG_WRITEBACK
  localparam logic [11:0] REG_ROWS = 12'h0C8;          // rows issued to the pipe (one row = LANES pairs)
  localparam logic [11:0] REG_STALLS = 12'h0D0;        // clocks the pipe mouth waited for output space, for a slot of a cylinder pipe, or for a facet pipe's interval
  localparam logic [11:0] REG_BUBBLES = 12'h0D8;       // clocks the pipe mouth waited for a secondary
  localparam logic [11:0] REG_BAD_PRIM = 12'h0E0;      // primaries refused as bad input
  localparam logic [11:0] REG_BAD_SEC = 12'h0E8;       // secondaries refused as bad input
  localparam logic [11:0] REG_SECONDARIES = 12'h0F0;   // secondaries swept
  localparam logic [11:0] REG_WRITTEN = 12'h0F8;       // records written to SRAM
  localparam logic [11:0] REG_WRITEBACK = 12'h068;     // clocks that wrote the kept records back to SRAM
  localparam logic [11:0] REG_CAPS3 = 12'h070;         // [12:0] pairs in the card, [16] roles can be swapped, [17] normals, [18] two pairs at a time, [20:19] TRANSFORM_*, [21] check bits in DDR, [22] box rule of ray-triangle, [31:24] words of a primary slot, [47:32] and [63:48] entries of the object tables
  localparam logic [11:0] REG_PRIM_SPLIT = 12'h078;    // with a second pair: the first of its primaries, a multiple of the lanes

  localparam logic [11:0] REG_OBJECT_COUNT = 12'h0A8;  // objects to sweep; 0: the slots of REG_SEC_FIRST and REG_SEC_COUNT as they lie in DDR
  localparam logic [11:0] REG_ECC = 12'h0B8;           // words of secondaries read from DDR in a pass: [31:0] corrected, [63:32] with more errors than that
  localparam logic [11:0] REG_PRIM_OBJECT_COUNT = 12'h0B0;  // objects of primaries; 0: primaries as they were written

  // ---- Object tables, in SPACE_REG above the registers, write only: entries of OBJECT_WORDS words of the container width. The range
  // takes effect with its second word, the transform with its last; both are written in ascending order ----
  localparam logic [31:0] OBJECT_TABLE = 32'h00040000;       // of secondaries: ranges of slots in DDR
  localparam logic [31:0] PRIM_OBJECT_TABLE = 32'h00080000;  // of primaries: ranges of their numbers in the register file
  localparam int OBJECT_WORDS = 16;       // from entry to entry
  localparam int OBJECT_FIRST = 0;        // first slot
  localparam int OBJECT_COUNT = 1;        // slots
  localparam int OBJECT_ROTATION = 2;     // 9 words, row by row
  localparam int OBJECT_TRANSLATION = 11; // 3 words
  localparam int OBJECT_END = 14;         // words in use
  localparam int TRANSFORM_NONE = 0;         // values of the parameter TRANSFORM: there is no transformer
  localparam int TRANSFORM_SECONDARIES = 1;  // for secondaries
  localparam int TRANSFORM_BOTH = 2;         // for primaries too

  localparam logic [31:0] ID_MAGIC = 32'h43444531;
  localparam logic [31:0] INTERFACE_VERSION = 32'd4;

  localparam int STATUS_BUSY = 0;
  localparam int STATUS_DONE = 1;
  localparam int STATUS_COMMAND_ERROR = 2;  // go refused: mode, pair, count or range out of bounds
  localparam int STATUS_BUS_ERROR = 3;      // access outside a space, to a read-only register, or while busy
  localparam int STATUS_SRAM_WAIT = 4;      // the SRAM ring is full and the engine waits for the host
  localparam int STATUS_IRQ = 5;            // done, an error, or a full ring wants the host
  localparam int STATUS_ECC_ERROR = 6;      // words of DDR with errors that cannot be corrected were read in this pass

  // ---- Result modes ----
  localparam logic [2:0] MODE_NEAREST = 3'd0;   // smallest (T, index) a primary
  localparam logic [2:0] MODE_FARTHEST = 3'd1;  // largest T, then smallest index
  localparam logic [2:0] MODE_ANY = 3'd2;       // first hit in stream order; stops when every primary has one
  localparam logic [2:0] MODE_ALL = 3'd3;       // every pair's record
  localparam logic [2:0] MODE_HITS = 3'd4;      // records with F = 1 only

  // ---- Pair codes ----
  localparam logic [3:0] PAIR_RAY_TRIANGLE = 4'd0;
  localparam logic [3:0] PAIR_OBB_OBB = 4'd1;
  localparam logic [3:0] PAIR_TRIANGLE_AABB = 4'd2;
  localparam logic [3:0] PAIR_TRIANGLE_OBB = 4'd3;
  localparam logic [3:0] PAIR_SPHERE_SPHERE = 4'd4;
  localparam logic [3:0] PAIR_TRIANGLE_SPHERE = 4'd5;
  localparam logic [3:0] PAIR_RAY_CYLINDER = 4'd6;
  localparam logic [3:0] PAIR_TRIANGLE_CYLINDER = 4'd7;
  localparam logic [3:0] PAIR_CYLINDER_CYLINDER = 4'd8;
  localparam logic [3:0] PAIR_OBB_CYLINDER = 4'd9;
  localparam logic [3:0] PAIR_OBB_PLANE = 4'd10;
  localparam logic [3:0] PAIR_RAY_SPHERE = 4'd11;
  localparam logic [3:0] PAIR_SPHERE_OBB = 4'd12;
  localparam int PAIRS = 13;
  localparam logic [3:0] NO_PAIR = 4'd15;

  // ---- Shapes ----
  localparam int SHAPE_RAY = 0;       // o x y z, d x y z, tmin, tmax
  localparam int SHAPE_TRIANGLE = 1;  // v0 x y z, v1, v2
  localparam int SHAPE_SPHERE = 2;    // c x y z, r
  localparam int SHAPE_AABB = 3;      // min x y z, max
  localparam int SHAPE_PLANE = 4;     // n x y z, d
  localparam int SHAPE_CYLINDER = 5;  // c x y z, axis x y z, half height, radius
  localparam int SHAPE_OBB = 6;       // c x y z, half extents, rotation by rows (columns are the axes)

  function automatic int larger(input int a, input int b);  // of two stage times
    larger = (a > b) ? a : b;
  endfunction
  function automatic [63:0] power_of_two(input int exp, input int man, input int e);  // the word of 2^e in a format, 0 where it underflows
    int biased;
    biased = (1 << (exp - 1)) - 1 + e;
    power_of_two = (biased > 0) ? 64'(biased) << man : (biased + man > 0) ? 64'd1 << (biased + man - 1) : 64'd0;
  endfunction
  function automatic bit has_ring(input int pair);  // the pipe is a ring with a mouth (cylinder_pair.sv), a budget sets its work
    has_ring = pair == int'(PAIR_TRIANGLE_CYLINDER) || pair == int'(PAIR_CYLINDER_CYLINDER) || pair == int'(PAIR_OBB_CYLINDER);
  endfunction
  function automatic bit any_ring(input int pairs);  // of a set
    any_ring = 0;
    for (int p = 0; p < PAIRS; p++) if (((pairs >> p) & 1) != 0 && has_ring(p)) any_ring = 1;
  endfunction
  function automatic int cylinder_body(input int pair);  // what such a pipe's primary is: 0 cylinder, 1 box, 2 triangle (cylinder.svh)
    cylinder_body = (pair == int'(PAIR_CYLINDER_CYLINDER)) ? 0 : (pair == int'(PAIR_OBB_CYLINDER)) ? 1 : 2;
  endfunction
  function automatic bit has_box(input int pair);  // BOX is an option of its pipe (ray_box.sv)
    has_box = pair == int'(PAIR_RAY_TRIANGLE);
  endfunction
  function automatic bit has_facets(input int pair);  // the pipe is made of facet units, which can take turns (pair_hold.sv)
    has_facets = pair == int'(PAIR_OBB_OBB) || pair == int'(PAIR_TRIANGLE_AABB) || pair == int'(PAIR_TRIANGLE_OBB);
  endfunction
  function automatic bit any_facets(input int pairs);  // of a set
    any_facets = 0;
    for (int p = 0; p < PAIRS; p++) if (((pairs >> p) & 1) != 0 && has_facets(p)) any_facets = 1;
  endfunction
  function automatic int shape_words(input int shape);
    shape_words = (shape == SHAPE_RAY || shape == SHAPE_CYLINDER) ? 8 : (shape == SHAPE_TRIANGLE) ? 9 :
        (shape == SHAPE_AABB) ? 6 : (shape == SHAPE_OBB) ? 15 : 4;
  endfunction
  function automatic int primary_shape(input int pair);  // A
    primary_shape = (pair == int'(PAIR_RAY_TRIANGLE) || pair == int'(PAIR_RAY_CYLINDER) || pair == int'(PAIR_RAY_SPHERE)) ? SHAPE_RAY :
        (pair == int'(PAIR_SPHERE_SPHERE) || pair == int'(PAIR_SPHERE_OBB)) ? SHAPE_SPHERE :
        (pair == int'(PAIR_CYLINDER_CYLINDER)) ? SHAPE_CYLINDER :
        (pair == int'(PAIR_OBB_OBB) || pair == int'(PAIR_OBB_CYLINDER) || pair == int'(PAIR_OBB_PLANE)) ? SHAPE_OBB : SHAPE_TRIANGLE;
  endfunction
  function automatic int secondary_shape(input int pair);  // B
    secondary_shape = (pair == int'(PAIR_RAY_TRIANGLE)) ? SHAPE_TRIANGLE : (pair == int'(PAIR_TRIANGLE_AABB)) ? SHAPE_AABB :
        (pair == int'(PAIR_OBB_PLANE)) ? SHAPE_PLANE :
        (pair == int'(PAIR_OBB_OBB) || pair == int'(PAIR_TRIANGLE_OBB) || pair == int'(PAIR_SPHERE_OBB)) ? SHAPE_OBB :
        (pair == int'(PAIR_SPHERE_SPHERE) || pair == int'(PAIR_TRIANGLE_SPHERE) || pair == int'(PAIR_RAY_SPHERE)) ? SHAPE_SPHERE : SHAPE_CYLINDER;
  endfunction
  function automatic bit any_long(input int pairs);  // some pair of a set takes more clocks than a ray or two spheres
    any_long = 0;
    for (int p = 0; p < PAIRS; p++)
      if (((pairs >> p) & 1) != 0 && primary_shape(p) != SHAPE_RAY && !(primary_shape(p) == SHAPE_SPHERE && secondary_shape(p) == SHAPE_SPHERE))
        any_long = 1;
  endfunction

  // What a word of a shape is.
  localparam int WORD_COORDINATE = 0;  // a length of either sign
  localparam int WORD_SIZE = 1;        // a length above zero
  localparam int WORD_DIRECTION = 2;   // of a ray: lengths in units of their own
  localparam int WORD_INTERVAL = 3;    // tmin, tmax: lengths in those units
  localparam int WORD_PURE = 4;        // of a unit vector or rotation
  function automatic int word_kind(input int shape, input int k);
    word_kind = WORD_COORDINATE;
    if (shape == SHAPE_RAY) word_kind = (k < 3) ? WORD_COORDINATE : (k < 6) ? WORD_DIRECTION : WORD_INTERVAL;
    if ((shape == SHAPE_PLANE && k < 3) || (shape == SHAPE_CYLINDER && k >= 3 && k < 6) || (shape == SHAPE_OBB && k >= 6)) word_kind = WORD_PURE;
    if ((shape == SHAPE_SPHERE && k == 3) || (shape == SHAPE_CYLINDER && k >= 6) || (shape == SHAPE_OBB && k >= 3 && k < 6)) word_kind = WORD_SIZE;
  endfunction
  function automatic bit is_length(input int shape, input int k);
    is_length = word_kind(shape, k) == WORD_COORDINATE || word_kind(shape, k) == WORD_SIZE;
  endfunction
  function automatic int lengths(input int shape);  // how many words of the shape are
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

  // The input contract's range of lengths, as exponents of two: no coordinate or size is above 2^length_high, no size, nor the largest
  // component of a ray's direction, below 2^length_low. host/include/cde/reference/check.hpp says why.
  function automatic int length_high(input int exp);
    length_high = (exp < 8) ? ((1 << (exp - 1)) - 2) / 2 : ((1 << (exp - 1)) - 8) / 3;
  endfunction
  function automatic int length_low(input int exp, input int man);
    length_low = (exp < 8) ? -length_high(exp) : -(((1 << (exp - 1)) - 3 - man) / 3);
  endfunction
  // Whether a pair is brought to the size of one in front of its pipe (length_scale.sv): those that multiply four lengths, and all in
  // formats of fewer than 8 exponent bits.
  function automatic bit scaled(input int pair, input int exp);
    scaled = exp < 8 || (primary_shape(pair) != SHAPE_RAY && primary_shape(pair) != SHAPE_SPHERE && secondary_shape(pair) != SHAPE_PLANE);
  endfunction
  function automatic int scale_latency(input bit ray, input int lat_mul, input int lat_cmp);  // of length_scale.sv
    scale_latency = lat_cmp + unscale_latency(ray, lat_mul, lat_cmp);
  endfunction
  function automatic int unscale_latency(input bit ray, input int lat_mul, input int lat_cmp);  // of length_unscale.sv
    unscale_latency = ray ? larger(lat_cmp, lat_mul) : lat_cmp;
  endfunction

  function automatic int ring_entry(input int lat_add, input int lat_mul, input int lat_cmp);  // clocks that cylinder_pair.sv needs for its operands
    ring_entry = scale_latency(0, lat_mul, lat_cmp) + larger(lat_add, lat_mul);
  endfunction

  // Words of the largest slot that a set of pairs (bit p: pair p) needs, of primaries or of secondaries; `swap`: either shape may be
  // either.
  function automatic int slot_words(input int pairs, input bit primary, input bit swap);
    slot_words = 0;
    for (int p = 0; p < PAIRS; p++)
      if (((pairs >> p) & 1) != 0) begin
        if ((primary || swap) && shape_words(primary_shape(p)) > slot_words) slot_words = shape_words(primary_shape(p));
        if ((!primary || swap) && shape_words(secondary_shape(p)) > slot_words) slot_words = shape_words(secondary_shape(p));
      end
  endfunction
  // Whether some pair of the set has the shape in that role.
  function automatic bit uses_shape(input int pairs, input int shape, input bit primary, input bit swap);
    uses_shape = 0;
    for (int p = 0; p < PAIRS; p++)
      if (((pairs >> p) & 1) != 0) begin
        if ((primary || swap) && primary_shape(p) == shape) uses_shape = 1;
        if ((!primary || swap) && secondary_shape(p) == shape) uses_shape = 1;
      end
  endfunction

  // Whether the transformer of a card handles the shape, and its clocks: R x is LAT_MUL + 2*LAT_ADD, + t is LAT_ADD; n'.t of a plane
  // waits for R n.
  function automatic bit moves_shape(input int pairs, input int shape, input bit swap, input int transform);
    moves_shape = uses_shape(pairs, shape, 0, swap) || (transform == TRANSFORM_BOTH && uses_shape(pairs, shape, 1, swap));
  endfunction
  function automatic int transform_latency(input int pairs, input bit swap, input int transform, input int lat_add, input int lat_mul);
    transform_latency = moves_shape(pairs, SHAPE_PLANE, swap, transform) ? 2 * lat_mul + 5 * lat_add : lat_mul + 3 * lat_add;
  endfunction

  // ---- Ray-triangle algorithms (REG_CAPS) ----
  localparam logic [7:0] ALGORITHM_MOLLER = 8'd0;
  localparam logic [7:0] ALGORITHM_BADOUEL = 8'd1;
  localparam logic [7:0] ALGORITHM_PLUECKER = 8'd2;
  localparam logic [7:0] ALGORITHM_WATERTIGHT = 8'd3;

  // ---- Slots and records, in words of the container width ----
  localparam int DDR_WORDS = 9;  // words of a DDR beat, 288 bits in fp32; slots are packed, a word each of the shape
  localparam int RECORD_WORDS = 7;
  localparam int RECORD_CP = 0;       // 3 words
  localparam int RECORD_FLAGS = 3;    // [0] F, [1] bad input
  localparam int RECORD_INDEX = 4;    // secondary index; all ones when nothing was found
  localparam int RECORD_T = 5;
  localparam int RECORD_PRIMARY = 6;
  localparam int FLAG_F = 0;
  localparam int FLAG_BAD = 1;
  // With normals a second record follows: n x y z in the words of CP, the signed gap in T, flags with FLAG_NORMAL, the same index
  // and primary.
  localparam int FLAG_NORMAL = 2;

  // ---- PCI: what a driver reads and writes through the bus (docs/pci.md) ----
  localparam logic [15:0] PCI_VENDOR_ID = 16'hCDE1;           // none that the PCI-SIG has assigned
  localparam logic [15:0] PCI_DEVICE_ID = 16'h0001;
  localparam logic [31:0] PCI_CLASS = 32'h0B400001;           // class code and revision: co-processor
  localparam logic [31:0] PCI_SUBSYSTEM = 32'h0001CDE1;       // subsystem id, subsystem vendor id
  localparam int PCI_BAR_BITS = 16;                           // BAR0: 64 KB of memory
  localparam logic [15:0] PCI_REGISTERS = 16'h1000;           // below it SPACE_REG, from here the registers of the bridge
  localparam logic [15:0] PCI_REGISTERS_END = 16'h2000;
  localparam logic [15:0] PCI_PAGE_TABLE = 16'h8000;          // 64-bit entries up to the end of BAR0
  localparam int PCI_PAGES = 4096;                            // entries of the page table
  localparam int PCI_PAGE_BITS = 12;                          // a page is 4 KB; mapped address = entry << 12 | offset
  localparam int PCI_PAGE_VALID = 0;                          // bits of an entry: valid,
  localparam int PCI_PAGE_WRITABLE = 1;                       // device to host allowed,
  localparam int PCI_PAGE_FRAME = 12;                         // [31:12] bus address of the page

  // Registers of the bridge (byte offsets in BAR0, 64 bits each)
  localparam logic [15:0] PCI_REG_CONTROL = 16'h1000;         // write: PCI_CONTROL_* bits; reads 0
  localparam logic [15:0] PCI_REG_STATUS = 16'h1008;          // PCI_STATUS_* bits, [15:8] code that halted the ring, [23:16] where
  localparam logic [15:0] PCI_REG_IRQ_STATUS = 16'h1010;      // PCI_IRQ_* bits; writing 1 clears all but PCI_IRQ_CARD
  localparam logic [15:0] PCI_REG_IRQ_MASK = 16'h1018;        // 1: the cause drives INTA#
  localparam logic [15:0] PCI_REG_RING_BASE = 16'h1020;       // mapped address of the descriptors, a multiple of 32
  localparam logic [15:0] PCI_REG_RING_SIZE = 16'h1028;       // number of descriptors, 2 to 32,768
  localparam logic [15:0] PCI_REG_RING_HEAD = 16'h1030;       // the next one to be served; read only
  localparam logic [15:0] PCI_REG_RING_TAIL = 16'h1038;       // the first one not to be served
  localparam logic [15:0] PCI_REG_COMPLETION_BASE = 16'h1040; // mapped address of the completion records, a multiple of 16
  localparam logic [15:0] PCI_REG_BURST = 16'h1048;           // bytes of a burst at most, 64 to 4,096, a multiple of 8
  localparam logic [15:0] PCI_REG_RETRY_LIMIT = 16'h1050;     // retries in a row until a transfer fails; 0: never
  localparam logic [15:0] PCI_REG_FAULT_ADDR = 16'h1058;      // mapped (refused) or bus address (failed) of the first fault
  localparam logic [15:0] PCI_REG_BURSTS = 16'h1080;          // transactions of the card as a master
  localparam logic [15:0] PCI_REG_BEATS = 16'h1088;           // their data phases
  localparam logic [15:0] PCI_REG_WAITS = 16'h1090;           // clocks of theirs in which no data moved
  localparam logic [15:0] PCI_REG_RETRIES = 16'h1098;
  localparam logic [15:0] PCI_REG_DISCONNECTS = 16'h10A0;
  localparam logic [15:0] PCI_REG_PARITY_ERRORS = 16'h10A8;   // seen as a master or as a target
  localparam logic [15:0] PCI_REG_ABORTS = 16'h10B0;          // master aborts and target aborts received
  localparam logic [15:0] PCI_REG_BUSY = 16'h10B8;            // clocks in which FRAME# or IRDY# of any master was asserted

  localparam int PCI_CONTROL_RUN = 0;    // serve the ring; refused while it is halted
  localparam int PCI_CONTROL_STOP = 1;   // halt when the descriptor being served is done
  localparam int PCI_CONTROL_CLEAR = 2;  // leave the halted state, forget the fault; the head returns to 0
  localparam int PCI_CONTROL_COUNT = 3;  // counters to 0
  localparam int PCI_STATUS_RUN = 0;
  localparam int PCI_STATUS_HALTED = 1;    // until PCI_CONTROL_CLEAR
  localparam int PCI_STATUS_BUSY = 2;      // a descriptor is being served
  localparam int PCI_STATUS_CLEARING = 3;  // after reset the page table is being emptied; accesses wait
  localparam int PCI_STATUS_CODE = 8;
  localparam int PCI_STATUS_WHERE = 16;    // PCI_WHERE_*
  localparam int PCI_IRQ_COMPLETION = 0;   // a descriptor that asked for it is done
  localparam int PCI_IRQ_HALTED = 1;
  localparam int PCI_IRQ_CARD = 2;         // STATUS_IRQ of the card, as it stands

  // Descriptor, 4 words of 64 bits: [31:0] mapped address, [63:32] bytes; [31:0] offset in the local space and flags; 2 unused.
  // Addresses and bytes are multiples of 8.
  localparam int PCI_DESCRIPTOR_BYTES = 32;
  localparam int PCI_DESCRIPTOR_SPACE = 32;   // of word 1: 2 bits, SPACE_*
  localparam int PCI_DESCRIPTOR_TO_HOST = 40;
  localparam int PCI_DESCRIPTOR_IRQ = 41;     // interrupt on completion
  // Completion record, 2 words: [31:0] fault address, [63:35] bytes done / 8; then the fields below. Each word says that it is there:
  // its lap bit is 1 in the first lap of the ring, then 0, and so on.
  localparam int PCI_COMPLETION_BYTES = 16;
  localparam int PCI_COMPLETION_NUMBER = 0;  // 16 bits: descriptor; the record has the same place in its ring
  localparam int PCI_COMPLETION_PCI = 16;    // 16 bits: PCI status register
  localparam int PCI_COMPLETION_CODE = 32;   // 8 bits: PCI_CODE_*
  localparam int PCI_COMPLETION_LAP_FIRST = 32;  // of word 0
  localparam int PCI_COMPLETION_LAP = 63;        // of word 1
  localparam logic [7:0] PCI_CODE_OK = 8'd0;
  localparam logic [7:0] PCI_CODE_LENGTH = 8'd1;        // 0 or not a multiple of 8
  localparam logic [7:0] PCI_CODE_ALIGNMENT = 8'd2;     // host address or local offset not a multiple of 8, unknown flags
  localparam logic [7:0] PCI_CODE_UNMAPPED = 8'd3;      // no valid page
  localparam logic [7:0] PCI_CODE_READ_ONLY = 8'd4;     // to a page that is not writable
  localparam logic [7:0] PCI_CODE_MASTER_ABORT = 8'd5;  // nobody answers
  localparam logic [7:0] PCI_CODE_TARGET_ABORT = 8'd6;
  localparam logic [7:0] PCI_CODE_PARITY = 8'd7;
  localparam logic [7:0] PCI_CODE_RETRY_LIMIT = 8'd8;
  localparam logic [7:0] PCI_CODE_SETTINGS = 8'd9;      // ring registers out of range, or written while it runs
  localparam logic [7:0] PCI_CODE_STOPPED = 8'd10;      // by the driver
  localparam logic [7:0] PCI_CODE_DISABLED = 8'd11;     // bus mastering is off in the command register
  localparam logic [7:0] PCI_WHERE_DATA = 8'd0;
  localparam logic [7:0] PCI_WHERE_DESCRIPTOR = 8'd1;   // reading it
  localparam logic [7:0] PCI_WHERE_COMPLETION = 8'd2;   // writing it; the driver gets no record
  localparam logic [7:0] PCI_WHERE_SETTINGS = 8'd3;

endpackage
