// SPDX-License-Identifier: Apache-2.0
// PCI bus master: moves `qwords_i` words of 64 bits between the card and consecutive bus addresses, in one or several
// transactions. All bus signals are active high, and outputs are registers.
//
// It asks for 64-bit transfers, and uses 32 bits if the target does not answer ACK64#. After a retry, a disconnect or
// the end of its time slice (latency timer, GNT# gone) it starts again with the remaining words. These end the command:
// a target abort, a master abort (no DEVSEL# within 4 cycles), a data parity error, or more consecutive retries than
// allowed. It then reports the bus address and the number of words known to be good. A word read with bad parity does
// not leave this module.
// Latency: 3 cycles from start_i to REQ#, 3 from the last data phase to done_o.
// Throughput: one data phase per cycle.
// Stall: none; data and room must be present before start_i.
module pci_master (
    input logic clk_i,
    input logic rst_i,
    output logic active_o,  // not idle: the clock must run

    input logic start_i,  // held with the command until done_o
    input logic write_i,
    input logic [31:3] addr_i,
    input logic [9:0] qwords_i,  // 1 to 512
    input logic [63:0] wdata_i,  // next word to write
    output logic wpop_o,
    output logic rvalid_o,
    output logic [63:0] rdata_o,
    output logic done_o,
    output logic [7:0] code_o,   // with done_o: PCI_CODE_*
    output logic [31:0] fault_addr_o,
    output logic [9:0] moved_o,  // words done

    input logic enable_i,       // command register: may become bus master,
    input logic parity_i,       // reports parity errors
    input logic [7:0] latency_i,
    input logic [15:0] retry_limit_i,

    output logic req_o,
    input logic gnt_i,
    input logic [63:0] ad_i,
    input logic frame_i,
    input logic irdy_i,
    input logic trdy_i,
    input logic stop_i,
    input logic devsel_i,
    input logic ack64_i,
    input logic perr_i,
    input logic parity_error_i,    // PAR does not match the bus of the previous cycle
    input logic parity64_error_i,
    output logic own_o,            // owns the bus, from the address phase to the last data phase
    output logic [63:0] ad_o,
    output logic [7:0] cbe_o,
    output logic ad_oe_o,
    output logic ad64_oe_o,
    output logic cbe_oe_o,
    output logic frame_o,
    output logic frame_oe_o,  // also for REQ64#
    output logic req64_o,
    output logic irdy_o,
    output logic irdy_oe_o,
    output logic perr_o,  // drives PERR# in this cycle

    output logic burst_o,  // events for the counters, one cycle each
    output logic beat_o,
    output logic wait_o,
    output logic retry_o,
    output logic disconnect_o,
    output logic detected_parity_o,
    output logic master_parity_o,
    output logic master_abort_o,
    output logic target_abort_o
);
  import pci_pkg::*;
  localparam logic [2:0] IDLE = 0, LOAD = 1, REQUEST = 2, ADDRESS = 3, DATA = 4, TURN = 5, SETTLE = 6;
  localparam logic [2:0] DEVSEL_CYCLES = 4;  // fast to subtractive

  // ---- The command ----
  logic [2:0] state_q;
  logic [9:0] remaining_q, remaining;  // words left, with the current one
  logic half_q, half;        // the lower half of the current word is done
  logic [63:0] word_q;       // the word being written, or the lower half of the word being read
  logic [31:0] addr_q, addr; // of the next data phase
  logic [15:0] retries_q;
  logic [7:0] code_q;

  // ---- The transaction ----
  logic wide_q, wide, seen_q, moved_q, aborted_q, ending, transfer, word_done, finish, no_answer, time_over, granted;
  logic req64_q;
  logic [1:0] check_q;  // data phases of the last two cycles
  logic [2:0] cycles_q;
  logic [7:0] slice_q;
  logic [7:0] code;
  assign granted = gnt_i && !frame_i && !irdy_i && !own_o;  // and the bus is idle
  assign wide = seen_q ? wide_q : req64_q && ack64_i;
  assign no_answer = !seen_q && !devsel_i && cycles_q == DEVSEL_CYCLES;
  assign transfer = state_q == DATA && irdy_o && trdy_i && devsel_i;
  assign word_done = transfer && (wide || half_q);
  assign remaining = remaining_q - 10'(word_done);
  assign half = transfer ? !wide && !half_q : half_q;
  assign addr = addr_q + (!transfer ? 32'd0 : wide ? 32'd8 : 32'd4);
  assign time_over = slice_q == 0 && !gnt_i;
  // The next data phase is the last: no words are left, or the master must release the bus.
  assign ending = (remaining == 1 && (wide || half)) || time_over || code_q != PCI_CODE_OK;
  assign finish = state_q == DATA && irdy_o && !frame_o && (transfer || stop_i || aborted_q);

  logic [63:0] next_word;
  assign next_word = word_done ? wdata_i : word_q;
  assign wpop_o = write_i && (state_q == LOAD || (word_done && remaining != 0));
  assign own_o = frame_oe_o || irdy_oe_o;
  assign req64_o = req64_q && frame_o;
  assign active_o = state_q != IDLE || start_i || frame_oe_o || irdy_oe_o || gnt_i != cbe_oe_o || perr_o ||
      check_q != 0;

  always_ff @(posedge clk_i) begin
    case (state_q)
      IDLE: begin
        if (start_i && !done_o) begin
          state_q <= !enable_i ? SETTLE : write_i ? LOAD : REQUEST;
          remaining_q <= qwords_i;
          half_q <= 0;
          addr_q <= {addr_i, 3'b0};
          retries_q <= '0;
        end
      end
      LOAD: begin
        word_q <= wdata_i;
        state_q <= REQUEST;
      end
      REQUEST:
      if (granted) begin
        state_q <= ADDRESS;
        {frame_o, frame_oe_o} <= '1;
        req64_q <= !half_q;
        slice_q <= latency_i;
        {seen_q, wide_q, moved_q, aborted_q} <= '0;
        cycles_q <= '0;
      end
      ADDRESS: begin
        state_q <= DATA;
        irdy_oe_o <= 1;
        // A single word: ACK64# decides whether this data phase is the last, so IRDY# waits for it.
        irdy_o <= !(req64_q && remaining_q == 1);
        frame_o <= req64_q || remaining_q != 1;
      end
      DATA: begin
        if (devsel_i && !seen_q) begin
          seen_q <= 1;
          wide_q <= wide;
        end
        cycles_q <= cycles_q + 3'(cycles_q != DEVSEL_CYCLES);
        remaining_q <= remaining;
        half_q <= half;
        addr_q <= addr;
        if (transfer) begin
          moved_q <= 1;
          retries_q <= '0;
          if (write_i && word_done) word_q <= wdata_i;
          if (!write_i && !half_q) word_q[31:0] <= ad_i[31:0];
        end
        if (no_answer) aborted_q <= 1;
        if (finish) begin
          state_q <= TURN;
          irdy_o <= 0;
          frame_oe_o <= 0;
        end else if (!irdy_o) begin
          irdy_o <= devsel_i || no_answer;
          frame_o <= frame_o && !((devsel_i && wide) || no_answer || stop_i);
        end else if (stop_i || no_answer) frame_o <= 0;
        else if (transfer) frame_o <= frame_o && !ending;
        if (irdy_o && stop_i && !transfer && devsel_i && !frame_o && !moved_q) retries_q <= retries_q + 1;
      end
      TURN: begin
        state_q <= SETTLE;
        irdy_oe_o <= 0;
      end
      SETTLE: state_q <= (remaining_q == 0 || code != PCI_CODE_OK) ? IDLE : REQUEST;
      default: state_q <= IDLE;
    endcase
    if (slice_q != 0 && frame_o) slice_q <= slice_q - 1;
    if (rst_i) begin
      state_q <= IDLE;
      {frame_o, frame_oe_o, irdy_o, irdy_oe_o, req64_q} <= '0;
      {half_q, seen_q, wide_q, moved_q, aborted_q} <= '0;
    end
  end
  assign req_o = state_q == REQUEST;

  // ---- Address, data and byte enables ----
  logic [3:0] command;
  assign command = write_i ? PCI_MEMORY_WRITE : remaining_q == 1 ? PCI_MEMORY_READ :
      remaining_q <= 4 ? PCI_READ_LINE : PCI_READ_MULTIPLE;
  always_ff @(posedge clk_i) begin
    if (state_q == REQUEST) begin
      ad_o <= {32'b0, addr_q};
      cbe_o <= {4'b0, command};
    end else if (state_q == ADDRESS || transfer) begin
      ad_o <= half ? {32'b0, word_q[63:32]} : next_word;
      cbe_o <= '0;
    end
    // A master with GNT# on an idle bus must drive AD, C/BE# and then PAR: the bus is parked at it.
    if (state_q == IDLE || state_q == LOAD || state_q == REQUEST || state_q == SETTLE) begin
      ad_oe_o <= granted;
      cbe_oe_o <= granted;
      ad64_oe_o <= state_q == REQUEST && granted && !half_q;
    end else if (state_q == ADDRESS) begin
      ad_oe_o <= write_i;
      ad64_oe_o <= write_i && req64_q;
    end else if (finish) {ad_oe_o, ad64_oe_o, cbe_oe_o} <= '0;
    if (rst_i) {ad_oe_o, ad64_oe_o, cbe_oe_o} <= '0;
  end

  // ---- Parity: PAR comes one cycle after the data, and the target's PERR# one cycle later ----
  logic check_wide_q, check_full_q, read_error, write_error;
  logic [31:0] check_addr_q, check_addr2_q;
  logic [9:0] good_q;  // words read and known to be good
  assign read_error = !write_i && check_q[0] && (parity_error_i ||
      (check_wide_q && parity64_error_i)) && code_q == PCI_CODE_OK;
  assign write_error = write_i && check_q[1] && perr_i && code_q == PCI_CODE_OK;
  assign rvalid_o = !write_i && check_q[0] && check_full_q && !read_error && code_q == PCI_CODE_OK;
  always_ff @(posedge clk_i) begin
    check_q <= {check_q[0], transfer};
    if (transfer) begin
      check_wide_q <= wide;
      check_full_q <= word_done;
      check_addr_q <= addr_q;
      if (!write_i) rdata_o <= wide ? ad_i : {ad_i[31:0], word_q[31:0]};
    end
    check_addr2_q <= check_addr_q;
    perr_o <= read_error && parity_i;
    code_q <= code;
    if (state_q == IDLE) begin
      code_q <= PCI_CODE_OK;
      good_q <= '0;
    end else if (code != PCI_CODE_OK && code_q == PCI_CODE_OK)
      fault_addr_o <= read_error ? check_addr_q : write_error ? check_addr2_q : addr_q;
    if (rvalid_o) good_q <= good_q + 1;
    done_o <= state_q == SETTLE && (remaining_q == 0 || code != PCI_CODE_OK);
    if (state_q == SETTLE) code_o <= code;
    if (rst_i) begin
      check_q <= '0;
      {perr_o, done_o} <= '0;
    end
  end
  // In a write, the words before the faulty one are good. PERR# came at most two data phases after it.
  assign moved_o = !write_i ? good_q : code_o == PCI_CODE_PARITY ? 10'((fault_addr_o[31:3] - addr_i)) :
      qwords_i - remaining_q;

  always_comb begin
    code = code_q;
    if (code_q == PCI_CODE_OK) begin
      if (read_error || write_error) code = PCI_CODE_PARITY;
      else if (aborted_q && finish) code = PCI_CODE_MASTER_ABORT;
      else if (finish && stop_i && !devsel_i && !transfer) code = PCI_CODE_TARGET_ABORT;
      else if (state_q == SETTLE && retry_limit_i != 0 && retries_q >= retry_limit_i) code = PCI_CODE_RETRY_LIMIT;
      else if (state_q == SETTLE && remaining_q != 0 && !enable_i) code = PCI_CODE_DISABLED;
    end
  end

  // ---- Events ----
  assign burst_o = state_q == ADDRESS;
  assign beat_o = transfer;
  assign wait_o = state_q == DATA && !transfer;
  assign retry_o = finish && stop_i && devsel_i && !transfer && !moved_q;
  assign disconnect_o = finish && stop_i && devsel_i && (transfer || moved_q);
  assign detected_parity_o = read_error;
  assign master_parity_o = (read_error || write_error) && parity_i;
  assign master_abort_o = finish && aborted_q;
  assign target_abort_o = finish && stop_i && !devsel_i && !transfer && !aborted_q;
endmodule
