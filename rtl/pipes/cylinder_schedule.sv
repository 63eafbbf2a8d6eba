// SPDX-License-Identifier: Apache-2.0
// Next pass of a cylinder pair (pass() of reference/pipes/cylinder/schedule.hpp), by steps instead of by count.
// Combinational.
`include "cylinder.svh"
module cylinder_schedule #(
    parameter int BODY = `BODY_CYLINDER
) (
    input logic [23:0] iterations_i,  // {K2, K1, M}, one byte each
    input logic [`PASS_W-1:0] pass_i,
    output logic [`PASS_W-1:0] first_o,
    output logic [`PASS_W-1:0] next_o,
    output logic last_o,  // pass_i is the pair's last pass
    output logic [15:0] passes_o  // passes per pair
);
  /*verilator inline_module*/
  localparam bit CYLINDER = BODY == `BODY_CYLINDER;
  localparam logic [7:0] FRAMES = (BODY == `BODY_BOX) ? 3 : 4, VERTICES = (BODY == `BODY_BOX) ? 8 : 3;
  localparam logic [15:0] WITNESS = 16'd2 + 16'(`PROJECTIONS) + 16'(`WIDE_PROJECTIONS);
  logic [7:0] samples, circle, free, index, next_index;
  logic [3:0] phase, next_phase;
  logic [1:0] track, next_track;
  assign {free, circle, samples} = iterations_i;
  assign phase = `PASS_PHASE(pass_i);
  assign track = `PASS_TRACK(pass_i);
  assign index = `PASS_INDEX(pass_i);
  assign first_o = {10'd0, CYLINDER ? `PHASE_CENTRE : `PHASE_FRAME};
  assign last_o = phase == `PHASE_PROJECT && track == 1 && index == `WIDE_PROJECTIONS - 1;
  assign next_o = {next_index, next_track, next_phase};
  assign passes_o = CYLINDER ? 16'd14 + 2 * 16'(circle) + 3 * 16'(free) + WITNESS
      : 16'(FRAMES) + 16'd7 + 16'(VERTICES) + 3 * (16'(samples) + 16'(circle)) + WITNESS;

  // `count` more passes of this phase, or the next phase.
  logic more, circle_done, track_done;
  logic [7:0] count;
  always_comb begin
    case (phase)
      `PHASE_CENTRE: count = 3;
      `PHASE_FRAME: count = FRAMES;
      `PHASE_VERTEX: count = VERTICES;
      `PHASE_SAMPLE: count = samples + 1;
      `PHASE_REFINE: count = circle;
      `PHASE_NEWTON: count = free;
      `PHASE_PROJECT: count = (track == 0) ? `PROJECTIONS : `WIDE_PROJECTIONS;
      default: count = 1;
    endcase
  end
  assign more = index + 1 < count;
  // A track without steps ends where its steps would begin.
  assign circle_done = phase == `PHASE_REFINE || ((phase == `PHASE_BESIDE || phase == `PHASE_SAMPLE) && circle == 0);
  assign track_done = phase == `PHASE_NEWTON || (phase == `PHASE_START && free == 0);
  always_comb begin
    next_index = more ? index + 1 : 0;
    next_track = track;
    next_phase = phase;
    if (!more) begin
      if (circle_done) begin
        next_track = (track == (CYLINDER ? 2'd1 : 2'd2)) ? 0 : track + 1;
        if (next_track != 0) next_phase = CYLINDER ? `PHASE_CAP : `PHASE_SIDE;
        else next_phase = CYLINDER ? `PHASE_POLE : `PHASE_TOUCH;
      end else if (track_done) begin
        next_track = (track == 2) ? 0 : track + 1;
        next_phase = (track == 0) ? `PHASE_POLE : (track == 1) ? `PHASE_START : `PHASE_TOUCH;
      end else begin
        case (phase)
          `PHASE_CENTRE: next_phase = `PHASE_CAP;
          `PHASE_CAP: next_phase = `PHASE_SIDE;
          `PHASE_SIDE: next_phase = CYLINDER ? `PHASE_BESIDE : `PHASE_SAMPLE;
          `PHASE_FRAME: next_phase = `PHASE_AXIS;
          `PHASE_AXIS: next_phase = `PHASE_VERTEX;
          `PHASE_VERTEX: next_phase = `PHASE_SIDE;
          `PHASE_POLE: next_phase = `PHASE_START;
          `PHASE_START: next_phase = `PHASE_NEWTON;
          `PHASE_TOUCH: next_phase = `PHASE_PROJECT;
          `PHASE_PROJECT: begin
            next_phase = `PHASE_TOUCH;
            next_track = 1;
          end
          default: next_phase = `PHASE_REFINE;  // after beside or the last sample
        endcase
      end
    end
  end
endmodule
