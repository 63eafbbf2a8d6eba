// SPDX-License-Identifier: Apache-2.0
// Reads the nodes that a traversal unit visits. Without LINES, all nodes are on chip. With LINES, the first PINNED
// nodes are pinned, which means on chip. The others are in DDR, and a cache holds LINES of them.
// A visit whose node is not in the cache waits in a queue, and later visits overtake it. DDR answers in order, so
// visits leave the queue in order. A node takes two beats of DDR.
// A line of the cache keeps the number of the last waiting visit to it. It is in use until this visit leaves. Another
// node cannot replace it meanwhile, and further visits to its node join the queue. Numbers repeat, so a line may seem
// in use when it is not. Then a visit waits without need, or replaces the line of another way.
// Without a free way, a visit joins the queue and is looked up again at its head. The same holds while the cache is
// cleared after rst_i or clear_i, one set per cycle.
// A look-up never stalls. A visit enters it only if there is room behind it.
// With HALVES a node takes four cycles, and memories are half as wide: words of the first half are in node_o for two
// cycles, then words of the second half.
// Latency: from valid_i to valid_o 0 cycles without LINES, else 3 cycles, plus the memory's latency for a fetch. The
// node follows one cycle later.
// Throughput: one node per CYCLES cycles. A visit that begins to wait delays others by at most one cycle, and by none
// while another visit is kept behind the look-up.
// Stall: ready_o, ddr_ready_i.
`include "bvh.svh"
module node_reader #(
    parameter int CONTEXTS = 128,  // power of two: most visits at a time
    parameter int CX = 8,          // bits of a context's number
    parameter int CYCLES = 1,      // per node: 1, 2 or 4
    parameter int PINNED = 4096,
    parameter int LINES = 0,       // 0, or a power of two >= 2 * WAYS
    parameter int WAYS = 4,        // power of two
    parameter bit HALVES = 0,      // only with CYCLES = 4 and LINES
    localparam int AT = `AT_BITS(CX),
    localparam int BEAT = records_pkg::DDR_WORDS
) (
    input logic clk_i,
    input logic rst_i,
    input logic clear_i,  // between passes, until outstanding_o is low: drops visits and outstanding requests
    input logic [31:0] nodes_i,  // number of nodes; a node beyond them is read as if it were on chip
    input logic [31:0] base_i,   // word of node 0 in DDR
    input logic valid_i,
    output logic ready_o,
    input logic [AT-1:0] at_i,
    input logic [bvh_pkg::PLACE-1:0] place_i,
    // The visit whose node is in node_o in the next CYCLES cycles.
    output logic valid_o,
    output logic [AT-1:0] at_o,
    output logic [bvh_pkg::PLACE-1:0] place_o,
    output logic [bvh_pkg::NODE_WORDS-1:0][31:0] node_o,
    // On-chip memory; a read returns one cycle later.
    output logic chip_read_o,
    output logic [bvh_pkg::PLACE-1:0] chip_at_o,
    output logic chip_second_o,  // with HALVES: the second half
    input logic [bvh_pkg::NODE_WORDS-1:0][31:0] chip_node_i,

    output card_pkg::ddr_request_t ddr_o,
    input logic ddr_ready_i,
    input logic ddr_valid_i,
    input logic [BEAT-1:0][31:0] ddr_data_i,
    output logic outstanding_o,  // beats are outstanding, or will be by this cycle's request
    output logic cached_o,       // the visit of valid_o is to a node that is not pinned
    output logic fetched_o       // a node is requested from DDR
);
  import bvh_pkg::*;
  if (CYCLES != 1 && CYCLES != 2 && CYCLES != 4) $error("node_reader: CYCLES must be 1, 2 or 4");
  if (HALVES && (CYCLES != 4 || LINES == 0)) $error("node_reader: HALVES needs CYCLES = 4 and LINES");
  logic busy, chosen_now;  // chosen_now: a visit's node is read
  logic [1:0] left_q;  // further cycles of a node
  assign busy = CYCLES != 1 && left_q != 0;
  always_ff @(posedge clk_i)
    left_q <= (rst_i || clear_i) ? '0 : chosen_now ? 2'(CYCLES - 1) : left_q - 2'(busy);

  if (LINES == 0) begin : g_on_chip
    assign ready_o = !busy;
    assign chosen_now = valid_i && !busy;
    assign valid_o = chosen_now;
    assign {at_o, place_o} = {at_i, place_i};
    logic [PLACE-1:0] place_q;
    always_ff @(posedge clk_i) if (!busy) place_q <= place_i;
    assign {chip_at_o, chip_second_o} = {busy ? place_q : place_i, 1'b0};
    assign node_o = chip_node_i;
    assign chip_read_o = valid_o;
    assign ddr_o = '0;
    assign {outstanding_o, cached_o, fetched_o} = '0;
    logic unused;
    assign unused = &{1'b0, nodes_i, base_i, ddr_ready_i, ddr_valid_i, ddr_data_i};
  end else begin : g_cache
    localparam int SETS = LINES / WAYS;
    localparam int SW = $clog2(SETS);
    localparam int WW = $clog2(WAYS);
    localparam int TAG = PLACE - SW;
    localparam int COUNT = $clog2(CONTEXTS);
    localparam int NUMBER = COUNT + 3;  // bits of a waiting visit's number
    if (2 * WAYS > LINES || (LINES & (LINES - 1)) != 0 || (WAYS & (WAYS - 1)) != 0 || WAYS < 2) begin : g_lines
      $error("node_reader: WAYS must be a power of two >= 2, LINES a power of two >= 2 * WAYS");
    end
    typedef struct packed {
      logic valid;
      logic [TAG-1:0] tag;
      logic [NUMBER-1:0] last;
    } line_t;
    typedef enum logic [1:0] {FETCH, JOIN, AGAIN} wait_t;
    typedef struct packed {
      wait_t kind;
      logic [WW+SW-1:0] line;
      logic [AT-1:0] at;
      logic [PLACE-1:0] place;
    } waiting_t;
    typedef struct packed {
      logic valid;
      logic cached;
      logic [WW+SW-1:0] line;
      logic [AT-1:0] at;
      logic [PLACE-1:0] place;
    } read_t;
    // Most visits in the look-up and behind it. With more cycles per node, more only fill the queue earlier.
    localparam int KEPT = (CYCLES == 1) ? 4 : 3;
    logic rst, ddr_second;
    read_t [KEPT-1:0] kept_q;  // visits whose nodes can be read, behind the look-up; the oldest is the first
    assign rst = rst_i || clear_i;

    // ---- Waiting visits: a queue, and its head in a register ----
    waiting_t queued, parked;
    read_t head_q;
    logic park, leave, move, fetch_q, join_q, again_q, arrived, serve, again, cleared;
    logic some;
    logic [COUNT:0] arrived_q;  // arrived_q: fetched nodes whose visits have not left
    logic [NUMBER-1:0] first_q, tail_q;  // number of the head, and of the next visit that begins to wait
    sync_fifo #(.W($bits(waiting_t)), .DEPTH(CONTEXTS)) queue_waiting (
        .clk_i, .rst_i(rst), .write_i(park), .wdata_i(parked), .free_o(), .count_o(), .some_o(some), .rdata_o(queued),
        .read_i(move));
    assign move = some && (!head_q.valid || leave);
    assign arrived = join_q || (fetch_q && arrived_q != 0);
    assign leave = serve || again;
    always_ff @(posedge clk_i) begin
      if (move || leave) begin
        head_q <= '{valid: move, cached: 1'b1, line: queued.line, at: queued.at, place: queued.place};
        {fetch_q, join_q, again_q} <= {move && queued.kind == FETCH, move && queued.kind == JOIN,
                                       move && queued.kind == AGAIN};
      end
      if (rst) {head_q.valid, fetch_q, join_q, again_q} <= '0;
    end

    // ---- Look-up: one cycle after the visit, the tags of its set are compared ----
    logic look, look_q, room;
    logic [AT-1:0] look_at, look_at_q;
    logic [PLACE-1:0] look_place, look_place_q, place_then_q, place_last_q;  // place_then_q: of the decision
    logic [SW-1:0] look_set, set;  // set: of the decision
    logic on_chip;
    assign again = again_q && cleared && room;
    assign ready_o = room && !again;
    assign look = room && (again || valid_i);
    assign {look_at, look_place} = (again_q && cleared) ? {head_q.at, head_q.place} : {at_i, place_i};
    assign look_set = look_place[SW-1:0];
    assign set = place_then_q[SW-1:0];
    assign on_chip = 32'(look_place_q) < PINNED || 32'(look_place_q) >= nodes_i;
    always_ff @(posedge clk_i) begin
      look_q <= look && !rst;
      {look_at_q, look_place_q} <= {look_at, look_place};
    end
    logic [SW:0] clear_q;  // sets that have been cleared
    logic tags_q;  // the tags were read after that
    assign cleared = clear_q[SW];
    always_ff @(posedge clk_i) begin
      clear_q <= rst ? '0 : clear_q + (SW + 1)'(!cleared);
      tags_q <= cleared && !rst;
    end
    line_t written;
    logic same_node;  // as the decision of the previous cycle
    logic [WAYS-1:0] write, match, waited, kept, valid;
    assign same_node = look_place_q == place_last_q;
    for (genvar w = 0; w < WAYS; w++) begin : way
      (* ram_style = "block", no_rw_check *) line_t lines[SETS];
      line_t line_q;
      logic new_q;  // the set was written in the cycle of its read
      always_ff @(posedge clk_i) begin
        if (!cleared || write[w]) lines[cleared ? set : clear_q[SW-1:0]] <= cleared ? written : '0;
        line_q <= lines[look_set];
        new_q <= write[w] && look_set == set;
      end
      always_comb begin
        kept[w] = 1'b0;
        for (int k = 0; k < KEPT; k++)
          if (kept_q[k].valid && kept_q[k].cached && kept_q[k].line == {WW'(w), look_place_q[SW-1:0]}) kept[w] = 1'b1;
      end
      assign valid[w] = new_q || line_q.valid;
      assign match[w] = new_q ? same_node : line_q.valid && line_q.tag == look_place_q[PLACE-1:SW];
      assign waited[w] = new_q || between(line_q.last);
    end
    // The visit of this number waits.
    function automatic logic between(input logic [NUMBER-1:0] visit);
      logic from, to;
      {from, to} = {visit >= first_q, visit < tail_q};
      between = (first_q <= tail_q) ? from && to : from || to;
    endfunction
    function automatic logic [WW-1:0] first_of(input logic [WAYS-1:0] ways);
      first_of = '0;
      for (int w = WAYS - 1; w >= 0; w--) if (ways[w]) first_of = WW'(w);
    endfunction

    // ---- The comparison, one cycle later. It did not see what the decision of its cycle wrote or kept ----
    logic then_q, tags_then_q, on_chip_q, same_set_q, same_node_q;
    logic [AT-1:0] at_then_q;
    logic [WAYS-1:0] match_q, waited_q, kept_then_q, valid_q, write_q, taken_q, changed;
    logic [WAYS-1:0] match_now, used_now, valid_now;
    always_ff @(posedge clk_i) begin
      then_q <= look_q && !rst;
      {at_then_q, place_then_q, place_last_q} <= {look_at_q, look_place_q, place_then_q};
      {tags_then_q, on_chip_q} <= {tags_q, on_chip};
      {match_q, waited_q, kept_then_q, valid_q} <= {match, waited, kept, valid};
      same_set_q <= look_place_q[SW-1:0] == set;
      same_node_q <= look_place_q == place_then_q;
      {write_q, taken_q} <= {write, write | (then_q ? match_q : '0)};
    end
    assign changed = same_set_q ? write_q : '0;
    assign match_now = (match_q & ~changed) | (same_node_q ? changed : '0);
    assign used_now = waited_q | kept_then_q | (same_set_q ? taken_q : '0);
    assign valid_now = valid_q | changed;
    // A new node takes an empty way, else the next free way in turn.
    logic [WW-1:0] turn_q, chosen;
    logic [WAYS-1:0] free, next;
    assign free = ~used_now;
    assign next = free & ~((WAYS'(1) << turn_q) - 1'b1);
    assign chosen = (match_now != 0) ? first_of(match_now) : (valid_now != '1) ? first_of(~valid_now) :
        first_of((next != 0) ? next : free);

    // ---- Decision: read, or wait. A visit that cannot be read at once is kept, and the next one looked up ----
    read_t looked, reading;
    read_t [KEPT-1:0] left;  // kept visits without the one that is read
    logic found, now, keep, head_next_q;
    assign found = tags_then_q && (match_q & ~waited_q & ~changed) != 0;
    assign looked = '{
        valid: then_q && (on_chip_q || found), cached: !on_chip_q, line: {first_of(match_q), set}, at: at_then_q,
        place: place_then_q};
    assign reading = kept_q[0].valid ? kept_q[0] : looked;
    // Waiting visits and others take turns.
    assign serve = arrived && !busy && (head_next_q || !reading.valid);
    assign now = reading.valid && !busy && !serve;
    assign keep = looked.valid && (kept_q[0].valid || !now);
    assign left = now ? {read_t'('0), kept_q[KEPT-1:1]} : kept_q;
    assign park = then_q && !on_chip_q && !found && !rst;
    logic [KEPT-1:0] places;  // of kept_q that are taken
    for (genvar k = 0; k < KEPT; k++) assign places[k] = kept_q[k].valid;
    assign room = $countones({then_q, look_q, places}) < KEPT;
    always_ff @(posedge clk_i) begin
      if (chosen_now) head_next_q <= now;
      for (int k = 0; k < KEPT; k++) begin
        kept_q[k] <= (keep && !left[k].valid && (k == 0 || left[k-1].valid)) ? looked : left[k];
        if (rst) kept_q[k].valid <= 1'b0;
      end
      if (rst) head_next_q <= 1'b0;
    end
    assign parked = '{
        kind: (!tags_then_q || (match_now == 0 && free == 0 && valid_now == '1)) ? AGAIN :
            (match_now != 0) ? JOIN : FETCH,
        line: {chosen, set}, at: at_then_q, place: place_then_q};
    assign fetched_o = park && parked.kind == FETCH;
    assign write = (park && parked.kind != AGAIN) ? WAYS'(1) << chosen : '0;
    assign written = '{valid: 1'b1, tag: place_then_q[PLACE-1:SW], last: tail_q};
    always_ff @(posedge clk_i) begin
      if (fetched_o) turn_q <= chosen + 1'b1;
      if (leave) first_q <= first_q + 1'b1;
      if (park) tail_q <= tail_q + 1'b1;
      if (ddr_second != (serve && fetch_q)) arrived_q <= arrived_q + {{COUNT{!ddr_second}}, 1'b1};
      if (rst) {turn_q, first_q, tail_q, arrived_q} <= '0;
    end

    // ---- Read ----
    // One cycle after the decision.
    read_t read_q;
    logic read_valid_q, second_q, cache_q;
    assign chosen_now = !busy && (arrived || reading.valid);
    always_ff @(posedge clk_i) begin
      if (chosen_now) read_q <= serve ? head_q : reading;
      read_valid_q <= chosen_now && !rst;
      second_q <= HALVES && busy && left_q != 3;
      cache_q <= read_q.cached;
    end
    assign valid_o = read_valid_q;
    assign {at_o, place_o} = {read_q.at, read_q.place};
    assign {chip_at_o, chip_second_o} = {read_q.place, second_q};
    assign cached_o = read_valid_q && read_q.cached;
    assign chip_read_o = read_valid_q && !read_q.cached;
    logic unused;
    assign unused = &{1'b0, read_q.valid};

    // ---- DDR ----
    logic [31:0] first_word, request, second_word_q;  // first words of a node, and of its second beat
    assign first_word = base_i + {32'(place_then_q) << 4} + {32'(place_then_q) << 1};
    logic [WW+SW-1:0] fill;
    logic [COUNT+1:0] outstanding_q;
    logic asked, leaves, asked_half_q, half_q;
    sync_fifo #(.W(32), .DEPTH(CONTEXTS)) queue_requests (
        .clk_i, .rst_i(rst), .write_i(fetched_o), .wdata_i(first_word), .free_o(), .count_o(), .some_o(ddr_o.valid),
        .rdata_o(request), .read_i(leaves));
    sync_fifo #(.W(WW + SW), .DEPTH(CONTEXTS)) queue_fills (
        .clk_i, .rst_i(rst), .write_i(fetched_o), .wdata_i(parked.line), .free_o(), .count_o(), .some_o(),
        .rdata_o(fill), .read_i(ddr_second));
    assign ddr_o.words = 4'(BEAT);
    assign ddr_o.word = asked_half_q ? second_word_q : request;
    assign asked = ddr_o.valid && ddr_ready_i;
    assign leaves = asked && asked_half_q;
    assign ddr_second = ddr_valid_i && half_q && !rst;
    assign outstanding_o = outstanding_q != 0 || ddr_o.valid;
    always_ff @(posedge clk_i) begin
      asked_half_q <= asked_half_q ^ asked;
      second_word_q <= request + BEAT;
      half_q <= half_q ^ ddr_valid_i;
      if (rst) {asked_half_q, half_q} <= '0;
      outstanding_q <= rst_i ? '0 : outstanding_q + (COUNT + 2)'(asked) - (COUNT + 2)'(ddr_valid_i);
    end

    // ---- Lines: a beat is half a node. A line that is read is not filled: asserted below ----
    if (HALVES) begin : g_halves
      (* no_rw_check *) logic [BEAT-1:0][31:0] halves[2*LINES];
      logic [BEAT-1:0][31:0] words_q;
      always_ff @(posedge clk_i) begin
        if (ddr_valid_i && !rst) halves[{fill, half_q}] <= ddr_data_i;
        words_q <= halves[{read_q.line, second_q}];
      end
      assign node_o = cache_q ? {2{words_q}} : chip_node_i;
    end else begin : g_whole
      (* no_rw_check *) logic [NODE_WORDS/BEAT-1:0][BEAT-1:0][31:0] nodes[LINES];
      node_t node_q;
      always_ff @(posedge clk_i) begin
        if (ddr_valid_i && !rst) nodes[fill][half_q] <= ddr_data_i;
        node_q <= nodes[read_q.line];
      end
      assign node_o = cache_q ? node_q : chip_node_i;
    end

`ifndef SYNTHESIS
    logic busy_q;
    always_ff @(posedge clk_i) busy_q <= busy;
    always_ff @(posedge clk_i)
      if (!rst_i) begin
        assert (!(ddr_valid_i && outstanding_q == 0)) else $error("node_reader: data without a request");
        assert (!(ddr_valid_i && !rst && (read_valid_q || busy_q) && read_q.cached && fill == read_q.line &&
            (!HALVES || half_q == second_q)))
        else $error("node_reader: a line is filled while it is read");
      end
`endif
  end
endmodule
