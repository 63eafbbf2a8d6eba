// SPDX-License-Identifier: Apache-2.0
// Moves objects. It has the object tables of secondaries and, with TRANSFORM = 2, of primaries. Both use its one
// transformer. Secondaries are transformed when they enter the secondary register file, primaries before a pass.
// Latency: 1 cycle for the RAMs, then the transformer's.
// Throughput: one slot per cycle.
// Stall: none.
module objects #(
    parameter config_pkg::config_t CONFIG,
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int PRIMARIES = CONFIG.primaries,
    localparam int PAIRS = CONFIG.pairs,
    localparam int SWAP = CONFIG.swap,
    localparam int TRANSFORM = CONFIG.transform,
    localparam int OBJECTS = CONFIG.objects,
    localparam int PRIM_OBJECTS = CONFIG.prim_objects,
    localparam latency_pkg::latency_t LAT = CONFIG.lat,
    localparam ARITH = config_pkg::arith(CONFIG.host),
    localparam int DDR_SLOTS = CONFIG.ddr_slots,
    localparam int CW = formats_pkg::container(EXP, MAN),
    localparam int SEC_WORDS = pairs_pkg::slot_words(PAIRS, 0, SWAP != 0),
    localparam int PRIM_WORDS = pairs_pkg::slot_words(PAIRS, 1, SWAP != 0),
    localparam int PRIM_W = $clog2(PRIMARIES),
    localparam int OBJECT_W = $clog2(OBJECTS)
) (
    input logic clk_i,       // clock of the engine
    input logic clk_bus_i,   // runs during a beat and with pose_done_o
    input logic clk_core_i,  // not gated
    input logic rst_i,
    input logic write_i,  // into SPACE_REG above the registers
    input logic [31:0] addr_i,
    input logic [63:0] data_i,
    input logic primary_write_i,

    input card_pkg::pass_t command_i,  // the pass that a go would start now
    output logic good_o,  // every entry that the command uses is in contract
    output logic busy_o,  // good_o is not known yet

    input pairs_pkg::pair_t pair_i,  // of the pass
    input logic swap_i,
    input logic [OBJECT_W-1:0] range_entry_i,
    output logic [1:0][31:0] range_o,
    input logic [OBJECT_W-1:0] transform_entry_i,
    input logic moving_i,       // a secondary arrives or is in the transformer
    output logic clk_moving_o,  // clock of the transformer and of the registers before it
    input logic [SEC_WORDS-1:0][CW-1:0] unmoved_i,
    output logic [SEC_WORDS-1:0][CW-1:0] moved_o,

    output logic pose_request_o,
    input logic pose_i,
    output logic pose_done_o,  // one cycle
    output logic [PRIM_W-1:0] read_o,
    input logic [PRIM_WORDS-1:0][CW-1:0] written_i,
    output logic pose_commit_o,
    output logic [PRIM_W-1:0] pose_number_o,
    output logic [PRIM_WORDS-1:0][CW-1:0] pose_slot_o
);
  pairs_pkg::pair_t [1:0] command_pair;
  logic [1:0] command_swap;
  logic [PRIM_W-1:0] split;
  assign command_pair = command_i.pair;
  assign command_swap = command_i.swap;
  assign split = command_i.split[PRIM_W-1:0];
  localparam bit BOTH = TRANSFORM == pairs_pkg::TRANSFORM_BOTH;
  localparam int WORDS = (BOTH && PRIM_WORDS > SEC_WORDS) ? PRIM_WORDS : SEC_WORDS;

  // ---- Shapes in the roles of the command ----
  pairs_pkg::shape_t secondary, command_secondary;
  pairs_pkg::shape_t [1:0] primary;
  assign command_secondary = pairs_pkg::SHAPE_BITS'(command_swap[0] ?
      pairs_pkg::primary_shape(int'(command_pair[0])) : pairs_pkg::secondary_shape(int'(command_pair[0])));
  assign secondary = pairs_pkg::SHAPE_BITS'(swap_i ? pairs_pkg::primary_shape(int'(pair_i)) :
      pairs_pkg::secondary_shape(int'(pair_i)));
  for (genvar k = 0; k < 2; k++) begin : of
    pairs_pkg::pair_t pair;
    logic swap;
    assign pair = (command_pair[k] == pairs_pkg::NO_PAIR) ? command_pair[0] : command_pair[k];
    assign swap = (command_pair[k] == pairs_pkg::NO_PAIR) ? command_swap[0] : command_swap[k];
    assign primary[k] = pairs_pkg::SHAPE_BITS'(swap ? pairs_pkg::secondary_shape(int'(pair)) :
        pairs_pkg::primary_shape(int'(pair)));
  end

  // ---- Tables ----
  logic write_secondaries, write_primaries, unused_range_write, sec_good, sec_busy, prim_good, prim_busy;
  logic [8:0][CW-1:0] sec_rotation, rotation;
  logic [2:0][CW-1:0] sec_translation, translation;
  assign write_secondaries = write_i && addr_i < registers_pkg::PRIM_OBJECT_TABLE;
  assign write_primaries = write_i && addr_i >= registers_pkg::PRIM_OBJECT_TABLE;
  object_table #(.CONFIG(CONFIG), .ENTRIES(OBJECTS), .CAPACITY(DDR_SLOTS * records_pkg::DDR_WORDS)) table_secondaries (
      .clk_bus_i, .clk_core_i, .clk_i, .clk_moving_i(clk_moving_o), .rst_i, .write_i(write_secondaries),
      .addr_i(addr_i - registers_pkg::OBJECT_TABLE), .data_i, .range_write_o(unused_range_write),
      .count_i(command_i.objects), .shapes_i({2{command_secondary}}), .good_o(sec_good), .busy_o(sec_busy),
      .range_entry_i, .range_o, .transform_entry_i, .rotation_o(sec_rotation), .translation_o(sec_translation));
  assign good_o = sec_good && prim_good;
  assign busy_o = sec_busy || prim_busy;

  // ---- The transformer. It and the registers before it are clocked only while they hold a slot ----
  logic plain_q, pose_q, pose_plain, pose_moving;
  pairs_pkg::shape_t shape_q, pose_shape;
  logic [WORDS-1:0][CW-1:0] slot, moved;
  clock_gate gate (.clk_i(clk_core_i), .enable_i(moving_i | pose_moving), .clk_o(clk_moving_o));
  always_ff @(posedge clk_moving_o) begin
    pose_q <= pose_i;
    plain_q <= pose_i ? pose_plain : command_i.objects == 0;
    shape_q <= pose_i ? pose_shape : secondary;
  end
  transformer #(.CONFIG(CONFIG), .WORDS(WORDS)
  ) transform (
      .clk_i(clk_moving_o), .shape_i(shape_q), .plain_i(plain_q), .rotation_i(rotation), .translation_i(translation),
      .slot_i(slot), .slot_o(moved));
  assign moved_o = moved[SEC_WORDS-1:0];

  // ---- Primaries ----
  if (BOTH) begin : g_primaries
    localparam int LATENCY = pairs_pkg::transform_latency(PAIRS, SWAP != 0, TRANSFORM, LAT.add, LAT.mul);
    localparam int PRIM_OBJECT_W = $clog2(PRIM_OBJECTS);
    logic range_write;
    logic [1:0][31:0] prim_range;
    logic [8:0][CW-1:0] prim_rotation;
    logic [2:0][CW-1:0] prim_translation;
    logic [PRIM_OBJECT_W-1:0] prim_range_entry, prim_transform_entry;
    object_table #(.CONFIG(CONFIG), .ENTRIES(PRIM_OBJECTS), .PRIMARY(1), .CAPACITY(PRIMARIES)) table_primaries (
        .clk_bus_i, .clk_core_i, .clk_i, .clk_moving_i(clk_moving_o), .rst_i, .write_i(write_primaries),
        .addr_i(addr_i - registers_pkg::PRIM_OBJECT_TABLE), .data_i, .range_write_o(range_write),
        .count_i(command_i.prim_objects), .shapes_i(primary), .good_o(prim_good), .busy_o(prim_busy),
        .range_entry_i(prim_range_entry), .range_o(prim_range), .transform_entry_i(prim_transform_entry),
        .rotation_o(prim_rotation), .translation_o(prim_translation));
    primary_poser #(
        .PRIMARIES(PRIMARIES), .ENTRIES(PRIM_OBJECTS), .T_COMMIT((ARITH == "rtl") ? LATENCY : 0),
        .T_JUDGED(LATENCY + config_pkg::check_latency(LAT))
    ) poser (
        .clk_i, .clk_bus_i, .rst_i, .primary_write_i, .transform_write_i(write_primaries), .range_write_i(range_write),
        .objects_i(command_i.prim_objects), .shapes_i(primary),
        .split_i(command_pair[1] == pairs_pkg::NO_PAIR ? '0 : split), .pose_request_o(pose_request_o),
        .pose_i, .done_o(pose_done_o), .range_entry_o(prim_range_entry), .range_i(prim_range),
        .transform_entry_o(prim_transform_entry), .read_o, .shape_o(pose_shape), .plain_o(pose_plain),
        .moving_o(pose_moving), .commit_o(pose_commit_o), .number_o(pose_number_o));
    assign rotation = pose_q ? prim_rotation : sec_rotation;
    assign translation = pose_q ? prim_translation : sec_translation;
    assign slot = pose_q ? (WORDS * CW)'(written_i) : (WORDS * CW)'(unmoved_i);
    assign pose_slot_o = moved[PRIM_WORDS-1:0];
  end else begin : g_secondaries
    logic unused;
    assign unused = &{1'b0, primary, primary_write_i, command_i.prim_objects, split, pose_q, written_i,
        write_primaries};
    assign {prim_good, prim_busy} = 2'b10;
    assign {pose_request_o, pose_done_o, pose_commit_o} = '0;
    assign read_o = '0;
    assign pose_number_o = '0;
    assign pose_slot_o = '0;
    assign {pose_plain, pose_moving, pose_shape} = '0;
    assign rotation = sec_rotation;
    assign translation = sec_translation;
    assign slot = unmoved_i;
  end
endmodule
