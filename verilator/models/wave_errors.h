// SPDX-License-Identifier: Apache-2.0
// Between fst_writer.cpp, which writes waves, and wave_file.h, which wants to know whether they
// were written and to say what they are of.
#pragma once

class VerilatedFstC;

/// Leaves a comment in an open file, where readers look for them: among the names of signals.
void comment_waves(VerilatedFstC& file, const char* text);

/// Where the writer leaves the errno of the first thing that fails in this thread; null: nowhere.
extern thread_local int* wave_error;
