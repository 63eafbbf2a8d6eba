// SPDX-License-Identifier: Apache-2.0
// Dataflow notation: one line per operator, and no delay is counted by hand. A signal `x` of a datapath has a stage
// time, the localparam `T_x`. An operator line declares its result and the result's time, and delays the early operand.
// DF_IN declares an input, and constants fit any time. In scope: clk_i, EXP, MAN, LANES, CW, ARITH and LAT, the
// operators' latencies. Scalars are `logic [LANES-1:0][CW-1:0]`, and vectors have three of them in front. Masks are all
// ones or all zeros in a lane.
//
//   `DF_VSUB(w, b_c, a_c)        w = b_c - a_c         T_w = max(T_b_c, T_a_c) + LAT.add
//   `DF_DOT(dd, w, w)            dd = w.w              T_dd = T_w + LAT.mul + 2 LAT.add
//
//   `DF_SQRT(d, dd)              d = sqrt(dd)          T_d = T_dd + LAT.sqrt
//
`ifndef CDE_DATAFLOW_SVH
`define CDE_DATAFLOW_SVH

// Parameters that a module must have: the format, the number of lanes, the latency of each operator kind (latency_pkg),
// and the back end.
`define DF_PARAMETERS \
    parameter int EXP = 8, \
    parameter int MAN = 23, \
    parameter int LANES = 1, \
    parameter latency_pkg::latency_t LAT = latency_pkg::ONES, \
    parameter ARITH = "rtl", \
    localparam int CW = (1 + EXP + MAN <= 32) ? 32 : 64
// Parameters that a part takes from the module around it.
`define DF_SAME .EXP(EXP), .MAN(MAN), .LANES(LANES), .LAT(LAT), .ARITH(ARITH)

// Condition under which the results of the following lines are used. Where it is 0, host arithmetic skips the operators
// and they give zeros; gates compute anyway. A module that redefines it restores it at its end. An iterative pipeline
// gains from it: only one phase works at a time.
`define DF_EN 1'b1

// 0 in a module that returns no NaN and whose results do not depend on a NaN's sign. Rays are such, since a hit is
// finite. Its operators leave the NaN of the host's processor. Otherwise every NaN is the canonical one. A module that
// redefines it restores it at its end.
`define DF_CANON 1

