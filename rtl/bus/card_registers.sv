// SPDX-License-Identifier: Apache-2.0
// Slave of the local bus: one 64-bit beat per cycle into a space (registers_pkg::SPACE_*). It holds the registers,
// checks every access against its space, and forwards beats to the primary register file, DDR and the SRAM ring. The
// PCI target and the DMA engine are masters of this port, and modules behind it do not depend on the host's bus.
// A beat is registered first and served in the next cycle. Everything here except the counters is clocked only during a
// beat, so an idle bus costs nothing.
// Latency: read data 2 cycles after the beat is taken.
// Throughput: one beat per cycle.
// Stall: ready_o is low while an SRAM read waits for the ring, and while a write waits for DDR. A control write waits
// for the check of objects, and after another write for the check of the command. After go or stop the next beat waits
// one cycle, in which they take effect.
module card_registers #(
    parameter config_pkg::config_t CONFIG,
    localparam int EXP = CONFIG.exp,
    localparam int MAN = CONFIG.man,
    localparam int LANES = CONFIG.lanes,
    localparam int PRIMARIES = CONFIG.primaries,
    localparam int PAIRS = CONFIG.pairs,
    localparam int ALGORITHM = CONFIG.algorithm,
    localparam int BOX = CONFIG.box,
    localparam int SWAP = CONFIG.swap,
    localparam int NORMALS = CONFIG.normals,
    localparam int PARALLEL = CONFIG.parallel,
    localparam int TRANSFORM = CONFIG.transform,
    localparam int OBJECTS = CONFIG.objects,
    localparam int PRIM_OBJECTS = CONFIG.prim_objects,
    localparam int TRAVERSAL_UNITS = CONFIG.traversal_units,
    localparam int ECC = CONFIG.ecc,
    localparam int DDR_SLOTS = CONFIG.ddr_slots,
    localparam int SRAM_RECORDS = CONFIG.sram_records,
    localparam logic [63:0] CONFIG_HASH = CONFIG.config_hash,
    localparam int CW = formats_pkg::container(EXP, MAN)
) (
    input logic clk_i,
    input logic clk_engine_i,  // runs from go to done
    input logic rst_i,
    input registers_pkg::bus_request_t bus_i,
    output registers_pkg::bus_response_t bus_o,
    output logic irq_o,

    output logic clk_bus_o,  // gated: runs while a beat is served
    output logic [31:0] addr_o,
    output logic [63:0] wdata_o,
    output logic prim_write_o,
    output logic ddr_write_o,
    input logic ddr_ready_i,
    output logic sram_pop_o,
    output logic sram_last_o,  // no pass ran a cycle ago, so the newest record is a last one
    input logic sram_readable_i,
    input logic sram_valid_i,
    input logic [63:0] sram_beat_i,
    input logic [31:0] sram_count_i,
    input logic sram_full_i,

    output logic go_o,
    output logic abort_o,
    output card_pkg::pass_t pass_o,  // the command and its settings; NO_PAIR if there is no second pair
    output logic [PRIMARIES-1:0] active_o,  // present and not masked
    input logic busy_i,
    input logic done_i,
    input logic [PRIMARIES-1:0] prim_bad_i,
    input card_pkg::events_t events_i,
    input logic [15:0] latency_i,

    output logic object_write_o,  // into the object tables
    input logic objects_good_i,
    input logic objects_busy_i,
    input logic pose_done_i,  // needs an edge of the bus clock

    // BVH.
    output card_pkg::access_t access_o,
    input logic [63:0] rdata_ext_i,  // read data of other modules
    input logic provided_good_i,  // the value written to REG_RAYS is valid
    input logic [2:0] bvh_good_i,  // settings are valid: of a refit, of primaries, of nodes
    input logic node_error_i
);
  logic ready, rvalid_q;
  logic [63:0] rdata_q, count_q;  // count_q: the value of a counter
  assign bus_o = {ready, rvalid_q, rdata_q | count_q | rdata_ext_i};
  localparam logic [63:0] DDR_BYTES = 64'(DDR_SLOTS) * 64'(records_pkg::DDR_WORDS * CW / 8);
  localparam logic [63:0] CW_BYTES = 64'(CW) / 64'd8;
  localparam int PRIM_WORDS = pairs_pkg::slot_words(PAIRS, 1, SWAP != 0);
  localparam logic [31:0] PRIM_BYTES = 32'(PRIMARIES * ((PRIM_WORDS * CW + 63) / 64) * 8);
  localparam logic [31:0] NODE_BYTES = 32'(config_pkg::chip_nodes(CONFIG)) * 32'(4 * bvh_pkg::NODE_WORDS);
  localparam logic [31:0] SLOT_BYTES = 32'(CONFIG.nodes) * 32'(4 * bvh_pkg::SLOTS_PER_NODE) *
      ((TRANSFORM != pairs_pkg::TRANSFORM_NONE) ? 32'd2 : 32'd1);
  localparam int STENCILS = (PRIMARIES + 63) / 64;

  registers_pkg::command_t command_q;
  registers_pkg::iterations_t iterations_q;
  registers_pkg::fault_t fault_q;
  logic [31:0] prim_count_q, split_q, sec_first_q, sec_count_q, object_count_q, prim_object_count_q;
  logic [STENCILS*64-1:0] stencil_q;
  logic done_q, command_error_q, bus_error_q;
  logic [63:0] cycles_q, rows_q, stalls_q, bubbles_q, bad_sec_q, secondaries_q, written_q, writeback_q,
      uncertain_q;

  // ---- The beat being served ----
  // When an access is allowed: never, always, while no pass runs, with valid data, while records can be read.
  typedef enum logic [2:0] {NEVER, ALWAYS, IDLE, VALID, READABLE} when_t;
  when_t when_q;
  logic compared_q, checked_q, good_q;  // of VALID: two cycles later, whether the data are valid
  logic in_page_q;  // the beat is in the 4 KB of the registers, aligned; the others read 0
  logic of_control_q, of_ddr_q, of_primaries_q;  // the beat writes the control register, a word of DDR, a primary
  logic of_checks_q;  // its result needs the checks of what was written before
  logic wrote_q;  // a write in the last cycle: modules beside this one take it now
  logic valid_q, write_q, write_reg, read, allowed, pops, command_ok;
  logic [registers_pkg::SPACE_BITS-1:0] space_q;
  logic [31:0] addr_q;
  logic [63:0] wdata_q;
  registers_pkg::control_t control;
  assign control = wdata_q;
  logic unused_control;
  assign unused_control = &{1'b0, control.reserved};

  localparam logic [31:0] OBJECT_BYTES = 32'(OBJECTS * records_pkg::OBJECT_WORDS * CW / 8),
      PRIM_OBJECT_BYTES = 32'(PRIM_OBJECTS * records_pkg::OBJECT_WORDS * CW / 8);
  function automatic bit in_stencil(input logic [31:3] addr);
    in_stencil = addr[31:5] == 27'(registers_pkg::REG_STENCIL[11:5]) && 32'(addr[4:3]) < STENCILS;
  endfunction
  function automatic bit in_objects(input logic [31:0] addr);
    in_objects = (TRANSFORM != pairs_pkg::TRANSFORM_NONE && addr >= registers_pkg::OBJECT_TABLE &&
        addr < registers_pkg::OBJECT_TABLE + OBJECT_BYTES) ||
        (TRANSFORM == pairs_pkg::TRANSFORM_BOTH && addr >= registers_pkg::PRIM_OBJECT_TABLE &&
            addr < registers_pkg::PRIM_OBJECT_TABLE + PRIM_OBJECT_BYTES);
  endfunction
  logic in_bvh;
  assign in_bvh = TRAVERSAL_UNITS != 0 && addr_q >= 32'(registers_pkg::REG_ROOT) && addr_q < registers_pkg::REG_END;

  // Memories and settings are not written while a pass runs.
  function automatic when_t writes_register(input logic [31:0] addr);
    bit present;
    writes_register = IDLE;
    present = 1;
    case (addr)
      32'(registers_pkg::REG_CONTROL): writes_register = ALWAYS;
      32'(registers_pkg::REG_COMMAND), 32'(registers_pkg::REG_PRIM_COUNT), 32'(registers_pkg::REG_PRIM_SPLIT),
          32'(registers_pkg::REG_ITERATIONS), 32'(registers_pkg::REG_SEC_FIRST),
              32'(registers_pkg::REG_SEC_COUNT): present = 1;
      32'(registers_pkg::REG_OBJECT_COUNT): present = TRANSFORM != pairs_pkg::TRANSFORM_NONE;
      32'(registers_pkg::REG_NODE_COUNT), 32'(registers_pkg::REG_NODE_FIRST), 32'(registers_pkg::REG_SLOT_COUNT),
          32'(registers_pkg::REG_RAY_COUNT), 32'(registers_pkg::REG_ROOT), 32'(registers_pkg::REG_ROOT) + 8,
          32'(registers_pkg::REG_ROOT) + 16, 32'(registers_pkg::REG_ROOT) + 24: present = TRAVERSAL_UNITS != 0;
      32'(registers_pkg::REG_NODE_BASE), 32'(registers_pkg::REG_SLOT_BASE): present = CONFIG.node_cache != 0;
      32'(registers_pkg::REG_NODE_FLIP): present = TRAVERSAL_UNITS != 0 && ECC != 0;
      32'(registers_pkg::REG_RAYS): begin
        writes_register = VALID;
        present = TRAVERSAL_UNITS != 0;
      end
      32'(registers_pkg::REG_PRIM_OBJECT_COUNT): present = TRANSFORM == pairs_pkg::TRANSFORM_BOTH;
      default: present = in_stencil(addr[31:3]) || in_objects(addr);
    endcase
    if (!present) writes_register = NEVER;
  endfunction
  function automatic when_t when_allowed(input logic [registers_pkg::SPACE_BITS-1:0] space, input logic write,
                                         input logic [31:0] addr);
    when_allowed = NEVER;
    case (space)
      registers_pkg::SPACE_REG:
        if (write) when_allowed = writes_register(addr);
        else if (addr < registers_pkg::REG_END) when_allowed = ALWAYS;
      registers_pkg::SPACE_PRIM: if (write && addr < PRIM_BYTES) when_allowed = IDLE;
      registers_pkg::SPACE_DDR: if (write && {32'd0, addr} < DDR_BYTES) when_allowed = IDLE;
      registers_pkg::SPACE_SRAM: if (!write) when_allowed = READABLE;
      registers_pkg::SPACE_NODES: if (TRAVERSAL_UNITS != 0 && write && addr < NODE_BYTES) when_allowed = IDLE;
      registers_pkg::SPACE_SLOTS:
        if (TRAVERSAL_UNITS != 0 && CONFIG.node_cache == 0 && write && addr < SLOT_BYTES) when_allowed = IDLE;
      registers_pkg::SPACE_RAYS:
        if (TRAVERSAL_UNITS != 0 && write && addr < 32'(32 * CONFIG.ray_places)) when_allowed = ALWAYS;
      default: when_allowed = NEVER;
    endcase
    if (addr[2:0] != '0) when_allowed = NEVER;
  endfunction

  // The beat is decoded as it is taken: the decoder would be in the paths of the answers.
  clock_gate gate (.clk_i, .enable_i(
      bus_i.valid | valid_q | rvalid_q | wrote_q | go_o | abort_o | done_i | pose_done_i | rst_i), .clk_o(clk_bus_o));
  always_ff @(posedge clk_bus_o) begin
    if (ready) begin
      valid_q <= bus_i.valid;
      write_q <= bus_i.write;
      space_q <= bus_i.space;
      addr_q <= bus_i.addr;
      when_q <= when_allowed(bus_i.space, bus_i.write, bus_i.addr);
      in_page_q <= bus_i.space == registers_pkg::SPACE_REG && bus_i.addr[31:12] == '0 && bus_i.addr[2:0] == '0;
      of_control_q <= bus_i.space == registers_pkg::SPACE_REG && bus_i.write &&
          bus_i.addr == 32'(registers_pkg::REG_CONTROL);
      of_checks_q <= bus_i.space == registers_pkg::SPACE_REG &&
          bus_i.addr == (bus_i.write ? 32'(registers_pkg::REG_CONTROL) : 32'(registers_pkg::REG_BAD_PRIM));
      of_ddr_q <= bus_i.space == registers_pkg::SPACE_DDR;
      of_primaries_q <= bus_i.space == registers_pkg::SPACE_PRIM;
      wdata_q <= bus_i.wdata;
    end
    {checked_q, compared_q} <= {2{valid_q && when_q == VALID && !ready}} & {compared_q, 1'b1};
    good_q <= provided_good_i;
    wrote_q <= access_o.write && !rst_i;
    if (rst_i) valid_q <= 0;
  end
  assign addr_o = addr_q;
  assign wdata_o = wdata_q;
  logic [11:0] offset;
  assign offset = addr_q[11:0];
  // busy_i one cycle late: it would be in the path of every write. A beat waits in the cycle of go_o.
  logic busy_q, started_q, running;
  always_ff @(posedge clk_bus_o) {busy_q, started_q} <= {busy_i, go_o && !rst_i};
  assign running = busy_q || started_q;
  always_comb
    case (when_q)
      ALWAYS: allowed = 1;
      IDLE: allowed = !running;
      VALID: allowed = good_q;
      READABLE: allowed = sram_readable_i;
      default: allowed = 0;
    endcase

  localparam logic [2:0] SETTLE = 3'd5;  // cycles of the checks of the command and of the primaries after a write
  logic [2:0] settle_q;  // such cycles left
  logic waits;  // go or stop take effect
  logic stays;  // the beat waits
  always_ff @(posedge clk_bus_o) sram_last_o <= !busy_i;
  assign pops = when_q == READABLE && sram_readable_i;
  assign waits = go_o || abort_o;
  assign stays = waits || (when_q == VALID && !checked_q) || (ddr_write_o && !ddr_ready_i) ||
      (of_control_q && objects_busy_i) || (of_checks_q && settle_q != 0) ||
      (in_page_q && !write_q && wrote_q);
  assign ready = !(valid_q && (stays || (pops && !sram_valid_i)));
  always_ff @(posedge clk_bus_o)
    if (rst_i || access_o.write) settle_q <= SETTLE;
    else if (settle_q != 0) settle_q <= settle_q - 1'b1;
  assign read = valid_q && ready && !write_q;
  assign write_reg = valid_q && !stays && write_q && allowed && space_q == registers_pkg::SPACE_REG;
  assign access_o = '{
      write: valid_q && !stays && write_q && allowed,
      read: valid_q && !write_q,
      hit: in_page_q,
      space: space_q,
      addr: addr_q,
      data: wdata_q};
  assign object_write_o = write_reg && in_objects(addr_q);
  assign prim_write_o = valid_q && !waits && of_primaries_q && when_q == IDLE && !running;
  assign ddr_write_o = valid_q && !waits && of_ddr_q && when_q == IDLE && !running;
  assign sram_pop_o = valid_q && !waits && pops && sram_valid_i;

  // End of the secondaries in DDR. The checks of the command are up to date once settle_q is 0.
  logic [63:0] sec_end_q;
  logic [32:0] sec_last_q;
  logic command_ok_q, objects_ok;
  pairs_pkg::words_t sec_words_q;
  pairs_pkg::shape_t sec_shape_q, sec_shape2;
  logic pair_present, second_ok, iterations_ok, secondaries_ok;
  always_ff @(posedge clk_bus_o) begin
    sec_shape_q <= pairs_pkg::SHAPE_BITS'(command_q.swap ? pairs_pkg::primary_shape(int'(command_q.pair)) :
        pairs_pkg::secondary_shape(int'(command_q.pair)));
    sec_words_q <= pairs_pkg::WORDS_BITS'(pairs_pkg::shape_words(int'(sec_shape_q)));
    sec_last_q <= {1'b0, sec_first_q} + {1'b0, sec_count_q};
    sec_end_q <= (64'(sec_last_q) * 64'(sec_words_q)) * CW_BYTES;
  end
  assign pair_present = pairs_pkg::has(PAIRS, int'(command_q.pair));
  // A second pair: another pipe with the same secondaries and its own primaries. Streaming modes allow no second pair.
  assign sec_shape2 = pairs_pkg::SHAPE_BITS'(command_q.second_swap ?
      pairs_pkg::primary_shape(int'(command_q.second_pair)) :
      pairs_pkg::secondary_shape(int'(command_q.second_pair)));
  assign second_ok = !command_q.second ||
      (PARALLEL != 0 && pairs_pkg::has(PAIRS, int'(command_q.second_pair)) &&
          command_q.second_pair != command_q.pair && sec_shape2 == sec_shape_q &&
      command_q.mode <= registers_pkg::MODE_ANY && (SWAP != 0 ||
          !command_q.second_swap) && split_q != 0 && split_q < prim_count_q && split_q % 32'(LANES) == 0);
  // Iterations of cylinder pairs. Cards without such pairs ignore them.
  assign iterations_ok = (PAIRS & pairs_pkg::ITERATIVE_PAIRS) == 0 ||
      ((iterations_q.m == 8'd4 || iterations_q.m == 8'd8 || iterations_q.m == 8'd16) &&
      iterations_q.k1 <= registers_pkg::ITERATIONS_MOST && iterations_q.k2 <= registers_pkg::ITERATIONS_MOST);
  // BVH passes are for rays and solids; solids have no mode farthest. No secondary beyond the count is in the BVH.
  localparam bvh_pkg::traversals_t TRAVERSALS = (TRAVERSAL_UNITS != 0) ? bvh_pkg::card_traversals(CONFIG) : '0;
  logic brute_force_ok, bvh_ok, bvh_pair_ok, bvh_pair_ok_q, bvh_solid;
  logic [bvh_pkg::TRAVERSAL_BITS-1:0] traversal;
  assign traversal = {command_q.pair, command_q.swap};
  assign bvh_solid = bvh_pkg::solid(int'(traversal));
  always_comb begin
    bvh_pair_ok = bvh_pkg::has_traversal(TRAVERSALS, int'(traversal)) &&
        (!bvh_solid || command_q.mode != registers_pkg::MODE_FARTHEST);
    if (command_q.mode == registers_pkg::MODE_REFIT)
      bvh_pair_ok = command_q.pair == pairs_pkg::PAIR_RAY_TRIANGLE && !command_q.swap;
  end
  always_ff @(posedge clk_bus_o) bvh_pair_ok_q <= bvh_pair_ok;
  assign bvh_ok = TRAVERSAL_UNITS != 0 && command_q.mode <= registers_pkg::MODE_REFIT &&
      command_q.mode != registers_pkg::MODE_ALL && bvh_good_i[0] &&
      bvh_good_i[(command_q.mode == registers_pkg::MODE_REFIT) ? 2 : 1] &&
      bvh_pair_ok_q && !command_q.second && (!command_q.normals || (NORMALS != 0 && bvh_solid)) &&
      sec_first_q == 0 && sec_count_q != 0 && sec_end_q <= DDR_BYTES;
  // The objects in use, also of primaries, must be in contract, or go is refused.
  assign objects_ok = TRANSFORM == pairs_pkg::TRANSFORM_NONE || objects_good_i;
  always_ff @(posedge clk_bus_o) command_ok_q <= command_q.bvh ? bvh_ok : brute_force_ok;
  assign command_ok = command_ok_q && objects_ok && !running;
  assign brute_force_ok = command_q.mode <= registers_pkg::MODE_HITS && pair_present && second_ok && iterations_ok &&
      (SWAP != 0 || !command_q.swap) && (NORMALS != 0 || !command_q.normals) && prim_count_q != 0 &&
      prim_count_q <= 32'(PRIMARIES) && secondaries_ok;
  // The ranges of objects replace the range in the registers.
  assign secondaries_ok = object_count_q != 0 || (sec_count_q != 0 && sec_end_q <= DDR_BYTES);
  // Registers: the paths from the bus into the units would be long.
  always_ff @(posedge clk_bus_o) begin
    go_o <= !rst_i && valid_q && !stays && of_control_q && control.go && command_ok;
    abort_o <= !rst_i && valid_q && !stays && of_control_q && control.stop;
  end
  always_comb begin
    pass_o.unit = (TRAVERSAL_UNITS != 0 && command_q.bvh) ? card_pkg::UNIT_BVH : card_pkg::UNIT_ENGINE;
    pass_o.mode = command_q.mode;
    pass_o.pair = {(PARALLEL != 0 && command_q.second) ? command_q.second_pair : pairs_pkg::NO_PAIR, command_q.pair};
    pass_o.swap = {SWAP != 0 && command_q.second_swap, SWAP != 0 && command_q.swap};
    pass_o.normals = NORMALS != 0 && command_q.normals;
    pass_o.iterations = {iterations_q.k2, iterations_q.k1, iterations_q.m};
    pass_o.split = split_q[7:0];
    pass_o.primaries = prim_count_q[8:0];
    pass_o.first = sec_first_q;
    pass_o.count = sec_count_q;
    pass_o.objects = object_count_q;
    pass_o.prim_objects = prim_object_count_q;
  end
  logic [PRIMARIES-1:0] present_q;  // primaries below the counter register
  assign active_o = present_q & ~stencil_q[PRIMARIES-1:0];
  assign irq_o = done_q || command_error_q || bus_error_q || sram_full_i;

  registers_pkg::ecc_t ecc_q;  // counts of DDR words
  registers_pkg::id_t id;
  registers_pkg::caps_t caps;
  registers_pkg::caps3_t caps3;
  always_comb begin
    id.magic = registers_pkg::ID_MAGIC;
    id.version = registers_pkg::INTERFACE_VERSION;
    caps = '0;
    caps.algorithm = 8'(ALGORITHM);
    caps.man = 8'(MAN);
    caps.exp = 8'(EXP);
    caps.primaries = 16'(PRIMARIES);
    caps.lanes = 16'(LANES);
    caps3 = '0;
    caps3.prim_objects = (TRANSFORM == pairs_pkg::TRANSFORM_BOTH) ? 16'(PRIM_OBJECTS) : 16'd0;
    caps3.objects = (TRANSFORM != pairs_pkg::TRANSFORM_NONE) ? 16'(OBJECTS) : 16'd0;
    caps3.prim_words = 8'(PRIM_WORDS);
    caps3.filter = config_pkg::filter_pairs(CONFIG) != 0;
    caps3.box = 1'(BOX);
    caps3.ecc = 1'(ECC);
    caps3.transform = 2'(TRANSFORM);
    caps3.parallel = 1'(PARALLEL);
    caps3.normals = 1'(NORMALS);
    caps3.swap = 1'(SWAP);
  end
  // Variable fields are assembled where they are read: simulation would otherwise do it in every cycle.
  function automatic registers_pkg::caps2_t caps2_of(input logic [15:0] latency);
    caps2_of = '0;
    caps2_of.traversal_units = 8'(TRAVERSAL_UNITS);
    caps2_of.container = 8'(CW);
    caps2_of.sram_records = 32'(SRAM_RECORDS);
    caps2_of.latency = latency;
  endfunction
  function automatic registers_pkg::status_t status_of(input logic busy, input logic done, input logic command_error,
      input logic bus_error, input logic sram_wait, input logic irq, input logic ecc_error,
      input logic node_error);
    status_of = '0;
    status_of.busy = busy;
    status_of.done = done;
    status_of.command_error = command_error;
    status_of.bus_error = bus_error;
    status_of.sram_wait = sram_wait;
    status_of.irq = irq;
    status_of.ecc_error = ecc_error;
    status_of.node_error = node_error;
  endfunction
  // Primaries present and out of contract, counted in parts. A read adds the parts.
  localparam int BAD_PARTS = (PRIMARIES + 15) / 16;
  logic [BAD_PARTS-1:0][4:0] bad_prim_q;
  logic [16*BAD_PARTS-1:0] bad_prim;
  assign bad_prim = (16 * BAD_PARTS)'(prim_bad_i & present_q);
  function automatic logic [63:0] sum_of(input logic [BAD_PARTS-1:0][4:0] parts);
    sum_of = '0;
    for (int k = 0; k < BAD_PARTS; k++) sum_of = sum_of + 64'(parts[k]);
  endfunction
  always_ff @(posedge clk_bus_o) begin
    for (int k = 0; k < BAD_PARTS; k++) bad_prim_q[k] <= 5'($countones(bad_prim[16*k+:16]));
    rvalid_q <= read && !rst_i;
    // The data of a read that waits are used when it is ready. `allowed` would be a long path here.
    if (valid_q && !write_q && space_q == registers_pkg::SPACE_SRAM) rdata_q <= pops ? sram_beat_i : '0;
    else if (valid_q && !write_q && !in_page_q) rdata_q <= '0;
    else if (valid_q && !write_q) begin
      case (offset)
        registers_pkg::REG_ID: rdata_q <= id;
        registers_pkg::REG_CAPS: rdata_q <= caps;
        registers_pkg::REG_CONFIG_HASH: rdata_q <= CONFIG_HASH;
        registers_pkg::REG_CAPS2: rdata_q <= caps2_of(latency_i);
        registers_pkg::REG_CAPACITY: rdata_q <= DDR_BYTES;
        registers_pkg::REG_CAPS3: rdata_q <= caps3;
        registers_pkg::REG_PAIRS: rdata_q <= 64'(PAIRS);
        registers_pkg::REG_STATUS:
          rdata_q <= status_of(busy_i, done_q, command_error_q, bus_error_q, sram_full_i, irq_o, ecc_q.failed != 0,
              node_error_i);
        registers_pkg::REG_COMMAND: rdata_q <= command_q;
        registers_pkg::REG_PRIM_COUNT: rdata_q <= 64'(prim_count_q);
        registers_pkg::REG_PRIM_SPLIT: rdata_q <= 64'(split_q);
        registers_pkg::REG_ITERATIONS: rdata_q <= iterations_q;
        registers_pkg::REG_SEC_FIRST: rdata_q <= 64'(sec_first_q);
        registers_pkg::REG_SEC_COUNT: rdata_q <= 64'(sec_count_q);
        registers_pkg::REG_OBJECT_COUNT: rdata_q <= 64'(object_count_q);
        registers_pkg::REG_PRIM_OBJECT_COUNT: rdata_q <= 64'(prim_object_count_q);
        registers_pkg::REG_RECORDS: rdata_q <= 64'(sram_count_i);
        registers_pkg::REG_FAULT_ADDR: rdata_q <= fault_q;
        registers_pkg::REG_BAD_PRIM: rdata_q <= sum_of(bad_prim_q);
        default: rdata_q <= in_stencil(addr_q[31:3]) ? stencil_q[64*32'(offset[4:3])+:64] : '0;
      endcase
    end
    // One register for all of them would be slow.
    if (valid_q && !write_q) begin
      count_q <= '0;
      if (in_page_q)
        case (offset)
          registers_pkg::REG_CYCLES: count_q <= cycles_q;
          registers_pkg::REG_ROWS: count_q <= rows_q;
          registers_pkg::REG_STALLS: count_q <= stalls_q;
          registers_pkg::REG_BUBBLES: count_q <= bubbles_q;
          registers_pkg::REG_BAD_SEC: count_q <= bad_sec_q;
          registers_pkg::REG_SECONDARIES: count_q <= secondaries_q;
          registers_pkg::REG_WRITTEN: count_q <= written_q;
          registers_pkg::REG_UNCERTAIN: count_q <= uncertain_q;
          registers_pkg::REG_ECC: count_q <= ecc_q;
          registers_pkg::REG_WRITEBACK: count_q <= writeback_q;
          default: ;
        endcase
    end

    if (write_reg && !in_objects(addr_q) && !in_bvh) begin
      case (offset)
        registers_pkg::REG_COMMAND: command_q <= wdata_q & registers_pkg::COMMAND_BITS;
        registers_pkg::REG_PRIM_SPLIT: split_q <= |wdata_q[63:32] ? '1 : wdata_q[31:0];
        registers_pkg::REG_ITERATIONS: iterations_q <= {40'b0, |wdata_q[63:24] ? 24'hFFFFFF : wdata_q[23:0]};
        registers_pkg::REG_PRIM_COUNT: prim_count_q <= |wdata_q[63:32] ? '1 : wdata_q[31:0];
        registers_pkg::REG_SEC_FIRST: sec_first_q <= |wdata_q[63:32] ? '1 : wdata_q[31:0];
        registers_pkg::REG_SEC_COUNT: sec_count_q <= |wdata_q[63:32] ? '1 : wdata_q[31:0];
        registers_pkg::REG_CONTROL: begin
          if (control.clear) {done_q, command_error_q, bus_error_q} <= '0;
          if (control.go) begin
            done_q <= 0;
            command_error_q <= !command_ok;
          end
        end
        registers_pkg::REG_OBJECT_COUNT: object_count_q <= |wdata_q[63:32] ? '1 : wdata_q[31:0];
        registers_pkg::REG_PRIM_OBJECT_COUNT: prim_object_count_q <= |wdata_q[63:32] ? '1 : wdata_q[31:0];
        default: stencil_q[64*32'(offset[4:3])+:64] <= wdata_q;
      endcase
    end
    if (settle_q == SETTLE)
      present_q <= (prim_count_q >= 32'(PRIMARIES)) ? '1 : ~({PRIMARIES{1'b1}} << prim_count_q[7:0]);
    if (valid_q && ready && !allowed) begin
      bus_error_q <= 1;
      if (!bus_error_q) {fault_q.space, fault_q.addr} <= {space_q, addr_q};
    end
    if (done_i) done_q <= 1;

    if (rst_i) begin
      {done_q, command_error_q, bus_error_q} <= '0;
      command_q <= '0;
      iterations_q <= {40'b0, registers_pkg::ITERATIONS_RESET};
      {prim_count_q, split_q, sec_first_q, sec_count_q, object_count_q, prim_object_count_q} <= '0;
      stencil_q <= '0;
      present_q <= '0;
      fault_q <= '0;
    end
  end

  if (ECC != 0) begin : g_ecc
    always_ff @(posedge clk_engine_i) begin
      if (go_o || rst_i) ecc_q <= '0;
      else begin
        ecc_q.corrected <= ecc_q.corrected + 32'(events_i.ecc_corrected);
        ecc_q.failed <= ecc_q.failed + 32'(events_i.ecc_failed);
      end
    end
  end else begin : g_no_ecc
    assign ecc_q = '0;
    logic unused_ecc;
    assign unused_ecc = &{1'b0, events_i.ecc_corrected, events_i.ecc_failed};
  end

  // Events of rows and secondaries are counted one cycle late, in which the pass does not end.
  card_pkg::events_t row_events_q;
  logic unused_events;
  assign unused_events = &{1'b0, row_events_q};
  always_ff @(posedge clk_engine_i) row_events_q <= events_i;
  always_ff @(posedge clk_engine_i) begin
    if (go_o || rst_i) {cycles_q, rows_q, stalls_q, bubbles_q, bad_sec_q, secondaries_q, written_q, writeback_q,
        uncertain_q} <= '0;
    else begin
      cycles_q <= cycles_q + 64'(busy_i && !events_i.writeback);
      writeback_q <= writeback_q + 64'(events_i.writeback);
      rows_q <= rows_q + 64'($countones(row_events_q.issue));
      stalls_q <= stalls_q + 64'(row_events_q.stall);
      uncertain_q <= uncertain_q + 64'(events_i.uncertain);
      bubbles_q <= bubbles_q + 64'(row_events_q.bubble);
      secondaries_q <= secondaries_q + 64'(row_events_q.secondary);
      bad_sec_q <= bad_sec_q + 64'(row_events_q.secondary && row_events_q.secondary_bad);
      written_q <= written_q + 64'(events_i.record);
    end
  end
endmodule
