// SPDX-License-Identifier: Apache-2.0
// Between fst_writer.cpp, which writes waves, and wave_file.h, which wants to know whether they
// were written.
#pragma once

/// Where the writer leaves the errno of the first thing that fails in this thread; null: nowhere.
extern thread_local int* wave_error;