`define DF_MAX2(A, B) ((A) > (B) ? (A) : (B))
`define DF_MAX3(A, B, C) `DF_MAX2(A, `DF_MAX2(B, C))
`define DF_CONSTANT (-1)
`define DF_FORMAT .EXP(EXP), .MAN(MAN), .LANES(LANES), .ARITH(ARITH)
`define DF_SCALAR logic [LANES-1:0][CW-1:0]
`define DF_VECTOR logic [2:0][LANES-1:0][CW-1:0]
`define DF_MATRIX logic [2:0][2:0][LANES-1:0][CW-1:0]
`define DF_LAT_DOT (LAT.mul + 2 * LAT.add)
`define DF_LAT_CROSS (LAT.mul + LAT.add)

// ---- Sources of values ----
`define DF_IN(R, EXPRESSION, TIME) localparam int T_``R = TIME; `DF_SCALAR R; assign R = EXPRESSION;
`define DF_VIN(R, EXPRESSION, TIME) localparam int T_``R = TIME; `DF_VECTOR R; assign R = EXPRESSION;
`define DF_CONST(R, WORD) localparam int T_``R = `DF_CONSTANT; `DF_SCALAR R; assign R = {LANES{CW'(WORD)}};
`define DF_VCONST(R, X, Y, Z) localparam int T_``R = `DF_CONSTANT; `DF_VECTOR R; assign R = \
  {{LANES{CW'(Z)}}, {LANES{CW'(Y)}}, {LANES{CW'(X)}}};
`define DF_PICK(R, V, K) localparam int T_``R = T_``V; `DF_SCALAR R; assign R = V[K];
`define DF_AT(R, A, TIME) localparam int T_``R = TIME; `DF_SCALAR R; \
  df_pipe_delay #(.W(LANES * CW), .T_A(T_``A), .T(TIME), .ARITH(ARITH)) delay_``R (.clk_i, .a_i(A), .r_o(R));
`define DF_VAT(R, A, TIME) localparam int T_``R = TIME; `DF_VECTOR R; \
  df_pipe_delay #(.W(3 * LANES * CW), .T_A(T_``A), .T(TIME), .ARITH(ARITH)) delay_``R (.clk_i, .a_i(A), .r_o(R));
`define DF_VEC(R, X, Y, Z) localparam int T_``R = `DF_MAX3(T_``X, T_``Y, T_``Z); `DF_VECTOR R; \
  df_pipe_delay #(.W(LANES * CW), .T_A(T_``X), .T(T_``R), .ARITH(ARITH)) delay_x_``R (.clk_i, .a_i(X), .r_o(R[0])); \
  df_pipe_delay #(.W(LANES * CW), .T_A(T_``Y), .T(T_``R), .ARITH(ARITH)) delay_y_``R (.clk_i, .a_i(Y), .r_o(R[1])); \
  df_pipe_delay #(.W(LANES * CW), .T_A(T_``Z), .T(T_``R), .ARITH(ARITH)) delay_z_``R (.clk_i, .a_i(Z), .r_o(R[2]));

// Three vectors as a matrix, given row by row. DF_TRANSPOSE takes its columns as rows.
`define DF_MATRIX_IN(R, X, Y, Z, TIME) localparam int T_``R = TIME; `DF_MATRIX R; assign R = {Z, Y, X};
`define DF_TRANSPOSE(R, M) localparam int T_``R = T_``M; `DF_MATRIX R; \
  for (genvar k = 0; k < 3; k++) begin : transpose_``R assign R[k] = {M[2][k], M[1][k], M[0][k]}; end

// ---- Operators ----
`define DF_BINARY(R, A, B, OPERATION, LATENCY) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``A, T_``B), 0) + LATENCY; \
  `DF_SCALAR R; \
  df_operator #(`DF_FORMAT, .CANON(`DF_CANON), .OP(OPERATION), .T_A(T_``A), .T_B(T_``B), .LAT(LATENCY)) \
    op_``R (.clk_i, .en_i(`DF_EN), .a_i(A), .b_i(B), .r_o(R));
`define DF_ADD(R, A, B) `DF_BINARY(R, A, B, formats_pkg::FP_ADD, LAT.add)
`define DF_SUB(R, A, B) `DF_BINARY(R, A, B, formats_pkg::FP_SUB, LAT.add)
`define DF_MUL(R, A, B) `DF_BINARY(R, A, B, formats_pkg::FP_MUL, LAT.mul)
`define DF_DIV(R, A, B) `DF_BINARY(R, A, B, formats_pkg::FP_DIV, LAT.div)
`define DF_SQRT(R, A) `DF_BINARY(R, A, A, formats_pkg::FP_SQRT, LAT.sqrt)
`define DF_MIN(R, A, B) `DF_BINARY(R, A, B, formats_pkg::FP_MIN, LAT.cmp)
`define DF_MAX(R, A, B) `DF_BINARY(R, A, B, formats_pkg::FP_MAX, LAT.cmp)
`define DF_LT(M, A, B) `DF_BINARY(M, A, B, formats_pkg::FP_LT, LAT.cmp)
`define DF_LE(M, A, B) `DF_BINARY(M, A, B, formats_pkg::FP_LE, LAT.cmp)
`define DF_EQ(M, A, B) `DF_BINARY(M, A, B, formats_pkg::FP_EQ, LAT.cmp)
// LOW <= A <= HIGH, by two comparisons.
`define DF_BETWEEN(M, LOW, A, HIGH) `DF_LE(M``_low, LOW, A) `DF_LE(M``_high, A, HIGH) `DF_AND(M, M``_low, M``_high)

// ---- Vector operators: three scalar operators, vec_dot and vec_cross. B may be shared: one vector for all lanes ----
`define DF_LANES(SCALAR) ($bits(SCALAR) / CW)
`define DF_BINARY3(R, A, B, OPERATION, LATENCY) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``A, T_``B), 0) + LATENCY; \
  `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : op_``R \
    df_operator #(`DF_FORMAT, .B_LANES(`DF_LANES(B[k])), .CANON(`DF_CANON), .OP(OPERATION), .T_A(T_``A), .T_B(T_``B), \
      .LAT(LATENCY)) \
      op (.clk_i, .en_i(`DF_EN), .a_i(A[k]), .b_i(B[k]), .r_o(R[k])); \
  end
`define DF_VADD(R, A, B) `DF_BINARY3(R, A, B, formats_pkg::FP_ADD, LAT.add)
`define DF_VSUB(R, A, B) `DF_BINARY3(R, A, B, formats_pkg::FP_SUB, LAT.add)
`define DF_VMIN(R, A, B) `DF_BINARY3(R, A, B, formats_pkg::FP_MIN, LAT.cmp)
`define DF_VMAX(R, A, B) `DF_BINARY3(R, A, B, formats_pkg::FP_MAX, LAT.cmp)
`define DF_VMUL(R, A, B) `DF_BINARY3(R, A, B, formats_pkg::FP_MUL, LAT.mul)
`define DF_VLT(M, A, B) `DF_BINARY3(M, A, B, formats_pkg::FP_LT, LAT.cmp)
`define DF_VEQ(M, A, B) `DF_BINARY3(M, A, B, formats_pkg::FP_EQ, LAT.cmp)
// Vectors that all lanes share. With B_LANES = LANES each lane has its own.
`define DF_SHARED_VECTOR logic [2:0][B_LANES-1:0][CW-1:0]
`define DF_SHARED_VIN(R, EXPRESSION, TIME) localparam int T_``R = TIME; `DF_SHARED_VECTOR R; assign R = EXPRESSION;
`define DF_SHARED_VSUB(R, A, B) localparam int T_``R = `DF_MAX2(T_``A, T_``B) + LAT.add; `DF_SHARED_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : op_``R \
    df_operator #(.EXP(EXP), .MAN(MAN), .LANES(B_LANES), .ARITH(ARITH), .CANON(`DF_CANON), .OP(formats_pkg::FP_SUB), \
      .T_A(T_``A), .T_B(T_``B), .LAT(LAT.add)) op (.clk_i, .en_i(`DF_EN), .a_i(A[k]), .b_i(B[k]), .r_o(R[k])); \
  end
// A limited to LOW .. HIGH: max, then min. A NaN gives LOW.
`define DF_CLAMP(R, A, LOW, HIGH) `DF_MAX(R``_not_low, A, LOW) `DF_MIN(R, R``_not_low, HIGH)
`define DF_VCLAMP(R, A, LOW, HIGH) `DF_VMAX(R``_not_low, A, LOW) `DF_VMIN(R, R``_not_low, HIGH)
`define DF_VSCALE(R, V, S) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``V, T_``S), 0) + LAT.mul; `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : op_``R \
    df_operator #(`DF_FORMAT, .CANON(`DF_CANON), .OP(formats_pkg::FP_MUL), .T_A(T_``V), .T_B(T_``S), .LAT(LAT.mul)) \
      op (.clk_i, .en_i(`DF_EN), .a_i(V[k]), .b_i(S), .r_o(R[k])); \
  end
`define DF_DOT(R, A, B) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``A, T_``B), 0) + LAT.mul + 2 * LAT.add; \
  `DF_SCALAR R; \
  df_dot #(`DF_FORMAT, .B_LANES(`DF_LANES(B[0])), .CANON(`DF_CANON), .T_A(T_``A), .T_B(T_``B), .LAT(LAT)) \
    dot_``R (.clk_i, .en_i(`DF_EN), .a_i(A), .b_i(B), .r_o(R));
`define DF_CROSS(R, A, B) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``A, T_``B), 0) + LAT.mul + LAT.add; \
  `DF_VECTOR R; \
  df_cross #(`DF_FORMAT, .B_LANES(`DF_LANES(B[0])), .CANON(`DF_CANON), .T_A(T_``A), .T_B(T_``B), .LAT(LAT)) \
    cross_``R (.clk_i, .en_i(`DF_EN), .a_i(A), .b_i(B), .r_o(R));
// M x, one dot product per row.
`define DF_APPLY(R, M, X) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``M, T_``X), 0) + `DF_LAT_DOT; `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : row_``R \
    df_dot #(`DF_FORMAT, .CANON(`DF_CANON), .T_A(T_``M), .T_B(T_``X), .LAT(LAT)) \
      dot (.clk_i, .en_i(`DF_EN), .a_i(M[k]), .b_i(X), .r_o(R[k])); \
  end
// Row by row: differences, cross and dot products of rows, and rows scaled by the components of a vector.
`define DF_MSUB(R, A, B) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``A, T_``B), 0) + LAT.add; `DF_MATRIX R; \
  for (genvar k = 0; k < 9; k++) begin : op_``R \
    df_operator #(`DF_FORMAT, .CANON(`DF_CANON), .OP(formats_pkg::FP_SUB), .T_A(T_``A), .T_B(T_``B), .LAT(LAT.add)) \
      op (.clk_i, .en_i(`DF_EN), .a_i(A[k/3][k%3]), .b_i(B[k/3][k%3]), .r_o(R[k/3][k%3])); \
  end
