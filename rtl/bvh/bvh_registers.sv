// SPDX-License-Identifier: Apache-2.0
// Registers of the BVH: its settings, how many primaries the host has provided, and the counters of a pass.
// Accesses come from card_registers.sv, which has checked them. It ORs the data read here into its own, so an access
// elsewhere reads 0 here.
// Latency: a read takes 1 cycle of the bus clock.
// Throughput: one access per cycle.
// Stall: none.
module bvh_registers #(
    parameter config_pkg::config_t CONFIG,
    localparam int NODES = CONFIG.nodes
) (
    input logic clk_bus_i,
    input logic clk_i,
    input logic rst_i,
    input card_pkg::access_t access_i,
    input card_pkg::access_t written_i,  // the access of the last cycle, for writes
    output logic [63:0] rdata_o,
    output logic provided_good_o,  // the data of written_i are valid for REG_RAYS
    output logic [2:0] good_o,     // settings are valid for a pass: of a refit, of primaries, of nodes. Two cycles late
    input logic busy_i,
    input logic wide_i,   // primaries of the pass take two places
    input logic clear_i,  // a pass begins

    input logic [31:0] taken_i,
    output logic [31:0] provided_o,
    output logic [31:0] ray_count_o,
    output logic [31:0] nodes_o,
    output logic [31:0] first_node_o,  // first node that a refit updates
    output logic [31:0] slots_o,
    output logic [2:0][31:0] bases_o,  // words in DDR: objects of slots, slots, nodes
    output logic [6:0][31:0] root_o,
    input bvh_pkg::events_t events_i,
    input logic [4:0] deepest_i,
    output registers_pkg::node_flip_t flip_o,
    input logic [35:0] fault_i,  // registers_pkg::NODE_FAULT_*, place
    input logic new_root_i,      // a refit writes the root
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_i
);
  import registers_pkg::*;
  logic unused_access;  // data of reads, flags of reads for writes
  assign unused_access = &{1'b0, access_i, written_i};
  logic [3:0][63:0] root_q;
  logic [31:0] nodes_q, first_node_q, slots_q, ray_count_q, provided_q;
  logic [2:0][31:0] bases_q;
  node_flip_t flip_q;
  assign flip_o = flip_q;
  assign root_o = {root_q[3][31:0], root_q[2:0]};
  assign nodes_o = nodes_q;
  assign first_node_o = first_node_q;
  assign slots_o = slots_q;
  assign bases_o = bases_q;
  assign ray_count_o = ray_count_q;
  assign provided_o = provided_q;
  // Counts of primaries rise within a pass. At most as many as there are places can be provided and not taken.
  logic [31:0] value, taken;
  assign value = written_i.data[31:0];
  always_ff @(posedge clk_bus_i) taken <= busy_i ? taken_i : '0;
  assign provided_good_o = written_i.data[63:32] == 0 && value <= ray_count_q && (!busy_i || value >= provided_q) &&
      value >= taken && value - taken <= (wide_i ? CONFIG.ray_places / 2 : CONFIG.ray_places);
  // In DDR, nodes and slots end before its end.
  localparam logic [63:0] DDR_WORDS = 64'(CONFIG.ddr_slots) * 64'(records_pkg::DDR_WORDS);
  logic in_ddr;
  logic [2:0][63:0] ends_q;
  always_ff @(posedge clk_bus_i)
    ends_q <= {64'(bases_q[2]) + 64'(slots_q), 64'(bases_q[1]) + 64'(slots_q),
        64'(bases_q[0]) + 64'(nodes_q) * bvh_pkg::NODE_WORDS};
  assign in_ddr = CONFIG.node_cache == 0 ||
      (ends_q[0] <= DDR_WORDS && ends_q[1] <= DDR_WORDS && ends_q[2] <= DDR_WORDS);
  always_ff @(posedge clk_bus_i)
    good_o <= {CONFIG.node_cache == 0, ray_count_q != 0, nodes_q <= NODES &&
        first_node_q < nodes_q && slots_q != 0 && slots_q <= bvh_pkg::SLOTS_PER_NODE * NODES && in_ddr};

  function automatic logic [31:0] saturated(input logic [63:0] x);
    saturated = (x[63:32] != 0) ? '1 : x[31:0];
  endfunction
  logic write, writes_root, at_root;
  // Object tables are above the registers, in the same space.
  assign write = written_i.write && written_i.space == SPACE_REG && written_i.addr[31:12] == '0;
  assign writes_root = written_i.addr[11:0] >= REG_ROOT && written_i.addr[11:0] < REG_ROOT + 12'd32;
  assign at_root = access_i.addr[11:0] >= REG_ROOT && access_i.addr[11:0] < REG_ROOT + 12'd32;
  logic at_new_root;
  logic [8:0][63:0] new_root_q;
  assign at_new_root = access_i.addr[11:0] >= REG_NEW_ROOT && access_i.addr[11:0] < REG_NEW_ROOT + 12'd72;
  always_ff @(posedge clk_i) if (new_root_i) new_root_q <= node_i;
  logic [63:0] answer_q;
  node_caps_t caps;
  always_comb begin
    caps = '0;
    caps.nodes = 32'(NODES);
    caps.rays = 16'(CONFIG.ray_places);
    caps.slots_per_node = 8'(bvh_pkg::SLOTS_PER_NODE);
    caps.pinned_bits = (CONFIG.node_cache != 0) ? 8'($clog2(CONFIG.pinned_nodes)) : 8'hff;
  end
  always_ff @(posedge clk_bus_i) begin
    if (write) begin
      if (writes_root) root_q[written_i.addr[4:3]] <= written_i.data;
      case (written_i.addr[11:0])
        REG_NODE_COUNT: nodes_q <= saturated(written_i.data);
        REG_RAY_COUNT: begin
          ray_count_q <= saturated(written_i.data);
          provided_q <= '0;
        end
        REG_RAYS: provided_q <= value;
        REG_NODE_FLIP: flip_q <= written_i.data;
        REG_SLOT_COUNT: slots_q <= saturated(written_i.data);
        REG_NODE_FIRST: first_node_q <= saturated(written_i.data);
        REG_NODE_BASE: bases_q[0] <= saturated(written_i.data);
        REG_SLOT_BASE: bases_q[2:1] <= written_i.data;
        default: ;
      endcase
    end
    if (access_i.read) begin
      answer_q <= '0;
      if (access_i.hit) begin
        if (at_root) answer_q <= root_q[access_i.addr[4:3]];
        if (at_new_root) answer_q <= new_root_q[access_i.addr[6:3]];
        case (access_i.addr[11:0])
          REG_NODE_CAPS: answer_q <= caps;
          REG_NODE_COUNT: answer_q <= 64'(nodes_q);
          REG_RAY_COUNT: answer_q <= 64'(ray_count_q);
          REG_RAYS: answer_q <= {busy_i ? taken_i : '0, provided_q};
          REG_DEEPEST: answer_q <= 64'(deepest_i);
          REG_NODE_FAULT: answer_q <= 64'(fault_i);
          REG_NODE_FLIP: answer_q <= flip_q;
          REG_SLOT_COUNT: answer_q <= 64'(slots_q);
          REG_NODE_FIRST: answer_q <= 64'(first_node_q);
          REG_NODE_BASE: answer_q <= 64'(bases_q[0]);
          REG_SLOT_BASE: answer_q <= bases_q[2:1];
          default: ;
        endcase
      end
    end
    if (rst_i) {root_q, bases_q, nodes_q, first_node_q, slots_q, ray_count_q, provided_q, flip_q, answer_q} <= '0;
  end

  // ---- Counters ----
  logic [63:0] counts;
  logic [registers_pkg::COUNTERS-registers_pkg::ENGINE_COUNTERS-1:0][card_pkg::COUNT_BITS-1:0] events;
  assign events = {events_i.fetched, events_i.cached, events_i.secondaries, events_i.leaves, events_i.nodes};
  pass_counters #(.FIRST(registers_pkg::ENGINE_COUNTERS)) counters (
      .clk_i, .rst_i, .clear_i, .counts_i(events), .clk_bus_i, .read_i(access_i.read),
      .hit_i(access_i.hit), .offset_i(access_i.addr[11:0]), .rdata_o(counts));
  assign rdata_o = answer_q | counts;
endmodule
