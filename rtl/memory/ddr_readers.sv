// SPDX-License-Identifier: Apache-2.0
// Shares DDR's one read port among several readers. A round-robin arbiter chooses a request, and a response goes to its
// reader. A reader holds its request until ready_o, or withdraws it. So a reader waits for at most one request of each
// other reader. DDR answers in order, at any time, and a queue holds the readers of outstanding responses.
// USED, bit r: reader r exists. Requests of others are ignored. With a single reader the module is wires, and its
// requests are taken while the memory is ready.
// Latency: 0 cycles for requests and responses.
// Throughput: one request and one response per cycle.
// Stall: ready_o, while the memory is not ready or DEPTH responses are outstanding.
module ddr_readers #(
    parameter int READERS = 2,  // 2 and more
    parameter logic [READERS-1:0] USED = '1,
    parameter int DEPTH = 256,  // power of two
    localparam int W = config_pkg::index_bits(READERS)
) (
    input logic clk_i,
    input logic rst_i,
    input card_pkg::ddr_request_t [READERS-1:0] readers_i,
    output logic [READERS-1:0] ready_o,
    output logic [READERS-1:0] valid_o,      // the current beat of DDR belongs to this reader
    input logic [READERS-1:0][3:0] words_i,  // words of that beat in use

    output card_pkg::ddr_request_t request_o,
    input logic ready_i,
    input logic valid_i,
    output logic [3:0] words_o
);
  if (READERS < 2 || USED == 0) begin : g_readers
    $error("ddr_readers: READERS must be 2 or more, and one of them USED");
  end
  if ((USED & (USED - 1'b1)) == 0) begin : g_alone
    localparam int R = $clog2(USED);
    assign request_o = readers_i[R];
    assign ready_o = ready_i ? USED : '0;
    assign valid_o = valid_i ? USED : '0;
    assign words_o = words_i[R];
    logic unused_others;
    assign unused_others = &{1'b0, clk_i, rst_i, readers_i, words_i};
  end else begin : g_shared
    localparam int D = $clog2(DEPTH);
    logic [READERS-1:0] requesting, masked, mask_q, chosen;  // readers after the one served last
    logic [W-1:0] turn, owner_q;  // owner_q: reader of the oldest outstanding response
    logic [W-1:0] owners[DEPTH];
    logic [D:0] requested_q, answered_q, answered;
    // The room of the queue of owners, one cycle ahead.
    logic taken, full_q;
    logic [D:0] outstanding;
    assign taken = request_o.valid && ready_i;
    assign outstanding = requested_q - answered_q;
    always_ff @(posedge clk_i)
      full_q <= !rst_i && !valid_i && (full_q || (outstanding == (D + 1)'(DEPTH - 1) && taken));
    for (genvar r = 0; r < READERS; r++) begin : reader
        assign requesting[r] = USED[r] && readers_i[r].valid; end
    assign masked = requesting & mask_q;
    assign chosen = (masked != 0) ? masked : requesting;
    always_comb begin
      turn = '0;
      for (int r = READERS - 1; r >= 0; r--) if (chosen[r]) turn = W'(r);
    end
    assign request_o.valid = requesting != 0 && !full_q;
    assign {request_o.word, request_o.words} = {readers_i[turn].word, readers_i[turn].words};
    assign ready_o = taken ? READERS'(1) << turn : '0;
    assign answered = answered_q + (D + 1)'(valid_i);
    assign valid_o = valid_i ? READERS'(1) << owner_q : '0;
    assign words_o = words_i[owner_q];
    always_ff @(posedge clk_i) begin
      if (taken) begin
        owners[requested_q[D-1:0]] <= turn;
        requested_q <= requested_q + 1'b1;
        mask_q <= ~((READERS'(2) << turn) - 1'b1);
      end
      answered_q <= answered;
      owner_q <= (taken && requested_q == answered) ? turn : owners[answered[D-1:0]];
      if (rst_i) begin
        {requested_q, answered_q} <= '0;
        mask_q <= '1;
      end
    end
`ifndef SYNTHESIS
    always_ff @(posedge clk_i)
      if (!rst_i) begin
        assert (!(valid_i && requested_q == answered_q)) else $error("ddr_readers: data without a request");
      end
`endif
  end
endmodule