`define DF_MSCALE(R, M, V) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``M, T_``V), 0) + LAT.mul; `DF_MATRIX R; \
  for (genvar k = 0; k < 9; k++) begin : op_``R \
    df_operator #(`DF_FORMAT, .CANON(`DF_CANON), .OP(formats_pkg::FP_MUL), .T_A(T_``M), .T_B(T_``V), .LAT(LAT.mul)) \
      op (.clk_i, .en_i(`DF_EN), .a_i(M[k/3][k%3]), .b_i(V[k/3]), .r_o(R[k/3][k%3])); \
  end
`define DF_MCROSS(R, A, B) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``A, T_``B), 0) + `DF_LAT_CROSS; `DF_MATRIX R; \
  for (genvar k = 0; k < 3; k++) begin : row_``R \
    df_cross #(`DF_FORMAT, .CANON(`DF_CANON), .T_A(T_``A), .T_B(T_``B), .LAT(LAT)) \
      cross_row (.clk_i, .en_i(`DF_EN), .a_i(A[k]), .b_i(B[k]), .r_o(R[k])); \
  end
`define DF_MDOT(R, A, B) localparam int T_``R = `DF_MAX2(`DF_MAX2(T_``A, T_``B), 0) + `DF_LAT_DOT; `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : row_``R \
    df_dot #(`DF_FORMAT, .CANON(`DF_CANON), .T_A(T_``A), .T_B(T_``B), .LAT(LAT)) \
      dot (.clk_i, .en_i(`DF_EN), .a_i(A[k]), .b_i(B[k]), .r_o(R[k])); \
  end

// ---- Wires: signs, masks, choices ----
`define DF_SIGN1(R, A, OPERATION) localparam int T_``R = T_``A; `DF_SCALAR R; fp_sign #(`DF_FORMAT, .OP(OPERATION)) \
  sign_``R (.a_i(A), .b_i(A), .r_o(R));
`define DF_ABS(R, A) `DF_SIGN1(R, A, formats_pkg::SIGN_ABS)
`define DF_NEG(R, A) `DF_SIGN1(R, A, formats_pkg::SIGN_NEG)
`define DF_VSIGN1(R, A, OPERATION) localparam int T_``R = T_``A; `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : sign_``R fp_sign #(`DF_FORMAT, .OP(OPERATION)) \
    sign (.a_i(A[k]), .b_i(A[k]), .r_o(R[k])); end
`define DF_VABS(R, A) `DF_VSIGN1(R, A, formats_pkg::SIGN_ABS)
`define DF_VNEG(R, A) `DF_VSIGN1(R, A, formats_pkg::SIGN_NEG)
`define DF_MNEG(R, A) localparam int T_``R = T_``A; `DF_MATRIX R; \
  for (genvar k = 0; k < 9; k++) begin : sign_``R fp_sign #(`DF_FORMAT, .OP(formats_pkg::SIGN_NEG)) \
    sign (.a_i(A[k/3][k%3]), .b_i(A[k/3][k%3]), .r_o(R[k/3][k%3])); end
// Exclusive or of the sign bit of X into Y: move_sign(x, y) of the reference.
`define DF_MOVE_SIGN(R, X, Y) localparam int T_``R = `DF_MAX2(T_``X, T_``Y); `DF_SCALAR R; \
  df_wire #(`DF_FORMAT, .OP(formats_pkg::WIRE_SIGN), .T_A(T_``Y), .T_B(T_``X)) \
    wire_``R (.clk_i, .a_i(Y), .b_i(X), .r_o(R));
// The same for vectors: component by component, or one scalar's sign on all.
`define DF_VMOVE_SIGN(R, X, Y) localparam int T_``R = `DF_MAX2(T_``X, T_``Y); `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : wire_``R \
    df_wire #(`DF_FORMAT, .OP(formats_pkg::WIRE_SIGN), .T_A(T_``Y), .T_B(T_``X)) \
      move (.clk_i, .a_i(Y[k]), .b_i(X[k]), .r_o(R[k])); \
  end
`define DF_VFLIP(R, X, Y) localparam int T_``R = `DF_MAX2(T_``X, T_``Y); `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : wire_``R \
    df_wire #(`DF_FORMAT, .OP(formats_pkg::WIRE_SIGN), .T_A(T_``Y), .T_B(T_``X)) \
      move (.clk_i, .a_i(Y[k]), .b_i(X), .r_o(R[k])); \
  end
// The sign bit of A as a mask.
`define DF_NEGATIVE(M, A) localparam int T_``M = T_``A; `DF_SCALAR M; df_negative #(`DF_FORMAT) \
  negative_``M (.a_i(A), .m_o(M));
`define DF_LOGIC(M, A, B, OPERATION) localparam int T_``M = `DF_MAX2(T_``A, T_``B); `DF_SCALAR M; \
  df_wire #(`DF_FORMAT, .OP(OPERATION), .T_A(T_``A), .T_B(T_``B)) wire_``M (.clk_i, .a_i(A), .b_i(B), .r_o(M));
`define DF_AND(M, A, B) `DF_LOGIC(M, A, B, formats_pkg::WIRE_AND)
`define DF_OR(M, A, B) `DF_LOGIC(M, A, B, formats_pkg::WIRE_OR)
`define DF_NOT(M, A) localparam int T_``M = T_``A; `DF_SCALAR M; assign M = ~A;
// A where the mask is set, else B.
`define DF_SELECT(R, M, A, B) localparam int T_``R = `DF_MAX3(T_``M, T_``A, T_``B); `DF_SCALAR R; \
  df_select #(.CW(CW), .LANES(LANES), .ARITH(ARITH), .T_M(T_``M), .T_A(T_``A), .T_B(T_``B)) \
    select_``R (.clk_i, .m_i(M), .a_i(A), .b_i(B), .r_o(R));
`define DF_VSELECT(R, M, A, B) localparam int T_``R = `DF_MAX3(T_``M, T_``A, T_``B); `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : select_``R \
    df_select #(.CW(CW), .LANES(LANES), .ARITH(ARITH), .T_M(T_``M), .T_A(T_``A), .T_B(T_``B)) \
      select (.clk_i, .m_i(M), .a_i(A[k]), .b_i(B[k]), .r_o(R[k])); \
  end

// ---- The dominant axis of a vector: its largest component by magnitude, ties the lowest index ----
`define DF_DOMINANT(M, V) localparam int T_``M = `DF_MAX2(T_``V, 0) + 2 * LAT.cmp; logic [1:0][LANES-1:0][CW-1:0] M; \
  df_dominant #(`DF_FORMAT, .LAT(LAT)) dominant_``M (.clk_i, .a_i(V), .m_o(M));
// Components of V in cyclic order from the dominant axis M: R[0] is on that axis, R[1] and R[2] on the next two.
`define DF_CYCLE(R, M, V) localparam int T_``R = `DF_MAX2(T_``M, T_``V); `DF_VECTOR R; \
  df_cycle #(.CW(CW), .LANES(LANES), .ARITH(ARITH), .T_M(T_``M), .T_A(T_``V)) \
    cycle_``R (.clk_i, .m_i(M), .a_i(V), .r_o(R));
// The same with one mask per component.
`define DF_VSELECT_EACH(R, M, A, B) localparam int T_``R = `DF_MAX3(T_``M, T_``A, T_``B); `DF_VECTOR R; \
  for (genvar k = 0; k < 3; k++) begin : select_``R \
    df_select #(.CW(CW), .LANES(LANES), .ARITH(ARITH), .T_M(T_``M), .T_A(T_``A), .T_B(T_``B)) \
      select (.clk_i, .m_i(M[k]), .a_i(A[k]), .b_i(B[k]), .r_o(R[k])); \
  end
// Three choices: A if FIRST, else B if SECOND, else C.
`define DF_SELECT3(R, FIRST, SECOND, A, B, C) `DF_SELECT(R``_rest, SECOND, B, C) `DF_SELECT(R, FIRST, A, R``_rest)
`define DF_VSELECT3(R, FIRST, SECOND, A, B, C) `DF_VSELECT(R``_rest, SECOND, B, C) `DF_VSELECT(R, FIRST, A, R``_rest)
// Masks R_first and R_second choose the least of three, ties to the first (least3 of the reference; 3 compare). Without
// either mask it is the third. The next operator gives the least value.
`define DF_WHICH3(R, A, B, C) `DF_LE(R``_ab, A, B) `DF_LE(R``_ac, A, C) `DF_LE(R``_second, B, C) \
  `DF_AND(R``_first, R``_ab, R``_ac)
`define DF_LEAST3(R, A, B, C) `DF_WHICH3(R, A, B, C) `DF_SELECT3(R, R``_first, R``_second, A, B, C)

// ---- Control: one bit for all lanes, and selection by it ----
`define DF_CONTROL(C, EXPRESSION, TIME) localparam int T_``C = TIME; logic C; assign C = EXPRESSION;
// A where the bit is set, else B.
`define DF_CHOOSE(R, C, A, B) localparam int T_``R = `DF_MAX3(T_``C, T_``A, T_``B); `DF_SCALAR R; \
  df_choose #(.W(LANES * CW), .ARITH(ARITH), .T_C(T_``C), .T_A(T_``A), .T_B(T_``B)) \
    choose_``R (.clk_i, .c_i(C), .a_i(A), .b_i(B), .r_o(R));
`define DF_VCHOOSE(R, C, A, B) localparam int T_``R = `DF_MAX3(T_``C, T_``A, T_``B); `DF_VECTOR R; \
  df_choose #(.W(3 * LANES * CW), .ARITH(ARITH), .T_C(T_``C), .T_A(T_``A), .T_B(T_``B)) \
    choose_``R (.clk_i, .c_i(C), .a_i(A), .b_i(B), .r_o(R));
// The bit as a lane mask.
`define DF_FILL(M, C) localparam int T_``M = T_``C; `DF_SCALAR M; assign M = {(LANES * CW) {C}};
// ---- Units that TURNS = 1 or 3 users share (df_turn.sv), selected by a phase that counts 0, 1, 2 ----
`define DF_PHASE_IN(R, EXPRESSION, TIME) localparam int T_``R = TIME; logic [1:0] R; assign R = EXPRESSION;
`define DF_PHASE_AT(R, A, TIME) localparam int T_``R = TIME; logic [1:0] R; \
  df_pipe_delay #(.W(2), .T_A(T_``A), .T(TIME), .ARITH(ARITH)) delay_``R (.clk_i, .a_i(A), .r_o(R));
// A, B or C by the phase; with TURNS = 1 the operand of user U. With PASSING, operands B and C wait for their phase.
`define DF_TURN_OF(R, WORDS, PASSES, U, PHASE, A, B, C) localparam int T_``R = T_``PHASE; \
  df_turn #(.W(WORDS * LANES * CW), .TURNS(TURNS), .USER(U), .PASSING(PASSES), .T_PHASE(T_``PHASE), .T_A(T_``A), \
    .T_B(T_``B), .T_C(T_``C), \
      .ARITH(ARITH)) turn_``R (.clk_i, .phase_i(PHASE), .a_i(A), .b_i(B), .c_i(C), .r_o(R));
`define DF_TURN(R, U, PHASE, A, B, C) `DF_SCALAR R; `DF_TURN_OF(R, 1, 0, U, PHASE, A, B, C)
`define DF_VTURN(R, U, PHASE, A, B, C) `DF_VECTOR R; `DF_TURN_OF(R, 3, 0, U, PHASE, A, B, C)
`define DF_MTURN(R, U, PHASE, A, B, C) `DF_MATRIX R; `DF_TURN_OF(R, 9, 0, U, PHASE, A, B, C)
`define DF_TURN_PASSING(R, U, PHASE, A, B, C) `DF_SCALAR R; `DF_TURN_OF(R, 1, 1, U, PHASE, A, B, C)
`define DF_VTURN_PASSING(R, U, PHASE, A, B, C) `DF_VECTOR R; `DF_TURN_OF(R, 3, 1, U, PHASE, A, B, C)
// The value of phase 0, held for all phases.
`define DF_HOLD(R, PHASE, A) `DF_TURN_PASSING(R, 0, PHASE, A, A, A)
`define DF_VHOLD(R, PHASE, A) `DF_VTURN_PASSING(R, 0, PHASE, A, A, A)
// The word of 2^E; it may be subnormal.
`define DF_POWER_OF_TWO(E) formats_pkg::power_of_two(EXP, MAN, E)
`endif
